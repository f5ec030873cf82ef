"""The rules that a gear set must obey: the paper's, and those that engineering adds, each with its source."""

from collections.abc import Callable, Mapping
from dataclasses import KW_ONLY, dataclass, replace

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.actuator.gearset import GearSet, contact_ratios
from pareto_monoped.actuator.layout import END_BEARING_BORE_MM, Family, Layout, radial_room_mm
from pareto_monoped.actuator.motor import Motor
from pareto_monoped.actuator.rating.build import build_stage, face_limit_mm
from pareto_monoped.actuator.rating.width import strength_margins
from pareto_monoped.actuator.service.loads import output_margin, planet_margin
from pareto_monoped.actuator.settings import ActuatorSettings
from pareto_monoped.design import RULE_SETS, ConstraintName, RuleSet
from pareto_monoped.geometry.gears import ADDENDUM, DEDENDUM, PRESSURE_ANGLE_RAD, ExternalGear
from pareto_monoped.geometry.shapes import Numbers

TOLERANCE_MM = 1e-9
"""Rounding must not decide: where 79 mm is the limit, 0.5 x 158 is allowed."""


@dataclass(frozen=True, slots=True, kw_only=True)
class CandidateSets:
    """What the rules look at: one gear set or arrays of them, with what was laid out around them.

    ``at`` may be missing for rules that do not need it (``Constraint.laid_out``). ``strength`` has the margins of
    ``rating.width.strength_margins``, where they are known already.
    """

    gears: GearSet
    face_width_mm: Numbers
    motor: Motor
    family: Family
    settings: ActuatorSettings
    at: Layout | None = None
    strength: Mapping[str, Numbers] | None = None

    @property
    def around(self) -> Layout:
        """The layout, for rules that need it."""
        assert self.at is not None
        return self.at


@dataclass(frozen=True, slots=True)
class Constraint:
    """One rule."""

    margin: Callable[[CandidateSets], Numbers]  #: what is left until it is broken, negative beyond
    cures: tuple[str, ...]  #: what would help where it forbids every gearbox
    _: KW_ONLY
    says: str  #: what it says
    source: str  #: where it comes from
    rule_sets: tuple[RuleSet, ...] = RULE_SETS  #: the sets of rules that it belongs to
    laid_out: bool = False  #: whether it needs the layout, which costs more to work out than all other rules together
    of_width: bool = False  #: whether it looks at the face width


def _no_interference(sets: CandidateSets) -> Numbers:
    gears = sets.gears
    reach = 4.0 * gears.carrier_radius_mm * np.sin(np.pi / gears.planets)
    # Tips that shifts move outwards count like a larger pitch circle.
    shifted = 4.0 * gears.module_mm * (gears.planet_shift - gears.planet().tip_shortening)
    return reach - 2.0 * gears.module_mm * gears.planet_teeth - shifted - sets.settings.planet_gap_mm


def _teeth_min(sets: CandidateSets) -> Numbers:
    """Return the teeth beyond those against undercutting: a shift of x makes up for 2 x / sin(alpha)^2 of them."""
    gears, per_shift = sets.gears, 2.0 / np.square(np.sin(PRESSURE_ANGLE_RAD))
    sun = gears.sun_teeth + per_shift * gears.sun_shift
    spare_teeth: Numbers = (
        np.minimum(sun, gears.planet_teeth + per_shift * gears.planet_shift) - sets.settings.teeth_min
    )
    return spare_teeth


def _tip_thickness(sets: CandidateSets) -> Numbers:
    least = sets.settings.parts.rating.tip_thickness_modules

    def margin(gears: GearSet) -> Numbers:
        thinnest = np.minimum(gears.sun().tip_thickness_mm, gears.planet().tip_thickness_mm)
        return thinnest - least * gears.module_mm

    return _of_shifted(sets.gears, margin)


def _root_fillet(sets: CandidateSets) -> Numbers:
    def margin(gears: GearSet) -> Numbers:
        return gears.ring_root_radius_mm * gears.ring().fillet_angle_rad

    return _of_shifted(sets.gears, margin)


def _of_shifted(gears: GearSet, margin: Callable[[GearSet], Numbers]) -> Numbers:
    """Return a margin of shifted sets; teeth without a shift keep the rule, which saves much of the search's time."""
    if not gears.is_shifted:
        return np.zeros(np.shape(gears.sun_teeth))
    if not np.ndim(gears.sun_teeth):
        return margin(gears)
    shifted = np.flatnonzero((gears.centre_shift != 0.0) | (gears.sun_shift != 0.0))
    found = np.zeros(np.shape(gears.sun_teeth))
    found[shifted] = margin(gears.where(shifted))
    return found


def _sun_rim(sets: CandidateSets) -> Numbers:
    if sets.settings.rules == "iso6336":
        return sets.gears.sun().root_radius_mm - 0.5 * END_BEARING_BORE_MM
    if sets.family == "ISSPG":
        return np.zeros(np.shape(sets.gears.sun_teeth))
    bore = 0.5 * sets.settings.parts.gears.sun_bore_mm
    return _root_mm(sets, sets.gears.sun()) - bore - 1.2 * (ADDENDUM + DEDENDUM) * sets.gears.module_mm


def _planet_rim(sets: CandidateSets) -> Numbers:
    bore = 0.5 * sets.settings.planet_bore_mm
    return _root_mm(sets, sets.gears.planet()) - bore - 1.2 * (ADDENDUM + DEDENDUM) * sets.gears.module_mm


def _root_mm(sets: CandidateSets, gear: ExternalGear) -> Numbers:
    """Return the radius of the roots; the rules of the paper count them as deep as without backlash."""
    return replace(gear, backlash_mm=0.0).root_radius_mm if sets.settings.rules == "paper" else gear.root_radius_mm


def _ring_interference(sets: CandidateSets) -> Numbers:
    ring = sets.gears.ring()
    reach = sets.gears.carrier_radius_mm * np.sin(sets.gears.ring_working_angle_rad)
    spare_mm: Numbers = ring.tip_radius_mm - np.sqrt(np.square(ring.base_radius_mm) + np.square(reach))
    return spare_mm


def _within_stator(sets: CandidateSets) -> Numbers:
    if sets.family == "ESSPG":
        return np.zeros(np.shape(sets.gears.sun_teeth))
    kit = sets.motor.frameless
    assert kit is not None
    assert kit.stator_height_mm is not None
    return kit.stator_height_mm - sets.face_width_mm


def _bearing_room(sets: CandidateSets) -> Numbers:
    if sets.family == "ISSPG":
        # The seat in front of the stator and its flange must stay inside the casing's bolts and rim.
        data = sets.settings.parts.casing
        return sets.around.r_casing - (sets.around.r_seat + data.ring_wall_mm + data.flange_width_mm)
    return sets.around.r_ring - sets.settings.parts.casing.ring_lip_mm - sets.around.r_seat


def _strength(rule: str) -> Callable[[CandidateSets], Numbers]:
    """Return the margin of a rule about safety factors."""

    def margin(sets: CandidateSets) -> Numbers:
        if sets.strength is not None:
            return sets.strength[rule]
        stage = build_stage(sets.gears, sets.motor, sets.family, sets.settings)
        return strength_margins(stage.safeties(sets.face_width_mm), stage)[rule]

    return margin


def _planet_bearing(sets: CandidateSets) -> Numbers:
    if sets.strength is not None and "planet_bearing" in sets.strength:
        return sets.strength["planet_bearing"]
    return planet_margin(sets.gears, sets.face_width_mm, sets.motor, sets.settings)


_RATED: tuple[RuleSet, ...] = ("iso6336",)
CONSTRAINTS: Mapping[ConstraintName, Constraint] = {
    "meshing": Constraint(
        lambda s: -((s.gears.sun_teeth + s.gears.ring_teeth) % s.gears.planets),
        ("another number of planets",),
        says="(Ns + Nr) / n_p is whole, so that evenly spread planets mesh", source="paper, III (eq. 3)"),
    "no_interference": Constraint(_no_interference, ("a smaller planet_gap_mm", "fewer planets"),
        says="2 m (Ns + Np) sin(pi / n_p) - 2 m Np >= delta_p, so that planets keep clear of each other",
        source="paper, IV (eq. 4)"),
    "teeth_min": Constraint(_teeth_min, ("a smaller module", "fewer teeth with profile shift"),
        says="Ns, Np >= N_min, against undercutting; less by 2 x / sin(alpha)^2 with a profile shift of x",
        source="paper, V (eq. 5); ISO 21771 for the shift"),
    "tip_thickness": Constraint(_tip_thickness, ("less profile shift",), rule_sets=_RATED,
        says="tips of sun and planets at least 0.4 modules thick",
        source="Niemann/Winter, Maschinenelemente II; limit in data/actuator_parts.toml, table rating"),
    "gearbox_diameter": Constraint(
        lambda s: radial_room_mm(s.motor, s.family, s.settings) - 2.0 * s.gears.ring_pitch_radius_mm,
        ("a wider motor", "a smaller module"),
        says="m Nr <= D_GB: the ring's pitch circle stays inside motor diameter less clearance",
        source="paper, V (eq. 5)"),
    "ring_root": Constraint(
        lambda s: radial_room_mm(s.motor, s.family, s.settings) - 2.0 * s.gears.ring_root_radius_mm,
        ("a wider motor", "a smaller module"),
        says="m (Nr + 2.5) <= D_GB: so does the ring's root circle",
        source="implied by the paper's section IV-A: the families end at 6:1 and 8.7:1; root circle after ISO 53"),
    "root_fillet": Constraint(_root_fillet, ("less profile shift", "more teeth"), rule_sets=_RATED,
        says="fillets of 0.38 modules fit between the flanks of every gear",
        source="root radius of the basic rack, ISO 53"),
    "sun_rim": Constraint(_sun_rim, ("a smaller journal of the sun", "a larger module"),
        says="the sun's roots lie outside its journal of 6 mm (iso6336), or stay 1.2 tooth depths off its bore of 6 "
        "mm (paper, ESSPG)",
        source="assembly; AGMA 2001-D04, rim thickness factor 1"),
    "planet_rim": Constraint(_planet_rim, ("a smaller bore of the planets", "a larger module"),
        says="wall between the planet's bore and its roots >= 1.2 tooth depths",
        source="AGMA 2001-D04, rim thickness factor 1"),
    "ring_rim": Constraint(
        lambda s: s.around.r_ring - s.gears.ring_root_radius_mm - 3.5 * s.gears.module_mm,
        ("a thicker ring", "a smaller module"), laid_out=True,
        says="wall behind the ring's roots >= 3.5 modules",
        source="ISO 6336-3, rim thickness factor 1 of internal gears"),
    "ring_interference": Constraint(_ring_interference, ("more planet teeth", "profile shift"),
        says="the ring's tips meet the planet's flanks outside its base circle",
        source="involute interference of internal gears: Colbourne, The Geometry of Involute Gears, ch. 8"),
    "contact_ratio": Constraint(
        lambda s: np.minimum(*contact_ratios(s.gears)) - s.settings.contact_ratio_min,
        ("more teeth",),
        says="contact ratio of either mesh at least 1.2", source="Shigley, section 13-6"),
    "within_stator": Constraint(_within_stator, ("a longer stator", "a stronger steel", "more planets"), of_width=True,
        says="face width <= height of the stator that the gears sit in (ISSPG)",
        source="paper, section II-A: the ISSPG is integrated within the stator"),
    "bearing": Constraint(
        lambda s: np.where(np.isfinite(s.around.r_bore), 0.0, -1.0),
        ("a larger bearing in the catalogue",), laid_out=True,
        says="the catalogue has a main bearing of the bore needed", source="bearing catalogue, ISO 15"),
    "bearing_room": Constraint(_bearing_room, ("a bearing of smaller section", "a wider motor"), laid_out=True,
        says="the main bearing passes the ring's shoulder (ESSPG), its seat stays inside the casing (ISSPG)",
        source="assembly"),
    "face_width": Constraint(
        lambda s: face_limit_mm(s.gears, s.settings) - s.face_width_mm,
        ("a larger sun", "a larger face_over_sun_max"),
        says="face width <= 1.5 sun diameters and 40 modules",
        source="Niemann/Winter, Maschinenelemente II; limits in data/actuator_parts.toml, table rating",
        rule_sets=_RATED, of_width=True),
    "flank_strength": Constraint(_strength("flank_strength"), ("a larger sun", "a harder steel", "more planets"),
        says="S_H of every flank at least flank_safety within the face width allowed", source="ISO 6336-2, ISO 6336-6",
        rule_sets=_RATED, of_width=True),
    "root_strength": Constraint(_strength("root_strength"),
        ("a larger module in a thicker ring", "a stronger steel", "more planets"),
        says="S_F of every root at least root_safety within the face width allowed", source="ISO 6336-3, ISO 6336-6",
        rule_sets=_RATED, of_width=True),
    "overload_strength": Constraint(_strength("overload_strength"), ("a softer end stop", "a stronger steel"),
        says="S_H and S_F at least those required against static failure under one overload",
        source="ISO 6336-2 and -3, static limits", rule_sets=_RATED, of_width=True),
    "output_bearing": Constraint(
        lambda s: output_margin(s.gears.ratio * s.motor.peak_torque_n_m, s.around, s.settings),
        ("a larger sprocket", "a stronger bearing in the catalogue"),
        says="L10, s0 and tilt of both bearings of the knee's output keep their limits",
        source="ISO 281, ISO 76, SKF; limits in data/service.toml", rule_sets=_RATED, laid_out=True),
    "planet_bearing": Constraint(_planet_bearing, ("more planets", "a wider face", "thicker pins"),
        says="L10 and s0 of the planets' needles keep their limits, or pv of their bushes",
        source="ISO 281, ISO 76; limits in data/service.toml", rule_sets=_RATED, of_width=True),
}  # fmt: skip
"""Name -> rule. Three of the paper's constraints are not here: I (ratio) selects the interval, II (Nr = Ns + 2 Np) and
the ranges of module and planets in V hold for every candidate."""


def active_rules(settings: ActuatorSettings) -> tuple[ConstraintName, ...]:
    """Return the rules of a search, in the order of ``CONSTRAINTS``."""
    return tuple(
        name
        for name, rule in CONSTRAINTS.items()
        if settings.rules in rule.rule_sets and name not in settings.constraints_off
    )


def violations(
    sets: CandidateSets, names: tuple[ConstraintName, ...] | None = None
) -> tuple[tuple[ConstraintName, ...], NDArray[np.bool_]]:
    """Return the rules asked for, by default all active ones, and where they are broken, shape (names, sets)."""
    names = active_rules(sets.settings) if names is None else names
    shape = np.shape(sets.gears.sun_teeth)
    broken = [np.broadcast_to(CONSTRAINTS[name].margin(sets), shape) < -TOLERANCE_MM for name in names]
    return names, np.array(broken, dtype=bool).reshape(len(names), *shape)
