"""What is stored is what was given, as Optuna reads it and as we do."""

import json
import sqlite3
import warnings
from wsgiref.util import setup_testing_defaults

import numpy as np
import optuna
import pytest

from pareto_monoped.errors import DatabaseError, DiskError
from pareto_monoped.storage.reader import read_study
from pareto_monoped.storage.store import Store
from pareto_monoped.study.run import resume, run
from tests.study.support import copied_database, made_database, made_evaluations, made_generation, made_study


def load(path, name="made"):
    optuna.logging.set_verbosity(optuna.logging.WARNING)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        return optuna.load_study(study_name=name, storage=f"sqlite:///{path}")


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


def test_parameters_are_named_once_per_trial_and_found_by_their_trial(tmp_path):
    """Optuna's own tables have each name in an index, too, a tenth of a study; both are the same to Optuna."""
    path, theirs = tmp_path / "s.db", tmp_path / "theirs.db"
    study = made_study()
    many = made_evaluations(np.full(60, 0.7), np.full(60, 2.0))
    made_database(path, [made_generation(study, 0, 0, many, state={})], study)
    assert 60 <= path.read_bytes().count(b"shank_length_m") < 90  # settings and columns have it, too
    optuna.storages.RDBStorage(f"sqlite:///{theirs}").engine.dispose()
    with sqlite3.connect(theirs) as connection:
        connection.execute("ATTACH ? AS ours", (str(path),))
        for table in ("studies", "study_directions", "trials", "trial_params", "trial_values", "trial_user_attributes"):
            connection.execute(f"INSERT INTO {table} SELECT * FROM ours.{table}")
        connection.execute("INSERT INTO trial_system_attributes SELECT * FROM ours.trial_system_attributes")
    connection.close()
    assert load(path).trials == load(theirs).trials
    with sqlite3.connect(path) as connection:
        plan = connection.execute("EXPLAIN QUERY PLAN SELECT * FROM trial_params WHERE trial_id IN (3, 4)").fetchall()
    connection.close()
    assert "USING INDEX" in plan[0][3]


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
    copied_database(tmp_path / "s.db")
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


@pytest.fixture(scope="module")
def simulated(tmp_path_factory):
    """The file of a study of four jumps."""
    path = tmp_path_factory.mktemp("simulated") / "s.db"
    run(made_study(evaluations=4, audit=False), path, workers=1)
    return path.read_bytes()


@pytest.mark.parametrize("column", [b"param_name VARCHAR", b"datetime_complete DATETIME", b"objective INTEGER"])
def test_a_refused_resume_leaves_a_file_with_a_damaged_column_of_optunas_as_it_was(simulated, tmp_path, column):
    """Found by a storm of flipped bits: it had stored that it was opened before it met the column."""
    path = tmp_path / "s.db"
    damaged = simulated.replace(column, bytes([column[0] ^ 1]) + column[1:])
    assert damaged != simulated
    path.write_bytes(damaged)
    with pytest.raises(DatabaseError, match="no such column"):
        resume(path, evaluations=8, workers=1)
    assert path.read_bytes() == damaged
    assert [one.name for one in tmp_path.iterdir()] == ["s.db"]
