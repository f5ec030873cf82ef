"""``verify`` finds what the running hash alone does not: Optuna's tables, impossible values, jumps that differ."""

import sqlite3
from contextlib import closing

import pytest

from pareto_monoped.analysis.verify import require_sound, verify
from pareto_monoped.definition.study import study_from_dict
from pareto_monoped.errors import DatabaseError, StudyError
from pareto_monoped.storage.file import FileConnection
from pareto_monoped.storage.optuna_tables import stored_digest, trial_ids
from pareto_monoped.storage.reader import read_study
from pareto_monoped.storage.store import Store
from pareto_monoped.study.run import run
from tests.study.support import UNSEALED, change, reseal

STUDY = study_from_dict(
    {"name": "v", "evaluations": 60, "audit": False, "algorithm": {"name": "nsga2", "population": 20}}, source="test"
)


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    path = tmp_path_factory.mktemp("verify") / "s.db"
    run(STUDY, path, workers=1, evaluations=50)
    return path


@pytest.fixture
def path(whole, tmp_path):
    copy = tmp_path / "s.db"
    copy.write_bytes(whole.read_bytes())
    return copy


def test_a_sound_study(path):
    result = verify(path, simulate=9)
    assert (result.trials, result.sealed, result.simulated) == (50, True, 9)
    assert result.findings == result.foreign == ()
    require_sound(path, result)


def test_rows_of_a_generation_are_found_by_their_keys(path):
    """Optuna has no index of numbers: each generation read all tables, three minutes for 100,000 trials."""
    statements = []
    with closing(sqlite3.connect(path, factory=FileConnection)) as connection:
        ids = trial_ids(connection)
        connection.set_trace_callback(statements.append)
        stored_digest(connection, [ids[number] for number in range(20, 40)])
        connection.set_trace_callback(None)
        plans = [connection.execute(f"EXPLAIN QUERY PLAN {text}").fetchall() for text in statements]
    assert len(plans) == 5
    assert [step for plan in plans for *_, step in plan if step.startswith("SCAN")] == []


@pytest.mark.parametrize(
    ("statement", "words"),
    [
        ("UPDATE trials SET state = 'FAIL' WHERE number = 7", "trial 7 is FAIL in Optuna's tables"),
        ("DELETE FROM trials WHERE number = 7", "trial 7 is missing in Optuna's tables"),
        ("UPDATE trial_values SET value = value + 1e-9 WHERE trial_id = 9", "trial 8 has another value 0"),
        ("DELETE FROM trial_values WHERE trial_id = 9 AND objective = 1", "trial 8 lacks a value"),
        ("UPDATE trial_params SET param_value = 5.5 WHERE trial_id = 3", "trial 2 has another parameter"),
        ("DELETE FROM trial_params WHERE trial_id = 3 AND param_name = 'knee_ratio'", "trial 2 lacks a parameter"),
        ("UPDATE trial_params SET distribution_json = '{}' WHERE trial_id = 3", "trials 0 to 19 do not match"),
        ("UPDATE trials SET datetime_start = '2001-01-01 00:00:00' WHERE number = 45", "trials 40 to 49 do not match"),
        ("UPDATE trial_system_attributes SET value_json = '[0.0]' WHERE trial_id = 30", "trials 20 to 39 do not match"),
        ("UPDATE studies SET study_name = 'w'", "Optuna's name of the study is 'w', ours 'v'"),
        ("UPDATE study_directions SET direction = 'MINIMIZE'", "Optuna's directions"),
        ("UPDATE version_info SET library_version = '5.0.9'", "Optuna's version_info does not match its hash"),
        ("UPDATE alembic_version SET version_num = 'v3.2.0.q'", "Optuna's alembic_version does not match its hash"),
        (
            "UPDATE study_user_attributes SET value_json = upper(value_json) WHERE key = 'hash'",
            "Optuna's study_user_attributes hash does not match its hash",
        ),
        ("DELETE FROM study_system_attributes", "Optuna's study_system_attributes study:metric_names is missing"),
    ],
)
def test_optunas_tables_must_be_ours(path, statement, words):
    change(path, statement)
    result = verify(path)
    assert any(words in line for line in result.findings), result.findings
    with pytest.raises(DatabaseError, match="restore a copy"):
        require_sound(path, result)


def test_what_optuna_and_its_users_may_change_is_no_damage(path):
    """An upgrade of Optuna's tables changes both of its versions; the dashboard keeps notes as attributes."""
    change(
        path,
        "UPDATE version_info SET library_version = '6.0.0'",
        "UPDATE alembic_version SET version_num = 'v6.0.0.a'",
        "INSERT INTO study_user_attributes (study_id, key, value_json) VALUES (1, 'note', '1')",
        "INSERT INTO study_system_attributes (study_id, key, value_json) VALUES (1, 'dashboard:note_ver', '1')",
    )
    assert verify(path).findings == ()


PARAM = "trial_id, param_name, param_value, distribution_json"
FEASIBLE = "(SELECT min(trial) FROM monoped_trials WHERE state = 'feasible')"


@pytest.mark.parametrize(
    ("statement", "words"),
    [
        (f"UPDATE monoped_trials SET height_m = NULL WHERE trial = {FEASIBLE}", "its height_m is no finite number"),
        (f"UPDATE monoped_trials SET height_m = 9e999 WHERE trial = {FEASIBLE}", "its height_m is no finite number"),
        (f"UPDATE monoped_trials SET height_m = 50 WHERE trial = {FEASIBLE}", "has a height_m above 10"),
        (f"UPDATE monoped_trials SET energy_j = -5 WHERE trial = {FEASIBLE}", "its energy_j is negative"),
        (f"UPDATE monoped_trials SET height_m = -0.5 WHERE trial = {FEASIBLE}", "its height_m is negative"),
        (f"UPDATE monoped_trials SET electrical_energy_j = -5 WHERE trial = {FEASIBLE}", "electrical_energy_j is neg"),
        ("UPDATE monoped_trials SET state = 'good' WHERE trial = 6", "trial 6 has an unknown state"),
        ("UPDATE monoped_trials SET generation = 7 WHERE trial = 6", "trial 7 has an impossible generation"),
        ("UPDATE monoped_trials SET shank_length_m = 3 WHERE trial = 6", "trial 6 has a shank_length_m beyond"),
        ("UPDATE monoped_trials SET violation = 0.5", "has an impossible violation"),
        ("UPDATE monoped_checkpoint SET told = 100000", "its checkpoint stands before generation 2 with 100000"),
        ("UPDATE monoped_checkpoint SET generation = -3", "its checkpoint stands before generation -3"),
        ("UPDATE monoped_history SET hypervolume = -1 WHERE generation = 1", "a hypervolume that is negative or"),
        ("UPDATE monoped_history SET seconds = 0 WHERE generation = 1", "seconds that go back"),
        ("DELETE FROM monoped_history WHERE generation = 2", "does not lead to 50 trials"),
        ("UPDATE monoped_history SET generation = 9 WHERE generation = 2", "does not count generations from 0 on"),
        ("INSERT INTO monoped_audits VALUES (77, 1, '{}')", "audit of trial 77"),
        (
            f"INSERT INTO trial_params ({PARAM}) SELECT {PARAM} FROM trial_params LIMIT 1",
            "a parameter in Optuna's tables",
        ),
    ],
)
def test_impossible_values_are_found_without_a_hash(path, statement, words):
    change(path, *UNSEALED, statement)
    result = verify(path)
    assert any(words in line for line in result.findings), result.findings


@pytest.mark.parametrize("column", ["hypervolume", "seconds"])
def test_an_infinite_number_of_the_history_is_refused_when_read(path, column):
    change(path, *UNSEALED, f"UPDATE monoped_history SET {column} = 9e999 WHERE generation = 1")
    for read in (verify, read_study):
        with pytest.raises(DatabaseError, match="history is not finite"):
            read(path)


def test_a_measure_that_came_after_the_first_trials_is_not_missed_in_them(path):
    """A study of an earlier version that goes on has it in its later trials only."""
    change(path, "UPDATE monoped_trials SET rise_m = NULL WHERE trial < 8")
    reseal(path)
    assert verify(path, simulate=100).findings == ()
    change(path, "UPDATE monoped_trials SET rise_m = NULL WHERE trial = 11")
    reseal(path)
    (found,) = verify(path, simulate=100).findings
    assert found.startswith("trial 11 jumps otherwise: its rise_m is nan, again ")


def test_jumps_are_not_compared_by_code_or_a_machine_that_would_compute_others(path):
    data = read_study(path)
    probe = data.meta.probe
    probe[0][0] += 1e-15
    with Store(path, data.study) as store:
        store.set_meta({"probe": probe})
    with pytest.raises(StudyError, match="began with other results: height and energy of the probe designs"):
        verify(path, simulate=1)


def test_a_jump_that_differs_is_found(path):
    """Values that look right, in Optuna's tables too; of 50 trials, 50 are simulated again."""
    data = read_study(path)
    behind = data.trials[(data.trials["state"] == "feasible") & ~data.trials["trial"].isin(data.front()["trial"])]
    trial = int(behind["trial"].iloc[0])
    change(
        path,
        f"UPDATE monoped_trials SET energy_j = energy_j * 1.001 WHERE trial = {trial}",
        f"UPDATE trial_values SET value = value * 1.001 WHERE trial_id = {trial + 1} AND objective = 1",
    )
    reseal(path)
    assert verify(path).findings == ()
    (found,) = verify(path, simulate=100).findings
    assert found.startswith(f"trial {trial} jumps otherwise: its energy_j is ")
    assert "np." not in found
