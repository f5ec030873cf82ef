"""Trials that an Optuna user adds to a study, before, between and while generations are stored."""

import pytest

from pareto_monoped.analysis.verify import verify
from pareto_monoped.definition.study import study_from_dict
from pareto_monoped.errors import DatabaseError
from pareto_monoped.storage.front_reader import read_front
from pareto_monoped.storage.optuna_check import repair
from pareto_monoped.storage.reader import read_study
from pareto_monoped.storage.status import status
from pareto_monoped.storage.store import Store
from pareto_monoped.study.run import resume, run
from tests.study.support import copied_database, made_database, made_evaluations, made_generation, made_study


def ask_and_tell(load, values=None, name="made"):
    """One trial as a user adds it; it stays running without values."""
    study = load(name)
    trial = study.ask()
    trial.suggest_float("hip_ratio", 4.0, 8.7)
    if values is not None:
        study.tell(trial, values)
    return trial.number


@pytest.fixture
def mixed(db, load):
    """Six trials of ours, one foreign, one of ours, one foreign while we are at work, one of ours, one foreign."""
    study = made_study()
    copied_database(db)
    foreign = [ask_and_tell(load)]
    one = made_evaluations([0.75], [8.5])
    with Store(db, study) as store:
        store.add(made_generation(study, 2, 6, one, state={"after": 2}))
        foreign.append(ask_and_tell(load, [9.0, 0.1]))
        store.add(made_generation(study, 3, 7, made_evaluations([0.74], [8.6]), state={"after": 3}))
    foreign.append(ask_and_tell(load, [5.0, 0.2]))
    return foreign


def test_a_study_keeps_its_own_numbers(mixed, db, load):
    foreign = mixed
    assert read_study(db).trials["trial"].tolist() == list(range(8))
    assert foreign == [6, 8, 10]
    assert [trial.number for trial in load().trials] == list(range(11))
    assert set(read_front(db).rows["trial"]) <= set(range(8))
    assert read_front(db).foreign == status(db)["foreign"] == 3
    result = verify(db)
    assert result.foreign == (6, 8, 10)
    assert [line for line in result.findings if "Optuna" in line] == []


def test_repair_drops_them_and_nothing_else(mixed, db, load):
    foreign = mixed
    before = read_study(db)
    assert 8 in {trial.number for trial in load().best_trials}
    assert repair(db) == tuple(foreign)
    after = read_study(db)
    assert after.trials.equals(before.trials)
    assert after.front().equals(before.front())
    result = verify(db)
    assert result.foreign == ()
    assert [line for line in result.findings if "Optuna" in line] == []
    loaded = load()
    assert [trial.number for trial in loaded.trials] == list(range(8))
    assert {trial.number for trial in loaded.best_trials} == set(after.front()["trial"])
    assert repair(db) == ()
    study = made_study()
    with Store(db, study) as store:
        store.add(made_generation(study, 4, 8, made_evaluations([0.75], [8.5]), state={}))
    assert [trial.number for trial in load().trials] == list(range(9))


def test_repair_does_not_bless_damage(mixed, db, sql):
    sql("UPDATE trial_values SET value = value + 1.0 WHERE trial_id = 1")
    stored = sql("SELECT * FROM trials ORDER BY trial_id")
    with pytest.raises(DatabaseError, match=r"cannot be repaired \(trial 0 has another value"):
        repair(db)
    assert sql("SELECT * FROM trials ORDER BY trial_id") == stored


@pytest.mark.parametrize("db", ["file", pytest.param("server", marks=pytest.mark.long)], indirect=True)
def test_when_optuna_writes_for_us(db, load):
    """In the fall-back, too, our trials are told from others by their number, not by their place."""
    study = made_study()
    made_database(db, known_schemas=())
    ask_and_tell(load, [9.0, 0.1])
    generation = made_generation(study, 2, 6, made_evaluations([0.75, 0.76], [8.5, 8.6]), state={})
    with Store(db, study, known_schemas=()) as store:
        store._optuna.add_by_optuna(generation)
        store.add(generation)
    assert len(load().trials) == 9
    assert len(read_study(db).trials) == 8


def optunas(findings):
    return [line for line in findings if "Optuna" in line]


@pytest.mark.parametrize("db", ["file", pytest.param("server", marks=pytest.mark.long)], indirect=True)
def test_a_study_that_changes_to_optunas_own_calls_is_verified_and_repaired(db, load, sql):
    """A later Optuna may bring another schema: generations before are written directly, those after by Optuna.

    Foreign trials stand before, between and after ours; every trial of ours is still found in Optuna's tables.
    """
    study = made_study()
    copied_database(db)
    foreign = [ask_and_tell(load, [9.0, 0.1])]
    two = made_evaluations([0.75, 0.76], [8.5, 8.6])
    with Store(db, study, known_schemas=()) as store:
        store.add(made_generation(study, 2, 6, two, state={}))
        foreign.append(ask_and_tell(load))
        store.add(made_generation(study, 3, 8, two, state={}))
    with Store(db, study) as store:
        store.add(made_generation(study, 4, 10, two, state={}))
    foreign.append(ask_and_tell(load))
    result = verify(db)
    assert result.foreign == tuple(foreign) == (6, 9, 14)
    assert optunas(result.findings) == []
    before = read_study(db)
    assert repair(db) == (6, 9, 14)
    after = verify(db)
    assert after.foreign == ()
    assert optunas(after.findings) == []
    assert read_study(db).trials.equals(before.trials)
    assert [trial.number for trial in load().trials] == list(range(12))
    sql("UPDATE trial_values SET value = 8.7 WHERE value = 8.6")
    assert optunas(verify(db).findings) != []


@pytest.mark.parametrize("db", ["file", pytest.param("server", marks=pytest.mark.long)], indirect=True)
def test_a_run_goes_on_as_without_them(db, load, tmp_path):
    study = study_from_dict(
        {"name": "f", "evaluations": 20, "audit": False, "algorithm": {"name": "nsga2", "population": 10}},
        source="test",
    )
    run(study, tmp_path / "whole.db", workers=1)
    run(study, db, workers=1, evaluations=10)
    ask_and_tell(load, [3.0, 0.5], "f")
    said = []
    resume(db, evaluations=20, workers=1, notify=said.append)
    assert any("1 of Optuna's trials is not of this package" in line for line in said)
    assert read_study(db).trials.equals(read_study(tmp_path / "whole.db").trials)
