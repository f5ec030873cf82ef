"""Trials that an Optuna user adds to a study, before, between and while generations are stored."""

import optuna
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
from tests.study.support import change, made_database, made_evaluations, made_generation, made_study


def load(path, name="made"):
    optuna.logging.set_verbosity(optuna.logging.WARNING)
    return optuna.load_study(study_name=name, storage=f"sqlite:///{path}")


def ask_and_tell(path, values=None, name="made"):
    """One trial as a user adds it; it stays running without values."""
    study = load(path, name)
    trial = study.ask()
    trial.suggest_float("hip_ratio", 4.0, 8.7)
    if values is not None:
        study.tell(trial, values)
    return trial.number


@pytest.fixture
def mixed(tmp_path):
    """Six trials of ours, one foreign, one of ours, one foreign while we are at work, one of ours, one foreign."""
    path, study = tmp_path / "s.db", made_study()
    made_database(path)
    foreign = [ask_and_tell(path)]
    one = made_evaluations([0.75], [8.5])
    with Store(path, study) as store:
        store.add(made_generation(study, 2, 6, one, state={"after": 2}))
        foreign.append(ask_and_tell(path, [9.0, 0.1]))
        store.add(made_generation(study, 3, 7, made_evaluations([0.74], [8.6]), state={"after": 3}))
    foreign.append(ask_and_tell(path, [5.0, 0.2]))
    return path, foreign


def test_a_study_keeps_its_own_numbers(mixed):
    path, foreign = mixed
    assert read_study(path).trials["trial"].tolist() == list(range(8))
    assert foreign == [6, 8, 10]
    assert [trial.number for trial in load(path).trials] == list(range(11))
    assert set(read_front(path).rows["trial"]) <= set(range(8))
    assert read_front(path).foreign == status(path)["foreign"] == 3
    result = verify(path)
    assert result.foreign == (6, 8, 10)
    assert [line for line in result.findings if "Optuna" in line] == []


def test_repair_drops_them_and_nothing_else(mixed):
    path, foreign = mixed
    before = read_study(path)
    assert 8 in {trial.number for trial in load(path).best_trials}
    assert repair(path) == tuple(foreign)
    after = read_study(path)
    assert after.trials.equals(before.trials)
    assert after.front().equals(before.front())
    result = verify(path)
    assert result.foreign == ()
    assert [line for line in result.findings if "Optuna" in line] == []
    loaded = load(path)
    assert [trial.number for trial in loaded.trials] == list(range(8))
    assert {trial.number for trial in loaded.best_trials} == set(after.front()["trial"])
    assert repair(path) == ()
    study = made_study()
    with Store(path, study) as store:
        store.add(made_generation(study, 4, 8, made_evaluations([0.75], [8.5]), state={}))
    assert [trial.number for trial in load(path).trials] == list(range(9))


def test_repair_does_not_bless_damage(mixed):
    path, _ = mixed
    change(path, "UPDATE trial_values SET value = value + 1.0 WHERE trial_id = 1")
    stored = path.read_bytes()
    with pytest.raises(DatabaseError, match=r"cannot be repaired \(trial 0 has another value"):
        repair(path)
    assert path.read_bytes() == stored


def test_when_optuna_writes_for_us(tmp_path):
    """In the fall-back, too, our trials are told from others by their number, not by their place."""
    path, study = tmp_path / "s.db", made_study()
    made_database(path, known_schemas=())
    ask_and_tell(path, [9.0, 0.1])
    generation = made_generation(study, 2, 6, made_evaluations([0.75, 0.76], [8.5, 8.6]), state={})
    with Store(path, study, known_schemas=()) as store:
        store._optuna.add_by_optuna(generation)
        store.add(generation)
    assert len(load(path).trials) == 9
    assert len(read_study(path).trials) == 8


def optunas(findings):
    return [line for line in findings if "Optuna" in line]


def test_a_study_that_changes_to_optunas_own_calls_is_verified_and_repaired(tmp_path):
    """A later Optuna may bring another schema: generations before are written directly, those after by Optuna.

    Foreign trials stand before, between and after ours; every trial of ours is still found in Optuna's tables.
    """
    path, study = tmp_path / "s.db", made_study()
    made_database(path)
    foreign = [ask_and_tell(path, [9.0, 0.1])]
    two = made_evaluations([0.75, 0.76], [8.5, 8.6])
    with Store(path, study, known_schemas=()) as store:
        store.add(made_generation(study, 2, 6, two, state={}))
        foreign.append(ask_and_tell(path))
        store.add(made_generation(study, 3, 8, two, state={}))
    with Store(path, study) as store:
        store.add(made_generation(study, 4, 10, two, state={}))
    foreign.append(ask_and_tell(path))
    result = verify(path)
    assert result.foreign == tuple(foreign) == (6, 9, 14)
    assert optunas(result.findings) == []
    before = read_study(path)
    assert repair(path) == (6, 9, 14)
    after = verify(path)
    assert after.foreign == ()
    assert optunas(after.findings) == []
    assert read_study(path).trials.equals(before.trials)
    assert [trial.number for trial in load(path).trials] == list(range(12))
    change(path, "UPDATE trial_values SET value = 8.7 WHERE value = 8.6")
    assert optunas(verify(path).findings) != []


def test_a_run_goes_on_as_without_them(tmp_path):
    study = study_from_dict(
        {"name": "f", "evaluations": 40, "audit": False, "algorithm": {"name": "nsga2", "population": 20}},
        source="test",
    )
    run(study, tmp_path / "whole.db", workers=1)
    run(study, tmp_path / "s.db", workers=1, evaluations=20)
    ask_and_tell(tmp_path / "s.db", [3.0, 0.5], "f")
    said = []
    resume(tmp_path / "s.db", evaluations=40, workers=1, notify=said.append)
    assert any("1 of Optuna's trials is not of this package" in line for line in said)
    assert read_study(tmp_path / "s.db").trials.equals(read_study(tmp_path / "whole.db").trials)
