"""Compiled kriging in groups against numpy's linear algebra, group by group."""

import numpy as np
import pytest

from pareto_monoped.search.kriging import _alike, kriging_factors, kriging_shares, kriging_values

SCALE, NUGGET = 3.0, 1e-4


def kernel(points, others):
    r = np.sqrt(SCALE * np.square(points[:, None] - others).sum(axis=2))
    return (1.0 + r) * np.exp(-r)


def shares_of(points, errors, ends, nugget=NUGGET):
    return kriging_shares(kriging_factors(points, ends, SCALE, nugget), errors, ends)


def groups_of(sizes, features=9, seed=1):
    generator = np.random.default_rng(seed)
    points = generator.uniform(-1.0, 1.0, (sum(sizes), features))
    return points, generator.standard_normal((sum(sizes), 3)), np.cumsum(sizes)


def test_the_kernel_is_exact_up_to_the_distance_of_opposite_corners_in_15_features():
    r = np.concatenate((np.linspace(0.0, 14.0, 10_000), np.geomspace(1e-12, 1.0, 100)))
    got = r * r / SCALE
    _alike(got, SCALE)
    np.testing.assert_allclose(got, (1.0 + r) * np.exp(-r), rtol=2e-13)


@pytest.mark.parametrize("sizes", [[40], [1, 30, 7], [150, 150]])
def test_values_are_those_of_each_group_alone(sizes):
    points, errors, ends = groups_of(sizes)
    shares = shares_of(points, errors, ends)
    generator = np.random.default_rng(2)
    wanted, groups = generator.uniform(-1.0, 1.0, (200, 9)), generator.integers(0, len(sizes), 200)
    got = kriging_values(wanted, groups, points, shares, ends, SCALE)
    for group, end in enumerate(ends):
        own = slice(end - sizes[group], end)
        matrix = kernel(points[own], points[own]) + NUGGET * np.eye(sizes[group])
        expected = kernel(wanted[groups == group], points[own]) @ np.linalg.solve(matrix, errors[own])
        np.testing.assert_allclose(got[groups == group], expected, rtol=0.0, atol=1e-10)


def test_a_result_depends_on_no_other_group_and_no_other_point():
    """To the last bit: this is what lets threads share groups out."""
    points, errors, ends = groups_of([20, 60, 33])
    shares = shares_of(points, errors, ends)
    alone = shares_of(points[20:80].copy(), errors[20:80].copy(), np.array([60]))
    assert np.array_equal(shares[20:80], alone)
    wanted, groups = np.random.default_rng(3).uniform(-1.0, 1.0, (150, 9)), np.arange(150) % 3
    together = kriging_values(wanted, groups, points, shares, ends, SCALE)
    each = [kriging_values(wanted[k : k + 1], groups[k : k + 1], points, shares, ends, SCALE)[0] for k in range(150)]
    assert np.array_equal(together, np.array(each))


def test_equal_points_without_a_nugget_have_no_solution():
    points = np.zeros((2, 3))
    with pytest.raises(np.linalg.LinAlgError):
        shares_of(points, np.ones((2, 1)), np.array([2]), 0.0)
