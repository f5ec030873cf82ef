"""Outlines of the leg against shapely polygons drawn from the same pieces, and against ISO 606."""

import numpy as np
import pytest
import shapely

from pareto_monoped.geometry.shapes import Arc
from pareto_monoped.leg.outlines import rounded, sprocket, sprocket_pitch_radius_mm, waisted


def polygon(path, steps=400):
    points = []
    for piece in path.pieces:
        if isinstance(piece, Arc):
            # Without the last point, which is the next piece's first.
            angle = np.linspace(piece.start_rad, piece.end_rad, steps)[:-1]
            ring = np.stack([np.cos(angle), np.sin(angle)], axis=1)
            points += list(np.array([piece.x_mm, piece.y_mm]) + piece.radius_mm * ring)
        else:
            points += [(piece.x0_mm, piece.y0_mm)]
    return shapely.Polygon(points)


CASES = {
    "waisted": waisted(top_radius_mm=52.0, bottom_radius_mm=31.0, half_width_mm=24.0, length_mm=300.0),
    "waisted the other way": waisted(top_radius_mm=31.0, bottom_radius_mm=40.0, half_width_mm=20.0, length_mm=200.0),
    "rounded": rounded(half_width_mm=16.0, high_mm=-60.0, low_mm=-150.0, corner_mm=6.0),
    "sprocket": sprocket(teeth=20, pitch_mm=8.0, roller_mm=5.0),
}


@pytest.mark.parametrize("name", CASES)
def test_outlines_close_and_enclose_what_a_polygon_does(name):
    path = CASES[name]
    drawn = polygon(path)
    assert drawn.is_valid, shapely.is_valid_reason(drawn)
    assert drawn.exterior.is_ccw
    moments = path.moments()
    assert moments.area == pytest.approx(drawn.area, rel=1e-4)
    assert moments.x / moments.area == pytest.approx(drawn.centroid.x, abs=0.01)
    assert moments.y / moments.area == pytest.approx(drawn.centroid.y, abs=0.01)


@pytest.mark.parametrize("name", CASES)
def test_each_piece_begins_where_the_last_one_ended(name):
    def ends(piece):
        if isinstance(piece, Arc):
            return [
                (piece.x_mm + piece.radius_mm * np.cos(a), piece.y_mm + piece.radius_mm * np.sin(a))
                for a in (piece.start_rad, piece.end_rad)
            ]
        return [(piece.x0_mm, piece.y0_mm), (piece.x1_mm, piece.y1_mm)]

    pieces = CASES[name].pieces
    for one, following in zip(pieces, (*pieces[1:], pieces[0]), strict=False):
        assert ends(one)[1] == pytest.approx(ends(following)[0], abs=1e-9)


def test_sprocket_keeps_the_limits_of_iso_606():
    # 05B-1 with 20 teeth: d = 51.14 mm, tip between d + p (1 - 1.6/z) - d1 = 53.50 and d + 1.25 p - d1 = 56.14.
    assert 2.0 * sprocket_pitch_radius_mm(teeth=20, pitch_mm=8.0) == pytest.approx(51.14, abs=0.005)
    points = np.array(polygon(CASES["sprocket"]).exterior.coords)
    radius = np.hypot(points[:, 0], points[:, 1])
    assert 53.50 <= 2.0 * radius.max() <= 56.14
    # Root diameter d - 2 ri with ri = 0.505 d1.
    assert 2.0 * radius.min() == pytest.approx(51.14 - 2.0 * 0.505 * 5.0, abs=0.01)


def test_rollers_lie_in_the_sprockets_gaps_without_cutting_into_it():
    drawn = polygon(CASES["sprocket"])
    radius = sprocket_pitch_radius_mm(teeth=20, pitch_mm=8.0)
    for tooth in range(20):
        angle = 2.0 * np.pi * tooth / 20
        roller = shapely.Point(radius * np.cos(angle), radius * np.sin(angle)).buffer(2.5, quad_segs=64)
        assert drawn.intersection(roller).area < 1e-3
