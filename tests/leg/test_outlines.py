"""Outlines of the leg against shapely polygons drawn from the same pieces."""

import numpy as np
import pytest
import shapely

from pareto_monoped.geometry.shapes import Arc
from pareto_monoped.leg.chain_drives import CHAIN_DRIVES
from pareto_monoped.leg.outlines import rounded, waisted
from pareto_monoped.leg.sprocket import sprocket_outline
from tests.leg.polygons import polygon

OUTLINES = {
    "waisted": waisted(top_radius_mm=52.0, bottom_radius_mm=31.0, half_width_mm=24.0, length_mm=300.0),
    "waisted the other way": waisted(top_radius_mm=31.0, bottom_radius_mm=40.0, half_width_mm=20.0, length_mm=200.0),
    "rounded": rounded(half_width_mm=16.0, high_mm=-60.0, low_mm=-150.0, corner_mm=6.0),
    "sprocket": sprocket_outline(CHAIN_DRIVES[0]),
}


@pytest.mark.parametrize("name", OUTLINES)
def test_outlines_close_and_enclose_what_a_polygon_does(name):
    path = OUTLINES[name]
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

    pieces = OUTLINES[name].pieces
    for one, following in zip(pieces, (*pieces[1:], pieces[0]), strict=False):
        assert ends(one)[1] == pytest.approx(ends(following)[0], abs=1e-9)
