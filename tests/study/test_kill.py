"""Killed by SIGKILL at random moments and resumed, a study ends up bit for bit where it would have without."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

from pareto_monoped.storage.reader import read_study

ROOT = Path(__file__).parents[2]
WEIGHTED = 'name = "weighted_cmaes"\nheight_weights = [0.3, 0.7]\niterations = 15'
NSGA2 = 'name = "nsga2"\npopulation = 20'
SURROGATE = 'name = "surrogate"\npopulation = 20\ndrawn_generations = 2'


BATTERY = 'objectives = ["height_m", "electrical_energy_j"]\n'
THREE = 'objectives = ["height_m", "electrical_energy_j", "mass_kg"]\n[constraints]\nmass_kg = { max = 4.6 }\n'
MOTORS = 'motor = ["VT8020", "U8", "MN8014"]\n'
PAIRS = 'hip_motor = ["VT8020", "U8"]\nknee_motor = ["U8", "MN8014"]\n'
OPTIONAL = "[variables]\nknee_release_rad = { lower = 0.0, upper = 0.6 }\nrest_length_m = { lower = 2, upper = 12 }\n"
EVERY = ("nsga2", "sms_emoa", "age_moea2", "surrogate", "optuna_nsga2", "optuna_tpe", "random")
TWO = MOTORS.replace(', "MN8014"', "")


def kill_all(folder, studies, evaluations, kills, seed=3):
    """Runs tests/study/killed.py on studies (algorithm, beginning of the file); their folders and reports."""
    folders = [folder / str(k) for k in range(len(studies))]
    for place, (algorithm, top) in zip(folders, studies, strict=True):
        place.mkdir()
        text = f'name = "s"\nevaluations = {evaluations}\naudit = false\n{top}[algorithm]\n{algorithm}\n'
        (place / "s.toml").write_text(text)
    done = subprocess.run(
        [sys.executable, "-m", "tests.study.killed", str(kills), str(seed), *map(str, folders)],
        capture_output=True,
        text=True,
        cwd=ROOT,
    )
    assert done.returncode == 0, done.stderr
    return list(zip(folders, json.loads(done.stdout), strict=True))


def check(place, report, evaluations, kills):
    """Everything that must hold after each kill and at the end."""
    assert len(report) == kills
    for kill in report:
        assert kill["sound"] == "ok"
        assert kill["stored"] >= kill["acknowledged"]
    # Some kills must have come while it was at work, or this shows nothing.
    assert any(0 < kill["stored"] < evaluations and kill["code"] == -9 for kill in report)
    whole, resumed = read_study(place / "whole.db"), read_study(place / "killed.db")
    assert resumed.trials.equals(whole.trials)
    assert resumed.front().equals(whole.front())
    assert resumed.checkpoint == whole.checkpoint
    assert resumed.meta.hash == whole.meta.hash
    assert resumed.history["hypervolume"].equals(whole.history["hypervolume"])


def killed(folder, algorithms, evaluations, kills, top=""):
    for place, report in kill_all(folder, [(algorithm, top) for algorithm in algorithms], evaluations, kills):
        check(place, report, evaluations, kills)


def test_killed_twice(tmp_path):
    """A study with all that is stored besides designs: motors, a limit, a third objective, a model."""
    killed(tmp_path, [SURROGATE], evaluations=80, kills=2, top=TWO + THREE)
    data = read_study(tmp_path / "0" / "killed.db")
    assert data.trials["motor"].nunique() == 2
    assert data.study.objectives.names == ("height_m", "electrical_energy_j", "mass_kg")
    assert (data.trials["mass_kg"] > 4.6).any()
    assert (data.front()["mass_kg"] <= 4.6).all()


@pytest.mark.long
def test_plainer_studies_killed_three_times(tmp_path):
    """Without what the one above has besides, and one that runs through weights."""
    studies = [
        (WEIGHTED, BATTERY),
        (NSGA2, ""),
        (NSGA2, OPTIONAL),
        (WEIGHTED, ""),
        (SURROGATE, ""),
        ('name = "sms_emoa"\npopulation = 20', THREE),
    ]
    for place, report in kill_all(tmp_path, studies, evaluations=240, kills=3):
        check(place, report, evaluations=240, kills=3)


@pytest.mark.long
@pytest.mark.parametrize("top", [MOTORS, PAIRS + THREE], ids=["one for both joints", "one per joint"])
def test_every_algorithm_with_motors_killed_twice(tmp_path, top):
    """Small generations, so that both kills come between many of them."""
    settings = [f'name = "{name}"\npopulation = 10' for name in EVERY]
    killed(tmp_path, settings, evaluations=100, kills=2, top=top)
    data = read_study(tmp_path / "0" / "killed.db")
    assert data.trials["motor"].nunique() == len(data.kits)


@pytest.mark.long
def test_three_objectives_killed_five_times(tmp_path):
    names = ("nsga2", "age_moea2", "optuna_nsga2", "optuna_tpe", "random", "surrogate")
    killed(tmp_path, [f'name = "{name}"' for name in names], evaluations=400, kills=5, top=THREE)


@pytest.mark.long
def test_killed_twenty_times(tmp_path):
    killed(tmp_path, [NSGA2, WEIGHTED.replace("30", "200")], evaluations=3200, kills=20)


@pytest.mark.long
def test_the_other_algorithms_killed_five_times(tmp_path):
    names = ("sms_emoa", "age_moea2", "optuna_nsga2", "optuna_tpe", "random", "surrogate")
    killed(tmp_path, [f'name = "{name}"' for name in names], evaluations=400, kills=5)
