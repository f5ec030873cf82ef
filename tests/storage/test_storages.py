"""What every storage must do: each test runs on a file of SQLite and on a schema of a PostgreSQL server."""

import os
from contextlib import closing
from functools import partial

import numpy as np
import optuna
import pytest

from pareto_monoped.analysis.verify import verify
from pareto_monoped.definition.study import study_from_dict
from pareto_monoped.design import NAMES, PAPER_NAMES
from pareto_monoped.errors import DatabaseError
from pareto_monoped.measures import MEASURE_NAMES
from pareto_monoped.storage.columns import LATER
from pareto_monoped.storage.front_reader import read_front
from pareto_monoped.storage.place import storage_of
from pareto_monoped.storage.reader import read_study
from pareto_monoped.storage.status import status
from pareto_monoped.storage.store import Store
from pareto_monoped.study.run import run
from tests.compute.dask_here import until
from tests.study.support import (
    UNSEALED,
    change,
    copied_database,
    made_database,
    made_evaluations,
    made_generation,
    made_study,
    reseal,
)


def one(number=2, first=6):
    """A generation of one trial, by default the one after those of ``made_database``."""
    return made_generation(made_study(), number, first, made_evaluations([0.75], [8.5]), state={"after": number})


def test_every_number_comes_back_to_the_last_bit(db):
    _, generations = made_database(db)
    trials = read_study(db).trials
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
def test_optuna_reads_what_was_stored(db, options, load):
    study, generations = made_database(db, **options)
    loaded = load()
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


def test_optunas_front_is_ours(db, load):
    copied_database(db)
    best = {trial.number for trial in load().best_trials}
    assert best == set(read_study(db).front()["trial"]) == {0, 3, 4}


@pytest.mark.parametrize("db", ["file", pytest.param("server", marks=pytest.mark.long)], indirect=True)
@pytest.mark.parametrize("options", [{}, {"known_schemas": ()}], ids=["direct", "by Optuna's public call"])
def test_optuna_has_the_objectives_of_the_study(db, options, load):
    names = ["mass_kg", "height_m", "electrical_energy_j"]
    _, generations = made_database(db, study=made_study(objectives=names), **options)
    loaded = load()
    assert [direction.name for direction in loaded.directions] == ["MINIMIZE", "MAXIMIZE", "MINIMIZE"]
    assert loaded.metric_names == names
    columns = [np.concatenate([getattr(g.evaluations, name) for g in generations]) for name in names]
    for trial, values in zip(loaded.trials, np.column_stack(columns).tolist(), strict=True):
        assert trial.values == (None if trial.state.name == "FAIL" else values)
    assert {trial.number for trial in loaded.best_trials} == set(read_study(db).front()["trial"])


def test_optuna_can_go_on_with_it(db, load):
    copied_database(db)
    loaded = load()
    loaded.optimize(lambda trial: (trial.suggest_float(NAMES[0], 0.3, 0.5), 1.0), n_trials=1)
    assert loaded.trials[-1].number == 6


def test_fixed_variables_are_stored_but_are_no_parameters(db, load):
    study = made_study(variables={"hip_ratio": 5.0})
    made_database(db, study=study)
    assert "hip_ratio" not in load().trials[0].params
    assert (read_study(db).trials["hip_ratio"] == 5.0).all()


def test_the_checkpoint_moves_with_whole_generations_only(db):
    study = made_study()
    made_database(db, [], study)
    part = made_evaluations([0.7, 0.8], [1.0, 2.0])
    with Store(db, study) as store:
        store.add(made_generation(study, 0, 0, part, state={"a": 1}))
        store.add(made_generation(study, 1, 2, part, state=None))
    data = read_study(db)
    assert (data.checkpoint.generation, data.checkpoint.evaluations, data.checkpoint.state) == (1, 2, {"a": 1})
    assert len(data.trials) == 4


def test_readers_see_whole_generations_while_it_grows(db, load):
    study = made_study()
    made_database(db, [], study)
    part = made_evaluations([0.7, 0.8], [1.0, 2.0])
    with Store(db, study) as store:
        for number in range(3):
            store.add(made_generation(study, number, 2 * number, part, state={}))
            assert len(read_study(db).trials) == len(load().trials) == 2 * (number + 1)


@pytest.mark.parametrize("db", ["file", pytest.param("server", marks=pytest.mark.long)], indirect=True)
@pytest.mark.parametrize("name", ["'; DROP TABLE trials; --", "<script>alert(1)</script>", "../../x\n\u202e\U0001f9bf"])
def test_names_are_text_and_nothing_else(db, name, load):
    made_database(db, study=made_study(name=name))
    assert read_study(db).study.name == name
    assert len(load(name).trials) == 6


def test_trials_that_optuna_wrote_before_a_kill_are_not_written_twice(db, load):
    """In the fall-back Optuna commits a trial at a time, so a kill can come between its rows and ours."""
    study = made_study()
    made_database(db, [], study)
    generation = made_generation(study, 0, 0, made_evaluations([0.7, 0.8, 0.9], [1.0, 2.0, 3.0]), state={})
    with Store(db, study, known_schemas=()) as store:
        store._optuna.add_by_optuna(generation)
    assert len(read_study(db).trials) == 0
    with Store(db, study, known_schemas=()) as store:
        store.add(generation)
    assert len(load().trials) == len(read_study(db).trials) == 3


def test_the_front_is_sorted_and_holds_feasible_trials_only(db):
    copied_database(db)
    front = read_study(db).front()
    assert front["trial"].tolist() == [4, 0, 3]
    assert front["height_m"].tolist() == [0.7, 0.8, 1.1]


def test_ill_conditioned_trials_leave_the_front_and_others_come_up(db):
    study = copied_database(db)
    with Store(db, study) as store:
        store.set_audits([(0, True, {"spread_height_m": 1e-5}), (3, False, {"spread_height_m": float("inf")})])
    data = read_study(db)
    # Trial 5, 0.9 m on 40 J, was dominated by trial 3, 1.1 m on 30 J.
    assert data.front()["trial"].tolist() == [4, 0, 5]
    assert data.front(include_ill_conditioned=True)["trial"].tolist() == [4, 0, 3]
    assert data.audits["spread_height_m"].tolist() == [1e-5, float("inf")]


def test_history_and_meta(db):
    copied_database(db)
    data = read_study(db)
    assert data.history["evaluations"].tolist() == [4, 6]
    assert data.history["hypervolume"].tolist() == [0.0, 1.0]
    assert data.wall_time_s == 1.5
    assert data.meta.finished is False
    assert data.reference_point.as_dict() == {"height_m": 0.55, "energy_j": 100.0}


def test_a_study_without_trials(db):
    made_database(db, [])
    data = read_study(db)
    assert len(data.trials) == len(data.history) == len(data.audits) == len(data.front()) == 0
    assert {"trial", "state", "hip_ratio", "height_m", "violation"} <= set(data.trials.columns)


def test_a_study_of_format_1_is_read_and_marked_and_never_sealed(db, sql):
    copied_database(db)
    sealed = read_study(db)
    sql(*UNSEALED)
    assert not read_study(db).sealed
    assert not read_front(db).sealed
    assert not status(db)["sealed"]
    assert read_study(db).trials.equals(sealed.trials)
    with pytest.raises(DatabaseError, match=r"is of version 0\.2\.0 or earlier, which is only read"):
        Store(db, made_study())
    assert not read_study(db).sealed


def test_a_study_gets_the_columns_that_came_later_when_it_is_opened_for_writing(tmp_path):
    path, last = tmp_path / "s.db", LATER[-1].name
    copied_database(path)
    before = read_study(path)
    change(path, f"ALTER TABLE monoped_trials DROP COLUMN {last}")
    reseal(path)
    with Store(path, made_study()) as store:
        store.add(made_generation(made_study(), 2, 6, made_evaluations([0.75], [8.5]), state={"after": 2}))
    after = read_study(path)
    assert after.trials[:6].equals(before.trials)
    assert len(after.trials) == 7


@pytest.mark.parametrize("kept", range(4))
def test_a_study_cannot_be_made_one_of_an_earlier_version_to_hide_an_edit(db, sql, kept):
    """Each of the statements is left out once, and once none that touches the version."""
    copied_database(db)
    sql("UPDATE monoped_trials SET height_m = 2.0 WHERE trial = 3")
    sql(*(statement for k, statement in enumerate(UNSEALED) if k != kept))
    for reader in (read_study, read_front, status, partial(Store, study=made_study())):
        with pytest.raises(DatabaseError, match="is damaged"):
            reader(db)


def test_trials_of_a_study_of_format_1_are_numbered_from_0_on(db, sql):
    copied_database(db)
    sql(*UNSEALED, "DELETE FROM monoped_trials WHERE trial = 2")
    for reader in (read_study, read_front, status):
        with pytest.raises(DatabaseError, match="trial 3 stands in place 2, where trial 2 must be"):
            reader(db)


def test_a_transaction_that_fails_leaves_no_link(db):
    study = copied_database(db)
    one = made_evaluations([0.75], [8.5])
    with Store(db, study) as store:
        with pytest.raises(DatabaseError):
            store.add(made_generation(study, 2, 5, one, state={}))  # trial 5 is there already
        store.add(made_generation(study, 2, 6, one, state={}))
    assert len(read_study(db).trials) == 7


def test_there_is_nothing_before_a_study_is_made(db):
    storage = storage_of(db)
    assert storage.is_vacant()
    with pytest.raises(DatabaseError, match=r"no such (file|study on the server); check the \w+, or run a study first"):
        read_study(db)
    made_database(db)
    assert not storage.is_vacant()


def test_a_study_is_never_replaced(db):
    copied_database(db)
    with pytest.raises(DatabaseError, match="another program has filled it meanwhile"):
        made_database(db)
    assert len(read_study(db).trials) == 6


def test_a_creation_that_fails_leaves_nothing_and_can_be_repeated(db, tmp_path, request, monkeypatch):
    def broken(*_):
        raise RuntimeError("in between")

    with monkeypatch.context() as patch:
        patch.setattr("pareto_monoped.storage.store.study_digests", broken)
        with pytest.raises(RuntimeError, match="in between"):
            made_database(db)
    assert list(tmp_path.iterdir()) == []
    if hasattr(db, "schema"):
        schemas = request.getfixturevalue("cluster").sql("SELECT nspname FROM pg_namespace")
        assert [name for (name,) in schemas if name.startswith(db.schema)] == []
    copied_database(db)
    assert len(read_study(db).trials) == 6


def test_one_process_at_a_time_runs_a_study(db, monkeypatch):
    """A second one is refused and told who runs; other studies go their own way, and an error frees the lock."""
    copied_database(db)
    storage = storage_of(db)
    assert storage.holder() is None
    with storage.locked():
        assert storage.holder() == os.getpid()
        words = rf"is being run by process {os.getpid()}\b.*another (schema|database file)"
        with monkeypatch.context() as patch:
            patch.setattr("pareto_monoped.storage.server._WAIT_S", 0.1)
            with pytest.raises(DatabaseError, match=words), storage_of(db).locked():
                pass
        other = db.of_schema("another") if hasattr(db, "schema") else db.with_name("another.db")
        with storage_of(other).locked():
            pass
    # A server frees a lock a moment after its session has ended, and whoever wants the lock waits for that.
    until(lambda: storage.holder() is None)
    with pytest.raises(RuntimeError), storage.locked():
        raise RuntimeError
    until(lambda: storage.holder() is None)


def write_without_waiting(db):
    """Begin to write; only SQLite comes as far as being told not to wait."""
    with storage_of(db).translated(), closing(storage_of(db).connect()) as second:
        second.execute("PRAGMA busy_timeout = 100")
        with second.transaction():
            pass


def test_one_connection_at_a_time_writes(db, monkeypatch):
    study = copied_database(db)
    with Store(db, study) as store:
        monkeypatch.setattr("pareto_monoped.storage.server._WAIT_S", 0.1)
        with (
            store._connection.transaction(),
            pytest.raises(DatabaseError, match=r"is locked by an|is being run by"),
        ):
            write_without_waiting(db)
        store.add(one())
    assert len(read_study(db).trials) == 7


def test_a_reader_sees_one_moment(db):
    """What is added while a study is read comes to the next reader."""
    study = copied_database(db)
    with Store(db, study) as store:
        with storage_of(db).reading() as connection:
            before = connection.execute("SELECT count(*) FROM monoped_trials").fetchone()
            store.add(one())
            assert connection.execute("SELECT count(*) FROM monoped_trials").fetchone() == before == (6,)
        assert len(read_study(db).trials) == 7


def test_a_reader_cannot_write(db):
    copied_database(db)
    storage = storage_of(db)
    with pytest.raises(DatabaseError, match="is read-only"), storage.reading() as connection:
        connection.execute("DELETE FROM monoped_trials")
    optunas = storage.optuna_storage(read_only=True)
    (study,) = optunas.get_all_studies()
    assert optunas.get_n_trials(study._study_id) == 6
    with pytest.raises(optuna.exceptions.StorageInternalError) as caught:
        optunas.set_study_user_attr(study._study_id, "note", "x")
    assert "read" in str(caught.value.__cause__)
    optunas.remove_session()
    optunas.engine.dispose()
    assert len(read_study(db).trials) == 6


def test_rows_of_the_same_key_are_replaced(db):
    study = copied_database(db)
    with Store(db, study) as store:
        store.set_audits([(0, True, {"spread_height_m": 0.5}), (1, True, {"spread_height_m": 0.25})])
        store.set_audits([(1, True, {"spread_height_m": 0.125})])
    assert read_study(db).audits["spread_height_m"].tolist() == [0.5, 0.125]


@pytest.mark.parametrize(
    ("statement", "words"),
    [
        ("UPDATE monoped_meta SET value = '{' WHERE key = 'study'", "is damaged"),
        ("DELETE FROM monoped_meta WHERE key = 'study'", "is damaged"),
        ("UPDATE monoped_meta SET value = '[1]' WHERE key = 'study'", "is damaged"),
        ("DELETE FROM monoped_checkpoint", "is damaged"),
        ("UPDATE monoped_checkpoint SET state = 'x'", "is damaged"),
        ("ALTER TABLE monoped_trials DROP COLUMN energy_j", "damaged"),
        ("INSERT INTO monoped_audits VALUES (1, 1, 'x')", "is damaged"),
        ("UPDATE monoped_trials SET height_m = height_m + 1e-9 WHERE trial = 3", "trial 3 does not match its hash"),
        ("DELETE FROM monoped_trials WHERE trial = 5", "1 trials are missing"),
        ("DROP TABLE monoped_front", "lacks the table 'monoped_front'"),
        ("ALTER TABLE trials RENAME TO birds", "is not a study database, it lacks the table 'trials'"),
        ("CREATE VIEW v AS SELECT 1", "holds the view or trigger 'v'"),
        ("UPDATE monoped_meta SET value = '9' WHERE key = 'format'", "newer than this version's"),
    ],
)
@pytest.mark.parametrize("db", ["file", pytest.param("server", marks=pytest.mark.long)], indirect=True)
def test_damage_is_found_by_readers(db, sql, statement, words):
    copied_database(db)
    read_study(db)
    sql(statement)
    with pytest.raises(DatabaseError) as caught:
        read_study(db)
    assert words in str(caught.value)
    assert "\n" not in str(caught.value)


def test_damage_to_optunas_tables_is_found(db, sql):
    copied_database(db)
    sound = verify(db).findings
    sql("UPDATE trial_values SET value = value + 1e-9 WHERE trial_id = 1")
    (found,) = set(verify(db).findings) - set(sound)
    assert "trial 0 has another value" in found


def test_a_finished_study_is_at_rest(db):
    settings = {"name": "s", "evaluations": 10, "audit": False, "algorithm": {"name": "random", "population": 5}}
    assert run(study_from_dict(settings, source="test"), db, workers=1).new_evaluations == 10
    assert storage_of(db).is_at_rest()
    assert (status(db)["state"], status(db)["process"]) == ("finished", None)
