"""Compiled distances against plain numpy, to the last bit."""

import numpy as np
import pytest

from pareto_monoped.search.archive import (
    farthest_first,
    nearest_places,
    nearest_squared,
    shortfall_of_two,
    squared_distances,
)


def plain(points, others):
    """Squares of the distances, summed from the first axis to the last, shape (n, k)."""
    away = np.zeros((len(points), len(others)))
    for f in range(points.shape[1]):
        away += np.square(points[:, f, None] - others[:, f])
    return away


@pytest.mark.parametrize("axes", [1, 2, 3, 9])
@pytest.mark.parametrize(("count", "known"), [(0, 5), (1, 1), (7, 300), (300, 7)])
def test_distances_of_all_pairs_and_to_the_nearest(axes, count, known):
    generator = np.random.default_rng(axes)
    points, others = generator.uniform(-1.0, 1.0, (count, axes)), generator.uniform(-1.0, 1.0, (known, axes))
    away = plain(points, others)
    assert np.array_equal(squared_distances(points, others), away)
    assert np.array_equal(nearest_squared(points, others), away.min(axis=1))
    assert np.array_equal(nearest_places(points, others), away.argmin(axis=1))


def test_of_equally_near_the_first_counts():
    points = np.array([[0.0, 0.0], [1.0, 1.0]])
    others = np.array([[1.0, 0.0], [0.0, 1.0], [1.0, 0.0]])
    assert nearest_places(points, others).tolist() == [0, 0]


@pytest.mark.parametrize("first", [[0], [3, 17]])
def test_always_the_farthest_from_all_chosen(first):
    points = np.random.default_rng(5).random((60, 2))
    wanted = list(first)
    while len(wanted) < 12:
        away = plain(points, points[wanted]).min(axis=1)
        wanted.append(int(away.argmax()))
    assert farthest_first(points, np.array(first), 12).tolist() == wanted


def test_points_that_are_all_chosen_end_the_choice():
    points = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 0.0], [0.5, 1.0]])
    assert farthest_first(points, np.array([0, 1]), 10).tolist() == [0, 1, 3]
    assert farthest_first(points, np.array([0, 1, 3]), 2).tolist() == [0, 1, 3]


@pytest.mark.parametrize("known", [1, 2, 40])
def test_shortfall_of_two_objectives_is_the_least_shift_by_definition(known):
    generator = np.random.default_rng(known)
    points, front = generator.random((300, 2)), np.sort(generator.random((known, 2)), axis=0)
    front[:, 1] = front[::-1, 1]
    front = np.vstack((front, front[-1:]))
    # Points on the front, too.
    points[:known] = front[:known]
    wanted = np.max([np.min(points - member, axis=1) for member in front], axis=0)
    assert np.array_equal(shortfall_of_two(points, front), wanted)
