"""Every actuator of every map can be put together: nothing overlaps, nothing rubs, bolts meet their holes."""

import math
from dataclasses import replace
from functools import cache

import pytest

from pareto_monoped.actuator.actuator import build_actuator
from pareto_monoped.actuator.gearset import GearSet
from pareto_monoped.actuator.motor import FramedMotor, FramelessMotor, Motor
from pareto_monoped.actuator.motors import load_motor, motor_names
from pareto_monoped.actuator.search import build_map, map_for
from pareto_monoped.design import RULE_SETS
from pareto_monoped.errors import DesignError
from pareto_monoped.geometry.roles import SCREWS, Role
from pareto_monoped.geometry.shapes import Pattern
from tests.actuator.fit import clashes, overlaps_within, pieces, rings

EVERY_TIME = ("VT8020", "MAD_M6C12", "U12")
"""Motors whose parts are tried every time: the default, the smallest and the largest."""


@cache
def bests(name, rules="paper", every=4):
    """The best actuator of each family in every interval of one motor, or in some of them."""
    found = map_for(name, rules)
    won = [(family, one.best) for entry in found.entries for family, one in entry.families.items() if one.best]
    return [build_actuator(found.motor, family, best.gears, found.settings) for family, best in won[::every]]


@pytest.mark.parametrize("rules", RULE_SETS)
@pytest.mark.parametrize(
    ("name", "every"),
    [*((name, 4) for name in EVERY_TIME), *(pytest.param(name, 1, marks=pytest.mark.long) for name in motor_names())],
)
def test_no_parts_clash_and_every_hole_has_metal_around_it(name, rules, every):
    count = 0
    for actuator in bests(name, rules, every):
        found = clashes(actuator) + [line for part in actuator.parts for line in overlaps_within(part)]
        found += [f"{part.name} falls apart" for part in actuator.parts if pieces(part) != 1]
        assert not found, f"{actuator.family} {actuator.gears}: {found}"
        count += 1
    assert count > 20 / every


def test_the_check_sees_a_gear_that_is_too_wide(vt8020, settings):
    """Two planets with too little metal behind the ring: the check must not pass everything."""
    gears = GearSet(sun_teeth=19, planet_teeth=45, ring_teeth=109, module_mm=0.5, planets=2)
    assert clashes(build_actuator(vt8020, "ISSPG", gears, settings))


def patterns(actuator, name):
    part = next(part for part in actuator.parts if part.name == name)
    return [hole for prism in part.prisms for hole in prism.holes if isinstance(hole, Pattern)]


def meets(actuator, one, other):
    """Whether a bolt pattern of one part lies on a pattern of the other: same circle, count and angle."""
    return any(
        a.count == b.count
        and abs(a.pitch_radius_mm - b.pitch_radius_mm) < 1e-9
        and a.phase_rad == b.phase_rad
        and abs(a.radius_mm - b.radius_mm) > 0.1  # a thread below a clearance hole
        for a in patterns(actuator, one)
        for b in patterns(actuator, other)
    )


@pytest.mark.parametrize("name", ["VT8020", "U8", "U12"])
def test_bolts_of_mating_parts_meet(name):
    for actuator in bests(name):
        assert meets(actuator, "casing", "backplate")
        assert meets(actuator, "casing", "ring_housing")
        assert meets(actuator, "coupling", "motor_rotor")
        if actuator.family == "ESSPG":
            assert meets(actuator, "backplate", "motor_stator")


def test_interfaces_are_where_the_parts_have_their_holes(vt_map):
    for ratio in (4.0, 6.0, 7.9, 8.7):
        actuator = vt_map.lookup(ratio)
        front = "casing" if actuator.family == "ISSPG" else "ring_housing"
        for interface, name in ((actuator.mount, front), (actuator.output, "carrier")):
            # M3 tapping holes from the x axis on, and dowels in the gaps between them.
            gap = math.pi / interface.bolts.count
            dowels = interface.dowels
            for bolts, diameter_mm, phase_rad in (
                (interface.bolts, 2.5, 0.0),
                (dowels, dowels.diameter_mm, gap),
            ):
                assert any(
                    hole.count == bolts.count
                    and 2.0 * hole.pitch_radius_mm == pytest.approx(bolts.pitch_circle_mm)
                    and 2.0 * hole.radius_mm == pytest.approx(diameter_mm)
                    and hole.phase_rad == pytest.approx(phase_rad)
                    for hole in patterns(actuator, name)
                )
        back = actuator.mount.back_bolts
        assert any(
            hole.count == back.count and abs(2.0 * hole.pitch_radius_mm - back.pitch_circle_mm) < 1e-9
            for hole in patterns(actuator, "backplate")
        )


def test_interfaces_are_as_deep_as_the_holes_of_the_parts(vt_map):
    """Depth of the mounting threads and of the motor's own pattern at the back, from the parts' prisms."""

    def depth(part, bolts):
        spans = [
            (float(prism.z0_mm), float(prism.z1_mm))
            for prism in part.prisms
            for hole in prism.holes
            if isinstance(hole, Pattern)
            and hole.count == bolts.count
            and abs(2.0 * hole.pitch_radius_mm - bolts.pitch_circle_mm) < 1e-9
        ]
        return max(high for _, high in spans) - min(low for low, _ in spans)

    for ratio in (4.0, 7.9):
        actuator = vt_map.lookup(ratio)
        parts, mount = {part.name: part for part in actuator.parts}, actuator.mount
        assert depth(parts["backplate"], mount.back_bolts) == pytest.approx(mount.back_depth_mm)
        front = parts["casing" if actuator.family == "ISSPG" else "ring_housing"]
        rim = [prism for prism in front.prisms if prism.z1_mm > -actuator.length_mm / 2.0]
        assert depth(replace(front, prisms=tuple(rim)), mount.bolts) == pytest.approx(mount.thread_depth_mm)
        plain = [part for part in actuator.parts if part.role not in SCREWS]
        assert mount.housing_radius_mm == pytest.approx(max(ring.r1 for part in plain for ring in rings(part)))


@pytest.mark.parametrize("rules", ["iso6336", "paper"])
def test_rings_are_rounded_up_to_a_tenth_that_a_gauge_exists_for(rules):
    """Roots and rim of 3.5 modules, or the pitch circle and 5 or 6 mm; never thinner, by less than 0.1 mm thicker."""
    found = map_for("VT8020", rules)
    for entry in found.entries:
        if entry.actuator is None:
            continue
        actuator = entry.actuator
        gears, (ring,) = actuator.gears, [part for part in actuator.parts if part.name == "ring"]
        outer = 2.0 * float(ring.prisms[0].outline.radius_mm)
        exact = 2.0 * (gears.ring_root_radius_mm + 3.5 * gears.module_mm)
        if rules == "paper":
            exact = gears.module_mm * gears.ring_teeth + (5.0 if actuator.family == "ISSPG" else 6.0)
        (bearing,) = (r for part in actuator.parts if part.name == "main_bearing" for r in rings(part))
        if rules == "iso6336" and actuator.family == "ESSPG":
            exact = max(exact, 2.0 * bearing.r1 + 2.0)  # which passes its shoulder
        assert 10.0 * outer == pytest.approx(round(10.0 * outer), abs=1e-6)
        assert exact - 1e-6 <= outer < exact + 0.1


@pytest.mark.parametrize("name", motor_names())
def test_interfaces_do_not_depend_on_the_gear_set(name):
    found = bests(name)
    assert len({actuator.output for actuator in found}) == 1
    assert len({(actuator.family, actuator.mount) for actuator in found}) == len({a.family for a in found})


def test_faces_and_bearings_are_where_they_must_be():
    found = map_for("VT8020", "paper")
    for ratio in (4.0, 6.0, 7.0, 8.7):
        actuator = found.lookup(ratio)
        parts = {part.name: part for part in actuator.parts}
        assert max(ring.z1 for part in actuator.parts for ring in rings(part)) == 0.0  # screws' heads too
        housing = parts["casing" if actuator.family == "ISSPG" else "ring_housing"]
        assert max(ring.z1 for ring in rings(housing)) == 0.0
        assert max(ring.z1 for ring in rings(parts["carrier"])) == 0.0
        inside = SCREWS | {Role.ELECTRONICS}  # screws' heads and the encoder stand out at the back
        plain = [part for part in actuator.parts if part.role not in inside]
        assert actuator.length_mm == pytest.approx(-min(r.z0 for part in plain for r in rings(part)))
        # The main bearing's bore sits on the carrier, its outside in the ring housing, over its whole width but for the
        # 0.1 or 0.15 mm by which the groove of a retaining ring is wider than the ring.
        (bearing,) = rings(parts["main_bearing"])
        on = [r for r in rings(parts["carrier"]) if r.r1 == bearing.r0 and r.z0 < bearing.z1 and r.z1 > bearing.z0]
        assert min(r.z0 for r in on) <= bearing.z0 + 1e-9
        assert max(r.z1 for r in on) >= bearing.z1 - 0.15 - 1e-9
        seats = [r for r in rings(parts["ring_housing"]) if r.r0 == bearing.r1]
        assert min(r.z0 for r in seats) <= bearing.z0 + 0.15 + 1e-9
        assert max(r.z1 for r in seats) >= bearing.z1 - 1e-9


def test_motor_envelopes_are_the_motors(vt_map, vt8020):
    for ratio, body in ((6.0, vt8020.frameless), (7.0, vt8020.framed)):
        actuator = vt_map.lookup(ratio)
        own = [ring for part in actuator.parts if part.name.startswith("motor_") for ring in rings(part)]
        assert 2.0 * max(ring.r1 for ring in own) == body.outer_diameter_mm
        assert max(r.z1 for r in own) - min(r.z0 for r in own) == pytest.approx(body.length_mm, abs=0.6)
        mass = sum(part.mass_kg() for part in actuator.parts if part.name.startswith("motor_"))
        assert mass == pytest.approx(body.mass_kg)


def test_a_motor_without_stator_data_has_only_the_outer_family():
    assert load_motor("MN8014").frameless is None
    assert {actuator.family for actuator in bests("MN8014")} == {"ESSPG"}


@pytest.mark.parametrize(
    ("outer", "bore", "stator", "length"),
    [
        (60, 40, 54, 25),
        *(pytest.param(*sizes, marks=pytest.mark.long) for sizes in ((120, 80, 108, 30), (200, 150, 180, 40))),
    ],
)
def test_motors_of_other_sizes_fit_together_too(outer, bore, stator, length):
    motor = Motor(
        name="other",
        kv_rpm_per_v=100.0,
        rated_voltage_v=24.0,
        max_continuous_current_a=10.0,
        winding_resistance_ohm=0.1,
        framed=FramedMotor(mass_kg=0.3, outer_diameter_mm=outer, length_mm=length + 8.0),
        frameless=FramelessMotor(
            mass_kg=0.2,
            outer_diameter_mm=outer,
            length_mm=length,
            stator_inner_diameter_mm=bore,
            stator_outer_diameter_mm=stator,
        ),
    )
    found = build_map(motor)
    built = [entry.actuator for entry in found.entries if entry.actuator is not None]
    assert built
    for actuator in built[::10]:
        assert not clashes(actuator)
        assert not [line for part in actuator.parts for line in overlaps_within(part)]


def test_a_motor_too_small_for_any_gearbox_says_so():
    motor = Motor(
        name="tiny",
        kv_rpm_per_v=100.0,
        rated_voltage_v=24.0,
        max_continuous_current_a=10.0,
        winding_resistance_ohm=0.1,
        framed=FramedMotor(mass_kg=0.1, outer_diameter_mm=30.0, length_mm=20.0),
    )
    with pytest.raises(DesignError, match=r"gear ratio = 5.0: tiny has no gearbox.*gearbox_diameter.*another motor"):
        build_map(motor).lookup(5.0)


@pytest.mark.parametrize("name", ["VT8020", "MAD_M6C12"])
def test_the_registers_of_housings_are_round_faces_of_both_parts_in_zones_that_fit(name):
    """A hole and a shaft: H7 with h7, or with the ring, which is ground to h6."""
    told = 0
    for actuator in bests(name, every=8):
        parts = {part.name: part for part in actuator.parts}
        front = ("h7", "ring_housing") if actuator.family == "ISSPG" else ("H7", "ring")
        for one, zone, mate in (("casing", "H7", "backplate"), ("backplate", "h7", "casing"), ("casing", *front)):
            shared = [
                fit.diameter_mm
                for fit in parts[one].registers
                if fit.zone == zone and any(other.holds(fit.diameter_mm) for other in parts[mate].toleranced)
            ]
            assert len(shared) == 1, (one, mate, parts[one].registers)
            for part in (parts[one], parts[mate]):
                radii = [r for ring in rings(part) for r in (ring.r0, ring.r1)]
                assert any(abs(2.0 * r - shared[0]) < 5e-4 for r in radii), (part.name, shared)
            told += 1
    assert told >= 6
