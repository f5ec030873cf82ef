"""On a server a study has what it has in a file, to the last bit; Optuna and our other commands read it there."""

import subprocess
import sys
import warnings

import numpy as np
import optuna
import pytest

from pareto_monoped.analysis.verify import require_sound, verify
from pareto_monoped.definition.study import study_from_dict
from pareto_monoped.storage.database import reading
from pareto_monoped.storage.front_reader import read_front
from pareto_monoped.storage.optuna_check import repair
from pareto_monoped.storage.optuna_tables import reading_storage
from pareto_monoped.storage.place import place_of
from pareto_monoped.storage.reader import read_study
from pareto_monoped.storage.seals import ROWS
from pareto_monoped.storage.status import status
from pareto_monoped.study.run import resume, run
from tests.storage.server.cluster import OWNER
from tests.study.same import assert_same_study
from tests.study.support import made_database, made_evaluations, made_generation, made_study

pytest.importorskip("psycopg", reason="the extra postgres is not installed")

SMALL = {"name": "s", "evaluations": 60, "strength": False}
ALGORITHMS = [
    {"name": "nsga2", "population": 20},
    {"name": "surrogate", "population": 20, "drawn_generations": 1},
    {"name": "weighted_cmaes", "height_weights": [0.3, 0.7], "iterations": 3},
]


def rows_of(place, query):
    with reading(place) as connection:
        return [tuple(row) for row in connection.execute(query)]


@pytest.mark.parametrize("options", [{}, {"known_schemas": ()}], ids=["direct", "by Optuna's public call"])
def test_same_rows_and_running_hash(tmp_path, place, options):
    made_database(tmp_path / "s.db", **options)
    made_database(place, **options)
    for query in [*ROWS.values(), "SELECT * FROM monoped_trials ORDER BY trial"]:
        assert rows_of(place, query) == rows_of(tmp_path / "s.db", query), query
    if not options:  # Optuna notes the time of its own call
        chain = "SELECT link, first, columns, trials, written, hash FROM monoped_seals ORDER BY link"
        assert rows_of(place, chain) == rows_of(tmp_path / "s.db", chain)
    # Numbers drawn for measures are not plausible ones; what else is checked finds nothing.
    assert verify(place).findings == verify(tmp_path / "s.db").findings


@pytest.mark.parametrize("algorithm", ALGORITHMS, ids=lambda algorithm: algorithm["name"])
def test_same_study(tmp_path, place, algorithm):
    study = study_from_dict(SMALL | {"algorithm": algorithm}, source="test")
    for db in (tmp_path / "s.db", place):
        run(study, db, evaluations=30)
        resume(db, evaluations=60)
    assert_same_study(tmp_path / "s.db", place)
    require_sound(place, verify(place, simulate=5))
    assert read_front(place).rows.equals(read_front(tmp_path / "s.db").rows)
    here, there = status(tmp_path / "s.db"), status(place)
    timed = {"created", "database", "wall_time_s", "evaluations_per_second"}
    assert {key: there[key] for key in there.keys() - timed} == {key: here[key] for key in here.keys() - timed}


def test_minus_zero_and_nan_come_back_as_from_a_file(tmp_path, place):
    study = made_study()
    evaluations = made_evaluations([0.8, np.nan], [9.0, np.nan], ["ok", "diverged"])
    evaluations.drift_m[0] = -0.0
    generations = [made_generation(study, 0, 0, evaluations, state={"after": 0})]
    for db in (tmp_path / "s.db", place):
        made_database(db, generations, study)
    (zero,), (missing,) = rows_of(place, "SELECT drift_m FROM monoped_trials ORDER BY trial")
    assert not np.signbit(zero)
    assert missing is None
    assert verify(place).findings == verify(tmp_path / "s.db").findings


def test_optuna_reads_it_in_another_process(cluster, place):
    made_database(place)
    script = (
        "import optuna, sys\n"
        "study = optuna.load_study(study_name=None, storage=sys.argv[1])\n"
        "print([trial.values for trial in study.trials])\n"
    )
    plain = f"postgresql+psycopg://{OWNER}@/team?host={cluster.folder}&options=-csearch_path%3D{place.schema}"
    done = subprocess.run([sys.executable, "-c", script, plain], capture_output=True, text=True, check=False)
    assert done.stdout.strip() == "[[0.8, 9.0], [0.52, 1.0], None, [1.1, 30.0], [0.7, 8.0], [0.9, 40.0]]", done.stderr


def test_the_dashboards_view_reads_and_cannot_write(place):
    made_database(place)
    storage = reading_storage(place)
    (study,) = storage.get_all_studies()
    assert storage.get_n_trials(study._study_id) == 6
    with pytest.raises(optuna.exceptions.StorageInternalError) as caught:
        storage.set_study_user_attr(study._study_id, "note", "x")
    assert "read-only" in str(caught.value.__cause__)
    storage.remove_session()
    storage.engine.dispose()


def test_trials_of_an_optuna_user_are_left_alone_and_dropped(tmp_path, place):
    """Optuna's next trial gets a key of its own after ours, and ours after that."""
    study = study_from_dict(SMALL | {"algorithm": ALGORITHMS[0], "audit": False}, source="test")
    run(study, place, evaluations=20)
    from pareto_monoped.storage.server.connection import SQLALCHEMY, creator

    storage = optuna.storages.RDBStorage(SQLALCHEMY, engine_kwargs={"creator": creator(place)})
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        stranger = optuna.load_study(study_name="s", storage=storage)
    stranger.tell(stranger.ask(), state=optuna.trial.TrialState.FAIL)
    storage.remove_session()
    storage.engine.dispose()
    resume(place, evaluations=60)
    assert status(place)["foreign"] == 1
    assert verify(place).foreign == (20,)
    assert repair(place) == (20,)
    run(study, tmp_path / "s.db", evaluations=20)
    resume(tmp_path / "s.db", evaluations=60)
    assert_same_study(tmp_path / "s.db", place)
    require_sound(place, verify(place))


@pytest.mark.parametrize(
    ("statement", "words"),
    [
        ("UPDATE {}.monoped_trials SET height_m = height_m + 1e-9 WHERE trial = 3", "trial 3 does not match its hash"),
        ("DELETE FROM {}.monoped_trials WHERE trial = 5", "1 trials are missing"),
        ("DROP TABLE {}.monoped_front", "lacks the table 'monoped_front'"),
        ("CREATE VIEW {}.v AS SELECT 1", "holds the view or trigger 'v'"),
        (
            "CREATE RULE r AS ON INSERT TO {}.monoped_trials DO INSTEAD NOTHING",
            "holds the view or trigger 'r'",
        ),
        ("UPDATE {}.monoped_meta SET value = '9' WHERE key = 'format'", "newer than this version's"),
    ],
)
def test_damage_is_found(cluster, place, statement, words):
    made_database(place)
    read_study(place)
    cluster.sql(statement.format(place.schema))
    with pytest.raises(Exception, match=words) as caught:
        read_study(place)
    assert type(caught.value).__name__ == "DatabaseError"


def test_damage_to_optunas_tables_is_found(cluster, place):
    made_database(place)
    sound = verify(place).findings
    cluster.sql(f"UPDATE {place.schema}.trial_values SET value = value + 1e-9 WHERE trial_id = 1")
    (found,) = set(verify(place).findings) - set(sound)
    assert "trial 0 has another value" in found


def test_a_reader_sees_one_moment(place):
    """What is added while a study is read comes to the next reader."""
    study, _ = made_database(place)
    with reading(place) as connection:
        before = connection.execute("SELECT count(*) FROM monoped_trials").fetchone()
        from pareto_monoped.storage.store import Store

        with Store(place, study) as store:
            store.add(made_generation(study, 2, 6, made_evaluations([0.9], [9.0]), state={"after": 2}))
        assert connection.execute("SELECT count(*) FROM monoped_trials").fetchone() == before == (6,)
    assert len(read_study(place).trials) == 7


def test_nothing_of_a_study_on_a_server_stands_in_a_file(tmp_path, place, monkeypatch):
    monkeypatch.chdir(tmp_path)
    made_database(place)
    read_study(place)
    assert list(tmp_path.iterdir()) == []


def test_run_names_the_schema_after_the_study(cluster):
    study = study_from_dict(SMALL | {"name": "Named So", "algorithm": ALGORITHMS[0], "audit": False}, source="test")
    summary = run(study, place_of(cluster.address()), evaluations=20)
    assert summary.db.schema == "named_so"
    assert len(read_study(summary.db).trials) == 20


def test_settings_of_a_user_change_no_number(cluster, tmp_path, place):
    """A role may round numbers and write dates in another style; our sessions do not."""
    cluster.sql("ALTER ROLE owner SET extra_float_digits = -5", "ALTER ROLE owner SET DateStyle = 'German'")
    try:
        made_database(tmp_path / "s.db")
        made_database(place)
        query = "SELECT * FROM monoped_trials ORDER BY trial"
        assert rows_of(place, query) == rows_of(tmp_path / "s.db", query)
        assert verify(place).findings == verify(tmp_path / "s.db").findings
    finally:
        cluster.sql("ALTER ROLE owner RESET ALL")
