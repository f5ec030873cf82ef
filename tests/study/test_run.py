"""The run loop with the real evaluator, on small budgets."""

import os
import resource
import signal
import subprocess
import sys
import time
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

import numpy as np
import optuna
import pytest

from pareto_monoped.cli import _run as cli
from pareto_monoped.definition.goals import constraints_of
from pareto_monoped.definition.study import budgeted, study_from_dict
from pareto_monoped.definition.study_file import Stop
from pareto_monoped.definition.variables import Bounds
from pareto_monoped.design import NAMES
from pareto_monoped.errors import DatabaseError, StudyError
from pareto_monoped.jump.screen import CLEAR
from pareto_monoped.measures import MEASURE_NAMES
from pareto_monoped.pareto.front import front_mask
from pareto_monoped.pareto.objectives import HEIGHT_AND_ENERGY, hypervolume
from pareto_monoped.storage.reader import read_study
from pareto_monoped.storage.status import status
from pareto_monoped.storage.store import Store
from pareto_monoped.study.run import resume, run, run_second, seed_of_second
from pareto_monoped.study.simulator import load_simulator
from tests.study.support import change, reseal

ROOT = Path(__file__).parents[2]


def made(**more):
    settings = {"name": "s", "evaluations": 60, "audit": False, "algorithm": {"name": "nsga2", "population": 20}}
    return study_from_dict(settings | more, source="test")


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """A study run in one go by one worker: path, summary, data and what progress said."""
    path = tmp_path_factory.mktemp("whole") / "s.db"
    seen = []
    summary = run(made(), path, workers=1, progress=seen.append)
    return path, summary, read_study(path), seen


def test_stores_what_the_evaluator_gives(whole):
    _, summary, data, _ = whole
    assert summary.evaluations == summary.new_evaluations == len(data.trials) == 60
    assert summary.stop_reason == "budget"
    again = load_simulator(made(), workers=1).evaluator(data.trials[list(NAMES)].to_numpy())
    for name in MEASURE_NAMES:
        assert np.array_equal(data.trials[name].to_numpy(), getattr(again, name), equal_nan=True), name
    assert data.trials["status"].tolist() == again.status.tolist()


def test_progress_and_history_tell_what_is_stored(whole):
    _, summary, data, seen = whole
    assert [p.evaluations for p in seen] == data.history["evaluations"].tolist() == [20, 40, 60]
    assert [p.hypervolume for p in seen] == data.history["hypervolume"].tolist()
    assert (data.history["hypervolume"].diff().dropna() >= 0.0).all()
    feasible = data.trials[data.trials["state"] == "feasible"]
    points = feasible[["height_m", "energy_j"]].to_numpy()
    assert summary.hypervolume == pytest.approx(hypervolume(points, data.reference_point), rel=1e-12)
    assert summary.front_size == len(data.front())
    high = points[points[:, 0] >= 0.8, 1]
    assert seen[-1].at_height.value == high.min()


def test_every_evaluated_design_counts_for_the_front(whole):
    data = whole[2]
    ok = (data.trials["state"] == "feasible").to_numpy()
    mask = front_mask(data.trials[["height_m", "energy_j"]].to_numpy(), HEIGHT_AND_ENERGY, ok)
    assert set(data.front()["trial"]) == set(data.trials["trial"][mask])


@pytest.mark.parametrize("workers", [2, pytest.param(3, marks=pytest.mark.long)])
def test_workers_do_not_change_the_trials(whole, tmp_path, workers):
    run(made(), tmp_path / "s.db", workers=workers)
    assert read_study(tmp_path / "s.db").trials.equals(whole[2].trials)


def test_stopped_within_a_generation_and_gone_on_with_it_ends_the_same(whole, tmp_path):
    path = tmp_path / "s.db"
    for budget in (7, 13, 20, 21, 50):
        assert run(made(), path, evaluations=budget).evaluations == budget
    assert resume(path, evaluations=60).new_evaluations == 10
    data = read_study(path)
    assert data.trials.equals(whole[2].trials)
    assert data.checkpoint == whole[2].checkpoint
    assert data.history["evaluations"].tolist() == [20, 40, 60]


def test_a_study_that_is_done_is_left_untouched(whole):
    path, first, _, _ = whole
    before = (path.read_bytes(), path.stat().st_mtime_ns)
    again = run(made(), path)
    assert (again.new_evaluations, again.stop_reason, again.evaluations) == (0, "budget", 60)
    assert (again.hypervolume, again.front_size) == (first.hypervolume, first.front_size)
    assert resume(path).new_evaluations == 0
    # As many as there are is neither fewer nor more.
    assert run(made(), path, evaluations=60).new_evaluations == resume(path, evaluations=60).new_evaluations == 0
    with pytest.raises(StudyError, match="60 -> 59 "):
        run(made(), path, evaluations=59)
    assert (path.read_bytes(), path.stat().st_mtime_ns) == before


def test_resume_without_a_number_keeps_the_budget_of_the_last_run(tmp_path):
    run(made(), tmp_path / "s.db", evaluations=25)
    assert resume(tmp_path / "s.db").new_evaluations == 0
    assert status(tmp_path / "s.db")["budget"] == 25


def test_audits_can_be_switched_off(whole):
    assert whole[2].study.audit is False
    assert len(whole[2].audits) == 0


def test_the_seed_decides_the_trials(whole, tmp_path):
    run(made(), tmp_path / "s.db", seed=2, evaluations=20)
    assert not read_study(tmp_path / "s.db").trials["hip_ratio"].equals(whole[2].trials["hip_ratio"][:20])


def test_optuna_loads_it(whole):
    optuna.logging.set_verbosity(optuna.logging.WARNING)
    loaded = optuna.load_study(study_name="s", storage=f"sqlite:///{whole[0]}")
    assert {trial.number for trial in loaded.best_trials} == set(whole[2].front()["trial"])


def test_fixed_variables_stay_fixed(tmp_path):
    study = made(case="A", variables={"stiffness_n_per_m": {"lower": 20.0, "upper": 30.0}})
    run(study, tmp_path / "s.db", evaluations=20)
    trials = read_study(tmp_path / "s.db").trials
    assert (trials[["thigh_length_m", "shank_length_m"]] == 0.4).all(axis=None)
    assert trials["stiffness_n_per_m"].between(20.0, 30.0).all()


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"seed": 2}, "study.seed: 1 -> 2"),
        ({"variables": {"hip_ratio": 5.0}}, "study.variables.hip_ratio: (none) -> 5.0"),
        ({"constraints": {"min_height_m": 0.6}}, "study.constraints.min_height_m: 0.55 -> 0.6"),
        ({"algorithm": {"name": "nsga2", "population": 10}}, "study.algorithm.population: 20 -> 10"),
        ({"calibration": "ideal"}, "calibration.name"),
        ({"motor": "U8"}, 'motor.name: "VT8020" -> "U8"'),
        ({"evaluations": 50}, "study.evaluations: 60 -> 50 (only more is allowed)"),
    ],
)
def test_a_changed_study_is_refused_with_the_difference(whole, change, words):
    before = whole[0].read_bytes()
    with pytest.raises(StudyError) as caught:
        run(made(**change), whole[0])
    assert words in str(caught.value)
    assert "\n" not in str(caught.value)
    assert whole[0].read_bytes() == before


def test_other_results_of_the_same_settings_are_refused(whole, tmp_path):
    path = tmp_path / "s.db"
    path.write_bytes(whole[0].read_bytes())
    data = read_study(path)
    probe = data.meta.probe
    probe[0][0] += 1e-15
    with Store(path, data.study) as store:
        store.set_meta({"probe": probe})
    with pytest.raises(StudyError, match="probe designs"):
        resume(path, evaluations=80)


def test_goes_on_without_the_users_own_files(tmp_path):
    """Motor and calibration files are in the database: it is enough to resume from."""
    from importlib import resources

    folder = resources.files("pareto_monoped") / "data" / "calibrations"
    (tmp_path / "mine.toml").write_text((folder / "reference.toml").read_text().replace('"reference"', '"mine"'))
    (tmp_path / "s.toml").write_text('name = "s"\nevaluations = 20\naudit = false\ncalibration = "mine.toml"\n')
    from pareto_monoped.definition.study import load_study

    run(load_study(tmp_path / "s.toml"), tmp_path / "s.db")
    (tmp_path / "mine.toml").unlink()
    assert resume(tmp_path / "s.db", evaluations=30).new_evaluations == 10
    assert read_study(tmp_path / "s.db").meta.calibration.startswith("mine")


def test_stops_on_a_plateau(tmp_path):
    """Random search in a corner too small to find anything better in."""
    corner = {name: {"lower": 0.4, "upper": 0.4 + 1e-9} for name in NAMES[:1]} | dict.fromkeys(NAMES[2:4], 6.0)
    study = made(
        algorithm={"name": "random", "population": 5},
        stop={"plateau_evaluations": 10, "plateau_growth": 0.5},
        variables=corner,
    )
    summary = run(study, tmp_path / "s.db")
    assert summary.stop_reason == "plateau"
    assert 10 < summary.evaluations < 60


def test_a_search_that_has_no_feasible_design_is_on_no_plateau(tmp_path):
    """Its front does not grow, and still it has not arrived anywhere."""
    study = made(
        algorithm={"name": "random", "population": 5},
        evaluations=30,
        stop={"plateau_evaluations": 10, "plateau_growth": 0.5},
        constraints={"mass_kg": {"max": 0.1}},
    )
    summary = run(study, tmp_path / "s.db")
    assert (summary.stop_reason, summary.evaluations, summary.front_size) == ("budget", 30, 0)


def test_stops_on_wall_time_over_all_sessions(tmp_path):
    study = made(evaluations=10_000, stop={"wall_time_s": 0.05})
    first = run(study, tmp_path / "s.db")
    assert first.stop_reason == "wall_time"
    assert first.evaluations < 10_000
    assert run(study, tmp_path / "s.db").new_evaluations == 0
    longer = replace(study, stop=Stop(wall_time_s=1e6))
    assert run(longer, tmp_path / "s.db", evaluations=first.evaluations + 20).new_evaluations == 20


def test_wall_time_counts_earlier_sessions(tmp_path):
    """With an hour on the clock from earlier sessions, a limit of half an hour is used up and one of two is not."""
    path, hour = tmp_path / "s.db", 3600.0
    run(made(), path, evaluations=20)
    change(path, f"UPDATE monoped_history SET seconds = {hour}")
    reseal(path)
    summary = run(replace(made(), stop=Stop(wall_time_s=0.5 * hour)), path)
    assert (summary.stop_reason, summary.new_evaluations) == ("wall_time", 0)
    summary = run(replace(made(), stop=Stop(wall_time_s=2.0 * hour)), path, evaluations=40)
    assert (summary.stop_reason, summary.new_evaluations) == ("budget", 20)
    data = read_study(path)
    assert hour < data.wall_time_s < 2.0 * hour
    assert data.wall_time_s == data.history["seconds"].max() == status(path)["wall_time_s"]


def test_a_weighted_sweep_ends_by_itself(tmp_path):
    study = made(evaluations=1000, algorithm={"name": "weighted_cmaes", "height_weights": [0.2, 0.8], "iterations": 2})
    summary = run(study, tmp_path / "s.db")
    assert (summary.stop_reason, summary.evaluations) == ("exhausted", 32)
    assert read_study(tmp_path / "s.db").trials["height_weight"].tolist() == [0.2] * 16 + [0.8] * 16
    before = (tmp_path / "s.db").read_bytes()
    assert resume(tmp_path / "s.db").stop_reason == "exhausted"
    assert (tmp_path / "s.db").read_bytes() == before


def test_infeasible_trials_are_kept_and_off_the_front(tmp_path):
    study = replace(made(), constraints=constraints_of({"max_energy_j": 25.0}))
    run(study, tmp_path / "s.db", evaluations=40)
    data = read_study(tmp_path / "s.db")
    infeasible = data.trials[data.trials["state"] == "infeasible"]
    assert len(infeasible) > 0
    assert infeasible["reason"].str.contains("energy_j").all()
    assert (data.front()["energy_j"] <= 25.0).all()


def test_designs_that_the_screen_does_not_clear_are_audited(tmp_path, monkeypatch):
    """With a stricter screen about half of the front: each design has the measures of one or the other."""
    monkeypatch.setitem(CLEAR, "half_step_energy", 0.8)
    path = tmp_path / "s.db"
    run(made(audit=True, evaluations=40), path)
    audits = read_study(path).audits
    screened = audits["double_step_energy"].notna()
    assert screened.any()
    assert not screened.all()
    assert (audits["spread_energy"].isna() == screened).all()
    assert audits["well_conditioned"].all()


def test_the_front_is_audited_at_the_end_and_only_once(tmp_path):
    path = tmp_path / "s.db"
    said = []
    run(made(audit=True, evaluations=20), path, notify=said.append)
    data = read_study(path)
    assert set(data.audits["trial"]) >= set(data.front()["trial"])
    assert data.front()["trial"].isin(data.audits.loc[data.audits["well_conditioned"], "trial"]).all()
    assert (data.audits["double_step_energy"] > 0.0).all()
    assert len(said) >= 1
    said.clear()
    run(made(audit=True, evaluations=20), path, notify=said.append)
    assert said == []


def test_status_says_how_far_it_is(whole):
    facts = status(whole[0])
    assert (facts["state"], facts["evaluations"], facts["budget"], facts["process"]) == ("finished", 60, 60, None)
    assert facts["feasible"] + facts["infeasible"] + facts["failed"] == 60
    assert facts["hypervolume"] == whole[1].hypervolume
    assert facts["evaluations_per_second"] > 0.0


def test_trials_that_do_not_follow_from_the_checkpoint_are_refused(tmp_path):
    run(made(), tmp_path / "s.db", evaluations=25)
    change(tmp_path / "s.db", "UPDATE monoped_trials SET hip_ratio = hip_ratio + 0.01 WHERE trial = 22")
    reseal(tmp_path / "s.db")
    with pytest.raises(DatabaseError, match="trials 20 to 24 do not follow"):
        resume(tmp_path / "s.db", evaluations=60)


def test_bounds_beyond_the_papers_work(tmp_path):
    study = made(variables={"stiffness_n_per_m": {"lower": 0.5, "upper": 5.0}})
    assert study.variables["stiffness_n_per_m"] == Bounds(lower=0.5, upper=5.0)
    run(study, tmp_path / "s.db", evaluations=20)
    assert (read_study(tmp_path / "s.db").trials["state"] == "feasible").any()


def test_ctrl_c_ends_after_the_generation_and_a_second_process_is_refused(tmp_path):
    """One real process: refused to others while it runs, interrupted once, gone on with after."""
    toml = tmp_path / "s.toml"
    toml.write_text('name = "s"\nevaluations = 100000\naudit = false\n[algorithm]\nname = "random"\n')
    command = [sys.executable, "-m", "pareto_monoped", "run", str(toml), "--workers", "1"]
    process = subprocess.Popen(command, cwd=ROOT, stderr=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
    try:
        db = tmp_path / "s.db"
        deadline = time.monotonic() + 60.0
        while time.monotonic() < deadline and not (db.exists() and len(read_study(db).trials)):
            time.sleep(0.05)
        with pytest.raises(DatabaseError, match=f"process {process.pid};"):
            resume(db)
        facts = status(db)
        assert (facts["state"], facts["process"]) == ("running", process.pid)
        os.kill(process.pid, signal.SIGINT)
        _, said = process.communicate(timeout=60)
    finally:
        process.kill()
        process.wait()
    assert process.returncode == 130
    assert "ending after this generation; press Ctrl-C again to end at once" in said
    assert "Traceback" not in said
    data = read_study(db)
    assert data.meta.stop_reason == "interrupted"
    assert len(data.trials) == data.checkpoint.evaluations > 0
    assert sorted(path.name for path in tmp_path.iterdir()) == ["s.db", "s.toml"]


@pytest.mark.parametrize(
    "bent",
    [
        "state = '{}'",
        "state = json_remove(state, '$.generator')",
        "state = json_set(state, '$.X', json('[[1.0]]'))",
        "state = json_set(state, '$.rank', json('[1]'))",
        "state = json_set(state, '$.generator.bit_generator', 'os.system')",
        "state = json_set(state, '$.F', 'x')",
    ],
)
def test_a_bent_checkpoint_is_refused(whole, tmp_path, bent):
    path = tmp_path / "s.db"
    path.write_bytes(whole[0].read_bytes())
    change(path, f"UPDATE monoped_checkpoint SET {bent}")
    reseal(path)
    with pytest.raises(DatabaseError, match="checkpoint is damaged"):
        resume(path, evaluations=80)
    assert read_study(path).trials.equals(whole[2].trials)


@contextmanager
def full(size):
    """No file gets longer than so many bytes, by the system's own limit."""
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)


def test_a_disk_that_is_full_when_a_study_is_made_leaves_nothing(tmp_path, capsys):
    toml = tmp_path / "s.toml"
    toml.write_text('name = "s"\nevaluations = 20\n')
    with full(100_000):
        assert cli(["run", str(toml)]) == 1
    last = capsys.readouterr().err.splitlines()[-1]
    assert last.startswith("error: study database")
    assert "disk" in last
    assert "run the study again" in last  # there is nothing to resume
    assert "resume" not in last
    assert [path.name for path in tmp_path.iterdir()] == ["s.toml"]


def test_a_disk_that_fills_up_loses_nothing(tmp_path, capsys):
    toml = tmp_path / "s.toml"
    toml.write_text('name = "s"\nevaluations = 2000\naudit = false\n[algorithm]\nname = "random"\npopulation = 50\n')
    with full(600_000):
        assert cli(["run", str(toml)]) == 1
    told = capsys.readouterr().err
    assert told.splitlines()[-1].startswith("error: study database")
    assert "all acknowledged trials are safe" in told
    assert "Traceback" not in told
    data = read_study(tmp_path / "s.db")
    stored = len(data.trials)
    assert 0 < stored < 2000
    assert resume(tmp_path / "s.db", evaluations=stored + 50).new_evaluations == 50
    again = load_simulator(data.study, workers=2).evaluator(data.trials[list(NAMES)].to_numpy()[:50])
    assert np.array_equal(again.height_m, data.trials["height_m"][:50], equal_nan=True)


def test_a_second_search_is_that_of_its_seed_is_continued_and_not_run_again(whole, tmp_path):
    """Also after the first has got more evaluations than its file says; its own database stays as it is."""
    path, db = tmp_path / "s.db", tmp_path / "s_seed_9.db"
    first = run(made(), path, evaluations=80)
    before = path.read_bytes()
    stopped, found = run_second(first, made(), 9, progress=lambda _: True)
    assert (stopped.db, stopped.stop_reason, found) == (db, "interrupted", None)
    second, found = run_second(first, made(), 9)
    assert (second.evaluations, second.evaluations - second.new_evaluations) == (80, stopped.evaluations)
    plain = run(made(seed=9), tmp_path / "plain.db", evaluations=80)
    assert read_study(db).trials[[*NAMES]].equals(plain.data.trials[[*NAMES]])
    again, same = run_second(run(made(), path), made(), 9)
    assert (again.new_evaluations, same) == (0, found)
    assert path.read_bytes() == before


def test_a_second_search_has_the_weights_iterations_of_the_first(tmp_path):
    """The first ran on with a budget that its weights, shared out before, could not spend."""
    weights = {"name": "weighted_cmaes", "height_weights": [0.3, 0.7]}
    study = budgeted(made(evaluations=32, algorithm=weights), given=False, source="test")
    run(study, tmp_path / "s.db")
    first = run(study, tmp_path / "s.db", evaluations=80)
    second = run_second(first, study, 2)[0]
    assert (first.stop_reason, first.evaluations) == (second.stop_reason, second.evaluations) == ("exhausted", 32)


@pytest.mark.parametrize(("given", "found"), [(True, 8), (0, 0), (2**63 - 1, 2**63 - 1)])
def test_the_second_seed_is_the_next_one_or_that_given(given, found):
    assert seed_of_second(7, given) == found


def test_a_second_seed_that_is_the_studys_is_refused():
    with pytest.raises(StudyError, match=r"second seed = 7: must be another one than the study's; give another"):
        seed_of_second(7, 7)
    assert seed_of_second(2**63 - 1, True) == 0
