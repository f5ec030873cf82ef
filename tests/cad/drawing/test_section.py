"""The cut view of a round part shows what an eye would see."""

from shapely.geometry import Polygon

from pareto_monoped.cad.drawing.paper import WIDE_MM
from pareto_monoped.cad.drawing.section import RoundPart, section_view


def test_the_edges_of_a_solid_shaft_reach_from_its_top_to_its_bottom():
    """Its outline is drawn once around both halves, so that each edge between steps is a line of its own."""
    body = Polygon([(0.0, 0.0), (0.0, 6.0), (10.0, 6.0), (10.0, 4.0), (25.0, 4.0), (25.0, 0.0)])
    paper = section_view(RoundPart(body=body, teeth=(), bores=(), fits=(), from_above=False), 2.0)
    found = {
        tuple(map(tuple, stroke.points.tolist()))
        for stroke in paper.strokes
        if stroke.width_mm == WIDE_MM and not stroke.closed
    }
    assert found == {((2.0 * z, -2.0 * r), (2.0 * z, 2.0 * r)) for z, r in ((0.0, 6.0), (10.0, 6.0), (25.0, 4.0))}
