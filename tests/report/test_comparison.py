from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pareto_monoped.pareto.objectives import hypervolume, reference_point
from pareto_monoped.report.card import Source
from pareto_monoped.report.comparison import _held, _surface, compare, group_of, least_second, seed_groups
from pareto_monoped.report.page import build
from pareto_monoped.report.resimulation import resimulate
from pareto_monoped.storage.reader import read_study
from tests.report.conftest import cut

numbers = st.floats(0.5, 2.0)


@given(st.lists(st.tuples(numbers, st.floats(1.0, 90.0)), max_size=8), numbers)
def test_the_energy_at_a_height_is_the_least_of_those_that_reach_it(points, height):
    front = np.array(points).reshape(-1, 2)
    able = [energy for reached, energy in points if reached >= height]
    assert least_second(front, np.array([height]))[0] == (min(able) if able else np.inf)


@pytest.fixture(scope="module")
def both(data, other_seed):
    return [data, read_study(other_seed)]


def test_hypervolumes_come_from_one_corner(both):
    first, second = both
    corner = reference_point(second.study.objectives, {"energy_j": 300.0})
    further = replace(second.study, reference_point=corner)
    comparison = compare([first, replace(second, study=further)], ["a", "b"], (0.7, 0.8))
    for row, data in zip(comparison.rows, both, strict=True):
        points = data.front()[["height_m", "energy_j"]].to_numpy()
        assert row["hypervolume"] == pytest.approx(hypervolume(points, both[0].reference_point), abs=1e-4)


def test_seeds_of_one_study_are_a_group_with_ordered_surfaces(both):
    # Runs of different lengths are no group; as long as the shorter one, they are.
    assert compare(both, ["a", "b"], (0.8,)).surfaces == []
    alike = [cut(both[0], np.arange(len(both[0].trials)) < len(both[1].trials)), both[1]]
    (surface,) = compare(alike, ["a", "b"], (0.8,)).surfaces
    assert surface["labels"] == ["a", "b"]
    for best, worst in zip(surface["best"], surface["worst"], strict=True):
        assert worst is None or best <= worst
    # The best surface is the front of both runs together.
    together = np.concatenate([d.front()[["height_m", "energy_j"]].to_numpy() for d in alike])
    expected = least_second(together, np.array(surface["first"]))
    near = np.array([np.nan if v is None else v for v in surface["best"]])
    # Heights are rounded in the payload, so a step of the front may fall on the other side of one.
    assert np.nanmedian(np.abs(near - expected)[np.isfinite(expected)]) < 1e-3
    (growth,) = compare(alike, ["a", "b"], (0.8,)).growth
    assert growth["evaluations"][-1] == min(len(d.trials) for d in alike)
    assert growth["middle"] == "mean of 2 seeds"
    assert all(low <= high for low, high in zip(growth["low"], growth["high"], strict=True))


def fronts_of(energies):
    """Fronts of one design each, all of 1 m."""
    return [np.array([[1.0, energy]]) for energy in energies]


@pytest.mark.parametrize(("energies", "median"), [((30.0, 10.0, 20.0), 20.0), ((30.0, 10.0, 20.0, 40.0), 20.0)])
def test_the_median_is_what_half_of_the_runs_reach(energies, median):
    surface = _surface(fronts_of(energies), [str(e) for e in energies])
    assert (surface["best"][0], surface["median"][0], surface["worst"][0]) == (10.0, median, max(energies))


def test_two_runs_have_no_median():
    assert _surface(fronts_of((30.0, 10.0)), ["a", "b"])["median"] == []


def test_only_runs_of_equal_length_are_pooled_and_each_seed_once(data):
    def run_of(seed, count):
        study = replace(data.study, seed=seed)
        return replace(data, study=study, trials=data.trials.head(count))

    runs = [run_of(1, 200), run_of(2, 200), run_of(1, 200), run_of(3, 120), run_of(4, 200), run_of(5, 120)]
    assert seed_groups(runs) == [[0, 1, 4], [3, 5]]


def test_growth_holds_the_last_value_until_the_next_generation():
    history = np.array([[10.0, 1.0], [20.0, 3.0]])
    np.testing.assert_array_equal(_held(history, np.array([5.0, 10.0, 19.0, 20.0, 30.0])), [0.0, 1.0, 1.0, 3.0, 3.0])


def test_rows_give_the_energy_at_each_height(both):
    for row, data in zip(compare(both, ["a", "b"], (0.7, 0.8)).rows, both, strict=True):
        for height, energy in zip((0.7, 0.8), row["at_height"], strict=True):
            front = data.front()
            assert energy == round(front.loc[front["height_m"] >= height, "energy_j"].min(), 4)


def test_another_calibration_is_no_seed_of_it(data, other_seed):
    other = read_study(other_seed)
    contents = other.meta.contents | {"calibration": {"name": "another"}}
    changed = replace(other, meta=replace(other.meta, contents=contents))
    assert group_of(data) == group_of(other) != group_of(changed)


def test_other_algorithms_are_no_seeds_of_it(data, weighted):
    assert compare([data, read_study(weighted)], ["a", "b"], (0.8,)).surfaces == []


def test_one_study_is_not_compared(payload):
    assert payload.comparison is None


def test_two_studies_share_a_map(source, both):
    other = Source(data=both[1], resimulation=resimulate(both[1], most_jumps=1), models={})
    payload = build([source, other])
    assert len(payload.maps) == 1
    assert [card.kit for card in payload.studies] == [0, 0]
    assert len(payload.comparison.rows) == 2
