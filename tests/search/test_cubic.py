"""Compiled cubics against their terms written out."""

from itertools import combinations_with_replacement

import numpy as np
import pytest

from pareto_monoped.search.response_surface import cubic_terms, cubic_values


def plain_terms(points):
    """Products of three of (1, features), from left to right, point by point."""
    found = []
    for point in points:
        factors = [1.0, *point]
        chosen = combinations_with_replacement(range(len(factors)), 3)
        found.append([factors[i] * factors[j] * factors[k] for i, j, k in chosen])
    return np.array(found)


@pytest.mark.parametrize("features", [1, 4, 9])
def test_terms_are_all_products_of_three_to_the_last_bit(features):
    points = np.random.default_rng(1).uniform(-1.0, 1.0, (30, features))
    assert np.array_equal(cubic_terms(points), plain_terms(points))


@pytest.mark.parametrize("count", [0, 1, 63, 64, 65, 300])
def test_values_are_sums_of_the_terms(count):
    generator = np.random.default_rng(2)
    points, coefficients = generator.uniform(-1.0, 1.0, (count, 9)), generator.standard_normal((220, 3))
    wanted = plain_terms(points) @ coefficients if count else np.zeros((0, 3))
    got = cubic_values(points, coefficients)
    assert got.shape == (count, 3)
    # 220 terms of up to 1, and coefficients of about 1.
    np.testing.assert_allclose(got, wanted, rtol=0.0, atol=1e-12)


def test_a_value_does_not_depend_on_the_other_points():
    generator = np.random.default_rng(3)
    points, coefficients = generator.uniform(-1.0, 1.0, (150, 9)), generator.standard_normal((220, 2))
    each = np.vstack([cubic_values(point[None], coefficients) for point in points])
    assert np.array_equal(cubic_values(points, coefficients), each)
