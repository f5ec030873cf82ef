"""Gear areas against polygons drawn along the unrolled involute, and against known properties of involute gears."""

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from pareto_monoped.geometry.gears import FILLET, ExternalGear, InternalGear, fillet_room_rad, half_angle
from tests.geometry.polygons import integrals_of, region_integrals

ALPHA = np.radians(20.0)


def tooth_wheel(teeth, module, root, tip, thinning, shift=0.0):
    """A wheel between two radii, each flank drawn by unrolling a thread from the base circle."""
    base = 0.5 * module * teeth * np.cos(ALPHA)
    pitch_half = np.pi / (2 * teeth) - thinning / (module * teeth) + 2.0 * shift * np.tan(ALPHA) / teeth
    # Roll angle t: radius base sqrt(1 + t^2), polar angle t - atan t.
    start = np.sqrt(max((root / base) ** 2 - 1.0, 0.0))
    roll = np.linspace(start, np.sqrt((tip / base) ** 2 - 1.0), 200)
    radius = base * np.sqrt(1.0 + roll**2)
    angle = pitch_half + np.tan(ALPHA) - ALPHA - (roll - np.arctan(roll))
    if root < base:
        radius, angle = np.insert(radius, 0, root), np.insert(angle, 0, angle[0])
    across = np.linspace(angle[-1], -angle[-1], 20)[1:-1]
    gap = np.linspace(angle[0], 2 * np.pi / teeth - angle[0], 40)[1:-1]
    one_r = np.concatenate([radius, np.full(18, tip), radius[::-1], np.full(38, root)])
    one_a = np.concatenate([-angle, -across, angle[::-1], gap])
    turns = np.arange(teeth)[:, None] * 2 * np.pi / teeth
    a, r = (one_a[None, :] + turns).ravel(), np.tile(one_r, teeth)
    return shapely.Polygon(np.stack([r * np.cos(a), r * np.sin(a)], axis=1))


@pytest.mark.parametrize("teeth", [18, 20, 30, 41, 42, 67])
@pytest.mark.parametrize(("backlash", "shift", "cut"), [(0.0, 0.0, 0.0), (0.04, 0.0, 0.0), (0.04, 0.5, 0.06)])
def test_external_gear_is_its_drawing_with_rounded_roots(teeth, backlash, shift, cut):
    gear = ExternalGear(teeth=teeth, module_mm=0.5, backlash_mm=backlash, shift=shift, tip_shortening=cut)
    assert gear.tip_radius_mm == pytest.approx(0.25 * teeth + 0.5 * (1.0 + shift - cut))
    assert gear.root_radius_mm == pytest.approx(0.25 * teeth - 0.5 * (1.25 - shift))
    drawn = tooth_wheel(teeth, 0.5, gear.root_radius_mm, gear.tip_radius_mm, backlash, shift)
    assert drawn.is_valid
    rho = FILLET * 0.5
    rounded = drawn.buffer(rho, quad_segs=32).buffer(-rho, quad_segs=32)  # a closing rolls a disc in the corners
    got, expected = integrals_of(gear.moments()), region_integrals(rounded)
    # Shifted outwards, a space of few teeth is narrow at its bottom.
    assert got[0] == pytest.approx(expected[0], rel=7e-4 if shift else 2e-4)
    assert got[3] + got[4] == pytest.approx(expected[3] + expected[4], rel=1e-3 if shift else 6e-4)
    # Fillets are no more than what the closing filled, within a tenth, or a fifth where shifted.
    bare = region_integrals(drawn)[0]
    assert got[0] - bare == pytest.approx(expected[0] - bare, rel=0.2 if shift else 0.1)


@pytest.mark.parametrize("teeth", [54, 90, 154])
@pytest.mark.parametrize(("backlash", "shift"), [(0.0, 0.0), (0.04, 0.0), (0.04, 0.8), (0.04, -0.4)])
def test_internal_gear_is_its_drawing_with_rounded_roots(teeth, backlash, shift):
    gear = InternalGear(teeth=teeth, module_mm=0.5, backlash_mm=backlash, shift=shift)
    assert gear.tip_radius_mm == pytest.approx(0.25 * teeth - 0.5 * (1.0 - shift))
    if shift > 0.0 and teeth < 60:
        assert fillet_room_rad(gear) < 0.0
        return
    drawn = tooth_wheel(teeth, 0.5, gear.tip_radius_mm, gear.root_radius_mm, -backlash, shift)
    rho = FILLET * 0.5
    disc = shapely.Point(0, 0).buffer(gear.root_radius_mm + 2.0, quad_segs=2000)
    ring = disc.difference(drawn).buffer(rho, quad_segs=32).buffer(-rho, quad_segs=32)
    hole = np.pi * (gear.root_radius_mm + 2.0) ** 2 - ring.area
    assert gear.moments().area == pytest.approx(hole, rel=5e-5)


def test_tooth_thickness_on_the_pitch_circle_is_half_the_pitch_less_the_backlash():
    psi = half_angle(ExternalGear(teeth=36, module_mm=0.5), 9.0, 0.04)
    assert 2.0 * 9.0 * psi == pytest.approx(np.pi * 0.5 / 2.0 - 0.04, rel=1e-12)


@pytest.mark.parametrize(("teeth", "shift"), [(14, 0.5), (24, 0.0), (36, -0.4)])
def test_a_tooth_is_as_thick_at_its_tip_as_it_is_drawn(teeth, shift):
    gear = ExternalGear(teeth=teeth, module_mm=0.5, backlash_mm=0.04, shift=shift, tip_shortening=0.05)
    drawn = tooth_wheel(teeth, 0.5, gear.root_radius_mm, gear.tip_radius_mm + 0.05, 0.04, shift)
    turn = np.linspace(0.0, 2.0 * np.pi, 200001)
    circle = shapely.LineString(gear.tip_radius_mm * np.stack([np.cos(turn), np.sin(turn)], axis=1))
    assert gear.tip_thickness_mm == pytest.approx(circle.intersection(drawn).length / teeth, rel=1e-3)


def test_golden_values_from_fine_drawings():
    # A polygon as above with fillets, computed once.
    gear = ExternalGear(teeth=18, module_mm=0.5)
    assert gear.moments().area == pytest.approx(62.12, abs=0.02)
    # A pitch cylinder overstates the 18-tooth gear by 2.4 percent.
    assert np.pi * 4.5**2 / gear.moments().area == pytest.approx(1.024, abs=0.001)


@given(teeth=st.integers(18, 160), module=st.sampled_from([0.5, 0.55, 0.6, 0.7, 0.8, 1.0]))
def test_area_scales_with_the_square_of_the_module(teeth, module):
    one, unit = ExternalGear(teeth=teeth, module_mm=module), ExternalGear(teeth=teeth, module_mm=1.0)
    assert one.moments().area == pytest.approx(unit.moments().area * module**2, rel=1e-12)
    assert one.moments().xx == pytest.approx(unit.moments().xx * module**4, rel=1e-12)


@settings(max_examples=50)
@given(teeth=st.integers(40, 160))
def test_backlash_thins_teeth_and_widens_spaces(teeth):
    for kind, sign in ((ExternalGear, -1), (InternalGear, 1)):
        tight = kind(teeth=teeth, module_mm=0.5).moments().area
        loose = kind(teeth=teeth, module_mm=0.5, backlash_mm=0.04).moments().area
        assert sign * (loose - tight) > 0.0


def test_arrays_give_what_single_gears_do():
    teeth, module = np.array([18.0, 42.0, 90.0]), np.array([0.5, 0.6, 0.8])
    for kind in (ExternalGear, InternalGear):
        many = kind(teeth=teeth, module_mm=module, backlash_mm=0.04).moments()
        single = [
            kind(teeth=int(z), module_mm=float(m), backlash_mm=0.04).moments()
            for z, m in zip(teeth, module, strict=True)
        ]
        assert many.area == pytest.approx([one.area for one in single], rel=1e-14)
        assert many.xx == pytest.approx([one.xx for one in single], rel=1e-14)
