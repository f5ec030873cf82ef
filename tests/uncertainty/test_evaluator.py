"""Designs under uncertainty during a search: equal to the same samples one by one, for any batch and workers."""

from dataclasses import replace

import numpy as np
import pytest

from pareto_monoped.actuator.search import map_for
from pareto_monoped.design import LOWER, PAPER_CASES, UPPER, complete
from pareto_monoped.jump.calibration import load_calibration
from pareto_monoped.jump.evaluate import Evaluator
from pareto_monoped.uncertainty import samples as module
from pareto_monoped.uncertainty.samples import RobustEvaluator, sobol_samples, variations
from pareto_monoped.uncertainty.settings import sampling_of
from pareto_monoped.uncertainty.statistics import robustness

NAMES = ("failed_share", "overloaded_share", "height_m.p05", "electrical_energy_j.p95", "mass_kg.mean")
LEAST = {"gear_safety": 1.0, "link_safety": 1.0, "chain_safety": 1.0, "stop_safety": 1.0, "joint_safety": 1.0}
CALIBRATION, MAP = load_calibration(), map_for("VT8020")
SAMPLING = sampling_of({"samples": 16}, source="test")
RANDOM = complete(np.random.default_rng(3).uniform(LOWER, UPPER, (6, len(LOWER))))
IMPOSSIBLE = complete(np.array([[0.02, 0.3, 6.0, 6.0, 100.0, 1.0, 10.0]]))
DESIGNS = np.vstack((PAPER_CASES["C"].design.as_array()[None], RANDOM, IMPOSSIBLE))


def of_all(workers=1, sampling=SAMPLING, evaluator=None, names=NAMES):
    return RobustEvaluator(
        evaluator=evaluator or Evaluator(MAP, CALIBRATION, workers=workers),
        sampling=sampling,
        names=names,
        least=LEAST,
    )


@pytest.fixture(scope="module")
def found():
    return of_all()(DESIGNS)


def test_they_are_the_statistics_of_the_same_jumps(found):
    simulate, drawn = Evaluator(MAP, CALIBRATION), sobol_samples(SAMPLING.ranges, 16, 1)
    assert found.ok[0]
    for row in np.flatnonzero(found.ok):
        jumps = simulate(np.tile(DESIGNS[row], (16, 1)), variations=variations(drawn, 1, CALIBRATION))
        expected = robustness(jumps, slice(0, 16), LEAST)
        assert found.of("failed_share")[row] == expected.failed
        assert found.of("overloaded_share")[row] == expected.overloaded
        if "height_m" in expected.measures:
            assert found.of("height_m.p05")[row] == expected.measures["height_m"].p05
            assert found.of("electrical_energy_j.p95")[row] == expected.measures["electrical_energy_j"].p95
            assert found.of("mass_kg.mean")[row] == expected.measures["mass_kg"].mean


def test_the_jump_as_designed_is_that_of_the_bare_evaluator(found):
    bare = Evaluator(MAP, CALIBRATION)(DESIGNS)
    for name, values in bare.as_columns().items():
        if name != "reason":
            np.testing.assert_array_equal(found.as_columns()[name], values)
    assert set(found.as_columns()) == {*bare.as_columns(), *NAMES}


@pytest.mark.parametrize("names", [("height_m.p05",), ("overloaded_share",), ("mass_kg.mean", "failed_share"), ()])
def test_measures_that_nobody_asks_for_are_not_needed(found, names):
    """Without both shares among the names it ended in a KeyError."""
    some = of_all(names=names)(DESIGNS)
    assert tuple(some.robust) == names
    for name in names:
        np.testing.assert_array_equal(some.of(name), found.of(name))


def test_workers_batches_and_order_change_no_number(found, monkeypatch):
    monkeypatch.setattr(module, "_JUMPS", 16)  # one design at once
    back = of_all(workers=2)(DESIGNS[::-1])
    for name in NAMES:
        np.testing.assert_array_equal(back.of(name)[::-1], found.of(name))


def test_another_seed_gives_other_numbers_and_other_ranges_too(found):
    assert of_all(sampling=replace(SAMPLING, seed=2))(DESIGNS[:1]).of("height_m.p05")[0] != found.of("height_m.p05")[0]
    wide = sampling_of({"samples": 16, "masses": {"lower": 0.1, "upper": 0.2, "source": "test"}}, source="test")
    assert of_all(sampling=wide)(DESIGNS[:1]).of("height_m.p05")[0] < found.of("height_m.p05")[0]


def test_a_design_that_does_not_jump_has_no_numbers(found):
    assert not found.ok[-1]
    assert all(np.isnan(found.of(name)[-1]) for name in NAMES)


class Failing:
    """Jumps as the real evaluator; as built, the first design never reaches an apex and the second in 1 of 4 jumps."""

    calibration, executor = CALIBRATION, None

    def __call__(self, designs, motors=None, *, variations=None):
        result = Evaluator(MAP, CALIBRATION)(designs, motors, variations=variations)
        if variations is None:
            return result
        count = len(result) // 2
        lost = np.concatenate((np.ones(count, dtype=bool), np.arange(count) % 4 == 0))
        columns = {name: np.array(getattr(result, name)) for name in ("height_m", "electrical_energy_j", "mass_kg")}
        for values in columns.values():
            values[lost] = np.nan
        return replace(result, status=np.where(lost, "timeout", result.status), **columns)


def test_failed_jumps_are_counted_and_left_out_of_the_percentiles():
    case = PAPER_CASES["C"].design.as_array()
    found = of_all(evaluator=Failing())(np.tile(case, (2, 1)))
    assert found.of("failed_share").tolist() == [1.0, 0.25]
    assert np.isnan(found.of("height_m.p05")[0])
    assert found.reason == ("none of 16 jumps under uncertainty reaches an apex", "")
    drawn = sobol_samples(SAMPLING.ranges, 16, 1)
    heights = Evaluator(MAP, CALIBRATION)(np.tile(case, (16, 1)), variations=variations(drawn, 1, CALIBRATION)).height_m
    assert found.of("height_m.p05")[1] == np.percentile(heights[np.arange(16) % 4 != 0], 5.0)
