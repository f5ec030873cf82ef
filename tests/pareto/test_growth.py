"""What is left to gain, on growth whose future is known."""

import numpy as np
import pytest

from pareto_monoped.pareto.growth import AHEAD, left_to_gain

DONE = np.arange(40, 2001, 40)


def grown(done, power):
    """A hypervolume of 50 that is approached by a power of the evaluations; from 40 evaluations on it is above 0."""
    return 50.0 - 40.0 * (done / 40.0) ** -power


@pytest.mark.parametrize("power", [0.9, 1.2, 1.5])
def test_the_gain_of_power_laws_is_met_within_a_factor_of_two(power):
    today, then = grown(DONE[-1], power), grown(AHEAD * DONE[-1], power)
    assert 0.5 < left_to_gain(DONE, grown(DONE, power)) / ((then - today) / today) < 2.0


def test_what_does_not_grow_any_more_has_nothing_left_to_gain():
    assert left_to_gain(DONE, np.full(50, 48.9)) == 0.0


def test_the_share_does_not_depend_on_units():
    assert left_to_gain(DONE, 1000.0 * grown(DONE, 1.0)) == pytest.approx(left_to_gain(DONE, grown(DONE, 1.0)))


@pytest.mark.parametrize(
    ("done", "volumes"),
    [([], []), ([40], [3.0]), ([40, 80, 120, 160], [0.0, 0.0, 2.0, 3.0]), ([600, 1000], [2.0, 3.0])],
)
def test_where_half_of_the_search_says_nothing_neither_does_it(done, volumes):
    assert left_to_gain(done, volumes) is None
