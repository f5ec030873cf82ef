"""Settings of the rating after ISO 6336; values and sources stand in ``data/actuator_parts.toml``."""

from dataclasses import dataclass
from typing import Annotated, Literal

from pydantic import ConfigDict, Field

from pareto_monoped.actuator.carrier_data import PlanetBearing, SecondCarrier
from pareto_monoped.materials import GEAR_GRADES, GearGrade

Positive = Annotated[float, Field(gt=0.0, allow_inf_nan=False)]
_STRICT = ConfigDict(extra="forbid")

GradeName = Literal[
    "case_hardened_18crnimo7_6",
    "case_hardened_16mncr5",
    "nitrided_31crmov9",
    "nitrided_42crmo4",
    "through_hardened_42crmo4",
]
"""Names of the grades in ``materials.GEAR_GRADES``."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RatingData:
    """Safety factors, limits of the face width, and what the factors of ISO 6336 need to know of design and making.

    Attributes:
        sun_grade, planet_grade, ring_grade: steel of each gear.
        flank_safety, root_safety: least S_H and S_F under the duty.
        overload_flank_safety, overload_root_safety: least S_H and S_F against static failure under one overload.
        overload_factor: largest torque of a single event over the motor's peak torque.
        application_factor: K_A.
        face_width_min_mm, face_modules_min: least face width.
        face_over_sun_max: largest face width over the sun's reference diameter.
        face_modules_max: largest face width in modules.
        tip_thickness_modules: least thickness of the teeth of sun and planets at their tips.
        face_step_mm: face widths are multiples of this.
        accuracy_class: of the teeth, ISO 1328-1.
        flank_finish_factor: Z_L Z_v Z_R.
        flank_roughness_um: greatest Rz of the flanks, for which it holds.
        root_roughness_um: Rz of the fillets.
        reversed_bending_factor: Y_M of the planets, whose teeth bend both ways in every turn.
        second_carrier: what ties it to the first: the planets' ``pins`` alone, which tilt under load, or ``webs``
            between the planets as well, where the gaps have room for them.
        planet_bearing: what the planets turn on: ``bushes``, or rows of ``needles``.
        sun_support: whether the sun is held by bearings or floats between the planets.
        load_sharing_fixed, load_sharing_floating: K_gamma for 2, 3, ... planets; the last value also beyond.
    """

    __pydantic_config__ = _STRICT

    sun_grade: GradeName
    planet_grade: GradeName
    ring_grade: GradeName
    flank_safety: Positive
    root_safety: Positive
    overload_flank_safety: Positive
    overload_root_safety: Positive
    overload_factor: Positive
    application_factor: Positive
    face_width_min_mm: Positive
    face_modules_min: Positive
    face_over_sun_max: Positive
    face_modules_max: Positive
    tip_thickness_modules: Positive
    face_step_mm: Positive
    accuracy_class: Annotated[int, Field(ge=3, le=10)]
    flank_finish_factor: Positive
    flank_roughness_um: Positive
    root_roughness_um: Annotated[float, Field(ge=1.0, le=40.0)]
    reversed_bending_factor: Positive
    second_carrier: SecondCarrier
    planet_bearing: PlanetBearing
    sun_support: Literal["fixed", "floating"]
    load_sharing_fixed: tuple[Positive, ...]
    load_sharing_floating: tuple[Positive, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class DutyData:
    """The load spectrum that the gears are rated for.

    Attributes:
        jumps: how many the gears shall last.
        torque_shares: torque over the motor's peak torque, one value per level; above 1 where a stop is struck.
        reversed: whether the torque of a level loads the back flanks, one value per level; none does if empty.
        output_angles_rad: angle through which the output turns at that torque in each jump, one value per level.
    """

    __pydantic_config__ = _STRICT

    jumps: Positive
    torque_shares: tuple[Annotated[float, Field(gt=0.0, le=10.0)], ...]
    output_angles_rad: tuple[Positive, ...]
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
    """The grades that the settings name."""
    return GearSteels(
        sun=GEAR_GRADES[data.sun_grade], planet=GEAR_GRADES[data.planet_grade], ring=GEAR_GRADES[data.ring_grade]
    )
