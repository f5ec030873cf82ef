"""Trials behind the front are chosen by their number; what is better than them is named."""

import json

import numpy as np
import pandas as pd
import pytest
from hypothesis import given

from pareto_monoped.analysis.choices import better_than, choose, numbered
from pareto_monoped.cli import _run as cli
from pareto_monoped.errors import SelectionError
from pareto_monoped.pareto.objectives import HEIGHT_AND_ENERGY
from pareto_monoped.pareto.selectors import Among, Condition, Knee, Trial
from pareto_monoped.storage.reader import read_study
from tests.pareto.fronts import fronts
from tests.study.support import made_database, made_evaluations, made_generation, made_study

LIGHT = Condition(name="mass_kg", side="max", value=4.0)


@pytest.fixture
def db(tmp_path):
    """Trial 0 is the front, 1 and 2 are behind it, 3 misses the least height, and 4 does not jump."""
    study, db = made_study(), tmp_path / "s.db"
    height, energy = [0.9, 0.89, 0.8, 0.51, np.nan], [20.0, 20.1, 30.0, 5.0, np.nan]
    jumps = made_evaluations(height, energy, ["ok"] * 4 + ["timeout"])
    made_database(db, [made_generation(study, 0, 0, jumps)], study)
    return db


@given(front=fronts())
def test_what_is_better_agrees_with_brute_force(front):
    records = front.to_dict(orient="records")
    for own in records:
        expected = [
            one["trial"]
            for one in records
            if one["height_m"] >= own["height_m"]
            and one["energy_j"] <= own["energy_j"]
            and (one["height_m"], one["energy_j"]) != (own["height_m"], own["energy_j"])
        ]
        assert better_than(front, own["trial"], HEIGHT_AND_ENERGY) == expected


def test_only_a_number_adds_a_trial(db):
    data = read_study(db)
    front = data.front()
    assert front["trial"].tolist() == [0]
    assert numbered(Among(conditions=(LIGHT,), chooser=Trial(number=2))) == 2
    assert numbered(Knee()) is None
    for selector, added in (
        (Trial(number=2), [2]),
        (Trial(number=0), []),
        (Knee(), []),
    ):
        assert choose(data, selector, notify=print).rows["trial"].tolist() == [0, *added]
    for number in (3, 4, 99):  # infeasible, no jump, not there
        with pytest.raises(SelectionError, match=f"trial = {number}: must be a feasible design that .* as trials 0"):
            choose(data, Trial(number=number), notify=print)


def test_a_trial_that_failed_its_audit_is_not_chosen(db):
    from dataclasses import replace

    data = read_study(db)
    failed = replace(data, audits=pd.DataFrame({"trial": [1], "well_conditioned": [False]}))
    with pytest.raises(SelectionError, match="trials 0"):
        choose(failed, Trial(number=1), notify=print)


def test_pick_takes_it_and_says_what_is_better(db, capsys):
    assert cli(["pick", str(db), "--trial", "1", "--json"]) == 0
    picked = json.loads(capsys.readouterr().out)
    assert (picked["trial"], picked["height_m"], picked["behind"]) == (1, 0.89, [0])
    assert picked["one_more"]["trial"] == 0
    assert picked["one_more"]["costs"]["energy_j"] == pytest.approx(-0.1)
    assert cli(["pick", str(db), "--trial", "1"]) == 0
    assert "behind the front: 1 of its designs are no worse in any objective, as trial 0" in capsys.readouterr().out
    assert cli(["pick", str(db), "--trial", "0", "--json"]) == 0
    assert "behind" not in json.loads(capsys.readouterr().out)
    assert cli(["pick", str(db), "--trial", "3"]) == 2
    assert "must be a feasible design that passes its audit, such as trials 0" in capsys.readouterr().err


def test_export_takes_it(db, tmp_path, capsys):
    """The design is chosen before the formats are looked at."""
    command = ["export", str(db), "--trial", "1", "-o", str(tmp_path / "out"), "--formats", "none"]
    assert cli(command) == 2
    assert "trial 1 (0.890 m on 20.10 J): asked for by its number" in capsys.readouterr().err
