"""A study that searches for measures under uncertainty: stored, resumed, checked, picked from."""

import json
import shutil
import sqlite3

import numpy as np
import pytest

from pareto_monoped.analysis.verify import verify
from pareto_monoped.cli import _run as cli
from pareto_monoped.definition.study import load_study
from pareto_monoped.errors import StudyError
from pareto_monoped.pareto.front import front_mask
from pareto_monoped.storage.front_reader import read_front
from pareto_monoped.storage.reader import read_study
from pareto_monoped.study.run import resume, run

FILE = """
name = "robust"
evaluations = 24
strength = false
audit = false
objectives = ["height_m.p05", "electrical_energy_j.p95"]
[algorithm]
name = "nsga2"
population = 8
[uncertainty]
samples = 16
masses = {{ lower = {lower}, upper = 0.02, source = "scales" }}
[constraints]
height_m.p05 = {{ min = 0.6 }}
"""


def study_file(folder, lower=-0.02):
    path = folder / "s.toml"
    path.write_text(FILE.format(lower=lower), encoding="utf-8")
    return path


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    folder = tmp_path_factory.mktemp("robust_objectives")
    run(load_study(study_file(folder)), folder / "s.db", workers=1)
    return folder / "s.db"


@pytest.fixture
def db(made, tmp_path):
    shutil.copy(made, tmp_path / "s.db")
    return tmp_path / "s.db"


def test_each_trial_has_what_it_keeps_under_uncertainty(made):
    trials = read_study(made).trials
    jumped = trials[trials["state"] != "failed"]
    assert len(jumped) >= 8
    assert (jumped["height_m.p05"] < jumped["height_m"]).all()
    assert (jumped["electrical_energy_j.p95"] > 0.9 * jumped["electrical_energy_j"]).all()
    assert jumped["failed_share"].between(0.0, 1.0).all()
    feasible = trials[trials["state"] == "feasible"]
    assert (feasible["height_m.p05"] >= 0.6).all()
    low = jumped[jumped["height_m.p05"] < 0.6]
    assert (low["state"] == "infeasible").all()
    assert low["reason"].str.contains("height_m.p05 = .* is below the limit of 0.6").all()


def test_the_front_is_of_the_objectives(made):
    data = read_study(made)
    values = data.trials[["height_m.p05", "electrical_energy_j.p95"]].to_numpy()
    mask = front_mask(values, data.study.objectives, (data.trials["state"] == "feasible").to_numpy())
    assert sorted(read_front(made).rows["trial"]) == sorted(data.trials["trial"][mask])
    assert data.front()["height_m.p05"].is_monotonic_increasing


@pytest.mark.parametrize("cut", [pytest.param(5, marks=pytest.mark.long), 11])
def test_a_run_that_was_cut_goes_on_bit_for_bit_with_other_workers(made, tmp_path, cut):
    """8 trials make a generation, so that both cuts lie within one."""
    db = tmp_path / "s.db"
    run(load_study(study_file(tmp_path)), db, evaluations=cut, workers=2)
    resume(db, evaluations=24, workers=1)
    whole, cut_up = read_study(made).trials, read_study(db).trials
    assert whole.equals(cut_up)


def test_the_trials_are_checked_and_simulated_again(db):
    verification = verify(db, simulate=8)
    assert (verification.findings, verification.simulated) == ((), 8)
    with sqlite3.connect(db) as connection:
        connection.execute('UPDATE monoped_trials SET "height_m.p05" = "height_m.p05" + 1e-12 WHERE trial = 3')
    connection.close()
    assert cli(["verify", str(db)]) != 0


def test_other_numbers_than_the_simulated_ones_are_found(db, monkeypatch):
    from pareto_monoped.uncertainty import samples

    monkeypatch.setattr(samples.RobustEvaluator, "drawn", samples.sobol_samples(load_study_ranges(db), 16, 2))
    assert any("height_m.p05" in line for line in verify(db, simulate=8).findings)


def load_study_ranges(db):
    return read_study(db).study.uncertainty.ranges


def test_other_ranges_are_another_study(db, tmp_path):
    with pytest.raises(StudyError, match=r"study.uncertainty.masses.lower: -0.02 -> -0.03"):
        run(load_study(study_file(tmp_path, lower=-0.03)), db)


def test_ranges_that_no_objective_needs_may_change(tmp_path):
    plain = 'name = "s"\nevaluations = 8\naudit = false\n[algorithm]\nname = "random"\n'
    path, db = tmp_path / "s.toml", tmp_path / "s.db"
    path.write_text(plain, encoding="utf-8")
    run(load_study(path), db, workers=1)
    assert read_study(db).study.uncertainty is None
    path.write_text(plain + '[uncertainty.gains]\nlower = -0.1\nupper = 0.1\nsource = "test"\n', encoding="utf-8")
    run(load_study(path), db, workers=1, evaluations=9)
    assert read_study(db).study.uncertainty.ranges.gains.lower == -0.1


def test_commands_understand_the_names(made, capsys):
    assert cli(["front", str(made), "--json"]) == 0
    rows = json.loads(capsys.readouterr().out)
    assert {"height_m.p05", "electrical_energy_j.p95"} <= set(rows[0])
    wanted = float(np.median([row["height_m.p05"] for row in rows]))
    able = [row for row in rows if row["height_m.p05"] >= wanted]
    best = min(able, key=lambda row: row["electrical_energy_j.p95"])
    for options in (["--min-height", str(wanted)], ["--min", f"height_m.p05={wanted}"]):
        assert cli(["pick", str(made), *options, "--json"]) == 0
        picked = json.loads(capsys.readouterr().out)
        assert picked["trial"] == best["trial"]
        assert picked["one_more"]["step"] == 0.01
    assert cli(["pick", str(made), "--nearest", "height_m.p05=0.9,electrical_energy_j.p95=30"]) == 0
    assert "nearest to the wish (height (5th percentile) 0.900 m" in " ".join(capsys.readouterr().out.split())
    assert cli(["front", str(made)]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert max(map(len, lines)) <= 80
    assert "height p05 m" in lines[0]
    assert cli(["pick", str(made), "--min", "mass_kg.p95=1"]) != 0
    assert "no design has a value of it" in capsys.readouterr().err
    assert cli(["front", str(made), "--objectives", "mass_kg.p95,height_m"]) != 0
    assert "no trial of" in capsys.readouterr().err


def test_optuna_sees_the_objectives(made):
    import optuna

    optuna.logging.set_verbosity(optuna.logging.WARNING)
    study = optuna.load_study(study_name="robust", storage=f"sqlite:///{made}")
    assert study.metric_names == ["height_m.p05", "electrical_energy_j.p95"]
    trials = read_study(made).trials
    k = int(trials[trials["state"] == "feasible"]["trial"].iloc[0])
    assert study.trials[k].values == trials.loc[k, ["height_m.p05", "electrical_energy_j.p95"]].tolist()


def test_the_study_s_ranges_are_those_of_robust(db, capsys):
    trial = int(read_front(db).rows["trial"].iloc[0])
    assert cli(["robust", str(db), "--trial", str(trial), "--json", "--workers", "1"]) == 0
    shown = json.loads(capsys.readouterr().out)
    assert (shown["uncertainty"], shown["samples"], shown["seed"]) == ("own", 256, 1)
    from pareto_monoped.storage.extra_rows import read_robustness

    stored = read_robustness(db)[trial].settings
    assert stored["uncertainty"]["masses"] == {"lower": -0.02, "upper": 0.02, "source": "scales"}
    assert cli(["pick", str(db), "--robust", "--knee", "--json"]) == 0
    spread = shown["trials"][str(trial)]["measures"]["height_m"]
    assert json.loads(capsys.readouterr().out)["height_m.p05"] == spread["p05"]
