import sqlite3
from pathlib import Path

from pareto_monoped.design import NAMES
from pareto_monoped.measures import MEASURE_NAMES
from pareto_monoped.storage.columns import COLUMNS, LATER, REQUIRED
from pareto_monoped.storage.reader import read_study
from tests.study.support import copied_database, made_database, made_study

STORED = Path(__file__).parent / "data" / "plain.db"


def test_every_variable_and_measure_has_one_column():
    names = [column.name for column in COLUMNS]
    assert len(set(names)) == len(names)
    assert {*NAMES, *MEASURE_NAMES} < set(names)
    assert all(column.meaning for column in COLUMNS)
    assert set(REQUIRED) < set(names)


def test_tables_are_declared_as_version_0_1_0_declared_them(tmp_path):
    """Name, type, NOT NULL, default and primary key of every column of every table of ours."""
    made_database(tmp_path / "s.db", study=made_study())
    declared = []
    for path in (STORED, tmp_path / "s.db"):
        connection = sqlite3.connect(f"{path.as_uri()}?mode=ro&immutable=1", uri=True)
        tables = [name for (name,) in connection.execute("SELECT name FROM sqlite_master WHERE name LIKE 'monoped_%'")]
        declared.append({name: connection.execute(f"PRAGMA table_info({name})").fetchall() for name in sorted(tables)})
        connection.close()
    assert len(declared[0]) == 5
    assert set(declared[1]) - set(declared[0]) == {"monoped_front", "monoped_seals"}
    declared[1] = {name: rows for name, rows in declared[1].items() if name in declared[0]}
    later = [column.name for column in LATER if column.name not in {row[1] for row in declared[0]["monoped_trials"]}]
    old, new = (
        {name: [row[1:] for row in rows if row[1] not in later] for name, rows in tables.items()} for tables in declared
    )
    assert old == new
    assert later == [row[1] for row in declared[1]["monoped_trials"] if row[1] in later]


def test_the_frame_has_the_types_of_the_table(tmp_path):
    for generations in (None, []):
        path = tmp_path / f"{generations}.db"
        made_database(path, generations)
        trials = read_study(path).trials
        # The motors of hip and knee stand only where a study names them.
        known = {c.name: c.dtype for c in COLUMNS if c.name not in ("hip_motor", "knee_motor")}
        assert {name: str(dtype) for name, dtype in trials.dtypes.items()} == known
        assert tuple(trials.columns[: len(REQUIRED)]) == REQUIRED


def test_a_column_of_a_later_version_is_read_as_a_number(tmp_path):
    path = tmp_path / "s.db"
    copied_database(path)
    connection = sqlite3.connect(path)
    connection.execute("ALTER TABLE monoped_trials ADD COLUMN later_j REAL DEFAULT 2.5")
    connection.commit()
    connection.close()
    assert read_study(path).trials["later_j"].tolist() == [2.5] * 6
