"""Gear outlines against cut teeth, closed-form areas, the definition of the involute, and meshing without overlap."""

from dataclasses import replace

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.interpolate import CubicSpline
from scipy.optimize import brentq
from shapely.affinity import rotate, translate

from pareto_monoped.actuator.gearset import GearSet
from pareto_monoped.cad.shape.outlines import Spline, all_polygons, contours, ends, polygon
from pareto_monoped.geometry.gears import ExternalGear, InternalGear
from tests.actuator.rating.teeth import Gear
from tests.geometry.cutting import cut_gear, cut_ring

# The published sets and small and large ones of the map.
SETS = [(18, 36, 90, 3), (30, 30, 90, 5), (22, 65, 152, 3), (18, 18, 54, 4), (20, 67, 154, 3)]


def region(gear):
    return shapely.Polygon(all_polygons([gear], 1e-3)[0])


def built(gear, points=50):
    """The region of a gear whose splines bend between their points, as in the kernel."""
    (contour,) = contours(gear)
    rows = []
    for piece in contour.pieces:
        if isinstance(piece, Spline):
            known = np.linspace(0.0, 1.0, len(piece.points_mm))
            rows.append(CubicSpline(known, piece.points_mm)(np.linspace(0.0, 1.0, points))[:-1])
        else:
            rows.append(polygon(replace(contour, pieces=(piece,)), 1e-5))
    return shapely.Polygon(np.concatenate(rows))


def first_flank(gear):
    """Points of the first spline that ends on the tip circle."""
    for piece in contours(gear)[0].pieces:
        if isinstance(piece, Spline) and np.abs(np.hypot(*piece.points_mm.T) - gear.tip_radius_mm).min() < 1e-9:
            return piece.points_mm
    raise AssertionError("no flank")


def around_space(region, gear):
    """Points along a region's edge that belong to one pitch around the y axis, less its ends."""
    points = np.array(region.exterior.segmentize(0.02).coords)
    angle = np.arctan2(points[:, 0], points[:, 1])
    near, far = sorted((gear.tip_radius_mm - 1e-3, gear.root_radius_mm + 1e-3))
    radius = np.hypot(*points.T)
    within = (np.abs(angle) < 0.99 * np.pi / gear.teeth) & (near < radius) & (radius < far)
    return shapely.points(points[within])


@pytest.mark.parametrize(
    ("teeth", "module", "shift", "thinning"),
    [(12, 0.5, 0.0, 0.04), (18, 0.5, 0.0, 0.04), (18, 0.5, 0.6, 0.0), (30, 0.8, -0.4, 0.024), (67, 0.5, 0.1, 0.02)],
)
def test_an_external_gear_is_drawn_as_a_rack_cuts_it(teeth, module, shift, thinning):
    phase = 0.5 * np.pi - np.pi / teeth  # a space on the y axis
    gear = ExternalGear(teeth=teeth, module_mm=module, backlash_mm=thinning, shift=shift, phase_rad=phase)
    cut, drawn = cut_gear(teeth, module, shift, thinning, float(gear.tip_radius_mm)), built(gear)
    assert drawn.is_valid
    for one, other in ((drawn, cut), (cut, drawn)):
        points = around_space(one, gear)
        assert len(points) > 50
        assert shapely.distance(points, other.exterior).max() < 3e-4
    assert drawn.area == pytest.approx(teeth * cut.area, rel=1e-4)


@pytest.mark.parametrize(
    ("teeth", "module", "shift", "widening"), [(54, 0.5, 0.0, 0.04), (90, 0.6, 0.8, 0.02), (154, 0.5, -0.4, 0.0)]
)
def test_a_ring_is_drawn_with_the_roots_that_a_wire_turns(teeth, module, shift, widening):
    phase = 0.5 * np.pi  # a space on the y axis
    gear = InternalGear(teeth=teeth, module_mm=module, backlash_mm=widening, shift=shift, phase_rad=phase)
    cut, drawn = cut_ring(teeth, module, shift, widening, float(gear.tip_radius_mm)), built(gear)
    assert drawn.is_valid
    points = around_space(drawn, gear)
    points = points[np.hypot(*shapely.get_coordinates(points).T) > gear.tip_radius_mm + 1e-3]
    assert len(points) > 50
    assert shapely.distance(points, cut.exterior).max() < 1e-4


@pytest.mark.parametrize("shift", [0.0, 0.5, -0.1])
@pytest.mark.parametrize("teeth", [18, 20, 25, 36, 41, 42, 65, 90])
def test_external_outline_has_the_area_of_the_closed_form(teeth, shift):
    gear = ExternalGear(teeth=teeth, module_mm=0.5, backlash_mm=0.04, shift=shift)
    drawn = region(gear)
    assert drawn.is_valid
    assert drawn.area == pytest.approx(gear.moments().area, rel=1e-3)  # chords between points
    assert built(gear).area == pytest.approx(gear.moments().area, rel=5e-5)
    assert drawn.bounds[2] == pytest.approx(gear.tip_radius_mm, abs=1e-3)
    points = np.array(drawn.exterior.coords)
    assert np.hypot(*points.T).min() == pytest.approx(gear.root_radius_mm, abs=2e-3)


@pytest.mark.parametrize("shift", [0.0, 0.8, -0.4])
@pytest.mark.parametrize("teeth", [54, 90, 152, 154])
def test_internal_outline_has_the_area_of_the_closed_form(teeth, shift):
    gear = InternalGear(teeth=teeth, module_mm=0.5, backlash_mm=0.04, shift=shift)
    if gear.fillet_angle_rad < 0.0:
        assert (teeth, shift) == (54, 0.8)
        return
    drawn = region(gear)
    assert drawn.is_valid
    assert drawn.area == pytest.approx(gear.moments().area, rel=3e-4)


@pytest.mark.parametrize("shift", [0.0, 0.5, -0.4])
@pytest.mark.parametrize(("kind", "teeth"), [(ExternalGear, 24), (InternalGear, 90)])
def test_flanks_of_shifted_teeth_lie_where_a_string_unwinds_to(kind, teeth, shift):
    """Every point of a drawn flank, against the thickness of a slow twin that knows no half angles."""
    gear = kind(teeth=teeth, module_mm=0.5, backlash_mm=0.04, shift=shift)
    slow = Gear(teeth, shift, internal=kind is InternalGear)
    flank = first_flank(gear)
    radius, angle = np.hypot(*flank.T), np.arctan2(flank[:, 1], flank[:, 0])
    play = 0.04 if kind is InternalGear else -0.04
    thickness = np.array([0.5 * slow.thickness(2.0 * r) + play * r / gear.pitch_radius_mm for r in radius])
    assert len(radius) >= 8
    assert 2.0 * radius * np.abs(angle) == pytest.approx(thickness, abs=1e-9)


@pytest.mark.parametrize("kind", [ExternalGear, InternalGear])
def test_flank_points_keep_the_definition_of_the_involute(kind):
    # The normal of an involute touches the base circle: seen from a flank's point, the unwound string is as long as
    # the arc it has left, for every point with the same origin on the base circle.
    flank, base = first_flank(kind(teeth=60, module_mm=1.0)), 30.0 * np.cos(np.radians(20.0))
    radius, angle = np.hypot(*flank.T), np.arctan2(flank[:, 1], flank[:, 0])
    string = np.sqrt(radius**2 - base**2)
    # The lower flank: its involute unwinds towards growing angles.
    origin = angle - (string / base - np.arctan2(string, base))
    assert origin == pytest.approx(np.full(len(origin), origin[0]), abs=1e-12)


@pytest.mark.parametrize(("teeth", "kind"), [(18, ExternalGear), (65, ExternalGear), (90, InternalGear)])
def test_pieces_join_and_roots_are_tangent(teeth, kind):
    gear = kind(teeth=teeth, module_mm=0.5)
    (contour,) = contours(gear)
    for one, following in zip(contour.pieces, (*contour.pieces[1:], contour.pieces[0]), strict=True):
        assert ends(one)[1] == pytest.approx(ends(following)[0], abs=1e-9)
    # No corner sharper than 3 degrees along the root: only the tips have edges, and they lie off the pitch circle.
    points = np.array(built(gear).exterior.coords)
    step = np.diff(np.vstack([points, points[1:2]]), axis=0)
    heading = np.unwrap(np.arctan2(step[:, 1], step[:, 0]))
    corner, place = np.abs(np.diff(heading)), np.hypot(*points[1:].T)
    root_side = np.abs(place - gear.tip_radius_mm) > 0.1
    assert corner[~root_side].max() > np.radians(30.0)
    assert corner[root_side].max() < np.radians(3.0)


SHIFTS = [(0.0, 0.0), (0.0, 0.4), (0.6, 0.5)]
EVERY_TIME = ((SETS[0], SHIFTS[2]), (SETS[1], SHIFTS[1]), (SETS[3], SHIFTS[0]), (SETS[3], SHIFTS[2]))


@pytest.mark.parametrize(
    ("numbers", "shifts"),
    [
        pytest.param(numbers, shifts, marks=() if (numbers, shifts) in EVERY_TIME else pytest.mark.long)
        for numbers in SETS
        for shifts in SHIFTS
    ],
)
def test_a_whole_cycle_of_the_mesh_leaves_the_teeth_apart(numbers, shifts):
    sun_teeth, planet_teeth, ring_teeth, planets = numbers
    gears = GearSet(
        sun_teeth=sun_teeth,
        planet_teeth=planet_teeth,
        ring_teeth=ring_teeth,
        module_mm=0.5,
        planets=planets,
        centre_shift=shifts[0],
        sun_shift=shifts[1],
        backlash_mm=0.015,
        tips_fitted=True,
    )
    if gears.ring().fillet_angle_rad < 0.0:
        assert (numbers, shifts) == ((18, 18, 54, 4), (0.6, 0.5))
        return
    # Each gear with a tooth, or a space, on the x axis.
    sun, planet, ring = (built(replace(gear(), phase_rad=0.0), 20) for gear in (gears.sun, gears.planet, gears.ring))
    distance = 0.25 * (sun_teeth + planet_teeth) + 0.5 * shifts[0]

    def overlaps(turn, error=0.0):
        """Shared areas of a planet with sun and ring while the sun turns by ``turn`` against the carrier."""
        worst = [0.0, 0.0]
        for place in 2.0 * np.pi * np.arange(planets) / planets:
            own = (
                place
                + np.pi
                - np.pi / planet_teeth
                + sun_teeth * place / planet_teeth
                - turn * sun_teeth / planet_teeth
            )
            placed = rotate(planet, np.degrees(own) + error, origin=(0, 0))
            placed = translate(placed, distance * np.cos(place), distance * np.sin(place))
            turned_sun = rotate(sun, np.degrees(turn), origin=(0, 0))
            ring_turn = np.pi * (planet_teeth - 1) / ring_teeth - turn * sun_teeth / ring_teeth
            turned_ring = rotate(ring, np.degrees(ring_turn), origin=(0, 0))
            worst[0] = max(worst[0], placed.intersection(turned_sun).area)
            worst[1] = max(worst[1], placed.difference(turned_ring).area)
        return worst

    for turn in np.linspace(0.0, 2.0 * np.pi / sun_teeth, 9):
        assert overlaps(turn) == [0.0, 0.0]
    assert min(overlaps(0.0, error=2.0)) > 0.01


@settings(max_examples=2 * settings.default.max_examples)
@given(st.integers(30, 160), st.floats(-0.6, 1.4))
def test_the_room_for_fillets_says_which_ring_can_be_drawn(teeth, shift):
    gear = InternalGear(teeth=teeth, module_mm=0.5, backlash_mm=0.04, shift=shift)
    room = gear.fillet_angle_rad
    if abs(room) < 1e-9 or gear.tip_radius_mm < gear.base_radius_mm:
        return
    try:
        drawn = region(gear)
    except ValueError:
        assert room < 0.0
    else:
        assert room > 0.0
        assert drawn.is_valid


@settings(max_examples=2 * settings.default.max_examples)
@given(st.integers(12, 160), st.floats(-0.6, 1.2))
def test_whatever_a_rack_cuts_can_be_drawn(teeth, shift):
    gear = ExternalGear(teeth=teeth, module_mm=0.5, backlash_mm=0.04, shift=shift)
    if gear.tip_thickness_mm > 0.0:
        assert region(gear).is_valid


@pytest.mark.parametrize("teeth", [40, 54, 90])
def test_a_ring_can_be_drawn_up_to_the_shift_at_which_the_room_for_fillets_ends(teeth):
    gear = lambda shift: InternalGear(teeth=teeth, module_mm=0.5, backlash_mm=0.04, shift=shift)  # noqa: E731
    most = brentq(lambda shift: gear(shift).fillet_angle_rad, 0.2, 2.0)
    assert region(gear(most - 1e-3)).is_valid
    with pytest.raises(ValueError, match="does not fit"):
        region(gear(most + 1e-3))


def test_a_fillet_that_does_not_fit_is_refused():
    with pytest.raises(ValueError, match=r"a fillet of 0\.19 mm does not fit into the spaces of 54 internal teeth"):
        contours(InternalGear(teeth=54, module_mm=0.5, backlash_mm=0.04, shift=0.8))
