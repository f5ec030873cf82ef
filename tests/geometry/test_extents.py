"""How large shapes and parts are, against points along their outlines."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pareto_monoped.geometry.extents import extent, perimeter_mm
from pareto_monoped.geometry.gears import ExternalGear
from pareto_monoped.geometry.parts import disc, layer, machined_part
from pareto_monoped.geometry.roles import Role
from pareto_monoped.geometry.shapes import Arc, Circle, Line, Path, Pattern, Spread, hull, rectangle, turned


def points(path):
    """Many points along a path."""
    share, found = np.linspace(0.0, 1.0, 2001), []
    for piece in path.pieces:
        if isinstance(piece, Line):
            x = piece.x0_mm + share * (piece.x1_mm - piece.x0_mm)
            found.append(np.stack([x, piece.y0_mm + share * (piece.y1_mm - piece.y0_mm)]))
        else:
            angle = piece.start_rad + share * (piece.end_rad - piece.start_rad)
            around = piece.radius_mm * np.stack([np.cos(angle), np.sin(angle)])
            found.append(np.array([[piece.x_mm], [piece.y_mm]]) + around)
    return found


def part(*prisms):
    return machined_part(name="p", role=Role.SPACER, prisms=prisms)


@given(angle=st.floats(-7.0, 7.0), top=st.floats(5.0, 40.0), bottom=st.floats(5.0, 40.0), y=st.floats(-80.0, 80.0))
def test_the_extent_of_a_path_is_that_of_points_along_it(angle, top, bottom, y):
    path = turned(hull(top_radius_mm=top, bottom_radius_mm=bottom, length_mm=90.0, y_mm=y), angle)
    rows = points(path)
    x, y = np.concatenate(rows, axis=1)
    box = extent(part(layer(path, -3.0, 4.0)))
    assert (box.x_mm, box.y_mm) == pytest.approx((np.ptp(x), np.ptp(y)), abs=1e-3)
    assert box.radius_mm == pytest.approx(np.hypot(x, y).max(), abs=1e-3)
    assert box.z_mm == 7.0
    length = sum(np.hypot(*np.diff(row)).sum() for row in rows)
    assert perimeter_mm(path) == pytest.approx(length, rel=1e-6)


def test_an_arc_that_runs_clockwise_reaches_as_far_as_its_points():
    """Pieces of a disc of which the arc runs either way, as seats of sprockets and bands of chain do."""
    for start in np.linspace(-3.0, 3.0, 25):
        for sweep in (-4.0, -2.0, 2.0, 4.0):
            ends = [(1.0 + 7.0 * np.cos(angle), 7.0 * np.sin(angle)) for angle in (start + sweep, start)]
            path = Path((Arc(1.0, 0.0, 7.0, start, start + sweep), Line(*ends[0], *ends[1])))
            x, y = np.concatenate(points(path), axis=1)
            box = extent(part(layer(path, 0.0, 1.0)))
            wanted = (np.ptp(x), np.ptp(y), np.hypot(x, y).max())
            assert (box.x_mm, box.y_mm, box.radius_mm) == pytest.approx(wanted, abs=1e-3)
            assert perimeter_mm(path) == pytest.approx(7.0 * abs(sweep) + np.hypot(*np.subtract(*ends)))


def test_round_shapes_and_teeth():
    box = extent(part(disc(5.0, 0.0, 2.0), layer(Circle(radius_mm=2.0, x_mm=7.0, y_mm=-1.0), 2.0, 3.0)))
    assert (box.x_mm, box.y_mm, box.z_mm) == (14.0, 10.0, 3.0)
    assert box.radius_mm == pytest.approx(50.0**0.5 + 2.0)
    ring = Pattern(radius_mm=1.0, pitch_radius_mm=6.0, count=4)
    assert extent(part(layer(ring, 0.0, 1.0))).radius_mm == 7.0
    assert perimeter_mm(ring) == pytest.approx(4 * 6.283185, rel=1e-6)
    spokes = Spread(path=rectangle(width_mm=6.0, height_mm=2.0, x_mm=9.0), count=3)
    assert extent(part(layer(spokes, 0.0, 1.0))).radius_mm == pytest.approx(145.0**0.5)
    assert perimeter_mm(spokes) == 48.0
    # Module 1 with 20 teeth: tips 1 mm beyond the pitch circle of 20 mm.
    gear = extent(part(layer(ExternalGear(teeth=20, module_mm=1.0), 0.0, 8.0)))
    assert (gear.x_mm, gear.radius_mm) == pytest.approx((22.0, 11.0))


def test_arrays_are_the_numbers_one_by_one():
    lengths = np.array([60.0, 90.0, 140.0])

    def link(length):
        path = hull(top_radius_mm=20.0, bottom_radius_mm=12.0, length_mm=length)
        return extent(part(layer(path, 0.0, 0.1 * length)))

    together = link(lengths)
    for name in ("x_mm", "y_mm", "z_mm", "radius_mm"):
        one_by_one = [getattr(link(length), name) for length in lengths]
        np.testing.assert_allclose(getattr(together, name) + 0.0 * lengths, one_by_one, rtol=1e-14)


def test_an_unknown_shape_is_no_guess():
    with pytest.raises(TypeError, match="object"):
        perimeter_mm(object())
    with pytest.raises(TypeError, match="object"):
        extent(part(layer(object(), 0.0, 1.0)))
