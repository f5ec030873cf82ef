"""Outlines of the leg against shapely polygons drawn from the same pieces."""

import numpy as np
import pytest
import shapely

from pareto_monoped.actuator.search import map_for
from pareto_monoped.geometry.shapes import Arc
from pareto_monoped.leg.dimensions import CHAIN_DRIVES, leg_dimensions
from pareto_monoped.leg.sandwich import Pulley, belt, mirrored, rounded, windows_between
from pareto_monoped.leg.sprocket import sprocket_outline
from pareto_monoped.leg.thigh_outline import thigh_outline
from tests.leg.polygons import polygon

PULLEYS = (
    Pulley(x_mm=0.0, y_mm=0.0, radius_mm=12.0),
    Pulley(x_mm=40.0, y_mm=-3.0, radius_mm=2.0),
    Pulley(x_mm=14.0, y_mm=18.0, radius_mm=3.0, inside=False),
    Pulley(x_mm=5.0, y_mm=50.0, radius_mm=6.0),
)
OUTLINES = {
    "around three pulleys and a fillet": lambda: belt(PULLEYS),
    "its mirror image": lambda: belt(mirrored(PULLEYS)),
    "short thigh": lambda: thigh_outline(55.0, 250.0, leg_dimensions(map_for("VT8020"))),
    "long thigh of a wide motor": lambda: thigh_outline(63.9, 550.0, leg_dimensions(map_for("U12"))),
    "rounded": lambda: rounded(half_width_mm=16.0, high_mm=-60.0, low_mm=-150.0, corner_mm=6.0),
    "sprocket": lambda: sprocket_outline(CHAIN_DRIVES[0]),
}


@pytest.mark.parametrize("name", OUTLINES)
def test_outlines_close_and_enclose_what_a_polygon_does(name):
    path = OUTLINES[name]()
    drawn = polygon(path)
    assert drawn.is_valid, shapely.is_valid_reason(drawn)
    assert drawn.exterior.is_ccw
    moments = path.moments()
    assert moments.area == pytest.approx(drawn.area, rel=1e-4)
    assert moments.x / moments.area == pytest.approx(drawn.centroid.x, abs=0.01)
    assert moments.y / moments.area == pytest.approx(drawn.centroid.y, abs=0.01)


@pytest.mark.parametrize("name", OUTLINES)
def test_each_piece_begins_where_the_last_one_ended(name):
    def ends(piece):
        if isinstance(piece, Arc):
            return [
                (piece.x_mm + piece.radius_mm * np.cos(a), piece.y_mm + piece.radius_mm * np.sin(a))
                for a in (piece.start_rad, piece.end_rad)
            ]
        return [(piece.x0_mm, piece.y0_mm), (piece.x1_mm, piece.y1_mm)]

    pieces = OUTLINES[name]().pieces
    for one, following in zip(pieces, (*pieces[1:], pieces[0]), strict=False):
        assert ends(one)[1] == pytest.approx(ends(following)[0], abs=1e-9)


def test_a_belt_around_discs_is_their_convex_hull():
    discs = [shapely.Point(0.0, 0.0).buffer(12.0, 400), shapely.Point(40.0, -3.0).buffer(2.0, 400)]
    discs.append(shapely.Point(5.0, 50.0).buffer(6.0, 400))
    hull = shapely.union_all(discs).convex_hull
    path = belt([pulley for pulley in PULLEYS if pulley.inside])
    assert polygon(path).symmetric_difference(hull).area < 1e-3 * hull.area
    assert path.moments().area == pytest.approx(hull.area, rel=1e-4)


def test_a_fillet_lies_outside_the_belt_and_touches_it():
    drawn = polygon(belt(PULLEYS))
    fillet = shapely.Point(14.0, 18.0).buffer(3.0, 400)
    assert drawn.intersection(fillet).area < 1e-2
    assert drawn.distance(fillet) < 1e-3


def test_the_mirror_image_is_the_outline_reflected():
    reflected = shapely.transform(polygon(belt(PULLEYS)), lambda points: points * [-1.0, 1.0])
    assert polygon(belt(mirrored(PULLEYS))).symmetric_difference(reflected).area < 1e-2


@pytest.mark.parametrize("rounding", [-1e-13, 0.0, 1e-13])
def test_a_pulley_that_lies_in_line_adds_no_turn(rounding):
    pulleys = [
        Pulley(x_mm=x, y_mm=y, radius_mm=2.0) for x, y in ((0.0, 0.0), (10.0, rounding), (20.0, 0.0), (10.0, 9.0))
    ]
    arcs = [piece for piece in belt(pulleys).pieces if isinstance(piece, Arc)]
    assert sum(abs(arc.end_rad - arc.start_rad) for arc in arcs) == pytest.approx(2.0 * np.pi)


@pytest.mark.parametrize("half_width_mm", [15.0, 6.5, 5.56, 3.0])
def test_the_corners_of_narrow_windows_do_not_cross(half_width_mm):
    for window in windows_between((-60.0, -110.0, -150.0), half_width_mm):
        drawn = polygon(window)
        assert drawn.is_valid, shapely.is_valid_reason(drawn)
        assert drawn.bounds[2] == pytest.approx(half_width_mm)
        assert window.moments().area == pytest.approx(drawn.area, rel=1e-4)
