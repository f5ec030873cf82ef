"""What the joints ask of an actuator: forces, pace, fit; values and sources stand in ``data/service.toml``."""

from dataclasses import dataclass
from functools import lru_cache
from typing import Annotated

from pydantic import ConfigDict, Field

from pareto_monoped.config import checked, read_shipped

Positive = Annotated[float, Field(gt=0.0, allow_inf_nan=False)]
NotNegative = Annotated[float, Field(ge=0.0, allow_inf_nan=False)]


@dataclass(frozen=True, slots=True, kw_only=True)
class ServiceData:
    """Pace of the joints, forces on the output, fit and lubrication of the bearings.

    Attributes:
        jumps_per_minute: on average.
        mean_speed_rad_per_s: of the output while it moves.
        chain_radius_mm: of the knee's sprocket.
        chain_offset_mm: knee: how far the chain runs in front of the output face.
        drive_support_mm: knee: from the chain to the middle of the bearing that carries the drive's far end.
        drive_support_bearing: knee: designation of that bearing, in ``data/needle_bearings.csv``.
        drive_support_clearance_mm: its radial clearance when fitted.
        leg_offset_mm: hip: how far the leg's middle plane lies in front of the output face.
        far_bearing_mm: hip: from the back of the knee actuator to the middle of the bearing that carries its free end.
        foot_force_n: largest in the push-off.
        leg_weight_n: of what hangs on the hip.
        bearing_clearance_mm: radial clearance of a fitted bearing.
        bearing_tilt_limit_rad: by which the rings may turn against each other.
        bearing_life_min_h: least L10 under the duty.
        static_safety_min, overload_static_safety_min: least s0 at the peak torque and under the overload.
        bearing_friction_coefficient: of ball bearings, at the radius of the bore.
        needle_friction_coefficient: of needle roller bearings with a cage, likewise.
        lubricant_viscosity_mm2_per_s: of the oil that the bearings churn; 0 if they churn none.
    """

    __pydantic_config__ = ConfigDict(extra="forbid")

    jumps_per_minute: Positive
    mean_speed_rad_per_s: Positive
    chain_radius_mm: Positive
    chain_offset_mm: NotNegative
    drive_support_mm: Positive
    drive_support_bearing: str
    drive_support_clearance_mm: NotNegative
    leg_offset_mm: NotNegative
    far_bearing_mm: Positive
    foot_force_n: NotNegative
    leg_weight_n: NotNegative
    bearing_clearance_mm: NotNegative
    bearing_tilt_limit_rad: Positive
    bearing_life_min_h: Positive
    static_safety_min: Positive
    overload_static_safety_min: Positive
    bearing_friction_coefficient: Positive
    needle_friction_coefficient: Positive
    lubricant_viscosity_mm2_per_s: NotNegative


@lru_cache(maxsize=1)
def default_service() -> ServiceData:
    """The shipped service data."""
    return checked(ServiceData, read_shipped("service.toml", what="service data"), source="service data")
