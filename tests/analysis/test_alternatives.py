"""Alternatives to a picked trial: against brute force on made studies, and worded."""

import math
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from pareto_monoped.analysis.alternatives import LEAST_DISTANCE, alternatives, differences, scale_of
from pareto_monoped.errors import SelectionError
from pareto_monoped.pareto.selectors import Condition
from pareto_monoped.storage.reader import read_study
from tests.study.support import made_database, made_evaluations, made_generation, made_study


@pytest.fixture(scope="module")
def data(tmp_path_factory):
    """60 trials around 0.9 m and 20 J, half of them within a percent; two of them have no jump."""
    generator = np.random.default_rng(4)
    height, energy = 0.9 + 0.02 * generator.standard_normal(60), 20.0 + 0.4 * generator.standard_normal(60)
    status = ["ok"] * 58 + ["diverged"] * 2
    study = made_study(gear_list=True, evaluations=60)
    db = tmp_path_factory.mktemp("alternatives") / "s.db"
    made_database(db, [made_generation(study, 0, 0, made_evaluations(height, energy, status))], study)
    read = read_study(db)
    # Gearboxes of a short list, as real studies have them; the last of the trials had no place on the front.
    ratios = generator.choice([4.0, 4.5, 6.1, 8.4], (60, 2))
    trials = read.trials.assign(knee_ratio=ratios[:, 0], hip_ratio=ratios[:, 1])
    audits = pd.DataFrame({"trial": [0, 1, 2], "well_conditioned": [True, False, True]})
    return replace(read, trials=trials, audits=audits)


def scaled(data, record):
    """A design as a point, by plain Python."""
    point = []
    for name in data.study.free:
        if name in ("knee_ratio", "hip_ratio"):
            listed = sorted({*data.trials[name]})
            point.append(listed.index(record[name]) / (len(listed) - 1))
        else:
            bounds = data.study.variables[name]
            point.append((record[name] - bounds.lower) / (bounds.upper - bounds.lower))
    return point


@pytest.mark.parametrize("tolerance", [0.005, 0.02, 0.1])
def test_they_are_within_the_tolerance_and_differ_most(data, tolerance):
    trial = int(data.front()["trial"].iloc[0])
    records = {int(record["trial"]): record for record in data.trials.to_dict(orient="records")}
    given = records[trial]
    able = {
        number: record
        for number, record in records.items()
        if number not in (trial, 1)  # trial 1 failed its audit
        and record["state"] == "feasible"
        and record["height_m"] >= given["height_m"] - tolerance * given["height_m"]
        and record["energy_j"] <= given["energy_j"] + tolerance * given["energy_j"]
    }
    found = alternatives(data, trial, count=4, tolerance=tolerance)
    taken = [scaled(data, given)]
    for one in found:
        gaps = {number: min(math.dist(scaled(data, record), t) for t in taken) for number, record in able.items()}
        assert gaps[one.trial] == pytest.approx(max(gaps.values()))
        assert one.distance == pytest.approx(math.dist(scaled(data, records[one.trial]), taken[0]))
        losses = [1.0 - one.values[0] / given["height_m"], one.values[1] / given["energy_j"] - 1.0]
        assert one.price == pytest.approx(max(losses))
        assert one.changes == pytest.approx((-losses[0], losses[1]))
        assert one.audited == (one.trial in (0, 2))
        taken.append(scaled(data, records[one.trial]))
    assert len(found) == 4 or max(min(math.dist(scaled(data, r), t) for t in taken) for r in able.values()) < (
        LEAST_DISTANCE
    )


def test_they_meet_the_conditions_of_the_pick(data):
    trial = int(data.front()["trial"].iloc[-1])
    light = Condition(name="mass_kg", side="max", value=float(data.trials["mass_kg"].median()))
    short = Condition(name="thigh_length_m", side="max", value=0.4)
    found = alternatives(data, trial, tolerance=0.2, conditions=(light, short))
    rows = data.trials.set_index("trial").loc[[one.trial for one in found]]
    assert len(found) == 5
    assert (rows["mass_kg"] <= light.value).all()
    assert (rows["thigh_length_m"] <= 0.4).all()


def test_a_trial_that_failed_its_audit_is_none(data):
    trial = int(data.front()["trial"].iloc[0])
    first = alternatives(data, trial, tolerance=0.1)[0].trial
    failed = replace(data, audits=pd.DataFrame({"trial": [first], "well_conditioned": [False]}))
    assert first not in [one.trial for one in alternatives(failed, trial, tolerance=0.1, count=50)]


def test_a_tolerance_of_nothing_leaves_what_is_no_worse(data):
    trial = int(data.front()["trial"].iloc[0])
    assert alternatives(data, trial, tolerance=0.0) == ()


@pytest.mark.parametrize("trial", [58, 1000])
def test_a_trial_without_a_jump_has_no_alternatives(data, trial):
    with pytest.raises(SelectionError, match=f"trial = {trial}: must be a trial of the study that jumped"):
        alternatives(data, trial)


def made_trials(data, *designs):
    """Trials that differ from the middle of all ranges by what each names."""
    middle = {
        "thigh_length_m": 0.4,
        "shank_length_m": 0.4,
        "knee_ratio": 6.1,
        "hip_ratio": 4.0,
        "stiffness_n_per_m": 100.0,
        "damping_n_s_per_m": 5.0,
        "torsional_stiffness_n_m_per_rad": 25.0,
        "motor": "VT8020",
    }
    return pd.DataFrame([middle | design for design in designs])


@pytest.mark.parametrize(
    ("design", "expected"),
    [
        ({"thigh_length_m": 0.306, "shank_length_m": 0.401}, ("shank-long, 0.306 and 0.401 m",)),
        ({"thigh_length_m": 0.45}, ("thigh-long, 0.450 and 0.400 m",)),
        ({"thigh_length_m": 0.38, "shank_length_m": 0.38}, ("thigh 20 mm shorter", "shank 20 mm shorter")),
        ({"knee_ratio": 8.4}, ("knee gearbox 8.4 instead of 6.1",)),
        ({"stiffness_n_per_m": 120.0}, ("K 120 instead of 100 N/m",)),
        # What is small is told only where there is nothing else to tell.
        ({"stiffness_n_per_m": 101.0}, ("K 101 instead of 100 N/m",)),
        ({"stiffness_n_per_m": 101.0, "damping_n_s_per_m": 9.0}, ("C 9 instead of 5 N s/m",)),
        # The greatest three, by shares of the ranges.
        (
            {
                "thigh_length_m": 0.31,
                "knee_ratio": 8.4,
                "damping_n_s_per_m": 9.9,
                "stiffness_n_per_m": 130.0,
            },
            ("C 9.9 instead of 5 N s/m", "shank-long, 0.310 and 0.400 m", "knee gearbox 8.4 instead of 6.1"),
        ),
    ],
)
def test_differences_in_plain_words(data, design, expected):
    trials = made_trials(data, {}, design)
    found = differences(scale_of(data, trials), trials, 1, 0)
    assert set(found) == set(expected)


def test_a_motor_is_a_category(data):
    several = replace(
        data,
        study=replace(data.study, motor=("U8", "VT8020", "U12")),
        trials=data.trials.assign(motor=np.resize(["U8", "VT8020", "U12"], len(data.trials))),
    )
    trials = made_trials(several, {}, {"motor": "U8"}, {"motor": "U12"})
    scale = scale_of(several, trials)
    assert scale.names[-1] == "motor"
    assert scale.categories.tolist() == [False] * 7 + [True]
    assert differences(scale, trials, 1, 0) == ("motor U8 instead of VT8020",)
    assert len(set(scale.points[:, -1])) == 3
    found = alternatives(several, int(several.front()["trial"].iloc[0]), tolerance=0.1, count=2)
    motors = several.trials.set_index("trial")["motor"]
    picked = motors.loc[int(several.front()["trial"].iloc[0])]
    assert {motors.loc[one.trial] for one in found} != {picked}


def test_the_price_in_plain_words(data):
    trial = int(data.front()["trial"].iloc[0])
    one = replace(alternatives(data, trial, tolerance=0.1)[0], differs=("shank-long",), changes=(0.0, 0.008))
    assert one.text() == "shank-long; 0.8 percent more energy"
    assert replace(one, changes=(-0.012, -0.02)).text() == (
        "shank-long; 1.2 percent less height, 2.0 percent less energy"
    )
    assert replace(one, changes=(0.0, 0.0001)).text() == "shank-long; the same price"
    assert replace(one, price=np.inf).as_dict()["price"] is None


def test_a_study_that_searches_ratios_has_them_as_numbers(data):
    plain = replace(data, study=replace(data.study, gear_list=False))
    trials = made_trials(plain, {"knee_ratio": 4.0}, {"knee_ratio": 8.7})
    points = scale_of(plain, trials).points
    assert points[:, plain.study.free.index("knee_ratio")] == pytest.approx([0.0, 1.0])
