"""A path repeated around the origin: moments and contours as of its copies."""

import numpy as np
import pytest

from pareto_monoped.cad.shape.outlines import contours, regions
from pareto_monoped.geometry.shapes import Arc, Circle, Line, Path, Pattern, Spread, rectangle, turned

WEB = Path((Arc(0.0, 0.0, 20.0, -0.3, 0.3), Line(20 * np.cos(0.3), 20 * np.sin(0.3), 12.0, 0.5),
            Line(12.0, 0.5, 12.0, -0.5), Line(12.0, -0.5, 20 * np.cos(0.3), -20 * np.sin(0.3))))  # fmt: skip


@pytest.mark.parametrize("count", [3, 4, 5])
def test_moments_are_the_sum_of_the_copies(count):
    spread = Spread(path=WEB, count=count, phase_rad=0.4)
    copies = [path.moments() for path in spread.paths()]
    whole = spread.moments()
    for name in ("area", "x", "y", "xx", "yy", "xy"):
        assert getattr(whole, name) == pytest.approx(sum(getattr(one, name) for one in copies), rel=1e-9, abs=1e-9)


def test_turning_keeps_area_and_distance():
    one, other = WEB.moments(), turned(WEB, 1.0).moments()
    assert other.area == pytest.approx(one.area)
    assert np.hypot(other.x, other.y) == pytest.approx(np.hypot(one.x, one.y))
    assert np.arctan2(other.y, other.x) == pytest.approx(1.0)


def test_each_region_gets_the_hole_that_lies_in_it():
    spread = Spread(path=WEB, count=3, phase_rad=0.2)
    holes = (Pattern(radius_mm=1.0, pitch_radius_mm=17.0, count=3, phase_rad=0.2),)
    found = regions(spread, holes)
    assert [len(inner) for _, inner in found] == [1, 1, 1]
    assert len({id(inner[0]) for _, inner in found}) == 3
    beside = (Pattern(radius_mm=1.0, pitch_radius_mm=17.0, count=3, phase_rad=0.2 + np.pi / 3.0),)
    assert [len(inner) for _, inner in regions(spread, beside)] == [0, 0, 0]
    one = regions(rectangle(width_mm=4.0, height_mm=4.0), (Circle(radius_mm=1.0),))
    assert len(one) == 1
    assert one[0][1] == [*contours(Circle(radius_mm=1.0))]
