"""What stage 1 takes as given: limits, standard modules, safety factors, dimensions. All of it can be changed."""

from dataclasses import dataclass, field
from functools import lru_cache
from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from pareto_monoped.actuator.assumptions import (
    DutyData,
    GearSteels,
    NeedleData,
    PlanetBearing,
    RatingData,
    SecondCarrier,
    ServiceData,
    WebData,
    chosen_steels,
    default_service,
)
from pareto_monoped.config import Positive, Strict, checked, read_shipped
from pareto_monoped.design import CONSTRAINT_NAMES, DEFAULT_RULES, RULE_SETS, RuleSet
from pareto_monoped.errors import InputError, unknown_name
from pareto_monoped.geometry.gears import ExternalGear
from pareto_monoped.geometry.making import GENERAL_SERIES, RATED_SERIES
from pareto_monoped.geometry.shapes import Numbers
from pareto_monoped.materials import MATERIALS, Materials

ISO_54_SERIES_1_MM = (0.5, 0.6, 0.8, 1.0)
ISO_54_SERIES_2_MM = (0.55, 0.7, 0.75, 0.9, 1.125)
"""Modules of ISO 54 (and DIN 780) between 0.5 and 1.2 mm: those of the first series, preferred, and of the second."""


@dataclass(frozen=True, slots=True, kw_only=True)
class GearData(Strict):
    """Strength and fixed proportions of the gears; sources in ``data/actuator_parts.toml``."""

    factor_of_safety: Positive
    service_factor: Positive
    backlash_mm: Annotated[float, Field(ge=0.0)]
    backlash_modules: Annotated[float, Field(ge=0.0)]
    backlash_least_mm: Annotated[float, Field(ge=0.0)]
    ring_width_internal_mm: Positive
    ring_width_external_mm: Positive
    ring_rim_modules: Positive
    planet_bore_mm: Positive
    sun_bore_mm: Positive
    planet_hub_wall_mm: Positive
    planet_recess_min_mm: Positive
    planet_web_share: Annotated[float, Field(gt=0.0, le=1.0)]


@dataclass(frozen=True, slots=True, kw_only=True)
class CarrierData(Strict):
    """Carrier, secondary carrier and pins, in mm."""

    bearing_clearance_mm: Positive
    flange_clearance_mm: Positive
    flange_radius_mm: Positive
    flange_thickness_mm: Positive
    thread_depth_mm: Positive
    diaphragm_mm: Positive
    shoulder_height_mm: Positive
    shoulder_thickness_mm: Positive
    pin_diameter_mm: Positive
    pin_wall_mm: Positive
    pin_depth_mm: Positive
    planet_clearance_mm: Positive
    secondary_thickness_mm: Positive
    sun_clearance_mm: Positive


@dataclass(frozen=True, slots=True, kw_only=True)
class CasingData(Strict):
    """Casing, backplate and ring housing, in mm."""

    plate_mm: Positive
    rim_mm: Positive
    wall_mm: Positive
    vent_wall_mm: Positive
    motor_clearance_mm: Positive
    flange_mm: Positive
    flange_width_mm: Positive
    bolt_offset_mm: Positive
    lip_mm: Positive
    seat_wall_mm: Positive
    ring_wall_mm: Positive
    shoulder_clearance_mm: Positive
    ring_lip_mm: Positive
    rotor_clearance_mm: Positive
    motor_carrier_clearance_mm: Positive
    bearing_play_mm: Positive


@dataclass(frozen=True, slots=True, kw_only=True)
class CouplingData(Strict):
    """Coupling between motor and sun, in mm."""

    radius_mm: Positive
    thickness_mm: Positive
    bolt_circle_mm: Positive
    bolt_count: int
    shaft_radius_mm: Positive
    rim_mm: Positive


@dataclass(frozen=True, slots=True, kw_only=True)
class SplineData(Strict):
    """Splines of the sun's shaft in the coupling: toothed as gears of 20 degrees, in mm."""

    module_mm: Positive
    external_teeth: Annotated[int, Field(ge=6)]
    internal_teeth: Annotated[int, Field(ge=6)]
    sun_shaft_radius_mm: Positive
    play_mm: Positive  #: least backlash along the pitch circle, by which the hub's spaces are wider than drawn

    @property
    def external(self) -> ExternalGear:
        """Of the ESSPG."""
        return ExternalGear(teeth=self.external_teeth, module_mm=self.module_mm)

    @property
    def internal(self) -> ExternalGear:
        """Of the ISSPG."""
        return ExternalGear(teeth=self.internal_teeth, module_mm=self.module_mm)


@dataclass(frozen=True, slots=True, kw_only=True)
class InterfaceData(Strict):
    """Patterns of bolts and dowels towards the links."""

    output_bolt_circle_mm: Positive
    output_bolt_count: int
    output_dowel_mm: Positive
    mount_bolt_count: int
    mount_dowel_mm: Positive


@dataclass(frozen=True, slots=True, kw_only=True)
class PartData(Strict):
    """Everything in ``data/actuator_parts.toml``."""

    gears: GearData
    carrier: CarrierData
    casing: CasingData
    coupling: CouplingData
    spline: SplineData
    interface: InterfaceData
    rating: RatingData
    duty: DutyData
    webs: WebData
    needles: NeedleData


@lru_cache(maxsize=1)
def default_parts() -> PartData:
    """Return the shipped part data."""
    return checked(PartData, read_shipped("actuator_parts.toml", what="part data"), source="part data")


SHIFTS = ((0.0, 0.0), (0.0, 0.4), (0.6, 0.5))
"""Centre shift and sun shift that the search tries under ``iso6336``, in modules.

Our own choice: of 30 pairs with a centre shift up to 0.8 and a sun shift up to 0.6, these three leave the gearboxes of
five motors on average 9 g heavier than all pairs together would, and no shift at all 48 g.
"""
_LEAST_PLANETS: dict[RuleSet, int] = {"paper": 2, "iso6336": 3}
"""``paper``: range of n_p in its eq. 5. Two planets do not centre the sun, and load the carrier's bearing unevenly."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ActuatorSettings:
    """Settings of stage 1."""

    #: ``paper``, face width by Lewis with the paper's limits, or ``iso6336``, flanks and roots of all gears rated after
    #: ISO 6336, see ``rating``
    rules: RuleSet = DEFAULT_RULES
    modules_mm: tuple[float, ...] = tuple(sorted(ISO_54_SERIES_1_MM + ISO_54_SERIES_2_MM))  #: modules to choose from
    #: Profile shifts to choose from, pairs of ``GearSet.centre_shift`` and ``sun_shift``; None means those of the
    #: rules: none (paper), or ``SHIFTS``
    shifts: tuple[tuple[float, float], ...] | None = None
    planets_min: int | None = None  #: least n_p; None is that of the rules: 2 (paper, eq. 5), or 3 under ``iso6336``.
    planets_max: int = 7  #: largest n_p (paper, eq. 5).
    teeth_min: int = 18  #: N_min of sun and planet (paper, eq. 5).
    planet_gap_mm: float = 5.0  #: delta_p of the no-interference constraint (paper, eq. 4).
    diameter_clearance_mm: float = 10.0  #: delta_clr between D_GB and the motor (paper, section III-A)
    contact_ratio_min: float = 1.2  #: least contact ratio of either mesh (Shigley, section 13-6)
    constraints_off: frozenset[str] = frozenset()  #: names of constraints not to apply, see ``rules.CONSTRAINTS``
    #: Source of the main bearing's mass: the catalogue, or the paper's regression over the bore
    bearings: Literal["catalogue", "regression"] = "catalogue"
    parts: PartData = field(default_factory=default_parts)  #: dimensions and safety factors
    materials: Materials = MATERIALS  #: what the parts are made of
    #: Grades of the gears under ``iso6336``; None takes those that ``parts.rating`` names
    steels: GearSteels | None = None
    #: Pace, forces and fits of the joints, and what their bearings must hold
    service: ServiceData = field(default_factory=default_service)

    def __post_init__(self) -> None:
        if self.rules not in RULE_SETS:
            raise InputError(unknown_name("rules", self.rules, RULE_SETS))
        for name in sorted(self.constraints_off):
            if name not in CONSTRAINT_NAMES:
                raise InputError(unknown_name("constraints_off", name, CONSTRAINT_NAMES))
        if not self.modules_mm or min(self.modules_mm) <= 0.0:
            raise InputError(f"modules_mm = {self.modules_mm!r}: must be one or more positive numbers; correct it")
        if self.shifts is not None and not self.shifts:
            raise InputError("shifts = (): must be one or more pairs of shifts; give (0.0, 0.0) for none")
        if not 2 <= self.planets_least <= self.planets_max:
            raise InputError(
                f"planets_min, planets_max = {self.planets_least}, {self.planets_max}: must be 2 or more, in order; "
                "correct them"
            )

    @property
    def planets_least(self) -> int:
        """Least number of planets."""
        return _LEAST_PLANETS[self.rules] if self.planets_min is None else self.planets_min

    @property
    def shift_choices(self) -> tuple[tuple[float, float], ...]:
        """Profile shifts to choose from."""
        if self.shifts is not None:
            return self.shifts
        return SHIFTS if self.rules == "iso6336" else ((0.0, 0.0),)

    @property
    def gear_steels(self) -> GearSteels:
        """Steel grades of the gears under ``iso6336``."""
        return chosen_steels(self.parts.rating) if self.steels is None else self.steels

    def tooth_thinning_mm(self, module_mm: Numbers) -> Numbers:
        """Return by how much each tooth is thinned on the reference circle; under ``paper``, all by the same."""
        data = self.parts.gears
        if self.rules == "paper":
            return data.backlash_mm
        thinner: Numbers = np.maximum(data.backlash_modules * module_mm, data.backlash_least_mm)
        return thinner

    @property
    def thickness_series(self) -> int:
        """Series of DIN 3967 for the tolerance of the gears' tooth thickness."""
        return GENERAL_SERIES if self.rules == "paper" else RATED_SERIES

    @property
    def second_carrier(self) -> SecondCarrier:
        """What ties the second carrier to the first; the rules of the paper know pins alone."""
        return "pins" if self.rules == "paper" else self.parts.rating.second_carrier

    @property
    def planet_bearing(self) -> PlanetBearing:
        """What the planets turn on; the rules of the paper know bushes alone."""
        return "bushes" if self.rules == "paper" else self.parts.rating.planet_bearing

    @property
    def planet_bore_mm(self) -> float:
        """Bore of the planets: around a bush, or the raceway of the needles."""
        if self.planet_bearing == "bushes":
            return self.parts.gears.planet_bore_mm
        return self.parts.carrier.pin_diameter_mm + 2.0 * self.parts.needles.diameter_mm

    @property
    def planet_clearance_mm(self) -> float:
        """From a planet's teeth to the carriers on either side: free, or for a washer with its play."""
        if self.planet_bearing == "bushes":
            return self.parts.carrier.planet_clearance_mm
        return self.parts.needles.washer_mm + self.parts.needles.washer_play_mm
