"""What the gears are rated for and what the joints ask: steels, safeties, duty, forces, pace, and lives under them.

Values and sources stand in ``data/actuator_parts.toml`` and ``data/service.toml``.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache, reduce
from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from pareto_monoped.config import NotNegative, Positive, Strict, checked, read_shipped
from pareto_monoped.geometry.shapes import Numbers
from pareto_monoped.materials import GEAR_GRADES, GearGrade

SecondCarrier = Literal["pins", "webs"]
PlanetBearing = Literal["bushes", "needles"]


@dataclass(frozen=True, slots=True, kw_only=True)
class WebData(Strict):
    """Webs between the planets, in one piece with the carrier, to which the second carrier is screwed."""

    clearance_mm: Positive  #: to the tips of planets and ring
    depth_mm: Positive  #: largest radial extent
    overhang_mm: Annotated[float, Field(ge=0.0)]  #: how far they may reach beyond the metal around the pins
    screw_wall_mm: Positive  #: least metal around the tapping hole of the screw
    neck_mm: Positive  #: least half width


@dataclass(frozen=True, slots=True, kw_only=True)
class NeedleData(Strict):
    """Rows of loose needle rollers between pin and planet, and the washers beside the planet."""

    diameter_mm: Positive  #: of a needle
    lengths_mm: tuple[Positive, ...]  #: to choose from, increasing; a planet takes one row, or two of the same length
    end_mm: Positive  #: what a rounded end takes from the length that carries, at either end
    washer_mm: Positive  #: thickness of a washer, between planet and carrier
    washer_diameter_mm: Positive
    washer_play_mm: Positive  #: axial play of the planet at either washer
    friction_coefficient: Positive  #: at the radius of the pin


GradeName = Literal[
    "case_hardened_18crnimo7_6",
    "case_hardened_16mncr5",
    "nitrided_31crmov9",
    "nitrided_42crmo4",
    "through_hardened_42crmo4",
]
"""Names of the grades in ``materials.GEAR_GRADES``."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RatingData(Strict):
    """Safety factors, limits of the face width, and what the factors of ISO 6336 need to know of design and making."""

    sun_grade: GradeName
    planet_grade: GradeName
    ring_grade: GradeName
    flank_safety: Positive  #: least S_H under the duty
    root_safety: Positive  #: least S_F under the duty
    overload_flank_safety: Positive  #: least S_H against static failure under one overload
    overload_root_safety: Positive  #: least S_F, likewise
    overload_factor: Positive  #: largest torque of a single event over the motor's peak torque
    application_factor: Positive  #: K_A
    face_width_min_mm: Positive  #: least face width
    face_modules_min: Positive  #: the same in modules
    face_over_sun_max: Positive  #: largest face width over the sun's reference diameter
    face_modules_max: Positive  #: largest face width in modules
    tip_thickness_modules: Positive  #: least thickness of the teeth of sun and planets at their tips
    face_step_mm: Positive  #: face widths are multiples of this
    accuracy_class: Annotated[int, Field(ge=3, le=10)]  #: of the teeth, ISO 1328-1
    planet_crowning_um: Annotated[float, Field(ge=0.0)]  #: C_beta of the planets' flanks
    flank_finish_factor: Positive  #: Z_L Z_v Z_R of sun and planets
    ring_finish_factor: Positive  #: of planets and ring
    flank_roughness_um: Positive  #: greatest Rz of the flanks, for which it holds
    root_roughness_um: Annotated[float, Field(ge=1.0, le=40.0)]  #: Rz of the fillets
    reversed_bending_factor: Positive  #: Y_M of the planets, whose teeth bend both ways in every turn
    #: What ties it to the first: the planets' ``pins`` alone, which tilt under load, or ``webs`` between the planets as
    #: well, where the gaps have room for them
    second_carrier: SecondCarrier
    planet_bearing: PlanetBearing  #: what the planets turn on: ``bushes``, or rows of ``needles``
    sun_support: Literal["fixed", "floating"]  #: whether the sun is held by bearings or floats between the planets
    load_sharing_fixed: tuple[Positive, ...]  #: K_gamma for 2, 3, ... planets; the last value also beyond
    load_sharing_floating: tuple[Positive, ...]  #: likewise


@dataclass(frozen=True, slots=True, kw_only=True)
class DutyData(Strict):
    """The load spectrum that the gears are rated for."""

    jumps: Positive  #: how many the gears shall last
    #: Torque over the motor's peak torque, one value per level; above 1 where a stop is struck
    torque_shares: tuple[Annotated[float, Field(gt=0.0, le=10.0)], ...]
    #: Angle through which the output turns at that torque in each jump, one value per level
    output_angles_rad: tuple[Positive, ...]
    #: Whether the torque of a level loads the back flanks, one value per level; none does if empty
    reversed: tuple[bool, ...] = ()

    @property
    def forward_levels(self) -> tuple[tuple[float, float], ...]:
        """Torque share and angle of the levels that load the front flanks."""
        return self._levels(back=False)

    @property
    def reversed_levels(self) -> tuple[tuple[float, float], ...]:
        """Torque share and angle of the levels that load the back flanks."""
        return self._levels(back=True)

    def _levels(self, *, back: bool) -> tuple[tuple[float, float], ...]:
        sides = self.reversed or (False,) * len(self.torque_shares)
        levels = zip(self.torque_shares, self.output_angles_rad, sides, strict=True)
        return tuple((share, angle) for share, angle, side in levels if side == back)

    @property
    def mean_share(self) -> float:
        """Mean torque over the peak torque, by angle."""
        levels = zip(self.torque_shares, self.output_angles_rad, strict=True)
        return sum(share * angle for share, angle in levels) / sum(self.output_angles_rad)

    def __post_init__(self) -> None:
        """Refuse levels without an angle."""
        if len(self.torque_shares) != len(self.output_angles_rad) or not self.torque_shares:
            raise ValueError(
                f"torque_shares and output_angles_rad have {len(self.torque_shares)} and "
                f"{len(self.output_angles_rad)} values: must be one per level each; correct them"
            )
        if self.reversed and len(self.reversed) != len(self.torque_shares):
            raise ValueError(
                f"reversed and torque_shares have {len(self.reversed)} and {len(self.torque_shares)} values: "
                "must be one per level each; correct them"
            )


@dataclass(frozen=True, slots=True, kw_only=True)
class GearSteels:
    """The steel grade of each gear."""

    sun: GearGrade
    planet: GearGrade
    ring: GearGrade


def chosen_steels(data: RatingData) -> GearSteels:
    """Return the grades that the settings name."""
    return GearSteels(
        sun=GEAR_GRADES[data.sun_grade], planet=GEAR_GRADES[data.planet_grade], ring=GEAR_GRADES[data.ring_grade]
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class ServiceData(Strict):
    """Pace of the joints, forces on the output, fit and lubrication of the bearings."""

    jumps_per_minute: Positive  #: on average
    mean_speed_rad_per_s: Positive  #: of the output while it moves
    chain_radius_mm: Positive  #: of the knee's sprocket
    chain_offset_mm: NotNegative  #: knee: how far the chain runs in front of the output face
    drive_support_mm: Positive  #: knee: from the chain to the middle of the bearing that carries the drive's far end
    drive_support_bearing: str  #: knee: designation of that bearing, in ``data/needle_bearings.csv``
    drive_support_clearance_mm: NotNegative  #: its radial clearance when fitted
    leg_offset_mm: NotNegative  #: hip: how far the leg's middle plane lies in front of the output face
    #: Hip: from the back of the knee actuator to the middle of the bearing that carries its free end
    far_bearing_mm: Positive
    foot_force_n: NotNegative  #: largest in the push-off
    leg_weight_n: NotNegative  #: of what hangs on the hip
    bearing_clearance_mm: NotNegative  #: radial clearance of a fitted bearing
    bearing_tilt_limit_rad: Positive  #: by which the rings may turn against each other
    bearing_life_min_h: Positive  #: least L10 under the duty
    static_safety_min: Positive  #: least s0 at the peak torque
    overload_static_safety_min: Positive  #: least s0 under the overload
    bearing_friction_coefficient: Positive  #: of ball bearings, at the radius of the bore
    needle_friction_coefficient: Positive  #: of needle roller bearings with a cage, likewise
    lubricant_viscosity_mm2_per_s: NotNegative  #: of the oil that the bearings churn; 0 if they churn none


@lru_cache(maxsize=1)
def default_service() -> ServiceData:
    """Return the shipped service data."""
    return checked(ServiceData, read_shipped("service.toml", what="service data"), source="service data")


def output_turns_per_hour(duty: DutyData, service: ServiceData) -> float:
    """Return the angle through which the output turns in an hour, in whole turns."""
    return 60.0 * service.jumps_per_minute * sum(duty.output_angles_rad) / (2.0 * np.pi)


def life_turns(loads_n: Sequence[Numbers], rating_n: Numbers, exponent: float, duty: DutyData) -> Numbers:
    """Return L10 in turns (ISO 281, Palmgren, Miner) under the duty; ``exponent``: 3 for balls, 10 / 3 for rollers."""
    whole = sum(duty.output_angles_rad)
    levels = zip(loads_n, duty.output_angles_rad, strict=True)
    used = [angle / whole * (load / rating_n) ** exponent for load, angle in levels]
    return 1e6 / reduce(np.add, used)
