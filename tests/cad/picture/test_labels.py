"""Scale bars measure what they say; numbers point into their parts and do not touch."""

import dataclasses

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pareto_monoped.cad.picture import labels
from pareto_monoped.cad.picture.drawing import Body, View, draw
from pareto_monoped.cad.picture.labels import Row, balloons, bar_mm, labelled

FRONT = View(towards=(0.0, 1.0, 0.0))


def plate(x0, x1, z0, z1, number):
    points = np.array([[x0, 0.0, z0], [x1, 0.0, z0], [x1, 0.0, z1], [x0, 0.0, z1]])
    return Body(points_mm=points, triangles=np.array([[0, 1, 2], [0, 2, 3]]), colour=(0.9, 0.2, 0.2), number=number)


@given(px_per_mm=st.floats(0.01, 1000.0), width=st.integers(100, 4000))
def test_a_bar_has_a_round_length_and_fits(px_per_mm, width):
    length = bar_mm(px_per_mm, width)
    assert f"{length:e}"[0] in "125"
    assert float(f"{length:.0e}") == pytest.approx(length)
    # At most a quarter of the width; the next round length would not fit.
    assert 0.1 * width * (1.0 - 1e-6) <= length * px_per_mm <= 0.25 * width * (1.0 + 1e-6)


def test_the_scale_bar_is_as_long_as_a_part_of_its_length():
    """A red plate of 100 mm, and the black outline of the bar below it."""
    drawn = draw([plate(0.0, 100.0, 0.0, 20.0, 0)], FRONT, width=800, height=300)
    picture = labelled(drawn, ()).astype(int)
    red = np.flatnonzero(((picture[..., 0] - picture[..., 2]) > 40).any(axis=0))
    length = bar_mm(drawn.px_per_mm, 800)
    assert length == 20.0
    dark = picture[300 - 22 + 4].max(axis=1) < 60
    bar = np.flatnonzero(dark)
    assert bar[0] == 16
    assert (bar[-1] - bar[0]) / (red[-1] - red[0]) == pytest.approx(length / 100.0, abs=0.01)


def test_numbers_point_into_their_parts_in_order_and_apart():
    drawn = draw([plate(10.0 * k, 10.0 * k + 9.0, 0.0, 30.0, k + 1) for k in range(12)], FRONT, width=900, height=300)
    found = balloons(drawn.numbers)
    assert sorted(balloon.number for balloon in found) == list(range(1, 13))
    for balloon in found:
        x, y = balloon.point
        assert drawn.numbers[round(y) - labels.STRIP_PX, round(x)] == balloon.number
    for line in {balloon.at[1] for balloon in found}:
        row = [balloon for balloon in found if balloon.at[1] == line]
        places = [balloon.at[0] for balloon in row]
        assert np.all(np.diff(places) >= 2 * labels._BALLOON_PX)
        assert np.all(np.diff([balloon.point[0] for balloon in row]) >= 0.0)


@given(wanted=st.lists(st.floats(-50.0, 950.0), min_size=1, max_size=24).map(sorted))
def test_places_stay_in_the_picture_and_apart(wanted):
    places = labels._spread(wanted, 900)
    assert len(places) == len(wanted)
    assert min(places) >= labels._BALLOON_PX
    assert max(places) <= 900 - labels._BALLOON_PX
    assert np.all(np.diff(places) >= 2 * labels._BALLOON_PX - 1e-6)


def test_what_cannot_be_seen_is_not_in_the_legend():
    front, behind = plate(0.0, 50.0, 0.0, 50.0, 2), plate(10.0, 20.0, 10.0, 20.0, 1)
    behind = dataclasses.replace(behind, points_mm=behind.points_mm + np.array([0.0, 5.0, 0.0]))
    drawn = draw([behind, front], FRONT, width=300, height=300)
    rows = [Row(number=1, text="hidden", colour=(0, 0, 0)), Row(number=2, text="shown", colour=(0, 0, 0))]
    numbers, seen = labels._seen(drawn.numbers, rows)
    assert [(row.number, row.text) for row in seen] == [(1, "shown")]
    assert set(np.unique(numbers)) == {0, 1}
