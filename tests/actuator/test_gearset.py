"""Ratios, contact ratios, efficiency and phases, against textbook values and geometry."""

import numpy as np
import pytest
import shapely
import shapely.affinity
from hypothesis import given
from hypothesis import strategies as st

from pareto_monoped.actuator.gearset import GearSet, contact_ratios, efficiency
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


@pytest.mark.parametrize("gears", SETS)
def test_efficiency_is_the_power_balance_of_the_stage(gears):
    """Mesh losses integrated numerically; then sun and ring torque add up to the carrier's."""
    friction = 0.1
    outer, inner = contact_ratios(gears)
    base_pitch = np.pi * np.cos(np.radians(20.0))

    def tip_share(teeth, addendum):
        tip, base = teeth / 2 + addendum, teeth / 2 * np.cos(np.radians(20.0))
        return (np.sqrt(tip**2 - base**2) - teeth / 2 * np.sin(np.radians(20.0))) / base_pitch

    s, p, r = gears.sun_teeth, gears.planet_teeth, gears.ring_teeth
    basic = 1.0 - mean_loss(s, p, outer, tip_share(p, 1.0), friction)
    basic *= 1.0 - mean_loss(p, -r, inner, -tip_share(r, -1.0), friction)
    # Unit torque on the sun; the ring's reaction is r / s times it, less losses; carrier speed is 1 / i of the sun's.
    expected = (1.0 + basic * r / s) / gears.ratio
    # The closed form holds while neither share of the contact ratio exceeds 1; the ring's does, by little.
    assert efficiency(gears, friction) == pytest.approx(expected, abs=1e-4)
    assert mean_loss(s, p, outer, tip_share(p, 1.0), friction) == pytest.approx(
        mesh_loss(s, p, tip_share(s, 1.0), tip_share(p, 1.0), friction), rel=1e-4
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
