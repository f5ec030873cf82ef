"""Indicators against areas and distances worked out by hand."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pareto_monoped.pareto.indicators import ReferencePoint, epsilon, hypervolume, igd_plus

REFERENCE = ReferencePoint(height_m=0.5, energy_j=10.0)


def test_hypervolume_of_one_point_is_a_rectangle():
    assert hypervolume(np.array([[0.8, 4.0]]), REFERENCE) == pytest.approx(0.3 * 6.0, rel=1e-14)


def test_hypervolume_of_two_points_is_a_staircase():
    points = np.array([[0.8, 4.0], [1.0, 7.0]])
    assert hypervolume(points, REFERENCE) == pytest.approx(0.3 * 6.0 + 0.2 * 3.0, rel=1e-14)


@pytest.mark.parametrize("point", [[0.5, 4.0], [0.4, 4.0], [0.8, 10.0], [0.8, 11.0]])
def test_points_that_do_not_dominate_the_reference_add_nothing(point):
    assert hypervolume(np.array([point]), REFERENCE) == 0.0
    assert hypervolume(np.array([[0.8, 4.0], point]), REFERENCE) == pytest.approx(1.8, rel=1e-14)


def test_no_points_have_no_hypervolume():
    assert hypervolume(np.zeros((0, 2)), REFERENCE) == 0.0


points = st.lists(st.tuples(st.floats(0.51, 2.0), st.floats(0.1, 9.9)), min_size=1, max_size=8)


@given(points, st.floats(0.51, 2.0), st.floats(0.1, 9.9))
def test_one_more_point_never_shrinks_the_hypervolume(given_points, height_m, energy_j):
    before = np.array(given_points)
    after = np.vstack((before, [height_m, energy_j]))
    assert hypervolume(after, REFERENCE) >= hypervolume(before, REFERENCE) - 1e-12


FRONT = np.array([[0.6, 2.0], [0.8, 4.0], [1.0, 6.0]])


def test_a_front_is_no_distance_from_itself():
    assert epsilon(FRONT, FRONT) == pytest.approx(0.0, abs=1e-15)
    assert igd_plus(FRONT, FRONT) == pytest.approx(0.0, abs=1e-15)


def test_a_front_shifted_by_a_share_of_the_extent_is_that_share_away():
    # Extent 0.4 m and 4 J: a tenth of it lower, no more energy.
    shifted = FRONT - np.array([0.04, 0.0])
    assert epsilon(shifted, FRONT) == pytest.approx(0.1, rel=1e-12)
    assert igd_plus(shifted, FRONT) == pytest.approx(0.1, rel=1e-12)


def test_a_dominating_front_is_better_than_none_away():
    better = FRONT + np.array([0.04, -0.4])
    assert epsilon(better, FRONT) == pytest.approx(-0.1, rel=1e-12)
    assert igd_plus(better, FRONT) == 0.0


def test_a_single_reference_point_is_measured_in_metres_and_joules():
    assert epsilon(np.array([[0.7, 2.0]]), np.array([[0.8, 2.0]])) == pytest.approx(0.1, rel=1e-12)
