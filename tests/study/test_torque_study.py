"""Studies of torque profiles: what a file may say, where they begin, how they are stored, resumed and read."""

import sqlite3
from contextlib import contextmanager

import numpy as np
import pandas as pd
import pytest

import pareto_monoped as pm
from pareto_monoped.definition.study import study_from_dict
from pareto_monoped.design import ALL_NAMES, KNOT_NAMES, NAMES
from pareto_monoped.errors import StudyError
from pareto_monoped.storage.reader import read_study
from pareto_monoped.study import simulator
from pareto_monoped.study.run import run

FILE = {
    "name": "free", "rules": "iso6336", "gear_list": True, "strength": True, "audit": False, "evaluations": 30,
    "variables": {"thigh_length_m": 0.5, "push_time_s": {"lower": 0.15, "upper": 0.4}},
    "controller": {"kind": "torque_over_time", "knots": 6}, "algorithm": {"name": "nsga2", "population": 12},
}  # fmt: skip
USED = ("push_time_s", *(f"{joint}_knot_{k}" for joint in ("hip", "knee") for k in range(1, 7)))


def study(**changes):
    return study_from_dict(FILE | changes, source="test")


@contextmanager
def short_search():
    """Before a study begins, a quarter of the usual jumps under the virtual leg, which take seconds."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(simulator, "_BEFORE", 200)
        yield


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    db = tmp_path_factory.mktemp("torque") / "whole.db"
    with short_search():
        run(study(), db, workers=1)
    return db


def trials(db):
    return pd.read_sql("SELECT * FROM monoped_trials ORDER BY trial", sqlite3.connect(db))


def test_knots_are_variables_and_the_springs_are_not():
    one = study()
    assert one.free == ("shank_length_m", "knee_ratio", "hip_ratio", *USED)
    assert one.names == ALL_NAMES
    assert (one.variables["stiffness_n_per_m"], one.variables["hip_knot_7"]) == (0.0, 0.0)
    assert study_from_dict(one.as_dict(), source="stored") == one
    plain = study_from_dict({"name": "plain", "evaluations": 40}, source="test")
    assert "controller" not in plain.as_dict()
    assert plain.names == NAMES


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"controller": {"kind": "torque"}}, "controller = 'torque': must be one of virtual_leg, torque_over_time"),
        ({"controller": {"kind": "torque_over_time", "knots": 13}}, r"\[controller\]: knots = 13: must be .*12"),
        ({"controller": {"kind": "torque_over_time", "knot": 8}}, "unknown key 'knot'"),
        ({"variables": {"hip_knot_7": 0.5}}, "variable = 'hip_knot_7': must be one of thigh_length_m"),
        ({"variables": {"stiffness_n_per_m": 50.0}}, "variable = 'stiffness_n_per_m': must be one of"),
        ({"controller": "virtual_leg", "variables": {"push_time_s": 0.3}}, "variable = 'push_time_s': must be one of"),
        ({"variables": {"hip_knot_2": 1.5}}, "hip_knot_2 = 1.5: must be a number from -1 to 1"),
    ],
)
def test_what_a_file_cannot_say_is_refused_in_one_line(changes, words):
    with pytest.raises(StudyError, match=words) as refused:
        study(**changes)
    assert "\n" not in str(refused.value)


@pytest.mark.long
def test_a_study_that_was_stopped_goes_on_as_if_it_never_was(made, tmp_path):
    """Also in the middle of a generation."""
    db = tmp_path / "parts.db"
    with short_search():
        for count in (17, 30):
            run(study(), db, evaluations=count, workers=1)
    pd.testing.assert_frame_equal(trials(db), trials(made))


def test_it_begins_with_high_jumps(made):
    """Random profiles hardly leave the floor; those that the virtual leg tells are the jumps of a front."""
    first = trials(made).head(12)
    random = study(algorithm={"name": "random", "population": 12}, evaluations=12)
    run(random, db := made.with_name("random.db"), workers=1)
    assert first["height_m"].median() > trials(db)["height_m"].median() + 0.15


def test_columns_and_readers_have_the_knots_that_are_searched(made):
    stored = trials(made)
    assert [name for name in KNOT_NAMES if name in stored] == list(USED)
    data = read_study(made)
    assert data.calibration.controller.law == study().controller
    loaded = pm.load_study(made)
    trial = int(data.front()["trial"].iloc[-1])
    design = loaded.design(trial)
    assert design.profile[1] == stored["hip_knot_1"][trial]
    again = loaded.simulate(design)
    assert again["height_m"][0] == stored["height_m"][trial]
    alone = pm.simulate(design, controller=study().controller)
    assert alone["energy_j"][0] == stored["energy_j"][trial]
    assert np.isfinite(loaded.front()["knee_knot_6"]).all()


@pytest.mark.long
@pytest.mark.parametrize("algorithm", ["surrogate", "weighted_cmaes"])
def test_other_searches_begin_there_too(algorithm, tmp_path):
    settings = {"name": algorithm, "population": 10} | ({"iterations": 2} if algorithm == "weighted_cmaes" else {})
    run(study(algorithm=settings, evaluations=20), tmp_path / "s.db", workers=1)
    assert trials(tmp_path / "s.db").head(10)["height_m"].median() > 0.7


@pytest.mark.long
def test_a_study_of_the_tracking_law_begins_with_the_torques_of_the_virtual_leg(tmp_path):
    """Their damping stays a variable, and their knots leave to it what it tells the motors."""
    one = study(
        controller={"kind": "tracking", "knots": 6},
        variables={},
        evaluations=20,
        algorithm={"name": "nsga2", "population": 20},
    )
    assert "damping_n_s_per_m" in one.free
    assert not {"stiffness_n_per_m", "push_time_s"} & set(one.free)
    run(one, tmp_path / "t.db", workers=1)
    begun = trials(tmp_path / "t.db")
    assert begun["height_m"].median() > 0.7
    assert begun["damping_n_s_per_m"].max() > 1.0
