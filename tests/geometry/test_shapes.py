"""Area integrals of shapes against polygons drawn finely and against textbook formulas."""

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from pareto_monoped.geometry.gears import ExternalGear, InternalGear
from pareto_monoped.geometry.shapes import Circle, Pattern, Spread, hull, rectangle
from tests.geometry.polygons import integrals_of, region_integrals

sizes = st.floats(min_value=0.5, max_value=50.0)
places = st.floats(min_value=-80.0, max_value=80.0)


def disc(x, y, radius, steps=4000):
    angle = np.linspace(0.0, 2.0 * np.pi, steps, endpoint=False)
    return shapely.Polygon(np.stack([x + radius * np.cos(angle), y + radius * np.sin(angle)], axis=1))


def assert_same(moments, region, reach, rel=1e-5):
    """Integrals agree relative to what the area would have at the farthest point."""
    scale = region.area * np.array([1.0, reach, reach, reach**2, reach**2, reach**2])
    assert (integrals_of(moments) - region_integrals(region)) / scale == pytest.approx(0.0, abs=rel)


@given(radius=sizes, x=places, y=places)
def test_circle_is_a_fine_polygon(radius, x, y):
    assert_same(Circle(radius_mm=radius, x_mm=x, y_mm=y).moments(), disc(x, y, radius), radius + abs(x) + abs(y))


@given(width=sizes, height=sizes, x=places, y=places)
def test_rectangle_is_exact(width, height, x, y):
    region = shapely.box(x - width / 2, y - height / 2, x + width / 2, y + height / 2)
    moments = rectangle(width_mm=width, height_mm=height, x_mm=x, y_mm=y).moments()
    assert_same(moments, region, width + height + abs(x) + abs(y), rel=1e-11)


@given(top=sizes, bottom=sizes, extra=st.floats(min_value=0.5, max_value=300.0), y=places)
def test_hull_is_the_convex_hull_of_two_discs(top, bottom, extra, y):
    length = abs(top - bottom) + extra
    path = hull(top_radius_mm=top, bottom_radius_mm=bottom, length_mm=length, y_mm=y)
    region = shapely.convex_hull(shapely.union(disc(0, y, top), disc(0, y - length, bottom)))
    assert_same(path.moments(), region, length + top + bottom + abs(y))


@pytest.mark.parametrize("count", [3, 4, 5, 7])
def test_pattern_is_the_sum_of_its_discs(count):
    pattern = Pattern(radius_mm=2.0, pitch_radius_mm=11.0, count=count, phase_rad=0.3, x_mm=4.0, y_mm=-3.0)
    single = [Circle(radius_mm=2.0, x_mm=x, y_mm=y).moments() for x, y in pattern.centres_mm()]
    total = single[0]
    for one in single[1:]:
        total = total + one
    assert len(single) == count
    assert integrals_of(pattern.moments()) == pytest.approx(integrals_of(total), rel=1e-12)


def test_pattern_of_two_keeps_area_and_polar_moment():
    pattern = Pattern(radius_mm=2.0, pitch_radius_mm=11.0, count=2)
    one, other = (Circle(radius_mm=2.0, x_mm=x, y_mm=y).moments() for x, y in pattern.centres_mm())
    both, expected = pattern.moments(), one + other
    assert both.area == pytest.approx(expected.area)
    assert both.xx + both.yy == pytest.approx(expected.xx + expected.yy)


def test_moving_there_and_back_changes_nothing():
    moments = hull(top_radius_mm=10.0, bottom_radius_mm=20.0, length_mm=60.0).moments()
    assert integrals_of(moments.moved(7.0, -9.0).moved(-7.0, 9.0)) == pytest.approx(
        integrals_of(moments), rel=1e-12, abs=1e-9
    )


def test_a_population_has_the_moments_of_its_members():
    lengths = np.array([60.0, 155.5, 400.0])
    many = hull(top_radius_mm=10.0, bottom_radius_mm=20.0, length_mm=lengths).moments()
    for index, length in enumerate(lengths):
        one = hull(top_radius_mm=10.0, bottom_radius_mm=20.0, length_mm=float(length)).moments()
        for name in ("area", "x", "y", "xx", "yy", "xy"):
            value = np.broadcast_to(getattr(many, name), lengths.shape)[index]
            assert value == pytest.approx(getattr(one, name), rel=1e-13, abs=1e-6)


KINDS = {
    "circle": lambda k: Circle(radius_mm=4.0 + k, x_mm=1.0, y_mm=-k),
    "pattern": lambda k: Pattern(radius_mm=1.5, pitch_radius_mm=12.0 + k, count=6),
    "lines": lambda k: rectangle(width_mm=3.0 + k, height_mm=5.0, x_mm=k),
    "lines and arcs": lambda k: hull(top_radius_mm=10.0 + k, bottom_radius_mm=20.0, length_mm=60.0 + k),
    "spread": lambda k: Spread(path=hull(top_radius_mm=2.0 + k, bottom_radius_mm=4.0, length_mm=9.0), count=3),
    "external gear": lambda k: ExternalGear(teeth=20 + k, module_mm=0.6, backlash_mm=0.04, shift=0.3),
    "internal gear": lambda k: InternalGear(teeth=70 + k, module_mm=0.6, backlash_mm=0.04, shift=-0.4),
}


@pytest.mark.parametrize("kind", KINDS)
def test_the_area_alone_is_that_of_the_moments_to_the_last_bit(kind):
    """The search ranks by masses from areas alone, and actuators are weighed from all moments."""
    many = np.linspace(0.0, 7.0, 57)
    for numbers in (many, 3.0, 3):
        # Each drawn anew, because a path keeps what it has worked out.
        area, moments = KINDS[kind](numbers).area_mm2(), KINDS[kind](numbers).moments()
        assert np.array_equal(area, moments.area)
        shape = KINDS[kind](numbers)
        assert np.array_equal(shape.moments().area, shape.area_mm2())
