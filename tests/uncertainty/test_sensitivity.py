"""Sobol' indices against functions whose indices are known in closed form."""

import math

import numpy as np
import pytest

from pareto_monoped.errors import InputError
from pareto_monoped.uncertainty.sensitivity import FEWEST_BLOCKS, indices


def always(function):
    return lambda points: (np.ones(len(points), dtype=bool), function(points))


def ishigami(points):
    """Ishigami and Homma 1990, with a = 7 and b = 0.1, on [-pi, pi]^3; and its double, as a second measure."""
    x = math.pi * (2.0 * points - 1.0)
    y = np.sin(x[:, 0]) + 7.0 * np.sin(x[:, 1]) ** 2 + 0.1 * x[:, 2] ** 4 * np.sin(x[:, 0])
    return np.column_stack((y, 2.0 * y))


def test_ishigami():
    """V1 = (1 + b pi^4 / 5)^2 / 2, V2 = a^2 / 8, V13 = 8 b^2 pi^8 / 225; no other part has any variance."""
    first = 0.5 * (1.0 + 0.1 * math.pi**4 / 5.0) ** 2
    second, both = 49.0 / 8.0, 8.0 * 0.01 * math.pi**8 / 225.0
    variance = first + second + both
    found = indices(always(ishigami), 3, blocks=4096)
    for row in (0, 1):
        assert found.first[row] == pytest.approx([first / variance, second / variance, 0.0], abs=0.02)
        assert found.total[row] == pytest.approx(
            [(first + both) / variance, second / variance, both / variance], abs=0.02
        )
    assert (found.jumps, found.failed, found.blocks) == (5 * 4096, 0.0, 4096)
    assert (found.error < 0.06).all()


def test_the_g_function_of_many_factors():
    """Sobol' 1998: product of (|4 x - 2| + a) / (1 + a); the variance of a factor alone is 1 / (3 (1 + a)^2)."""
    a = np.array([0.0, 1.0, 4.5, 9.0, 99.0, 99.0, 99.0, 99.0])

    def function(points):
        return np.prod((np.abs(4.0 * points - 2.0) + a) / (1.0 + a), axis=1)[:, None]

    alone = 1.0 / (3.0 * (1.0 + a) ** 2)
    variance = np.prod(1.0 + alone) - 1.0
    total = alone * np.prod(1.0 + alone) / (1.0 + alone) / variance
    found = indices(always(function), 8, blocks=4096)
    assert found.first[0] == pytest.approx(alone / variance, abs=0.02)
    assert found.total[0] == pytest.approx(total, abs=0.02)
    assert found.effect[0] == pytest.approx(np.zeros(8), abs=0.05)


def test_a_plane_has_its_slopes_as_changes_and_its_squares_as_shares():
    slopes = np.array([[3.0, -1.0, 0.5, 0.0], [0.0, 0.0, 0.0, 2.0]])
    found = indices(always(lambda points: 5.0 + points @ slopes.T), 4, blocks=256)
    assert found.effect == pytest.approx(slopes, abs=1e-9)
    shares = slopes**2 / (slopes**2).sum(axis=1, keepdims=True)
    assert found.total == pytest.approx(shares, abs=0.02)
    assert found.first == pytest.approx(shares, abs=0.05)


def test_a_measure_that_nothing_moves_has_no_shares():
    found = indices(always(lambda points: np.ones((len(points), 1))), 2, blocks=32)
    assert found.total.tolist() == found.error.tolist() == [[0.0, 0.0]]
    assert found.effect == pytest.approx(np.zeros((1, 2)), abs=1e-12)


def test_base_samples_with_a_failure_are_left_out_whole():
    """One in ten base samples fails in one of its jumps; the values of failed jumps are nonsense."""
    calls = []

    def function(points):
        calls.append(points)
        values = ishigami(points)
        ok = np.ones(len(points), dtype=bool)
        ok[1024:2048:10] = False
        values[~ok] = np.nan
        return ok, values

    found = indices(function, 3, blocks=1024)
    assert found.blocks == 512
    assert found.failed == pytest.approx(len(range(1024, 2048, 10)) / len(calls[0]))
    assert np.isfinite(found.effect).all()
    assert found.total[0] == pytest.approx([0.558, 0.442, 0.244], abs=0.08)


def test_the_same_seed_gives_the_same_numbers():
    first, again = (indices(always(ishigami), 3, blocks=64, seed=4) for _ in range(2))
    other = indices(always(ishigami), 3, blocks=64, seed=5)
    for name in ("first", "total", "error", "effect"):
        assert np.array_equal(getattr(first, name), getattr(again, name))
        assert not np.array_equal(getattr(first, name), getattr(other, name))


@pytest.mark.parametrize("blocks", [0, 16, 48])
def test_a_number_of_samples_that_cannot_be_is_refused(blocks):
    with pytest.raises(InputError, match=f"samples = {blocks}: must be a power of two of at least {FEWEST_BLOCKS}"):
        indices(always(ishigami), 3, blocks=blocks)


def test_too_many_failures_are_refused():
    def failing(others):
        """Every other base sample is whole, but for ``others``."""

        def function(points):
            numbers = np.arange(len(points))
            return (numbers % 2 == 0) & ~np.isin(numbers, others), ishigami(points)

        return function

    assert indices(failing([]), 3, blocks=64).blocks == 32
    with pytest.raises(InputError, match="50 percent of the jumps fail, so that only 31 of 64"):
        indices(failing([0]), 3, blocks=64)
