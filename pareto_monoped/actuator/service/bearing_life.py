"""Loads on the bearings of one actuator in the present layout, and what they leave: life and static safety.

The output's main bearing is a single row. At the knee, the chain pulls in front of it with nothing else to hold the
output, so that the row carries the whole tilting moment. At the hip, leg and knee actuator rest in two bearings, the
main bearing and that of the far cheek, so that neither sees a moment. End and rear bearing hold sun and rotor.
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.actuator.actuator import Actuator
from pareto_monoped.actuator.bearings import RatedBearing, rated_bearing
from pareto_monoped.actuator.layout import Layout
from pareto_monoped.actuator.rating.build import load_sharing
from pareto_monoped.actuator.rating_data import DutyData
from pareto_monoped.actuator.service.ball_row import row_load
from pareto_monoped.actuator.service.data import ServiceData
from pareto_monoped.actuator.settings import ActuatorSettings
from pareto_monoped.design import GRAVITY_M_PER_S2
from pareto_monoped.geometry.gears import PRESSURE_ANGLE_RAD

Place = Literal["main, knee", "main, hip", "end", "rear"]
Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class BearingService:
    """One bearing under the duty.

    Attributes:
        place: which bearing, and for the main bearing at which joint.
        bearing: of the catalogue.
        force_n, tilt_n_m: radial force and tilting moment at the actuator's peak torque.
        equivalent_n: dynamic equivalent load there.
        tilt_rad: by which the rings turn against each other.
        life_h: L10 under the duty.
        static_safety: at the peak torque.
        overload_safety: static safety under the overload.
        turns_per_output: its speed over the output's.
    """

    place: Place
    bearing: RatedBearing
    force_n: float
    tilt_n_m: float
    equivalent_n: float
    tilt_rad: float
    life_h: float
    static_safety: float
    overload_safety: float
    turns_per_output: float


def bearing_services(
    actuator: Actuator, at: Layout, settings: ActuatorSettings, service: ServiceData
) -> tuple[BearingService, ...]:
    """Every bearing of an actuator at both joints; the same actuator is taken for hip and knee.

    Args:
        actuator: the actuator.
        at: its layout.
        settings: of stage 1, with the duty.
        service: pace, forces and fits.
    """
    duty = settings.parts.duty
    main = rated_bearing(float(at.bearing.inner_diameter_mm))
    levels = np.array([*duty.torque_shares, 1.0, settings.parts.rating.overload_factor])
    force, moment = chain_load(actuator, at, service)
    hip = hip_force_n(actuator, at, service)
    # Sun and rotor rest in two bearings; the carrier of an ESSPG and the motor's own bearings share the sun's load.
    sun = 0.5 * uneven_force_n(actuator, settings)
    found = [
        _service("main, knee", main, levels * force, levels * moment, 1.0, duty, service),
        _service("main, hip", main, levels * hip, 0.0 * levels, 1.0, duty, service),
        _service(
            "end",
            rated_bearing(float(at.end_bearing.inner_diameter_mm)),
            levels * sun,
            0.0 * levels,
            actuator.ratio - 1.0,
            duty,
            service,
        ),
    ]
    if actuator.family == "ISSPG":
        assert actuator.motor.frameless is not None
        rotor = 0.5 * actuator.motor.rotor_mass_share * actuator.motor.frameless.mass_kg * GRAVITY_M_PER_S2
        bearing = rated_bearing(float(at.rear_bearing.inner_diameter_mm))
        found.append(_service("rear", bearing, levels * sun + rotor, 0.0 * levels, actuator.ratio, duty, service))
    return tuple(found)


def chain_load(actuator: Actuator, at: Layout, service: ServiceData) -> tuple[float, float]:
    """Pull of the chain at the peak torque in N, and its moment about the main bearing's middle in N m."""
    pull = actuator.peak_torque_n_m / (1e-3 * service.chain_radius_mm)
    return pull, 1e-3 * pull * (service.chain_offset_mm + main_bearing_depth_mm(at))


def main_bearing_depth_mm(at: Layout) -> float:
    """How far the middle of the main bearing lies behind the output face."""
    return -0.5 * float(at.z_bearing_front + at.z_bearing_back)


def hip_force_n(actuator: Actuator, at: Layout, service: ServiceData) -> float:
    """Radial force on the hip's main bearing: its share of foot force and weight, which act in the leg's middle plane.

    The other support is the far cheek's bearing, behind the knee actuator. Both are taken as pivots.
    """
    near = service.leg_offset_mm + main_bearing_depth_mm(at)
    far = service.chain_offset_mm + actuator.length_mm + service.far_bearing_mm
    return (service.foot_force_n + service.leg_weight_n) * far / (near + far)


def uneven_force_n(actuator: Actuator, settings: ActuatorSettings) -> float:
    """Radial force on the sun at the peak torque: what one planet's teeth press above the mean, (K_gamma - 1) of it."""
    gears = actuator.gears
    radius_m = 0.5e-3 * float(gears.module_mm) * float(gears.sun_teeth)
    tangential = actuator.motor.peak_torque_n_m / (radius_m * float(gears.planets))
    uneven = float(load_sharing(gears.planets, settings)) - 1.0
    return float(uneven * tangential / np.cos(PRESSURE_ANGLE_RAD))


def output_turns_per_hour(duty: DutyData, service: ServiceData) -> float:
    """Angle through which the output turns in an hour, in whole turns."""
    return 60.0 * service.jumps_per_minute * sum(duty.output_angles_rad) / (2.0 * np.pi)


def _service(
    place: Place,
    bearing: RatedBearing,
    force: Floats,
    moment: Floats,
    turns: float,
    duty: DutyData,
    service: ServiceData,
) -> BearingService:
    """Rate a bearing; the loads are those of the duty's levels, of the peak torque and of the overload."""
    loads = row_load(bearing, force, moment, service.bearing_clearance_mm)
    angles = np.array(duty.output_angles_rad)
    million_turns = (bearing.dynamic_rating_n / loads.equivalent_n[: len(angles)]) ** 3  # ISO 281, clause 5.3
    # Palmgren and Miner: each level takes its share of the turns.
    life_turns = 1e6 / float(np.sum(angles / np.sum(angles) / million_turns))
    peak, overload = len(angles), len(angles) + 1
    return BearingService(
        place=place,
        bearing=bearing,
        force_n=float(force[peak]),
        tilt_n_m=float(moment[peak]),
        equivalent_n=float(loads.equivalent_n[peak]),
        tilt_rad=float(loads.tilt_rad[peak]),
        life_h=life_turns / (output_turns_per_hour(duty, service) * turns),
        static_safety=float(loads.static_safety[peak]),
        overload_safety=float(loads.static_safety[overload]),
        turns_per_output=turns,
    )
