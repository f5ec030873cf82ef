"""Medians and bands against values that are known beforehand."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pareto_monoped.campaign.results import (
    attainment,
    growth,
    levels_of_section,
    quantiles,
    relative,
    sections_of,
    spread_of,
)
from tests.campaign.support import made_campaign

NAN = float("nan")


@given(st.lists(st.floats(-1e6, 1e6), min_size=1, max_size=40))
def test_as_many_values_as_said_are_at_or_below_each_end(values):
    found = spread_of(values)
    for share, end in ((0.5, found.middle), (0.1, found.low), (0.9, found.high)):
        assert end in values
        assert sum(value <= end for value in values) >= share * len(values) - 1e-9
        assert sum(value < end for value in values) < share * len(values)


@pytest.mark.parametrize(
    ("values", "expected"),
    [
        ([3.0], (3.0, 3.0, 3.0)),
        ([2.0, 1.0], (1.0, 1.0, 2.0)),
        ([3.0, 1.0, 2.0], (2.0, 1.0, 3.0)),
        (list(range(1, 11)), (5.0, 1.0, 9.0)),
        ([1.0, NAN, 2.0], (2.0, 1.0, NAN)),
    ],
)
def test_known_medians_and_bands(values, expected):
    np.testing.assert_array_equal(quantiles(np.array(values)[:, None])[:, 0], expected)


def three_seeds(number, place):
    """Fronts of two designs: a low one for 10, 20 or 30 J, and a high one, which the third seed does not have."""
    energies = 10.0 * (number % 3 + 1)
    return ([0.7], [energies]) if number % 3 == 2 else ([0.7, 1.0], [energies, 2.0 * energies])


def test_attainment_is_what_runs_need_for_each_height(tmp_path):
    campaign, results = made_campaign(tmp_path, "seeds = [1, 2, 3]", three_seeds)
    (section,) = sections_of(results, campaign.axes)
    (group,) = section.groups
    levels = levels_of_section(section)
    assert (levels[0], levels[-1]) == (0.7, 1.0)
    median, low, high = attainment(group, levels)
    assert (median[0], low[0], high[0]) == (20.0, 10.0, 30.0)
    assert (median[-1], low[-1]) == (40.0, 20.0)
    assert np.isnan(high[1:]).all()
    assert np.isfinite(median).all()


def test_more_is_better_of_a_second_objective_that_is_maximised(tmp_path):
    """The band then begins at the run with the most."""
    axes = 'objectives = [["height_m", "sustained_jumps_per_minute"]]\nseeds = [1, 2, 3]'
    campaign, results = made_campaign(tmp_path, axes, lambda *_: ([0.8], [9.0]))
    fronts = [[[0.7, 10.0 * k], [0.9, 5.0 * k]] for k in (1, 2, 3)]
    results = [replace(result, front=np.array(front)) for result, front in zip(results, fronts, strict=True)]
    (section,) = sections_of(results, campaign.axes)
    found = attainment(section.groups[0], np.array([0.7, 0.8, 0.9, 0.95]))
    np.testing.assert_array_equal(found[:, :3], [[20.0, 10.0, 10.0], [30.0, 15.0, 15.0], [10.0, 5.0, 5.0]])
    assert np.isnan(found[:, 3]).all()


def test_the_height_comes_first_wherever_it_is_an_objective(tmp_path):
    head = 'name = "made"\n[study]\nevaluations = 40\nstrength = false\n'
    axes = 'objectives = [["energy_j", "height_m"]]\nseeds = [1, 2, 3]'
    campaign, results = made_campaign(tmp_path, axes, lambda number, _: ([0.7 + 0.1 * number], [10.0]), head)
    (section,) = sections_of(results, campaign.axes)
    assert [result.most for result in results] == pytest.approx([0.7, 0.8, 0.9])
    # The energy is what each height costs.
    assert attainment(section.groups[0], np.array([0.65]))[:, 0].tolist() == [10.0, 10.0, 10.0]


def test_sections_are_what_can_be_compared_and_groups_differ_in_the_seed_only(tmp_path):
    axes = (
        'motors = ["U8", "U10"]\nobjectives = [["height_m", "energy_j"], ["height_m", "electrical_energy_j"]]\n'
        "seeds = [1, 2]"
    )
    leave_out = {"U10_energy_j_seed2"}
    campaign, results = made_campaign(
        tmp_path, axes, lambda number, place: None if place.name in leave_out else ([0.8], [10.0 + number])
    )
    sections = sections_of(results, campaign.axes)
    assert [section.objectives.names for section in sections] == [
        ("height_m", "energy_j"), ("height_m", "electrical_energy_j"),
    ]  # fmt: skip
    first = sections[0]
    assert first.axes == ("motors", "seeds")
    assert [(group.label, len(group.results)) for group in first.groups] == [("U8", 2), ("U10", 1)]
    assert [(group.label, len(group.results)) for group in first.by("seeds")] == [("seed1", 2), ("seed2", 1)]
    assert len(first.results) == 3


def test_a_hypervolume_is_told_against_the_median_of_its_group(tmp_path):
    campaign, results = made_campaign(tmp_path, "seeds = [1, 2, 3]", three_seeds)
    (section,) = sections_of(results, campaign.axes)
    # Areas from the corner at 0.55 m and 100 J: of one design 0.15 (100 - E), of two 0.15 (E2 - E1) + 0.45 (100 - E2).
    areas = [0.15 * 10.0 + 0.45 * 80.0, 0.15 * 20.0 + 0.45 * 60.0, 0.15 * 70.0]
    shares = relative(section)
    assert [shares[f"seed{k}"] for k in (1, 2, 3)] == pytest.approx([area / areas[1] for area in areas])


def test_growth_is_told_where_all_runs_have_values_and_holds_the_last_one(tmp_path):
    campaign, results = made_campaign(tmp_path, "seeds = [1, 2]", lambda *_: ([0.8], [9.0]))
    histories = [np.array([[10.0, 1.0], [20.0, 3.0]]), np.array([[20.0, 2.0], [40.0, 5.0]])]
    results = [replace(result, history=history) for result, history in zip(results, histories, strict=True)]
    (section,) = sections_of(results, campaign.axes)
    at, (median, low, high) = growth(section.groups[0])
    assert (at[0], at[-1]) == (20.0, 40.0)
    assert (low[0], high[0], low[-1], high[-1]) == (2.0, 3.0, 3.0, 5.0)
    assert median.tolist() == low.tolist()
