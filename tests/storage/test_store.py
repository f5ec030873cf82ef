"""What is stored is what was given, as Optuna reads it and as we do."""

import json
import sqlite3
import warnings
from wsgiref.util import setup_testing_defaults

import numpy as np
import optuna
import pytest

from pareto_monoped.design import NAMES, PAPER_NAMES
from pareto_monoped.errors import DiskError
from pareto_monoped.measures import MEASURE_NAMES
from pareto_monoped.storage.reader import read_study
from pareto_monoped.storage.store import Store
from tests.study.support import made_database, made_evaluations, made_generation, made_study


def load(path, name="made"):
    optuna.logging.set_verbosity(optuna.logging.WARNING)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        return optuna.load_study(study_name=name, storage=f"sqlite:///{path}")


def test_every_number_comes_back_to_the_last_bit(tmp_path):
    _, generations = made_database(tmp_path / "s.db")
    trials = read_study(tmp_path / "s.db").trials
    assert trials["trial"].tolist() == [0, 1, 2, 3, 4, 5]
    assert trials["generation"].tolist() == [0, 0, 0, 0, 1, 1]
    assert np.array_equal(trials[list(NAMES)].to_numpy(), np.vstack([g.designs for g in generations]))
    for name in MEASURE_NAMES:
        stored = np.concatenate([getattr(g.evaluations, name) for g in generations])
        assert np.array_equal(trials[name].to_numpy(), stored, equal_nan=True), name
    assert trials["state"].tolist() == ["feasible", "infeasible", "failed", "feasible", "feasible", "feasible"]
    assert trials["reason"].tolist()[1:3] == ["height_m = 0.52 is below the limit of 0.55", "it was diverged"]
    assert np.array_equal(trials["height_weight"], [np.nan] * 4 + [0.25] * 2, equal_nan=True)


@pytest.mark.parametrize("options", [{}, {"known_schemas": ()}], ids=["direct", "by Optuna's public call"])
def test_optuna_reads_what_was_stored(tmp_path, options):
    study, generations = made_database(tmp_path / "s.db", **options)
    loaded = load(tmp_path / "s.db")
    assert loaded.directions == [optuna.study.StudyDirection.MAXIMIZE, optuna.study.StudyDirection.MINIMIZE]
    assert loaded.metric_names == ["height_m", "energy_j"]
    trials = loaded.trials
    designs = np.vstack([g.designs for g in generations])
    for number, trial in enumerate(trials):
        assert trial.number == number
        assert trial.params == dict(zip(PAPER_NAMES, designs[number, : len(PAPER_NAMES)].tolist(), strict=True))
        for name in PAPER_NAMES:
            bounds = study.variables[name]
            assert trial.distributions[name] == optuna.distributions.FloatDistribution(bounds.lower, bounds.upper)
    assert [trial.values for trial in trials] == [[0.8, 9.0], [0.52, 1.0], None, [1.1, 30.0], [0.7, 8.0], [0.9, 40.0]]
    states = [trial.state.name for trial in trials]
    assert states == ["COMPLETE", "COMPLETE", "FAIL", "COMPLETE", "COMPLETE", "COMPLETE"]
    assert trials[1].constraints == pytest.approx({"0": 0.03 / 0.55})
    assert trials[1].user_attrs["reason"] == "height_m = 0.52 is below the limit of 0.55"
    assert trials[2].user_attrs == {"status": "diverged", "reason": "it was diverged"}
    assert trials[4].user_attrs == {"height_weight": 0.25}


def test_optunas_front_is_ours(tmp_path):
    made_database(tmp_path / "s.db")
    best = {trial.number for trial in load(tmp_path / "s.db").best_trials}
    assert best == set(read_study(tmp_path / "s.db").front()["trial"]) == {0, 3, 4}


@pytest.mark.parametrize("options", [{}, {"known_schemas": ()}], ids=["direct", "by Optuna's public call"])
def test_optuna_has_the_objectives_of_the_study(tmp_path, options):
    names = ["mass_kg", "height_m", "electrical_energy_j"]
    _, generations = made_database(tmp_path / "s.db", study=made_study(objectives=names), **options)
    loaded = load(tmp_path / "s.db")
    assert [direction.name for direction in loaded.directions] == ["MINIMIZE", "MAXIMIZE", "MINIMIZE"]
    assert loaded.metric_names == names
    columns = [np.concatenate([getattr(g.evaluations, name) for g in generations]) for name in names]
    for trial, values in zip(loaded.trials, np.column_stack(columns).tolist(), strict=True):
        assert trial.values == (None if trial.state.name == "FAIL" else values)
    assert {trial.number for trial in loaded.best_trials} == set(read_study(tmp_path / "s.db").front()["trial"])


def test_optuna_can_go_on_with_it(tmp_path):
    made_database(tmp_path / "s.db")
    loaded = load(tmp_path / "s.db")
    loaded.optimize(lambda trial: (trial.suggest_float(NAMES[0], 0.3, 0.5), 1.0), n_trials=1)
    assert loaded.trials[-1].number == 6


def test_fixed_variables_are_stored_but_are_no_parameters(tmp_path):
    study = made_study(variables={"hip_ratio": 5.0})
    made_database(tmp_path / "s.db", study=study)
    assert "hip_ratio" not in load(tmp_path / "s.db").trials[0].params
    assert (read_study(tmp_path / "s.db").trials["hip_ratio"] == 5.0).all()


def test_the_checkpoint_moves_with_whole_generations_only(tmp_path):
    path, study = tmp_path / "s.db", made_study()
    made_database(path, [], study)
    part = made_evaluations([0.7, 0.8], [1.0, 2.0])
    with Store(path, study) as store:
        store.add(made_generation(study, 0, 0, part, state={"a": 1}))
        store.add(made_generation(study, 1, 2, part, state=None))
    data = read_study(path)
    assert (data.checkpoint.generation, data.checkpoint.evaluations, data.checkpoint.state) == (1, 2, {"a": 1})
    assert len(data.trials) == 4


def test_a_study_at_rest_is_one_file(tmp_path):
    made_database(tmp_path / "s.db")
    assert [path.name for path in tmp_path.iterdir()] == ["s.db"]


def test_a_power_cut_keeps_what_was_acknowledged(tmp_path):
    """Only full synchronisation writes each commit through to the disk; without it, a power cut loses the last ones."""
    path, study = tmp_path / "s.db", made_study()
    made_database(path, [], study)
    with Store(path, study) as store:
        # Values in SQLite's documentation: 0 off, 1 normal, 2 full, 3 extra.
        assert store._connection.execute("PRAGMA synchronous").fetchone() == (2,)
        assert store._connection.execute("PRAGMA journal_mode").fetchone() == ("wal",)


def test_readers_see_whole_generations_while_it_grows(tmp_path):
    path, study = tmp_path / "s.db", made_study()
    made_database(path, [], study)
    part = made_evaluations([0.7, 0.8], [1.0, 2.0])
    with Store(path, study) as store:
        for number in range(3):
            store.add(made_generation(study, number, 2 * number, part, state={}))
            assert len(read_study(path).trials) == len(load(path).trials) == 2 * (number + 1)


@pytest.mark.parametrize("name", ["'; DROP TABLE trials; --", "<script>alert(1)</script>", "../../x\n\u202e\U0001f9bf"])
def test_names_are_text_and_nothing_else(tmp_path, name):
    made_database(tmp_path / "s.db", study=made_study(name=name))
    assert read_study(tmp_path / "s.db").study.name == name
    assert len(load(tmp_path / "s.db", name).trials) == 6


def test_odd_file_names_are_file_names(tmp_path):
    path = tmp_path / "a b?mode=ro&x=%41#.db"
    made_database(path)
    assert len(read_study(path).trials) == 6
    assert [p.name for p in tmp_path.iterdir()] == [path.name]


def test_a_full_database_keeps_what_was_acknowledged(tmp_path):
    """SQLite's own limit on pages gives its own "disk full" at a commit."""
    path, study = tmp_path / "s.db", made_study()
    made_database(path, [], study)
    many = made_evaluations(np.full(40, 0.7), np.full(40, 2.0))
    with Store(path, study) as store:
        store.add(made_generation(study, 0, 0, many, state={}))
        pages = store._connection.execute("PRAGMA page_count").fetchone()[0]
        store._connection.execute(f"PRAGMA max_page_count = {pages + 2}")
        with pytest.raises(DiskError, match="disk is full; make room and resume"):
            store.add(made_generation(study, 1, 40, many, state={"lost": True}))
        assert len(read_study(path).trials) == 40
        store._connection.execute("PRAGMA max_page_count = 100000")
        store.add(made_generation(study, 1, 40, many, state={"kept": True}))
    data = read_study(path)
    assert len(data.trials) == 80
    assert data.checkpoint.state == {"kept": True}


def test_trials_that_optuna_wrote_before_a_kill_are_not_written_twice(tmp_path):
    """In the fall-back Optuna commits a trial at a time, so a kill can come between its rows and ours."""
    path, study = tmp_path / "s.db", made_study()
    made_database(path, [], study)
    generation = made_generation(study, 0, 0, made_evaluations([0.7, 0.8, 0.9], [1.0, 2.0, 3.0]), state={})
    with Store(path, study, known_schemas=()) as store:
        store._optuna.add_by_optuna(generation)
    assert len(read_study(path).trials) == 0
    with Store(path, study, known_schemas=()) as store:
        store.add(generation)
    assert len(load(path).trials) == len(read_study(path).trials) == 3


def test_the_state_is_json_and_nothing_is_pickled(tmp_path):
    made_database(tmp_path / "s.db")
    connection = sqlite3.connect(tmp_path / "s.db")
    for (name,) in connection.execute("SELECT name FROM sqlite_master WHERE type = 'table'").fetchall():
        for row in connection.execute(f"SELECT * FROM {name}"):
            assert not any(isinstance(value, bytes) for value in row), name
    (state,) = connection.execute("SELECT state FROM monoped_checkpoint").fetchone()
    assert json.loads(state) == {"after": 1}
    connection.close()


def test_optuna_dashboard_reads_it(tmp_path):
    dashboard = pytest.importorskip("optuna_dashboard", reason="an optional extra")
    made_database(tmp_path / "s.db")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        application = dashboard.wsgi(f"sqlite:///{tmp_path}/s.db")
        started = []
        environ = {"PATH_INFO": "/api/studies/1", "QUERY_STRING": "after=0"}
        setup_testing_defaults(environ)
        body = b"".join(application(environ, lambda status, headers, *_: started.append(status)))
    assert started == ["200 OK"]
    detail = json.loads(body)
    assert len(detail["trials"]) == 6
    assert detail["trials"][1]["constraints"] == pytest.approx([0.03 / 0.55])
