"""Prices, distances and the most different designs, against plain loops."""

import itertools
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pareto_monoped.analysis.alternatives import LEAST_DISTANCE, distances, most_different, prices
from pareto_monoped.pareto.objectives import HEIGHT_AND_ENERGY, Objectives
from tests.pareto.fronts import THREE

points = st.integers(1, 9).flatmap(
    lambda n: st.lists(
        st.tuples(st.integers(0, 4).map(lambda k: 0.25 * k), st.floats(0.0, 1.0), st.integers(0, 2).map(float)),
        min_size=n,
        max_size=n,
    )
)
CATEGORIES = np.array([False, False, True])


def apart(one, other):
    return math.sqrt((one[0] - other[0]) ** 2 + (one[1] - other[1]) ** 2 + (one[2] != other[2]))


@given(points)
def test_the_distance_counts_a_category_as_one_whatever_its_number(given_points):
    found = distances(np.array(given_points), np.array(given_points[0]), CATEGORIES)
    assert found == pytest.approx([apart(given_points[0], one) for one in given_points])


@given(points, st.integers(0, 9))
def test_each_next_design_is_the_farthest_from_all_that_are_taken(given_points, count):
    found = most_different(np.array(given_points), 0, count, CATEGORIES)
    taken = [0]
    for row in found:
        gaps = [min(apart(one, given_points[k]) for k in taken) for one in given_points]
        assert gaps[row] == pytest.approx(max(gaps))
        assert gaps[row] >= LEAST_DISTANCE
        taken.append(row)
    rest = [min(apart(one, given_points[k]) for k in taken) for one in given_points]
    assert len(found) == count or max(rest) < LEAST_DISTANCE


def test_a_design_as_far_off_as_the_least_distance_is_one_more():
    line = np.array([[0.0], [LEAST_DISTANCE], [0.999 * LEAST_DISTANCE]])
    assert most_different(line, 0, 2, np.array([False])) == [1]
    assert most_different(line[::2], 0, 2, np.array([False])) == []


@given(points)
def test_the_least_distance_is_at_least_half_of_the_best_possible(given_points):
    """Gonzalez 1985; the best possible by trying all subsets."""
    found = most_different(np.array(given_points), 0, 2, CATEGORIES)
    if len(found) < 2:
        return

    def least(rows):
        return min(apart(given_points[a], given_points[b]) for a, b in itertools.combinations(rows, 2))

    best = max(least((0, *rows)) for rows in itertools.combinations(range(1, len(given_points)), 2))
    assert least((0, *found)) >= 0.5 * best - 1e-12


def test_the_price_is_the_greatest_loss_as_a_share():
    values = np.array([[1.0, 20.0], [0.99, 20.2], [1.2, 20.6], [0.9, 10.0], [1.1, 19.0]])
    assert prices(values, values[0], HEIGHT_AND_ENERGY) == pytest.approx([0.0, 0.01, 0.03, 0.1, -0.05])


def test_a_price_of_three_objectives_and_of_a_value_of_zero():
    values = np.array([[1.0, 20.0, 4.0], [1.0, 20.0, 4.2]])
    assert prices(values, values[0], THREE) == pytest.approx([0.0, 0.05])
    zero = Objectives(names=("height_m", "saturation_hip"))
    assert prices(np.array([[1.0, 0.0], [1.0, 0.1]]), np.array([1.0, 0.0]), zero).tolist() == [0.0, np.inf]
