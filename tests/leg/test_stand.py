"""The arms of the test stand: they fit the rods and the carriages, and are clear of what moves."""

import numpy as np
import pytest
import shapely
from shapely import Polygon
from shapely.geometry import Point

from pareto_monoped.actuator.motors import motor_names
from pareto_monoped.actuator.search import map_for
from pareto_monoped.cad.shape.outlines import all_polygons
from pareto_monoped.geometry.roles import Role
from pareto_monoped.geometry.shapes import Circle
from pareto_monoped.leg.base import base_parts
from pareto_monoped.leg.dimensions import leg_dimensions
from pareto_monoped.leg.sandwich import _corners, rounded_hull
from pareto_monoped.leg.stand import (
    ARM_MM,
    MGN12H,
    arm,
    carriage_places,
    carriage_screw,
    rod_places,
    rod_screws,
    stand_mass_kg,
)

EACH = pytest.mark.parametrize("leg", motor_names(), indirect=True)


@pytest.fixture
def leg(request):
    return leg_dimensions(map_for(getattr(request, "param", "VT8020")))


def test_a_rounded_hull_is_the_hull_of_its_discs():
    points = [(0.0, 0.0), (10.0, -2.0), (12.0, 7.0), (3.0, 9.0), (5.0, 4.0)]  # the last one lies inside
    (outline,) = all_polygons([rounded_hull(points, 2.5)], 1e-4)
    expected = Polygon(points[:4]).convex_hull.buffer(2.5, quad_segs=512)
    assert Polygon(outline).symmetric_difference(expected).area < 0.01
    assert rounded_hull(points, 2.5).moments().area == pytest.approx(expected.area, rel=1e-5)


@EACH
def test_an_arm_has_holes_at_three_rods_and_around_every_hole_metal(leg):
    (prism,) = arm(leg).prisms
    (outline,) = (Polygon(ring) for ring in all_polygons([prism.outline], 0.01))
    rods = {
        (round(x, 9), round(y, 9))
        for part in base_parts(0.09, leg)
        if part.role is Role.ROD
        for x, y, _ in part.places_mm
    }
    assert {(round(x, 9), round(y, 9)) for x, y, _ in rod_places(leg)} < rods
    holes = [Polygon(ring) for ring in all_polygons(prism.holes, 0.01)]
    for k, hole in enumerate(holes):
        assert outline.contains(hole.buffer(5.0))
        assert all(hole.distance(other) > 4.0 for other in holes[:k])
    round_holes = {(float(hole.x_mm), float(hole.y_mm)) for hole in prism.holes if isinstance(hole, Circle)}
    for x, y, _ in carriage_places(leg):
        for dx in (-10.0, 10.0):
            assert {(x + dx, y - 10.0), (x + dx, y + 10.0)} <= round_holes


@EACH
def test_arms_and_carriages_are_clear_of_the_hip_actuator_and_of_each_other(leg):
    (prism,) = arm(leg).prisms
    (outline,) = (Polygon(ring) for ring in all_polygons([prism.outline], 0.01))
    case_mm = leg.hip.housing_radius_mm
    assert outline.distance(Point(0.0, 0.0)) > case_mm + 1.0
    (x, low, _), (_, high, _) = carriage_places(leg)
    assert np.hypot(x + 0.5 * MGN12H.width_mm, max(low - 0.5 * MGN12H.length_mm, 0.0)) > case_mm + 10.0
    assert high - low > MGN12H.length_mm + 10.0


@EACH
def test_what_a_base_lifts_is_two_arms_four_carriages_and_their_screws(leg):
    """Arms by the area of their outline less its holes, in aluminium; carriages as in HIWIN's catalogue."""
    (prism,) = arm(leg).prisms
    (outline,) = (Polygon(ring) for ring in all_polygons([prism.outline], 0.001))
    area_mm2 = outline.area - sum(Polygon(ring).area for ring in all_polygons(prism.holes, 0.001))
    arms_kg = 2 * area_mm2 * ARM_MM * 2.71e-6
    assert stand_mass_kg(leg) == pytest.approx(arms_kg + 4 * 0.054 + 16 * 1.0e-3, abs=0.0003)


def test_screws_reach_their_threads_and_not_through(leg):
    assert carriage_screw().startswith("M3 x 8 ")
    assert 2.5 <= 8.0 - ARM_MM <= MGN12H.thread_mm
    lengths = {where: float(which.split()[2]) for where, _, which in rod_screws(leg)}
    for where, length in lengths.items():
        grip = ARM_MM + (leg.cheek_mm if "near" in where else leg.far_cheek_mm) + (2.0 if "upper" in where else 0.0)
        assert 6.0 <= length - grip <= 10.0


def test_the_corners_of_a_hull_are_shapely_s():
    """Anticlockwise from the lowest; points inside, on a side, or there twice are no corners."""
    generator = np.random.default_rng(3)
    for count in (3, 4, 7, 12):
        points = [tuple(point) for point in generator.integers(-9, 10, (count, 2)).astype(float)]
        wanted = shapely.MultiPoint(points).convex_hull.normalize()
        if wanted.geom_type != "Polygon":
            continue
        corners = _corners([*points, points[0]])
        assert shapely.Polygon(corners).normalize().equals(wanted)
        assert len(corners) == len(wanted.exterior.coords) - 1
        assert shapely.LinearRing(corners).is_ccw
        assert corners[0] == min(corners, key=lambda corner: (corner[1], corner[0]))
