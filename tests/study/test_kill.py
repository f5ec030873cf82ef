"""Killed by SIGKILL at random moments and resumed, a study ends up bit for bit where it would have without."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

from pareto_monoped.study.reader import read_study

ROOT = Path(__file__).parents[2]
WEIGHTED = 'name = "weighted_cmaes"\nheight_weights = [0.3, 0.7]\niterations = 30'
NSGA2 = 'name = "nsga2"\npopulation = 20'


def killed(folder, algorithm, evaluations, kills, seed=3):
    """Runs tests/study/killed.py; checks everything that must hold after each kill and at the end."""
    path = folder / "s.toml"
    path.write_text(f'name = "s"\nevaluations = {evaluations}\naudit = false\n[algorithm]\n{algorithm}\n')
    done = subprocess.run(
        [sys.executable, "-m", "tests.study.killed", str(path), str(folder), str(kills), str(seed)],
        capture_output=True,
        text=True,
        cwd=ROOT,
    )
    assert done.returncode == 0, done.stderr
    report = json.loads(done.stdout)
    assert len(report["kills"]) == kills
    for kill in report["kills"]:
        assert kill["sound"] == "ok"
        assert kill["stored"] >= kill["acknowledged"]
    # Some kills must have come while it was at work, or this shows nothing.
    assert any(0 < kill["stored"] < evaluations and kill["code"] == -9 for kill in report["kills"])
    whole, resumed = read_study(folder / "whole.db"), read_study(folder / "killed.db")
    assert resumed.trials.equals(whole.trials)
    assert resumed.front().equals(whole.front())
    assert resumed.checkpoint == whole.checkpoint
    assert resumed.meta["hash"] == whole.meta["hash"]
    assert resumed.history["hypervolume"].equals(whole.history["hypervolume"])
    return report


@pytest.mark.parametrize("algorithm", [NSGA2, WEIGHTED], ids=["nsga2", "weighted_cmaes"])
def test_killed_three_times(tmp_path, algorithm):
    killed(tmp_path, algorithm, evaluations=240, kills=3)


@pytest.mark.long
@pytest.mark.parametrize("algorithm", [NSGA2, WEIGHTED.replace("30", "200")], ids=["nsga2", "weighted_cmaes"])
def test_killed_twenty_times(tmp_path, algorithm):
    killed(tmp_path, algorithm, evaluations=3200, kills=20)


@pytest.mark.long
@pytest.mark.parametrize("name", ["sms_emoa", "age_moea2", "optuna_nsga2", "optuna_tpe", "random"])
def test_the_other_algorithms_killed_five_times(tmp_path, name):
    killed(tmp_path, f'name = "{name}"', evaluations=400, kills=5)
