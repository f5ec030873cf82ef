"""Studies of earlier versions have no running hash: a damaged history must end in one line there, too."""

import shutil
import sqlite3
from pathlib import Path

import pytest

from pareto_monoped.errors import DatabaseError
from pareto_monoped.report.page import payload_of

STORED = Path(__file__).parents[1] / "storage" / "data" / "plain.db"


@pytest.mark.parametrize(
    ("column", "value"),
    [("hypervolume", float("inf")), ("seconds", float("inf")), ("hypervolume", "abc"), ("seconds", "never")],
)
def test_a_damaged_history_is_told_in_one_line(tmp_path, column, value):
    db = tmp_path / "damaged.db"
    shutil.copy(STORED, db)
    connection = sqlite3.connect(db)
    connection.execute(f"UPDATE monoped_history SET {column} = ? WHERE generation = 1", (value,))
    connection.commit()
    connection.close()
    with pytest.raises(DatabaseError, match="is damaged") as caught:
        payload_of([db], most_jumps=0)
    assert "\n" not in str(caught.value)
