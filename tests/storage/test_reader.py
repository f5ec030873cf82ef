import sqlite3

import pandas as pd
import pytest

from pareto_monoped.errors import DatabaseError
from pareto_monoped.storage import reader
from pareto_monoped.storage.reader import read_study
from tests.study.support import copied_database


def test_trials_are_the_same_however_many_are_read_at_once(tmp_path, monkeypatch):
    """A million trials needed eight times their size while they were read and checked in one piece."""
    copied_database(tmp_path / "s.db")
    whole = read_study(tmp_path / "s.db").trials
    monkeypatch.setattr(reader, "_BLOCK", 2)
    blocks = read_study(tmp_path / "s.db").trials
    assert len(blocks) == 6
    pd.testing.assert_frame_equal(blocks, whole)


@pytest.mark.parametrize(
    "statement",
    [
        "UPDATE monoped_trials SET height_m = 'high'",
        "UPDATE monoped_trials SET energy_j = x'80049500'",
        "UPDATE monoped_history SET seconds = 'long'",
    ],
)
def test_values_of_another_type_are_said_to_be_damaged(tmp_path, statement):
    path = tmp_path / "s.db"
    copied_database(path)
    connection = sqlite3.connect(path)
    connection.execute(statement)
    connection.commit()
    connection.close()
    with pytest.raises(DatabaseError, match="damaged"):
        read_study(path)


def test_settings_that_a_stranger_bent_are_refused_like_a_bad_file(tmp_path):
    path = tmp_path / "s.db"
    copied_database(path)
    connection = sqlite3.connect(path)
    connection.execute("UPDATE monoped_meta SET value = json_set(value, '$.seed', -1) WHERE key = 'study'")
    connection.commit()
    connection.close()
    with pytest.raises(Exception, match="seed = -1") as caught:
        read_study(path)
    assert caught.value.exit_code == 2
