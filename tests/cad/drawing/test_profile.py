"""Half sections hold the material of their parts, and their faces are found."""

import numpy as np
import pytest
from shapely.geometry import Polygon

from pareto_monoped.cad.drawing.bores import bores
from pareto_monoped.cad.drawing.profile import (
    cylinders,
    faces,
    free,
    half_section,
    is_round,
    polygons,
    tapers,
    visible_circles,
)
from pareto_monoped.geometry.features import ShaftEnd
from pareto_monoped.geometry.parts import Part, Prism
from pareto_monoped.geometry.roles import Role
from pareto_monoped.geometry.shapes import Circle, Pattern, rectangle
from pareto_monoped.materials import MATERIALS


def disc(radius, low, high, *holes):
    return Prism(outline=Circle(radius_mm=radius), z0_mm=low, z1_mm=high, holes=holes)


def part(*prisms, **others):
    return Part(name="it", role=Role.SHAFT, material=MATERIALS.steel, prisms=prisms, process="machined", **others)


STEPPED = part(
    disc(20.0, 0.0, 5.0, Circle(radius_mm=8.0)),
    disc(12.0, 5.0, 20.0, Circle(radius_mm=8.0)),
    disc(12.0, 20.0, 22.0, Circle(radius_mm=6.0)),
    features=(ShaftEnd(at=Circle(radius_mm=12.0), face_mm=22.0, inwards=-1.0, width_mm=1.0, depth_mm=2.0),),
)


def revolved_mm3(body):
    """Pappus: the integral of 2 pi r over a profile, by its polygons' first moments."""
    total = 0.0
    for polygon in polygons(body):
        for ring, sign in ((polygon.exterior, 1.0), *((inner, -1.0) for inner in polygon.interiors)):
            region = Polygon(ring)
            total += sign * 2.0 * np.pi * region.area * region.centroid.y
    return total


def test_a_revolved_half_section_has_the_part_s_volume():
    assert revolved_mm3(half_section(STEPPED)) == pytest.approx(STEPPED.volume_mm3(), rel=1e-9)


def test_cylinders_faces_and_tapers_of_a_stepped_sleeve():
    body = half_section(STEPPED)
    assert [(c.radius, c.low, c.high, c.shaft) for c in cylinders(body)] == [
        (8.0, 0.0, 20.0, False),
        (20.0, 0.0, 5.0, True),
        (12.0, 5.0, 20.0, True),
        (6.0, 20.0, 22.0, False),
    ]
    assert [(f.z, f.inner, f.outer, f.up) for f in faces(body)] == [
        (0.0, 8.0, 20.0, False),
        (5.0, 12.0, 20.0, True),
        (20.0, 6.0, 8.0, False),
        (22.0, 6.0, 11.0, True),
    ]
    assert [(t.along, t.across) for t in tapers(body)] == [(2.0, 1.0)]


def test_extension_lines_reach_the_open_only_where_nothing_stands_in_their_way():
    body = half_section(STEPPED)
    assert free(body, 20.0, 22.5, 12.0)
    assert not free(body, 5.0, -1.0, 12.0)
    assert free(body, 20.0, -1.0, 8.0)
    assert not free(body, 20.0, 23.0, 8.0)


def test_a_viewer_sees_the_edges_of_his_side():
    body = half_section(STEPPED)
    assert visible_circles(body, from_above=True) == pytest.approx((6.0, 11.0, 12.0, 20.0))
    assert visible_circles(body, from_above=False) == pytest.approx((6.0, 8.0, 20.0))


def test_round_parts_are_those_that_are_turned():
    assert is_round(STEPPED)
    assert is_round(part(disc(20.0, 0.0, 5.0, Pattern(radius_mm=2.0, pitch_radius_mm=15.0, count=6))))
    assert not is_round(part(disc(20.0, 0.0, 5.0, rectangle(width_mm=4.0, height_mm=4.0))))
    assert not is_round(part(Prism(outline=Circle(radius_mm=5.0, x_mm=1.0), z0_mm=0.0, z1_mm=1.0)))


def test_holes_are_joined_over_prisms_and_know_whether_they_go_through():
    circle = Pattern(radius_mm=2.0, pitch_radius_mm=15.0, count=6)
    wide = Pattern(radius_mm=3.0, pitch_radius_mm=15.0, count=6)
    through = bores(part(disc(20.0, 0.0, 5.0, circle), disc(22.0, 5.0, 9.0, circle)))
    assert [(b.low, b.high, b.through, b.size()) for b in through] == [(0.0, 9.0, True, "Ø4 through")]
    blind = bores(part(disc(20.0, 0.0, 5.0, circle), disc(22.0, 5.0, 9.0)))
    assert [(b.low, b.high, b.through, b.size()) for b in blind] == [(0.0, 5.0, False, "Ø4, 5 deep")]
    stepped = bores(part(disc(20.0, 0.0, 5.0, circle), disc(22.0, 5.0, 9.0, wide)))
    assert {b.size() for b in stepped} == {"Ø4 through", "Ø6, 4 deep"}
    beside = bores(part(disc(20.0, 0.0, 5.0, circle), disc(10.0, 5.0, 9.0), disc(20.0, 9.0, 12.0)))
    assert [b.through for b in beside] == [True]
