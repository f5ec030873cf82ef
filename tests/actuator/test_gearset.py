"""Ratios, contact ratios, efficiency and phases, against textbook values and geometry."""

from dataclasses import replace

import numpy as np
import pytest
import shapely
import shapely.affinity
from hypothesis import given
from hypothesis import strategies as st

from pareto_monoped.actuator.gearset import GearSet, contact_ratios, efficiency, joined
from pareto_monoped.actuator.service.stiffness import backlash_arcmin
from tests.actuator.rating import teeth
from tests.geometry.test_gears import tooth_wheel

NOMINAL = GearSet(sun_teeth=18, planet_teeth=36, ring_teeth=90, module_mm=0.5, planets=3)
SETS = [
    NOMINAL,
    GearSet(sun_teeth=30, planet_teeth=30, ring_teeth=90, module_mm=0.5, planets=5),
    GearSet(sun_teeth=22, planet_teeth=65, ring_teeth=152, module_mm=0.5, planets=3),
]


def test_ratio_and_radii_of_the_nominal_set():
    assert NOMINAL.ratio == 6.0
    assert NOMINAL.carrier_radius_mm == 13.5
    assert NOMINAL.ring_root_radius_mm == 23.125
    assert str(NOMINAL) == "18/36/90 m 0.5 x3"


SHIFTS = pytest.mark.parametrize("shifts", [(0.0, 0.4), (0.6, 0.5), (0.3, 0.1), (-0.2, -0.1)])


@SHIFTS
@pytest.mark.parametrize("gears", SETS)
def test_shifted_gears_fill_their_working_circles(gears, shifts):
    """The shifts of planets and ring, the contact ratios and the play, against thicknesses on the working circles."""
    shifted = replace(gears, centre_shift=shifts[0], sun_shift=shifts[1])
    sun, planet, ring, distance = teeth.shifted(gears.sun_teeth, gears.planet_teeth, gears.ring_teeth, *shifts)
    assert shifted.carrier_radius_mm == pytest.approx(0.5 * distance, rel=1e-12)
    assert (shifted.planet_shift, shifted.ring_shift) == pytest.approx((planet.x, ring.x), abs=1e-9)
    assert shifted.planet().tip_shortening == shifted.sun().tip_shortening == pytest.approx(planet.cut, abs=1e-9)
    for gear, slow in ((shifted.sun(), sun), (shifted.planet(), planet), (shifted.ring(), ring)):
        assert gear.tip_radius_mm == pytest.approx(0.5 * slow.tip, rel=1e-9)
    expected = teeth.contact_ratio(sun, planet, distance), teeth.contact_ratio(planet, ring, distance)
    assert contact_ratios(shifted) == pytest.approx(expected, rel=1e-9)
    # Thinned by 0.04 mm each on the reference circle, both teeth leave this on the working circles.
    working = distance / (gears.sun_teeth + gears.planet_teeth)
    play_mm = 2.0 * 0.04 * working / 0.5
    assert backlash_arcmin(shifted, 0.04) == pytest.approx(play_mm / shifted.carrier_radius_mm * 180 * 60 / np.pi)


@SHIFTS
@pytest.mark.parametrize("gears", SETS)
def test_clearance_stays_that_of_the_basic_rack_at_least(gears, shifts):
    shifted = replace(gears, centre_shift=shifts[0], sun_shift=shifts[1])
    sun, planet, ring, far = shifted.sun(), shifted.planet(), shifted.ring(), shifted.carrier_radius_mm
    for clearance in (
        far - sun.tip_radius_mm - planet.root_radius_mm,
        far - planet.tip_radius_mm - sun.root_radius_mm,
        ring.root_radius_mm - far - planet.tip_radius_mm,
        ring.tip_radius_mm - far - planet.root_radius_mm,
    ):
        assert clearance >= 0.25 * shifted.module_mm - 1e-9


FITTED = [
    replace(gears, backlash_mm=0.03 * gears.module_mm, tips_fitted=True)
    for gears in (
        *(one.shifted(*shifts) for one in SETS for shifts in ((0.0, 0.0), (0.0, 0.4), (0.6, 0.5))),
        GearSet(sun_teeth=15, planet_teeth=57, ring_teeth=129, module_mm=0.6, planets=3, sun_shift=0.4),
        GearSet(sun_teeth=15, planet_teeth=20, ring_teeth=55, module_mm=0.9, planets=4, centre_shift=-0.2),
    )
]


def test_tips_are_as_long_as_a_drawing_of_the_line_of_action_allows():
    many = joined(FITTED)
    for k, gears in enumerate(FITTED):
        *slow, _ = teeth.drawn(gears)
        for name, expected in zip(("sun", "planet", "ring"), slow, strict=True):
            wanted = pytest.approx(float(gears.module_mm) * expected.tip, rel=1e-9)
            for kept in (gears, many.chosen(k), many.where(np.array([k])).chosen(0)):
                assert getattr(kept, name)().tip_radius_mm == wanted
            assert getattr(many, name)().tip_radius_mm[k] == wanted


def touched_mm(gears, tip, root, off_mm):
    """Radius at which a tip touches the flank of its mate last, however far down that may go.

    The tip rolls around the mate, which stands still. Its angle less that of the mate's involute is greatest or least
    where both touch.
    """
    shape, mate = getattr(gears, tip)(), getattr(gears, root)()
    rolls, far = float(mate.teeth / shape.teeth), float(gears.carrier_radius_mm) + off_mm
    centre, turns, at = {"ring": (-far, 1.0 - rolls, 0.0)}.get(
        tip, (far, 1.0 - rolls, 0.0) if root == "ring" else (far, 1.0 + rolls, np.pi)
    )
    base, most = float(mate.base_radius_mm), float(mate.root_radius_mm if root == "ring" else mate.tip_radius_mm)
    for side in (1.0, -1.0):
        low, high = 0.0, 12.0 / min(float(mate.teeth), float(shape.teeth))
        for _ in range(5):
            angle = np.linspace(low, high, 3001)
            point = centre * np.exp(1j * angle) + float(shape.tip_radius_mm) * np.exp(1j * (at + turns * angle))
            inside = (np.abs(point) > base) & (np.abs(point) < most)
            angle, point = angle[inside], point[inside]
            tangent = np.sqrt((np.abs(point) / base) ** 2 - 1.0)
            apart = np.unwrap(np.angle(point)) - side * (tangent - np.arctan(tangent))
            turning = np.flatnonzero(np.diff(np.sign(np.diff(apart))))
            if not len(turning):
                break
            low, high = angle[max(turning[0] - 2, 0)], angle[min(turning[0] + 4, len(angle) - 1)]
        else:
            return float(np.abs(point[turning[0] + 1]))
    raise AssertionError("they never touch")


def test_tips_that_are_fitted_keep_their_margin_at_either_end_of_the_planets_place():
    """Against flanks as the rack and the wire leave them, of the thickest and the thinnest teeth."""
    bound = set()
    for gears in FITTED:
        module = float(gears.module_mm)
        *slow, _ = teeth.drawn(gears)
        slow = dict(zip(("sun", "planet", "ring"), slow, strict=True))
        for tip, root in (("sun", "planet"), ("planet", "sun"), ("ring", "planet"), ("planet", "ring")):
            mate, thin = slow[root], [float(gears.backlash_mm)]
            if root != "ring":
                thin.append(teeth.thinning(mate.teeth, module, thin[0]))
            ends = [module * teeth.form_radius(teeth.generated(mate, one / module), mate) for one in thin]
            left = []
            for off_mm in (-0.022, 0.0, 0.022):
                touched = touched_mm(gears, tip, root, off_mm)
                left.append(min(ends) - touched if root == "ring" else touched - max(ends))
            assert min(left) >= 0.02 * module - 1e-6
            bound |= {(tip, root)} if min(left) <= 0.02 * module + 1e-6 else set()
    # The margin of each is exact somewhere: no tip is shorter than it must be.
    assert len(bound) == 4


def test_one_set_of_many_keeps_its_shifts():
    many = joined([SETS[0], SETS[1].shifted(0.6, 0.5), SETS[2].shifted(0.0, 0.4)])
    assert str(many.chosen(0)) == str(SETS[0])
    assert many.chosen(1) == replace(SETS[1], centre_shift=0.6, sun_shift=0.5)
    assert many.where(np.array([2])).chosen(0) == replace(SETS[2], sun_shift=0.4)
    assert str(many.chosen(2)) == "22/65/152 m 0.5 x3, shifts +0.40/-0.40/-0.40"
    assert many.planet_shift[0] == many.ring_shift[0] == many.planet().tip_shortening[0] == 0.0
    assert many.working_angle_rad[0] == SETS[0].working_angle_rad


def test_contact_ratio_of_a_textbook_pair():
    # Two equal 20-degree gears of 30 teeth have a contact ratio of 1.65 (KHK, technical reference, table of 20 degree
    # standard gears: 1.654).
    outer, _ = contact_ratios(SETS[1])
    assert outer == pytest.approx(1.654, abs=0.002)


def test_internal_contact_is_longer_than_external():
    for gears in SETS:
        outer, inner = contact_ratios(gears)
        assert 1.5 < outer < inner < 2.1


def mean_loss(first, second, ratio_of_contact, before, friction):
    """Loss of a mesh per unit of power, from friction along the path of contact, averaged over one base pitch.

    The load is shared evenly by the pairs in contact; at s base pitches from the pitch point they slide with
    s x pitch x (1/r1 + 1/r2) of the speed on the base circle. ``second`` is negative for an internal gear.
    """
    shift = (np.arange(20000) + 0.5) / 20000
    places = -before + shift[:, None] + np.arange(3)[None, :]
    inside = places <= ratio_of_contact - before
    sliding = (np.abs(places) * inside).sum(axis=1) / inside.sum(axis=1)
    return friction * 2.0 * np.pi * (1.0 / first + 1.0 / second) * sliding.mean()


def mesh_loss(first, second, after, before, friction):
    """Ohlendorf's closed form."""
    return np.pi * friction * (1 / first + 1 / second) * (1 - after - before + after**2 + before**2)


@pytest.mark.parametrize("shifts", [(0.0, 0.0), (0.0, 0.4), (0.6, 0.5)])
@pytest.mark.parametrize("plain", SETS)
def test_efficiency_is_the_power_balance_of_the_stage(plain, shifts):
    """Mesh losses integrated numerically; then sun and ring torque add up to the carrier's."""
    friction = 0.1
    gears = replace(plain, centre_shift=shifts[0], sun_shift=shifts[1])
    *slow, distance = teeth.shifted(plain.sun_teeth, plain.planet_teeth, plain.ring_teeth, *shifts)
    outer, inner = contact_ratios(gears)
    base_pitch = np.pi * np.cos(np.radians(20.0))

    def tip_share(gear):
        """From the pitch point, where the working circles touch, to the tip circle."""
        working = distance * gear.teeth / (plain.sun_teeth + plain.planet_teeth)
        return (np.sqrt(gear.tip**2 - gear.base**2) - np.sqrt(working**2 - gear.base**2)) / base_pitch

    s, p, r = gears.sun_teeth, gears.planet_teeth, gears.ring_teeth
    sun, planet, ring = map(tip_share, slow)
    basic = 1.0 - mean_loss(s, p, outer, planet, friction)
    basic *= 1.0 - mean_loss(p, -r, inner, -ring, friction)
    # Unit torque on the sun; the ring's reaction is r / s times it, less losses; carrier speed is 1 / i of the sun's.
    expected = (1.0 + basic * r / s) / gears.ratio
    # With contact ratios above 2, a third pair shares the load for a while.
    assert efficiency(gears, friction) == pytest.approx(expected, abs=3e-4 if inner > 2.0 else 1e-5)
    # Ohlendorf's form holds while neither share of the contact ratio exceeds 1.
    if max(sun, planet) <= 1.0 and min(sun, planet) >= 0.0:
        assert mean_loss(s, p, outer, planet, friction) == pytest.approx(
            mesh_loss(s, p, sun, planet, friction), rel=1e-4
        )
    assert efficiency(gears, 0.0) == pytest.approx(1.0)


@given(friction=st.floats(0.01, 0.3))
def test_more_friction_never_helps(friction):
    assert efficiency(NOMINAL, friction) < efficiency(NOMINAL, 0.9 * friction)


def planet_turn_rad(gears, angle_rad):
    """How far a planet at an angle is turned about its own axis against the one on the x axis."""
    return angle_rad * (1.0 + gears.sun_teeth / gears.planet_teeth)


def turned(polygon, angle, x=0.0, y=0.0):
    return shapely.affinity.translate(shapely.affinity.rotate(polygon, angle, origin=(0, 0), use_radians=True), x, y)


@pytest.mark.parametrize("gears", SETS)
def test_gears_in_phase_mesh_without_overlap(gears):
    """Sun, every planet and ring drawn where their phases say: no overlap with backlash, some if a gear is turned."""
    m, backlash = gears.module_mm, 0.04

    def wheel(kind, thinning):
        low, high = sorted((float(kind.root_radius_mm), float(kind.tip_radius_mm)))
        return turned(tooth_wheel(kind.teeth, m, low, high, thinning), float(kind.phase_rad))

    sun, ring_hole = wheel(gears.sun(), backlash), wheel(gears.ring(), -backlash)
    planet = wheel(gears.planet(), backlash)
    for k in range(gears.planets):
        angle = 2.0 * np.pi * k / gears.planets
        r = gears.carrier_radius_mm
        placed = turned(planet, planet_turn_rad(gears, angle), r * np.cos(angle), r * np.sin(angle))
        assert placed.intersection(sun).area < 1e-9
        assert placed.difference(ring_hole).area < 1e-9
        off = turned(
            planet, planet_turn_rad(gears, angle) + 0.6 / gears.planet_teeth, r * np.cos(angle), r * np.sin(angle)
        )
        assert off.intersection(sun).area + off.difference(ring_hole).area > 0.01
