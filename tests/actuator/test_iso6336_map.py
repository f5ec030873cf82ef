"""The map under the rules ``iso6336``: every winner keeps every limit, and where there is none, the reason helps."""

from dataclasses import replace

import numpy as np
import pytest

from pareto_monoped.actuator.actuator import actuator_mass_kg, build_actuator
from pareto_monoped.actuator.gearset import GearSet
from pareto_monoped.actuator.judge import candidates
from pareto_monoped.actuator.layout import layout, radial_room_mm
from pareto_monoped.actuator.motors import load_motor, motor_names
from pareto_monoped.actuator.ratiomap import STAND_IN_WITHIN
from pareto_monoped.actuator.rules import CONSTRAINTS, CandidateSets, violations
from pareto_monoped.actuator.search import build_map, map_for, map_of
from pareto_monoped.actuator.service.sheet import service_sheet
from pareto_monoped.actuator.settings import ActuatorSettings
from pareto_monoped.cad.as_built import as_built
from pareto_monoped.design import PAPER_CASES, RULE_SETS
from pareto_monoped.errors import DesignError, MotorError
from pareto_monoped.geometry.roles import Group, Role
from pareto_monoped.robot.build import build_robot
from tests.actuator import bearing_rules
from tests.actuator.loop import allowed_by_iso6336, main_bearing
from tests.actuator.rating import iso6336

SETTINGS = ActuatorSettings(rules="iso6336")
DATA = SETTINGS.parts.rating
DESIGNS = pytest.mark.parametrize("case", PAPER_CASES)


EVERY_TIME = ("VT8020",)
"""Motors whose winners are looked at every time: the default and the smallest."""
MOTORS = pytest.mark.parametrize(
    "name", [pytest.param(name, marks=() if name in EVERY_TIME else pytest.mark.long) for name in motor_names()]
)


@MOTORS
def test_every_winner_keeps_every_limit(name):
    motor = load_motor(name)
    found = map_of(motor, "iso6336")
    bests = [
        (family, one)
        for entry in found.entries
        for family, result in entry.families.items()
        for one in (result.best, result.runner_up)
        if one is not None
    ]
    assert bests
    for family, one in bests:
        gears, width = one.gears, one.face_width_mm
        assert gears.planets >= 3
        assert width >= max(6.0, 6.0 * gears.module_mm) - 1e-9
        assert width <= min(1.5 * gears.module_mm * gears.sun_teeth, 40.0 * gears.module_mm) + 1e-9
        assert round(10.0 * width, 9) == round(10.0 * width)
        # Without the margins that the search used: the rules rate the set again.
        at = layout(motor, family, gears, width, SETTINGS)
        sets = CandidateSets(gears=gears, face_width_mm=width, at=at, motor=motor, family=family, settings=SETTINGS)
        names, broken = violations(sets)
        assert {"flank_strength", "root_strength", "overload_strength", "face_width"} < set(names)
        assert not broken.any()
    for actuator in (entry.actuator for entry in found.entries if entry.actuator is not None):
        assert actuator.rating.flank_safety >= DATA.flank_safety
        assert actuator.rating.root_safety >= DATA.root_safety
        for gear in actuator.rating.gears:
            assert gear.overload_flank_safety >= DATA.overload_flank_safety
            assert gear.overload_root_safety >= DATA.overload_root_safety
        assert actuator.mass_kg == pytest.approx(sum(actuator.mass_breakdown_kg().values()))


def least_width(gears, motor, settings=SETTINGS):
    """By the slow rating, from the least width allowed upwards; None if no width up to the limits is enough.

    The planets' needles must hold as well. Of ten widths the last is tried first: if it does not hold, none of them is
    taken, though a narrower one might. Such a width would be missing here and make a test fail.
    """
    data = SETTINGS.parts.gears
    least = (DATA.flank_safety, DATA.root_safety, DATA.overload_flank_safety, DATA.overload_root_safety)
    high = min(1.5 * gears.module_mm * gears.sun_teeth, 40.0 * gears.module_mm)

    def holds(steps):
        if not bearing_rules.needles_hold(motor, gears, steps / 10.0, settings):
            return False
        safety, _ = iso6336.rate(
            gears, motor, steps / 10.0, SETTINGS, ring_wall=data.ring_rim_modules * gears.module_mm, sun_bore=None
        )
        return all(got >= wanted for one in safety.values() for got, wanted in zip(one, least, strict=True))

    widths = range(60, int(np.floor(10.0 * high + 1e-6)) + 1)
    for ten in (widths[k : k + 10] for k in range(0, len(widths), 10)):
        if holds(ten[-1]):
            steps = next(steps for steps in ten if holds(steps))
            return max(steps / 10.0, np.ceil(60.0 * gears.module_mm - 1e-9) / 10.0)
    return None


def sets_in(tenths):
    """Every gear set of an interval with every profile shift, in plain loops."""
    for module in SETTINGS.modules_mm:
        for sun in range(12, 45):
            for planet in range(12, 75):
                ring = sun + 2 * planet
                if not tenths * sun <= 10 * (sun + ring) < (tenths + 1) * sun:
                    continue
                for planets in range(3, 8):
                    for centre_shift, sun_shift in SETTINGS.shift_choices:
                        yield GearSet(
                            sun_teeth=sun,
                            planet_teeth=planet,
                            ring_teeth=ring,
                            module_mm=module,
                            planets=planets,
                            centre_shift=centre_shift,
                            sun_shift=sun_shift,
                            backlash_mm=max(0.03 * module, 0.017),
                            tips_fitted=True,
                        )


def slow_best(motor, family, tenths, settings=SETTINGS):
    """The lightest set of an interval that keeps every rule, bearings included: mass, gears, face width."""
    best = None
    for gears in sets_in(tenths):
        if not allowed_by_iso6336(motor, family, gears, 6.0):
            continue
        main = main_bearing(max(2 * float(gears.carrier_radius_mm) + 10.0, 35.0))
        if not bearing_rules.output_holds(motor, gears, main, settings):
            continue
        # No face is narrower than this one, and none that is wider is lighter.
        if best and build_actuator(motor, family, gears, settings, max(6.0, 6.0 * gears.module_mm)).mass_kg > best[0]:
            continue
        width = least_width(gears, motor, settings)
        if width is None or not allowed_by_iso6336(motor, family, gears, width):
            continue
        mass = build_actuator(motor, family, gears, settings).mass_kg
        if best is None or mass < best[0]:
            best = (mass, gears, width)
    return best


def agree(got, best):
    """Whether search and slow loop found the same."""
    if best is None:
        assert got is None
        return
    assert (got.gears, got.face_width_mm) == best[1:]
    assert got.mass_kg == pytest.approx(best[0], rel=1e-12)


@pytest.mark.parametrize(
    ("name", "family", "tenths"),
    [
        pytest.param("VT8020", "ISSPG", 40, marks=pytest.mark.long),
        pytest.param("VT8020", "ESSPG", 54, marks=pytest.mark.long),
        pytest.param("VT8020", "ESSPG", 60, marks=pytest.mark.long),
        ("VT8020", "ESSPG", 79),
        pytest.param("U8", "ISSPG", 45, marks=pytest.mark.long),
        ("U8", "ISSPG", 64),
    ],
)
def test_search_finds_what_a_slow_loop_with_the_slow_rating_finds(name, family, tenths):
    got = map_for(name, "iso6336").entries[tenths - 40].families[family].best
    agree(got, slow_best(load_motor(name), family, tenths))


@pytest.mark.parametrize(
    ("tenths", "service"),
    [
        (64, {"overload_static_safety_min": 5.0}),
        pytest.param(45, {"overload_static_safety_min": 5.0}, marks=pytest.mark.long),
        pytest.param(45, {"bearing_tilt_limit_rad": 5e-4}, marks=pytest.mark.long),
    ],
)
def test_search_and_slow_loop_agree_where_bearings_decide(tenths, service):
    """More is asked of the bearings than usual: needles want a wider face, or no tilt is small enough."""
    motor, family = load_motor("U8"), "ISSPG"
    settings = replace(SETTINGS, service=replace(SETTINGS.service, **service))
    got = build_map(motor, settings).entries[tenths - 40].families[family].best
    usual = map_for("U8", "iso6336").entries[tenths - 40].families[family].best
    assert usual is not None
    assert got is None or (got.gears != usual.gears and got.face_width_mm > usual.face_width_mm)
    agree(got, slow_best(motor, family, tenths, settings))


@pytest.mark.parametrize(("name", "family"), [("VT8020", "ISSPG"), ("U12", "ESSPG")])
def test_no_actuator_is_lighter_with_a_wider_face(name, family):
    """The search leaves out sets that are too heavy at the least face width."""
    motor = load_motor(name)
    gears = candidates(radial_room_mm(motor, family, SETTINGS), SETTINGS)
    places = np.random.default_rng(5).integers(0, len(gears.module_mm), 100)
    gears, width = gears.where(np.tile(places, 60)), np.repeat(np.linspace(6.0, 40.0, 60), 100)
    mass = actuator_mass_kg(layout(motor, family, gears, width, SETTINGS), motor, family, SETTINGS)
    masses = np.reshape(mass, (60, 100))
    known = np.isfinite(masses).all(axis=0)
    assert known.sum() > 25
    assert (np.diff(masses, axis=0)[:, known] >= 0.0).all()


@pytest.mark.long
def test_profile_shift_opens_intervals_and_never_adds_mass(vt8020):
    plain = build_map(vt8020, replace(SETTINGS, shifts=((0.0, 0.0),))).masses_kg()
    shifted = map_of(vt8020, "iso6336").masses_kg()
    have = np.isfinite(plain)
    assert (shifted[have] <= plain[have]).all()
    assert np.mean(plain[have] - shifted[have]) > 0.02
    assert np.isfinite(shifted).sum() > have.sum()


def test_ring_walls_grow_with_the_module_so_that_larger_modules_win():
    """With walls of 2.5 and 3 mm beyond the pitch circle, no module above 0.526 and 0.63 kept the rule ``ring_rim``."""
    for name in motor_names():
        winners = [e.actuator for e in map_of(load_motor(name), "iso6336").entries if e.actuator is not None]
        assert max(actuator.gears.module_mm for actuator in winners) > (0.63 if name in ("VT8020", "U12") else 0.526)
        for actuator in winners:
            (ring,) = [part for part in actuator.parts if part.role is Role.GEAR and part.group is Group.HOUSING]
            wall = ring.prisms[0].outline.radius_mm - actuator.gears.ring_root_radius_mm
            assert wall >= 3.5 * actuator.gears.module_mm - 1e-9


@pytest.mark.long
def test_two_planets_only_if_asked_for(vt8020):
    def planets(settings):
        return {e.actuator.gears.planets for e in build_map(vt8020, settings).entries if e.actuator is not None}

    assert min(planets(SETTINGS)) == 3
    assert min(planets(replace(SETTINGS, planets_min=2))) == 2


@pytest.mark.parametrize("limit", [pytest.param("flank_limit_mpa", marks=pytest.mark.long), "root_limit_mpa"])
def test_a_stronger_steel_never_makes_an_actuator_heavier_and_closes_no_interval(vt8020, limit):
    """Of all three gears: the nitrided ring decides for most roots."""
    before = map_of(vt8020, "iso6336").masses_kg()
    have = np.isfinite(before)
    steels = SETTINGS.gear_steels
    stronger = {
        gear: replace(getattr(steels, gear), **{limit: 1.1 * getattr(getattr(steels, gear), limit)})
        for gear in ("sun", "planet", "ring")
    }
    after = build_map(vt8020, replace(SETTINGS, steels=replace(steels, **stronger))).masses_kg()
    assert (after[have] <= before[have]).all()
    assert (after[have] < before[have]).any()


@pytest.mark.long
def test_a_weaker_steel_closes_intervals_and_the_reason_is_strength(vt8020):
    data = replace(DATA, sun_grade="through_hardened_42crmo4", planet_grade="through_hardened_42crmo4")
    weak = build_map(vt8020, replace(SETTINGS, parts=replace(SETTINGS.parts, rating=data)))
    strong = map_of(vt8020, "iso6336")
    assert np.isfinite(weak.masses_kg()).sum() < np.isfinite(strong.masses_kg()).sum()
    closed = weak.entries[30]
    assert strong.entries[30].actuator is not None
    assert closed.actuator is None
    assert "flank_strength" in closed.forbidden_by["ESSPG"]
    assert set(closed.forbidden_by["ESSPG"]) <= {"flank_strength", "root_strength", "overload_strength"}
    assert "a harder steel" in weak.why_not(7.0)


@pytest.mark.long
def test_a_limit_that_is_off_opens_an_interval(vt8020):
    """The first interval that only lacks strength; without the rules that say so there is a gearbox."""
    strength = {"flank_strength", "root_strength", "overload_strength"}
    entries = map_of(vt8020, "iso6336").entries
    place, names = next(
        (place, entry.forbidden_by["ESSPG"])
        for place, entry in enumerate(entries)
        if entry.actuator is None and entry.forbidden_by["ESSPG"] and set(entry.forbidden_by["ESSPG"]) <= strength
    )
    relaxed = build_map(vt8020, replace(SETTINGS, constraints_off=frozenset(names)))
    assert relaxed.entries[place].actuator is not None
    other = build_map(vt8020, replace(SETTINGS, constraints_off=frozenset({"planet_rim"})))
    assert other.entries[place].actuator is None


@pytest.mark.long
def test_without_webs_intervals_close_and_masses_grow(vt8020):
    data = replace(DATA, second_carrier="pins")
    worse = build_map(vt8020, replace(SETTINGS, parts=replace(SETTINGS.parts, rating=data))).masses_kg()
    usual = map_of(vt8020, "iso6336").masses_kg()
    have = np.isfinite(worse)
    assert np.isfinite(usual[have]).all()
    assert np.isfinite(usual).sum() > have.sum()
    assert np.mean(worse[have] - usual[have]) > 0.002


HARD_TO_KEEP = [
    ("output_bearing", {"bearing_life_min_h": 1e12}),
    ("output_bearing", {"static_safety_min": 20.0}),
    ("output_bearing", {"overload_static_safety_min": 10.0}),
    ("output_bearing", {"bearing_tilt_limit_rad": 1e-4}),
    ("planet_bearing", {"bearing_life_min_h": 1e9}),
    ("planet_bearing", {"static_safety_min": 60.0}),
    ("planet_bearing", {"overload_static_safety_min": 30.0}),
]


@pytest.mark.parametrize(("rule", "service"), HARD_TO_KEEP)
def test_a_winner_breaks_the_rule_of_a_bearing_of_which_more_is_asked(vt8020, rule, service):
    won = map_of(vt8020, "iso6336").entries[20].families["ESSPG"].best
    for settings, breaks in (
        (SETTINGS, False),
        (replace(SETTINGS, service=replace(SETTINGS.service, **service)), True),
    ):
        at = layout(vt8020, "ESSPG", won.gears, won.face_width_mm, settings)
        names, broken = violations(
            CandidateSets(
                gears=won.gears,
                face_width_mm=won.face_width_mm,
                at=at,
                motor=vt8020,
                family="ESSPG",
                settings=settings,
            )
        )
        assert bool(broken[names.index(rule)]) is breaks


@pytest.mark.parametrize(
    ("rule", "service"),
    [pytest.param(*one, marks=() if k in (3, 4) else pytest.mark.long) for k, one in enumerate(HARD_TO_KEEP)],
)
def test_a_bearing_that_does_not_hold_forbids_the_gearbox_and_is_named(vt8020, rule, service):
    usual = map_of(vt8020, "iso6336")
    hard = build_map(vt8020, replace(SETTINGS, service=replace(SETTINGS.service, **service)))
    closed = [
        entry
        for entry, before in zip(hard.entries, usual.entries, strict=True)
        if before.actuator is not None and entry.actuator is None
    ]
    assert any(rule in names for entry in closed for names in entry.forbidden_by.values())


@pytest.mark.long
def test_bearings_that_do_not_hold_forbid_nothing_where_their_rules_are_off(vt8020):
    """All that the test above asks for, at a time."""
    service = replace(
        SETTINGS.service,
        bearing_life_min_h=1e12,
        static_safety_min=60.0,
        overload_static_safety_min=30.0,
        bearing_tilt_limit_rad=1e-4,
    )
    off = replace(SETTINGS, service=service, constraints_off=frozenset({"output_bearing", "planet_bearing"}))
    found, usual = build_map(vt8020, off).masses_kg(), map_of(vt8020, "iso6336").masses_kg()
    assert np.isfinite(found).sum() >= np.isfinite(usual).sum()


@MOTORS
def test_every_winner_s_bearings_hold(name):
    """By the sheet, which solves the balls' contacts where the rule reads a table."""
    service, found = SETTINGS.service, map_for(name, "iso6336")
    for entry in found.entries:
        if entry.actuator is None:
            continue
        for bearing in service_sheet(entry.actuator, found.settings).bearings:
            assert bearing.life_h >= service.bearing_life_min_h
            assert bearing.static_safety >= service.static_safety_min
            assert bearing.overload_safety >= service.overload_static_safety_min
            assert bearing.tilt_rad <= service.bearing_tilt_limit_rad


@pytest.mark.long
def test_planets_too_weak_at_the_least_width_get_wider_faces(vt8020):
    """Needles that hold by a wide face alone: the search widens the face instead of giving up the gear set."""
    service = replace(SETTINGS.service, overload_static_safety_min=3.0)
    hard = build_map(vt8020, replace(SETTINGS, service=service))
    for entry in hard.entries:
        if entry.actuator is not None:
            sheet = service_sheet(entry.actuator, hard.settings)
            needles = next(found for found in sheet.bearings if found.place == "planets")
            assert needles.overload_safety >= 3.0
    usual = map_of(vt8020, "iso6336")
    wider = [
        one.actuator.face_width_mm > other.actuator.face_width_mm
        for one, other in zip(hard.entries, usual.entries, strict=True)
        if one.actuator is not None and other.actuator is not None and one.actuator.gears == other.actuator.gears
    ]
    assert any(wider)


@pytest.mark.long
def test_a_floating_sun_opens_intervals(vt8020):
    data = replace(DATA, sun_support="floating")
    better = build_map(vt8020, replace(SETTINGS, parts=replace(SETTINGS.parts, rating=data)))
    before = map_of(vt8020, "iso6336").masses_kg()
    have = np.isfinite(before)
    assert (better.masses_kg()[have] <= before[have] + 1e-12).all()
    assert np.isfinite(better.masses_kg()).sum() > have.sum()


@DESIGNS
@pytest.mark.parametrize("rules", RULE_SETS)
def test_the_papers_designs_have_gearboxes_under_both_sets_of_rules(case, rules):
    found = map_for("VT8020", rules)
    design = PAPER_CASES[case].design
    robot = build_robot(design, found)
    for actuator, ratio in ((robot.hip, design.hip_ratio), (robot.knee, design.knee_ratio)):
        note = found.stand_in(ratio)
        low = np.floor(10.0 * ratio + 1e-9) / 10.0
        assert (not low - 1e-9 <= actuator.ratio < low + 0.1 - 1e-9) == bool(note)
        assert (actuator.rating is None) == (rules == "paper")
        assert not note or rules == "iso6336"
    built = as_built(design, found)
    # The real ratios have gearboxes of their own: nothing stands in for what is built.
    assert not found.stand_in(built.hip_ratio)
    assert found.lookup(built.knee_ratio) is robot.knee


def test_a_stand_in_says_why_and_what_it_is():
    found = map_for("VT8020", "iso6336")
    lows = [e.ratio_low for e in found.entries if e.actuator is not None]
    asked = max(lows) + 0.15
    note = found.stand_in(asked)
    actuator = found.lookup(asked)
    for words in (f"{asked:g}", "_strength", "would help", str(actuator.gears), f"{actuator.ratio:.4f}:1"):
        assert words in note
    assert "\n" not in note
    assert found.stand_in(6.0) == ""
    assert found.entry(asked).ratio_low == max(lows)
    gaps = [e.ratio_low for e in found.entries if e.actuator is None and e.ratio_low < max(lows)]
    assert gaps
    for low in gaps:
        served = found.entry(low + 0.05)
        away = min(abs(e.actuator.ratio - low - 0.05) for e in found.entries if e.actuator is not None)
        assert abs(served.actuator.ratio - low - 0.05) == pytest.approx(away)


def test_far_from_every_gearbox_nothing_stands_in():
    found = map_for("VT8020", "iso6336")
    with pytest.raises(DesignError, match=r"no gearbox in .*would help"):
        found.lookup(max(e.actuator.ratio for e in found.entries if e.actuator) + STAND_IN_WITHIN + 0.2)
    assert found.interval_index([3.9, np.nan, 14.9, 15.1]).tolist() == [-1] * 4
    paper = map_for("VT8020", "paper")
    assert paper.interval_index([9.0, 8.85]).tolist() == [-1, -1]
    assert paper.stand_in(9.0) == ""


def test_a_motor_too_strong_for_every_gear_set_is_refused_by_its_torque(vt8020):
    strong = replace(vt8020, name="strong", peak_torque_n_m=150.0)
    with pytest.raises(MotorError) as caught:
        map_of(strong, "iso6336")
    message = str(caught.value)
    assert message.startswith("motor strong: no gearbox is strong enough at any ratio from 4 to 15")
    for words in ("peak_torque_n_m = 150", "flank_strength", "a harder steel"):
        assert words in message
    assert "\n" not in message


def test_gears_carry_grade_class_shift_and_safety():
    actuator = map_for("VT8020", "iso6336").lookup(6.0)
    gears = {part.group: part for part in actuator.parts if part.role is Role.GEAR}
    assert len(gears) == 3
    steels = SETTINGS.gear_steels
    shapes = actuator.gears.sun(), actuator.gears.planet(), actuator.gears.ring()
    for group, name, steel, shape in zip(
        (Group.ROTOR, Group.PLANET, Group.HOUSING),
        ("sun", "planet", "ring"),
        (steels.sun, steels.planet, steels.ring),
        shapes,
        strict=True,
    ):
        part = gears[group]
        assert (part.grade, part.accuracy_class) == (steel, DATA.accuracy_class)
        assert f"{shape.teeth} teeth, module {shape.module_mm:g} mm, 20 degrees, profile" in part.note
        assert f"shift {shape.shift * shape.module_mm:+.3f} mm" in part.note
        flank, root = (
            min(getattr(one, which) for one in actuator.rating.gears if one.gear == name)
            for which in ("flank_safety", "root_safety")
        )
        assert part.note.endswith(f"; S_H {flank:.2f}, S_F {root:.2f} (ISO 6336)")


def test_every_rule_belongs_to_a_set_and_says_what_would_help():
    for rule in CONSTRAINTS.values():
        assert rule.cures
        assert set(rule.rule_sets) <= set(RULE_SETS)
    paper = [name for name, rule in CONSTRAINTS.items() if "paper" in rule.rule_sets]
    assert not {"flank_strength", "root_strength", "overload_strength", "face_width"} & set(paper)
