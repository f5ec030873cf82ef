"""The front and the alternatives by what trials keep under uncertainty, against plain Python on made studies."""

import math
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from pareto_monoped.analysis.alternatives import LEAST_DISTANCE, alternatives
from pareto_monoped.analysis.robustness import robust_front, robust_trials
from pareto_monoped.definition.goals import objectives_of
from pareto_monoped.errors import SelectionError
from pareto_monoped.measures import MEASURE_NAMES
from pareto_monoped.pareto.pick import pick
from pareto_monoped.pareto.selectors import Among, Condition
from pareto_monoped.storage.extra_rows import Stored
from pareto_monoped.storage.reader import read_study
from pareto_monoped.uncertainty.settings import MOST_FAILED
from pareto_monoped.uncertainty.statistics import Robustness, Spread
from tests.study.support import made_database, made_evaluations, made_generation, made_study

COUNT = 60


@pytest.fixture(scope="module")
def data(tmp_path_factory):
    """60 trials of which one in ten is infeasible, and one failed its audit."""
    generator = np.random.default_rng(5)
    study = made_study(evaluations=COUNT)
    height, energy = 0.9 + 0.05 * generator.standard_normal(COUNT), 20.0 + generator.standard_normal(COUNT)
    height[::10] = 0.5
    db = tmp_path_factory.mktemp("robust_front") / "s.db"
    made_database(db, [made_generation(study, 0, 0, made_evaluations(height, energy))], study)
    audits = pd.DataFrame({"trial": [3, 4], "well_conditioned": [True, False]})
    return replace(read_study(db), audits=audits)


def spread(value):
    return Spread(mean=value, deviation=0.1 * value, p05=0.9 * value, p95=1.1 * value)


def stored_of(values, failed=0.0, settings=None):
    measures = {name: spread(value) for name, value in values.items()}
    return Stored(
        settings=settings or {"seed": 1},
        result=Robustness(samples=256, failed=failed, overloaded=0.25, measures=measures),
    )


@pytest.fixture(scope="module")
def stored(data):
    """Another order than that of the jumps as designed; one trial in five fails too often.

    Trial 4, which failed its audit, and trial 10, which is infeasible, are better than all others.
    """
    generator = np.random.default_rng(6)
    return {
        trial: stored_of(
            {
                "height_m": generator.uniform(0.85, 1.0) + 0.2 * (trial in (4, 10)),
                "energy_j": generator.uniform(18.0, 22.0) - 5.0 * (trial in (4, 10)),
                "apex_s": 0.5,
            },
            failed=0.06 if trial % 5 == 1 else 0.05,
        )
        for trial in range(COUNT)
    }


def kept(trial):
    """Whether a trial can be on the robust front."""
    return trial % 5 != 1 and trial % 10 != 0 and trial != 4


def worst(stored, trial):
    measures = stored[trial].result.measures
    return measures["height_m"].p05, measures["energy_j"].p95


def test_the_front_takes_the_worse_percentile_and_leaves_failures_out(data, stored):
    front = robust_front(data, robust_trials(data, stored))
    able = [trial for trial in range(COUNT) if kept(trial)]
    points = {trial: worst(stored, trial) for trial in able}
    expected = {
        trial
        for trial, (height, energy) in points.items()
        if not any(h >= height and e <= energy and (h, e) != (height, energy) for h, e in points.values())
    }
    assert set(front["trial"]) == expected
    assert front["height_m"].is_monotonic_increasing
    for _, row in front.iterrows():
        known = stored[int(row["trial"])].result
        assert (row["height_m"], row["energy_j"]) == worst(stored, int(row["trial"]))
        assert (row["apex_s"], row["overloaded_share"], row["failed_share"]) == (0.5, 0.25, known.failed)
        height = known.measures["height_m"]
        assert (row["height_m.mean"], row["height_m.p95"]) == (height.mean, height.p95)
    assert front["mass_kg"].isna().all()
    assert MOST_FAILED == 0.05


def test_a_study_of_robust_objectives_takes_its_own_percentiles(data, stored):
    objectives = objectives_of(["height_m.mean", "energy_j.p05"])
    searched = replace(
        data,
        study=replace(data.study, objectives=objectives),
        trials=data.trials.assign(**{"height_m.mean": 0.0, "energy_j.p05": 1.0}),
    )
    front = robust_front(searched, robust_trials(searched, stored))
    for _, row in front.iterrows():
        known = stored[int(row["trial"])].result.measures
        assert row["height_m.mean"] == known["height_m"].mean
        assert row["energy_j.p05"] == known["energy_j"].p05


def test_only_trials_of_the_same_settings_are_compared(data, stored):
    mixed = stored | {trial: replace(stored[trial], settings={"seed": 2}) for trial in range(7)}
    trials = robust_trials(data, mixed)
    assert trials.others == 7
    assert trials.settings == {"seed": 1}
    assert trials.rows["trial"].min() == 7
    assert trials.fragile == sum(trial % 5 == 1 for trial in range(7, COUNT))


@pytest.mark.parametrize(("failed", "words"), [(0.5, "all 6 fail in more than 5 percent"), (0.0, "feasible")])
def test_a_front_of_nothing_says_why(data, stored, failed, words):
    known = {t: replace(stored[t], result=replace(stored[t].result, failed=failed)) for t in range(0, COUNT, 10)}
    with pytest.raises(SelectionError, match=words):
        robust_front(data, robust_trials(data, known))


@pytest.mark.parametrize("tolerance", [0.02, 0.1])
def test_alternatives_are_within_the_tolerance_under_uncertainty(data, stored, tolerance):
    trials = robust_trials(data, stored)
    front = robust_front(data, trials)
    light = Condition(name="thigh_length_m", side="max", value=float(data.trials["thigh_length_m"].median()))
    picked = pick(front, Among(conditions=(light,)))
    found = alternatives(
        data, picked.trial, count=4, tolerance=tolerance, conditions=picked.conditions, rows=trials.rows
    )
    lengths = data.trials.set_index("trial")["thigh_length_m"]
    height, energy = worst(stored, picked.trial)
    able = [
        trial
        for trial in range(COUNT)
        if kept(trial)
        and trial != picked.trial
        and lengths[trial] <= light.value
        and worst(stored, trial)[0] >= height * (1.0 - tolerance)
        and worst(stored, trial)[1] <= energy * (1.0 + tolerance)
    ]
    assert {one.trial for one in found} <= set(able)
    taken = [picked.trial]
    for one in found:
        gaps = {trial: min(apart(data, trial, other) for other in taken) for trial in able}
        assert gaps[one.trial] == pytest.approx(max(gaps.values()))
        assert one.values == worst(stored, one.trial)
        taken.append(one.trial)
    assert (
        len(found) == 4
        or max((min(apart(data, trial, other) for other in taken) for trial in able), default=0.0) < LEAST_DISTANCE
    )


def apart(data, one, other):
    return math.dist(point(data, one), point(data, other))


def point(data, trial):
    row, bounds = data.trials.set_index("trial").loc[trial], data.study.variables
    return [(row[name] - bounds[name].lower) / (bounds[name].upper - bounds[name].lower) for name in data.study.free]


def test_every_measure_has_a_column(data, stored):
    rows = robust_trials(data, stored).rows
    assert {*MEASURE_NAMES, *data.trials.columns} <= set(rows.columns)
    assert rows.columns.is_unique
