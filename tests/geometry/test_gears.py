"""Gears against teeth cut by a rack, rings drawn along the unrolled involute, and properties of involute gears.

Areas and roots of sun and planet are compared with cut teeth in ``test_cut_teeth``.
"""

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from pareto_monoped.geometry.gears import FILLET, ExternalGear, InternalGear, half_angle
from tests.geometry.cutting import cut_gear
from tests.geometry.polygons import region_integrals

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


@pytest.mark.parametrize(
    ("teeth", "thinning", "shift", "cut"),
    [(12, 0.04, 0.0, 0.0), (14, 0.04, 0.5, 0.06), (18, 0.0, 0.0, 0.0), (30, 0.04, -0.4, 0.1), (67, 0.04, 0.1, 0.02)],
)
def test_an_external_gear_turns_as_heavily_as_what_a_rack_leaves(teeth, thinning, shift, cut):
    gear = ExternalGear(teeth=teeth, module_mm=0.5, backlash_mm=thinning, shift=shift, tip_shortening=cut)
    assert gear.tip_radius_mm == pytest.approx(0.25 * teeth + 0.5 * (1.0 + shift - cut))
    left = region_integrals(cut_gear(teeth, 0.5, shift, thinning, float(gear.tip_radius_mm)))
    assert gear.moments().xx + gear.moments().yy == pytest.approx(teeth * (left[3] + left[4]), rel=5e-5)


@settings(max_examples=100)
@given(st.integers(12, 90), st.floats(-0.6, 0.9), st.floats(0.0, 0.05))
def test_the_end_of_the_rack_s_straight_flank_cuts_on_the_form_circle_or_above_it_if_undercut(teeth, shift, thinning):
    gear = ExternalGear(teeth=teeth, module_mm=0.5, backlash_mm=thinning, shift=shift)
    # Undercut if the straight flank reaches below the point where the line of action touches the base circle.
    feed = 0.5 * shift - 0.5 * thinning / np.tan(ALPHA)
    straight = 0.5 * (1.25 - 0.38 * (1.0 - np.sin(ALPHA))) - feed
    undercut = straight - gear.pitch_radius_mm * np.sin(ALPHA) ** 2
    if undercut <= 0.0:
        assert gear.straight_end_mm == pytest.approx(gear.form_radius_mm, rel=1e-12)
    elif undercut > 1e-3:
        assert gear.straight_end_mm > gear.form_radius_mm + 1e-7


@pytest.mark.parametrize("teeth", [54, 90, 154])
@pytest.mark.parametrize(
    ("backlash", "shift", "cut"), [(0.0, 0.0, 0.0), (0.04, 0.0, 0.2), (0.04, 0.8, 0.0), (0.04, -0.4, 0.1)]
)
def test_internal_gear_is_its_drawing_with_rounded_roots(teeth, backlash, shift, cut):
    gear = InternalGear(teeth=teeth, module_mm=0.5, backlash_mm=backlash, shift=shift, tip_shortening=cut)
    assert gear.tip_radius_mm == pytest.approx(0.25 * teeth - 0.5 * (1.0 - shift - cut))
    assert gear.root_radius_mm == pytest.approx(0.25 * teeth + 0.5 * (1.25 + shift))
    if shift > 0.0 and teeth < 60:
        assert gear.fillet_angle_rad < 0.0
        return
    drawn = tooth_wheel(teeth, 0.5, gear.tip_radius_mm, gear.root_radius_mm, -backlash, shift)
    rho = FILLET * 0.5
    disc = shapely.Point(0, 0).buffer(gear.root_radius_mm + 2.0, quad_segs=2000)
    ring = disc.difference(drawn).buffer(rho, quad_segs=32).buffer(-rho, quad_segs=32)
    hole = region_integrals(disc) - region_integrals(ring)
    assert gear.moments().area == pytest.approx(hole[0], rel=5e-5)
    assert gear.moments().xx + gear.moments().yy == pytest.approx(hole[3] + hole[4], rel=1e-4)


@pytest.mark.parametrize(("kind", "sign"), [(ExternalGear, -1.0), (InternalGear, 1.0)])
def test_half_of_the_pitch_circle_is_tooth_but_for_backlash_and_shift(kind, sign):
    """A rack that is shifted by x m cuts 2 x m tan 20 degrees less off the pitch line."""
    gear = kind(teeth=36, module_mm=0.5, backlash_mm=0.04, shift=0.3)
    expected = np.pi * 0.5 / 2.0 + 2.0 * 0.3 * 0.5 * np.tan(ALPHA) + sign * 0.04
    assert 2.0 * 9.0 * half_angle(gear, 9.0) == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize(("teeth", "shift"), [(14, 0.5), (24, 0.0), (36, -0.4)])
def test_a_tooth_is_as_thick_at_its_tip_as_it_is_drawn(teeth, shift):
    gear = ExternalGear(teeth=teeth, module_mm=0.5, backlash_mm=0.04, shift=shift, tip_shortening=0.05)
    drawn = tooth_wheel(teeth, 0.5, gear.root_radius_mm, gear.tip_radius_mm + 0.05, 0.04, shift)
    turn = np.linspace(0.0, 2.0 * np.pi, 200001)
    circle = shapely.LineString(gear.tip_radius_mm * np.stack([np.cos(turn), np.sin(turn)], axis=1))
    assert gear.tip_thickness_mm == pytest.approx(circle.intersection(drawn).length / teeth, rel=1e-3)


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
