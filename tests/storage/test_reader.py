import sqlite3

import pandas as pd
import pytest

from pareto_monoped.errors import DatabaseError
from pareto_monoped.storage import reader, seals
from pareto_monoped.storage.reader import read_study
from pareto_monoped.storage.store import Store
from tests.study.support import made_database


def test_the_front_is_sorted_and_holds_feasible_trials_only(tmp_path):
    made_database(tmp_path / "s.db")
    front = read_study(tmp_path / "s.db").front()
    assert front["trial"].tolist() == [4, 0, 3]
    assert front["height_m"].tolist() == [0.7, 0.8, 1.1]


def test_ill_conditioned_trials_leave_the_front_and_others_come_up(tmp_path):
    path = tmp_path / "s.db"
    study, _ = made_database(path)
    with Store(path, study) as store:
        store.set_audits([(0, True, {"spread_height_m": 1e-5}), (3, False, {"spread_height_m": float("inf")})])
    data = read_study(path)
    # Trial 5, 0.9 m on 40 J, was dominated by trial 3, 1.1 m on 30 J.
    assert data.front()["trial"].tolist() == [4, 0, 5]
    assert data.front(include_ill_conditioned=True)["trial"].tolist() == [4, 0, 3]
    assert data.audits["spread_height_m"].tolist() == [1e-5, float("inf")]


def test_history_and_meta(tmp_path):
    made_database(tmp_path / "s.db")
    data = read_study(tmp_path / "s.db")
    assert data.history["evaluations"].tolist() == [4, 6]
    assert data.history["hypervolume"].tolist() == [0.0, 1.0]
    assert data.wall_time_s == 1.5
    assert data.meta.finished is False
    assert data.reference_point.as_dict() == {"height_m": 0.55, "energy_j": 100.0}


def test_a_study_without_trials(tmp_path):
    made_database(tmp_path / "s.db", [])
    data = read_study(tmp_path / "s.db")
    assert len(data.trials) == len(data.history) == len(data.audits) == len(data.front()) == 0
    assert {"trial", "state", "hip_ratio", "height_m", "violation"} <= set(data.trials.columns)


def test_trials_are_the_same_however_many_are_read_at_once(tmp_path, monkeypatch):
    """A million trials needed eight times their size while they were read and checked in one piece."""
    made_database(tmp_path / "s.db")
    whole = read_study(tmp_path / "s.db").trials
    monkeypatch.setattr(reader, "_BLOCK", 2)
    monkeypatch.setattr(seals, "_BLOCK", 2)
    blocks = read_study(tmp_path / "s.db").trials
    assert len(blocks) == 6
    pd.testing.assert_frame_equal(blocks, whole)


@pytest.mark.parametrize(
    "statement",
    [
        "UPDATE monoped_meta SET value = '{' WHERE key = 'study'",
        "DELETE FROM monoped_meta WHERE key = 'study'",
        "UPDATE monoped_meta SET value = '[1]' WHERE key = 'study'",
        "DELETE FROM monoped_checkpoint",
        "UPDATE monoped_checkpoint SET state = 'x'",
        "UPDATE monoped_trials SET height_m = 'high'",
        "UPDATE monoped_trials SET energy_j = x'80049500'",
        "ALTER TABLE monoped_trials DROP COLUMN energy_j",
        "INSERT INTO monoped_audits VALUES (1, 1, 'x')",
        "UPDATE monoped_history SET seconds = 'long'",
    ],
)
def test_damaged_contents_are_said_to_be_damaged(tmp_path, statement):
    path = tmp_path / "s.db"
    made_database(path)
    connection = sqlite3.connect(path)
    connection.execute(statement)
    connection.commit()
    connection.close()
    with pytest.raises(DatabaseError, match="damaged"):
        read_study(path)


def test_settings_that_a_stranger_bent_are_refused_like_a_bad_file(tmp_path):
    path = tmp_path / "s.db"
    made_database(path)
    connection = sqlite3.connect(path)
    connection.execute("UPDATE monoped_meta SET value = json_set(value, '$.seed', -1) WHERE key = 'study'")
    connection.commit()
    connection.close()
    with pytest.raises(Exception, match="seed = -1") as caught:
        read_study(path)
    assert caught.value.exit_code == 2
