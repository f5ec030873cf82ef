"""A study that frees optional variables: run, front, pick, report and export treat them like the rest."""

import json
import subprocess
import sys

import numpy as np
import pytest

from pareto_monoped.cad.records import record_job
from pareto_monoped.cli import _run as cli
from pareto_monoped.definition.study import study_from_dict
from pareto_monoped.design import DEFAULTS, NAMES, PAPER_NAMES
from pareto_monoped.errors import StudyError
from pareto_monoped.storage.reader import read_study

FREE = ("knee_release_rad", "rest_length_m", "start_height_m")
STUDY = """
name = "release"
evaluations = 40
seed = 4
audit = false

[variables]
knee_release_rad = { lower = 0.0, upper = 0.6 }
rest_length_m = { lower = 2.0, upper = 12.0 }
start_height_m = 0.45
"""


def command(capsys, *arguments):
    code, told = cli([str(argument) for argument in arguments]), capsys.readouterr()
    assert code == 0, told.err
    return told.out


@pytest.fixture(scope="module")
def db(tmp_path_factory):
    folder = tmp_path_factory.mktemp("release")
    (folder / "release.toml").write_text(STUDY)
    assert cli(["run", str(folder / "release.toml")]) == 0
    return folder / "release.db"


def test_trials_hold_them(db):
    data = read_study(db)
    assert data.study.free == (*PAPER_NAMES, "knee_release_rad", "rest_length_m")
    assert data.trials["knee_release_rad"].between(0.0, 0.6).all()
    assert data.trials["rest_length_m"].between(2.0, 12.0).all()
    assert (data.trials["start_height_m"] == 0.45).all()
    assert data.meta.study["variables"]["start_height_m"] == 0.45


def test_optuna_has_the_free_ones_as_parameters(db):
    import optuna

    study = optuna.load_study(study_name="release", storage=f"sqlite:///{db}")
    assert set(study.trials[0].params) == {*PAPER_NAMES, "knee_release_rad", "rest_length_m"}


def test_front_and_pick_show_them(db, tmp_path, capsys):
    # Of ten variables, nine fit into a table of 80 letters; the file has all.
    assert command(capsys, "front", db).splitlines()[0].split()[-2:] == ["r_k", "l0"]
    command(capsys, "front", db, "--csv", tmp_path / "front.csv")
    assert set(FREE) <= set((tmp_path / "front.csv").read_text().splitlines()[0].split(","))
    row = json.loads(command(capsys, "pick", db, "--knee", "--json"))
    assert set(FREE) <= set(row)


def test_the_report_has_axes_for_them(db, tmp_path, capsys):
    command(capsys, "report", db, "-o", tmp_path / "page.html")
    text = (tmp_path / "page.html").read_text()
    for label in ("knee release", "rest length", "start height"):
        assert label in text


@pytest.mark.long
def test_an_export_builds_and_replays_it(unchecked, db, tmp_path):
    assert cli(["export", str(db), "--knee", "-o", str(tmp_path / "knee"), "--formats", "mjcf"]) == 0
    record = json.loads((tmp_path / "knee" / "design.json").read_text())
    assert set(FREE) <= set(record["as_built"])
    replay = [sys.executable, tmp_path / "knee" / "model" / "replay.py"]
    assert subprocess.run(replay, capture_output=True, check=False).returncode == 0
    # A record whose lengths, jumps and masses are not those that its searched design gives again is refused.
    again = record_job(tmp_path / "knee" / "design.json", folder=tmp_path / "again")
    assert {name: getattr(again.design, name) for name in FREE} == {name: record["searched"][name] for name in FREE}


def test_without_them_a_study_stays_the_papers_own():
    study = study_from_dict({"name": "s", "evaluations": 10}, source="test")
    assert study.free == PAPER_NAMES
    assert set(study.as_dict()["variables"]) == set(PAPER_NAMES)
    np.testing.assert_array_equal(study.lower[len(PAPER_NAMES) :], list(DEFAULTS.values()))
    assert study_from_dict(study.as_dict(), source="test") == study
    assert len(study.lower) == len(NAMES)


@pytest.mark.parametrize(
    ("name", "value"), [("knee_release_rad", -0.1), ("rest_length_m", 0.1), ("start_height_m", 5.0)]
)
def test_impossible_values_are_refused(name, value):
    with pytest.raises(StudyError, match=name):
        study_from_dict({"name": "s", "evaluations": 10, "variables": {name: value}}, source="test")
