"""Gear outlines against closed-form areas, the definition of the involute, and meshing without overlap."""

from dataclasses import replace

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely.affinity import rotate, translate

from pareto_monoped.actuator.gearset import GearSet
from pareto_monoped.cad.shape.outlines import Teeth, all_polygons, contours, ends, outline, polygon
from pareto_monoped.geometry.gears import ExternalGear, InternalGear, fillet_room_rad
from tests.actuator.rating import iso6336

# The published sets and small and large ones of the map.
SETS = [(18, 36, 90, 3), (30, 30, 90, 5), (22, 65, 152, 3), (18, 18, 54, 4), (20, 67, 154, 3)]


def region(gear):
    return shapely.Polygon(all_polygons([gear], 1e-3)[0])


def fits(gear):
    """Whether the gear can be drawn; the product's rule, whose agreement with the drawing a test below checks."""
    return fillet_room_rad(gear) >= 0.0


@pytest.mark.parametrize("shift", [0.0, 0.5, -0.1])
@pytest.mark.parametrize("teeth", [18, 20, 25, 36, 41, 42, 65, 90])
def test_external_outline_has_the_area_of_the_closed_form(teeth, shift):
    gear = ExternalGear(teeth=teeth, module_mm=0.5, backlash_mm=0.04, shift=shift)
    drawn = region(gear)
    assert drawn.is_valid
    assert drawn.area == pytest.approx(gear.moments().area, rel=1.5e-3)
    assert drawn.bounds[2] == pytest.approx(gear.tip_radius_mm, abs=1e-3)
    points = np.array(drawn.exterior.coords)
    assert np.hypot(*points.T).min() == pytest.approx(gear.root_radius_mm, abs=2e-3)


@pytest.mark.parametrize("shift", [0.0, 0.8, -0.4])
@pytest.mark.parametrize("teeth", [54, 90, 152, 154])
def test_internal_outline_has_the_area_of_the_closed_form(teeth, shift):
    gear = InternalGear(teeth=teeth, module_mm=0.5, backlash_mm=0.04, shift=shift)
    if not fits(gear):
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
    slow = iso6336.Gear(teeth, shift, internal=kind is InternalGear)
    (contour,) = contours(gear)
    flank = next(piece for piece in contour.pieces if hasattr(piece, "points_mm")).points_mm
    radius, angle = np.hypot(*flank.T), np.arctan2(flank[:, 1], flank[:, 0])
    play = 0.04 if kind is InternalGear else -0.04
    thickness = np.array([0.5 * slow.thickness(2.0 * r) + play * r / gear.pitch_radius_mm for r in radius])
    assert len(radius) >= 8
    assert 2.0 * radius * np.abs(angle) == pytest.approx(thickness, abs=1e-9)


@pytest.mark.parametrize("inner", [False, True])
def test_flank_points_keep_the_definition_of_the_involute(inner):
    # The normal of an involute touches the base circle: seen from a flank's point, the unwound string is as long as
    # the arc it has left, for every point with the same origin on the base circle.
    teeth = Teeth(
        count=60,
        module_mm=1.0,
        tip_radius_mm=29.0 if inner else 31.0,
        root_radius_mm=31.25 if inner else 28.75,
        fillet_mm=0.38,
        inner=inner,
    )
    flank = next(piece for piece in outline(teeth).pieces if hasattr(piece, "points_mm")).points_mm
    radius = np.hypot(*flank.T)
    string = np.sqrt(radius**2 - teeth.base_radius_mm**2)
    # The lower flank: its involute unwinds towards growing angles.
    origin = np.arctan2(flank[:, 1], flank[:, 0]) - (
        string / teeth.base_radius_mm - np.arctan2(string, teeth.base_radius_mm)
    )
    assert origin == pytest.approx(np.full(len(origin), origin[0]), abs=1e-12)


@pytest.mark.parametrize(("teeth", "inner"), [(18, False), (65, False), (90, True)])
def test_pieces_join_and_fillets_are_tangent(teeth, inner):
    gear = (InternalGear if inner else ExternalGear)(teeth=teeth, module_mm=0.5)
    pitch = gear.pitch_radius_mm
    contour = outline(
        Teeth(
            count=teeth,
            module_mm=0.5,
            tip_radius_mm=float(gear.tip_radius_mm),
            root_radius_mm=float(gear.root_radius_mm),
            fillet_mm=0.19,
            inner=inner,
        )
    )
    for one, following in zip(contour.pieces, (*contour.pieces[1:], contour.pieces[0]), strict=True):
        assert ends(one)[1] == pytest.approx(ends(following)[0], abs=1e-9)
    # No corner sharper than 30 degrees along the root: only the tips have edges, and they lie off the pitch circle.
    points = polygon(contour, 1e-4)
    step = np.diff(np.vstack([points, points[:2]]), axis=0)
    heading = np.unwrap(np.arctan2(step[:, 1], step[:, 0]))
    corner = np.abs(np.diff(heading))
    place = np.hypot(*np.vstack([points[1:], points[:1]]).T)
    root_side = place < pitch - 0.3 if not inner else place > pitch + 0.3
    assert np.all(corner[root_side] < np.radians(30.0))


@pytest.mark.parametrize("shifts", [(0.0, 0.0), (0.0, 0.4), (0.6, 0.5)])
@pytest.mark.parametrize("numbers", SETS)
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
    )
    if not (fits(gears.ring(0.04)) and gears.planet_teeth + 17.1 * gears.planet_shift > 17.0):
        assert numbers == (18, 18, 54, 4)
        return
    # Each gear with a tooth, or a space, on the x axis.
    sun, planet, ring = (region(replace(gear(0.04), phase_rad=0.0)) for gear in (gears.sun, gears.planet, gears.ring))
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


@settings(max_examples=300)
@given(st.integers(12, 160), st.floats(-0.6, 1.4), st.sampled_from([ExternalGear, InternalGear]))
def test_the_room_for_fillets_says_what_can_be_drawn(teeth, shift, kind):
    gear = kind(teeth=teeth, module_mm=0.5, backlash_mm=0.04, shift=shift)
    room = fillet_room_rad(gear)
    if abs(room) < 1e-9 or gear.tip_radius_mm < gear.base_radius_mm:
        return
    try:
        region(gear)
    except ValueError:
        assert room < 0.0
    else:
        assert room > 0.0


def test_a_fillet_that_does_not_fit_is_refused():
    with pytest.raises(ValueError, match="fillet"):
        outline(Teeth(count=18, module_mm=0.5, tip_radius_mm=5.0, root_radius_mm=3.875, fillet_mm=0.6))
