"""What is left to gain, on growth whose future is known."""

import numpy as np
import pytest

from pareto_monoped.pareto.growth import AHEAD, SecondSearch, left_to_gain, second_search
from pareto_monoped.pareto.objectives import HEIGHT_AND_ENERGY, Objectives, reference_point

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


CORNER = reference_point(HEIGHT_AND_ENERGY, {"height_m": 0.5, "energy_j": 100.0})
FIRST = np.array([[0.8, 20.0], [1.0, 40.0], [1.4, 90.0]])
SECOND = np.array([[0.6, 10.0], [1.0, 44.0], [1.2, 60.0]])


def test_two_fronts_are_compared_as_by_hand():
    """Rectangles below the steps of both fronts; heights from the least of all to the greatest that both reach."""
    found = second_search(FIRST, SECOND, CORNER, 0.02)
    assert found.hypervolume == pytest.approx(0.1 * 90 + 0.2 * 80 + 0.2 * 60 + 0.2 * 40 + 0.2 * 10)
    # The second lacks the step of 0.2 m from 20 to 44 J, 4 J of the next one, and 10 J from 1.2 m on.
    alone = (0.2 * 24 + 0.2 * 4 + 0.2 * 10, 0.1 * 10 + 0.2 * 30)
    assert found.alone == pytest.approx([one / found.hypervolume for one in alone])
    assert found.heights_m == (0.7, 0.8, 0.9, 1.0, 1.1)
    assert found.energies_j == ((20.0, 44.0), (20.0, 44.0), (40.0, 44.0), (40.0, 44.0), (90.0, 60.0))
    assert found.differences == pytest.approx((1.2, 1.2, 0.1, 0.1, -1.0 / 3.0))
    assert found.left_to_gain == 0.02
    swapped = second_search(FIRST[:, ::-1], SECOND[:, ::-1], turned(CORNER), None)
    assert swapped.energies_j == found.energies_j
    assert swapped.alone == pytest.approx(found.alone)


def turned(corner):
    return reference_point(Objectives(names=corner.objectives.names[::-1]), corner.as_dict())


@pytest.mark.parametrize("names", [("height_m", "mass_kg"), ("height_m", "electrical_energy_j", "mass_kg")])
def test_of_other_objectives_only_the_hypervolumes_are_compared(names):
    corner = reference_point(Objectives(names=names), {"height_m": 0.5, names[1]: 100.0})
    fronts = [np.column_stack((front, *[[3.0, 3.1, 3.2]] * (len(names) - 2))) for front in (FIRST, SECOND)]
    found = second_search(*fronts, corner, None)
    assert min(found.alone) > 0.0
    assert found.heights_m == found.energies_j == ()
    assert "energy" not in found.text()


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({}, "The searches differ by at most 0.3 percent of energy at a height and 0.5 percent of the hypervolume: "
             "more evaluations would gain little."),
        ({"energies_j": ((20.0, 20.06), (50.0, 47.95))},
         "The second search needs 4.1 percent less energy at 1.10 m than the first: the seed still matters, give more "
         "evaluations."),
        ({"energies_j": ((20.0, 20.5), (50.0, 49.9))}, "needs 2.5 percent more energy at 0.80 m"),
        ({"alone": (0.001, 0.034)}, "The second search alone has 3.4 percent of the hypervolume of both: "),
        ({"alone": (0.034, 0.001)}, "The first search alone has 3.4 percent"),
        ({"left_to_gain": 0.052}, "hypervolume, but 4 times as many evaluations would gain about 5.2 percent."),
        ({"heights_m": (), "energies_j": ()}, "by at most 0.5 percent of the hypervolume: more"),
        ({"hypervolume": 0.0, "alone": (0.0, 0.0)}, "Neither search has a front"),
    ],
)  # fmt: skip
def test_one_sentence_says_what_to_do(changes, words):
    agreed = {"hypervolume": 40.0, "alone": (0.005, 0.001), "heights_m": (0.8, 1.1), "left_to_gain": None}
    agreed |= {"energies_j": ((20.0, 20.06), (50.0, 49.9))}
    assert words in SecondSearch(**(agreed | changes)).text()


def test_fronts_without_designs_have_nothing_to_compare():
    nothing = np.empty((0, 2))
    assert second_search(nothing, nothing, CORNER, None).text().startswith("Neither search has a front")
    found = second_search(nothing, SECOND, CORNER, None)
    assert (found.alone, found.heights_m) == ((0.0, 1.0), ())


def test_heights_that_rounding_takes_out_of_reach_are_left_out():
    found = second_search(
        np.array([[1.001, 40.0], [1.009, 41.0]]), np.array([[0.998, 39.0], [1.2, 60.0]]), CORNER, None
    )
    assert (found.heights_m, found.energies_j) == ((1.0,), ((40.0, 60.0),))
