"""Stored studies in scripts: the same trials, fronts and picks as the command line."""

import json

import numpy as np
import pandas as pd
import pytest

import pareto_monoped as pm
from pareto_monoped.cli import _run as cli
from pareto_monoped.errors import DesignError, SelectionError, StudyError


@pytest.fixture(scope="module")
def db(tmp_path_factory):
    """A small study that really jumps."""
    path = tmp_path_factory.mktemp("api") / "s.db"
    pm.run(pm.Study.define(name="s", evaluations=120, seed=3, audit=False), path)
    return path


@pytest.fixture(scope="module")
def stored(db):
    return pm.load_study(db)


def test_the_front_is_that_of_the_command_line(db, stored, capsys):
    assert cli(["front", str(db), "--json"]) == 0
    rows = json.loads(capsys.readouterr().out)
    front = stored.front()
    assert [row["trial"] for row in rows] == front["trial"].tolist()
    assert [row["height_m"] for row in rows] == front["height_m"].tolist()
    assert pm.load_study(str(db)).finished


def test_a_front_under_other_objectives(db, stored, capsys):
    named = ["mass_kg", "height_m"]
    assert cli(["front", str(db), "--objectives", ",".join(named), "--json"]) == 0
    assert [row["trial"] for row in json.loads(capsys.readouterr().out)] == stored.front(named)["trial"].tolist()
    with pytest.raises(StudyError, match="did you mean 'mass_kg'"):
        stored.front(["mass", "height_m"])


PICKS = {
    "knee": ({"by": "knee"}, ["--knee"]),
    "tradeoff": ({"by": "tradeoff"}, ["--tradeoff"]),
    "height": ({"min_height_m": 0.8}, ["--min-height", "0.8"]),
    "energy": ({"max_energy_j": 45.0}, ["--max-energy", "45"]),
    "both": ({"min_height_m": 0.7, "at_most": {"mass_kg": 5.0}}, ["--min-height", "0.7", "--max", "mass_kg=5"]),
    "weights": ({"weights": (1, 1)}, ["--weights", "1,1"]),
    "compromise": ({"compromise": [2, 1]}, ["--compromise", "2,1"]),
    "nearest": ({"nearest": {"height_m": 0.9, "energy_j": 30}}, ["--nearest", "height_m=0.9,energy_j=30"]),
    "knee of heavy ones": ({"by": "knee", "at_least": {"mass_kg": 4.3}}, ["--knee", "--min", "mass_kg=4.3"]),
}


@pytest.mark.parametrize(("words", "options"), PICKS.values(), ids=PICKS.keys())
def test_a_pick_is_that_of_the_command_line(words, options, db, stored, capsys):
    picked = stored.pick(**words)
    assert cli(["pick", str(db), *options, "--json"]) == 0
    said = json.loads(capsys.readouterr().out)
    assert (said["trial"], said["why"]) == (picked.trial, picked.why)
    assert picked.row["height_m"] == said["height_m"]
    assert picked.design == stored.design(picked.trial)


@pytest.mark.parametrize(
    ("words", "match"),
    [
        ({}, "nothing is asked for"),
        ({"by": "elbow"}, "'knee' or 'tradeoff'"),
        ({"by": "knee", "trial": 3}, "ways to choose = 2"),
        ({"at_most": {"mass": 4.0}}, "did you mean"),
        ({"min_height_m": 3.0}, "3"),
        ({"weights": (1, 1, 1)}, "weights"),
    ],
)
def test_a_pick_that_cannot_be_says_why(words, match, stored):
    with pytest.raises(SelectionError, match=match) as caught:
        stored.pick(**words)
    assert "\n" not in str(caught.value)


def test_a_design_of_a_study_jumps_again_as_it_is_stored(stored):
    front = stored.front()
    again = stored.simulate(front)
    np.testing.assert_array_equal(again["height_m"], front["height_m"])
    np.testing.assert_array_equal(again["energy_j"], front["energy_j"])
    trial = int(front["trial"].iloc[0])
    hip, knee = stored.motors(trial)
    pd.testing.assert_frame_equal(
        pm.simulate(stored.design(trial), hip_motor=hip, knee_motor=knee), again.iloc[[0]], check_exact=True
    )


def test_a_pick_jumps_with_the_motors_of_its_study_and_never_with_others(tmp_path):
    stored = pm.run(pm.Study.define(name="u8", evaluations=40, motor="U8", strength=False), tmp_path / "u8.db")
    picked = stored.pick("knee")
    assert stored.simulate(picked)["height_m"][0] == picked.row["height_m"]
    for call in (pm.simulate, pm.trace, pm.build_robot, lambda given: pm.simulate([given])):
        with pytest.raises(DesignError, match=r"of class Picked, .* use its \.design and the motors of its study"):
            call(picked)
    with pytest.raises(DesignError, match=r"of class PaperCase, must be Designs; use its \.design$"):
        pm.simulate(pm.PAPER_CASES["C"])


def test_an_unknown_condition_names_its_argument(stored):
    with pytest.raises(SelectionError, match=r"^at_most = 'mass': .* did you mean 'mass_kg'\?$"):
        stored.pick(at_most={"mass": 3.0})


def test_a_variable_around_a_pick_is_varied_in_a_few_lines(stored):
    design = stored.pick("knee").design
    ratios = np.linspace(0.95, 1.05, 5)
    varied = stored.simulate([design.replace({"stiffness_n_per_m": k * design.stiffness_n_per_m}) for k in ratios])
    assert varied["height_m"].nunique() == 5


def test_what_a_caller_changes_in_the_trials_stays_with_him(db):
    one = pm.load_study(db)
    one.trials.loc[:, "height_m"] = 9.0
    assert one.front()["height_m"].max() < 2.0


def test_a_trial_that_is_not_there(stored):
    with pytest.raises(SelectionError, match="trial = 9999: must be 0 to 119"):
        stored.design(9999)


def test_alternatives_cost_about_as_much(stored):
    trial = stored.pick("knee").trial
    others = stored.alternatives(trial, count=3, tolerance=0.3)
    assert all(other.price <= 0.3 for other in others)
    assert trial not in [other.trial for other in others]


def test_a_study_with_two_motors_names_those_of_a_trial(tmp_path):
    study = pm.Study.define(name="two", evaluations=80, motor=["VT8020", "U8"], audit=False)
    stored = pm.run(study, tmp_path / "two.db")
    jumped = stored.trials[stored.trials["status"] == "ok"]
    for motor in ("VT8020", "U8"):
        row = jumped[jumped["motor"] == motor].iloc[0]
        assert stored.motors(int(row["trial"])) == (motor, motor)
        again = stored.simulate(stored.design(int(row["trial"])), trial=int(row["trial"]))
        assert again["height_m"][0] == row["height_m"]
