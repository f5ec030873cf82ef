"""The rules that a gear set must obey: the paper's, and those that engineering adds, each with its source."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.actuator.gearset import GearSet, contact_ratios
from pareto_monoped.actuator.layout import Family, Layout, radial_room_mm
from pareto_monoped.actuator.motors import Motor
from pareto_monoped.actuator.settings import ActuatorSettings, ConstraintName
from pareto_monoped.geometry.gears import ADDENDUM, DEDENDUM, PRESSURE_ANGLE_RAD
from pareto_monoped.geometry.shapes import Numbers

TOLERANCE_MM = 1e-9
"""Rounding must not decide: where 79 mm is the limit, 0.5 x 158 is allowed."""


@dataclass(frozen=True, slots=True, kw_only=True)
class CandidateSets:
    """What the rules look at: one gear set or arrays of them, with what was laid out around them."""

    gears: GearSet
    face_width_mm: Numbers
    at: Layout
    motor: Motor
    family: Family
    settings: ActuatorSettings


@dataclass(frozen=True, slots=True, kw_only=True)
class Constraint:
    """One rule: what it says, its source, and its margin, which must not be negative."""

    says: str
    source: str
    margin: Callable[[CandidateSets], Numbers]


def _meshing(sets: CandidateSets) -> Numbers:
    gears = sets.gears
    return -((gears.sun_teeth + gears.ring_teeth) % gears.planets)


def _no_interference(sets: CandidateSets) -> Numbers:
    gears = sets.gears
    reach = 4.0 * gears.carrier_radius_mm * np.sin(np.pi / gears.planets)
    return reach - 2.0 * gears.module_mm * gears.planet_teeth - sets.settings.planet_gap_mm


def _sun_rim(sets: CandidateSets) -> Numbers:
    if sets.family == "ISSPG":
        return np.zeros(np.shape(sets.gears.sun_teeth))
    bore = 0.5 * sets.settings.parts.gears.sun_bore_mm
    return sets.gears.sun().root_radius_mm - bore - 1.2 * (ADDENDUM + DEDENDUM) * sets.gears.module_mm


def _planet_rim(sets: CandidateSets) -> Numbers:
    bore = 0.5 * sets.settings.parts.gears.planet_bore_mm
    return sets.gears.planet().root_radius_mm - bore - 1.2 * (ADDENDUM + DEDENDUM) * sets.gears.module_mm


def _ring_rim(sets: CandidateSets) -> Numbers:
    return sets.at.r_ring - sets.gears.ring_root_radius_mm - 3.5 * sets.gears.module_mm


def _ring_interference(sets: CandidateSets) -> Numbers:
    ring = sets.gears.ring()
    reach = sets.gears.carrier_radius_mm * np.sin(PRESSURE_ANGLE_RAD)
    return ring.tip_radius_mm - np.sqrt(np.square(ring.base_radius_mm) + np.square(reach))


def _contact_ratio(sets: CandidateSets) -> Numbers:
    outer, inner = contact_ratios(sets.gears)
    return np.minimum(outer, inner) - sets.settings.contact_ratio_min


def _within_stator(sets: CandidateSets) -> Numbers:
    if sets.family == "ESSPG":
        return np.zeros(np.shape(sets.gears.sun_teeth))
    kit = sets.motor.frameless
    assert kit is not None
    assert kit.stator_height_mm is not None
    return kit.stator_height_mm - sets.face_width_mm


def _bearing(sets: CandidateSets) -> Numbers:
    return np.where(np.isfinite(sets.at.r_bore), 0.0, -1.0)


def _bearing_room(sets: CandidateSets) -> Numbers:
    if sets.family == "ISSPG":
        # The seat in front of the stator and its flange must stay inside the casing's bolts and rim.
        data = sets.settings.parts.casing
        return sets.at.r_casing - (sets.at.r_seat + data.ring_wall_mm + data.flange_width_mm)
    return sets.at.r_ring - sets.settings.parts.casing.ring_lip_mm - sets.at.r_seat


CONSTRAINTS: Mapping[ConstraintName, Constraint] = {
    "meshing": Constraint(
        says="(Ns + Nr) / n_p is whole, so that evenly spread planets mesh",
        source="paper, III (eq. 3)",
        margin=_meshing,
    ),
    "no_interference": Constraint(
        says="2 m (Ns + Np) sin(pi / n_p) - 2 m Np >= delta_p, so that planets keep clear of each other",
        source="paper, IV (eq. 4)",
        margin=_no_interference,
    ),
    "teeth_min": Constraint(
        says="Ns, Np >= N_min, against undercutting",
        source="paper, V (eq. 5)",
        margin=lambda sets: np.minimum(sets.gears.sun_teeth, sets.gears.planet_teeth) - sets.settings.teeth_min,
    ),
    "gearbox_diameter": Constraint(
        says="m Nr <= D_GB: the ring's pitch circle stays inside motor diameter less clearance",
        source="paper, V (eq. 5)",
        margin=lambda sets: (
            radial_room_mm(sets.motor, sets.family, sets.settings) - 2.0 * sets.gears.ring_pitch_radius_mm
        ),
    ),
    "ring_root": Constraint(
        says="m (Nr + 2.5) <= D_GB: so does the ring's root circle",
        source="implied by the paper's section IV-A: the families end at 6:1 and 8.7:1; root circle after ISO 53",
        margin=lambda sets: (
            radial_room_mm(sets.motor, sets.family, sets.settings) - 2.0 * sets.gears.ring_root_radius_mm
        ),
    ),
    "sun_rim": Constraint(
        says="wall between the sun's bore and its roots >= 1.2 tooth depths (ESSPG; the ISSPG's sun has no bore)",
        source="AGMA 2001-D04, rim thickness factor 1",
        margin=_sun_rim,
    ),
    "planet_rim": Constraint(
        says="wall between the planet's bore and its roots >= 1.2 tooth depths",
        source="AGMA 2001-D04, rim thickness factor 1",
        margin=_planet_rim,
    ),
    "ring_rim": Constraint(
        says="wall behind the ring's roots >= 3.5 modules",
        source="ISO 6336-3, rim thickness factor 1 of internal gears",
        margin=_ring_rim,
    ),
    "ring_interference": Constraint(
        says="the ring's tips meet the planet's flanks outside its base circle",
        source="involute interference of internal gears: Colbourne, The Geometry of Involute Gears, ch. 8",
        margin=_ring_interference,
    ),
    "contact_ratio": Constraint(
        says="contact ratio of either mesh at least 1.2",
        source="Shigley, section 13-6",
        margin=_contact_ratio,
    ),
    "within_stator": Constraint(
        says="face width <= height of the stator that the gears sit in (ISSPG)",
        source="paper, section II-A: the ISSPG is integrated within the stator",
        margin=_within_stator,
    ),
    "bearing": Constraint(
        says="the catalogue has a main bearing of the bore needed",
        source="bearing catalogue, ISO 15",
        margin=_bearing,
    ),
    "bearing_room": Constraint(
        says="the main bearing passes the ring's shoulder (ESSPG), its seat stays inside the casing (ISSPG)",
        source="assembly",
        margin=_bearing_room,
    ),
}
"""Name -> rule. Three of the paper's constraints are not here: I (ratio) selects the interval, II (Nr = Ns + 2 Np) and
the ranges of module and planets in V hold for every candidate."""


def violations(sets: CandidateSets) -> tuple[tuple[ConstraintName, ...], NDArray[np.bool_]]:
    """Which of the active constraints each gear set breaks.

    Returns:
        The names, and an array of shape (names, sets), True where broken.
    """
    names = tuple(name for name in CONSTRAINTS if name not in sets.settings.constraints_off)
    shape = np.shape(sets.gears.sun_teeth)
    broken = [np.broadcast_to(CONSTRAINTS[name].margin(sets), shape) < -TOLERANCE_MM for name in names]
    return names, np.array(broken, dtype=bool).reshape(len(names), *shape)
