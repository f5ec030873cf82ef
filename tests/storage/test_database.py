"""A file that is not a study database is refused with one clear line and not changed by a byte."""

import contextlib
import os
import random
import sqlite3

import pytest

from pareto_monoped.errors import DatabaseError, DiskError
from pareto_monoped.storage.place import storage_of
from pareto_monoped.storage.reader import read_study
from pareto_monoped.storage.store import Store
from tests.study.support import copied_database, made_database, made_study


def refused(path, words, opener=read_study):
    """The error's line; the folder is the same before and after."""
    before = {p.name: (p.read_bytes(), p.stat().st_mtime_ns) for p in path.parent.iterdir() if p.is_file()}
    with pytest.raises(DatabaseError) as caught:
        opener(path)
    after = {p.name: (p.read_bytes(), p.stat().st_mtime_ns) for p in path.parent.iterdir() if p.is_file()}
    assert after == before
    message = str(caught.value)
    assert "\n" not in message
    assert str(path) in message
    for word in words:
        assert word in message


def writer(path):
    with Store(path, made_study()):
        pass


def change(path, statement):
    connection = sqlite3.connect(path)
    connection.execute(statement)
    connection.commit()
    connection.close()


def test_a_missing_file(tmp_path):
    refused(tmp_path / "s.db", ["no such file"])


def test_a_folder(tmp_path):
    (tmp_path / "s.db").mkdir()
    refused(tmp_path / "s.db", ["is a folder; give the name of a file"])


@pytest.mark.parametrize("content", [b"", b"name = 'x'\n", b"SQLite format 3", os.urandom(5000)])
def test_a_file_of_another_kind(tmp_path, content):
    (tmp_path / "s.db").write_bytes(content)
    refused(tmp_path / "s.db", ["is not a study database"])


@pytest.mark.parametrize("opener", [read_study, writer])
def test_another_sqlite_database(tmp_path, opener):
    change(tmp_path / "s.db", "CREATE TABLE birds (name TEXT)")
    refused(tmp_path / "s.db", ["is not a study database", "'studies'"], opener)


def test_a_study_of_optuna_alone(tmp_path):
    import optuna

    optuna.logging.set_verbosity(optuna.logging.WARNING)
    optuna.create_study(storage=f"sqlite:///{tmp_path}/s.db")
    refused(tmp_path / "s.db", ["is not a study database", "a study of Optuna"])


@pytest.mark.parametrize("opener", [read_study, writer])
def test_a_study_of_a_newer_version(tmp_path, opener):
    copied_database(tmp_path / "s.db")
    change(tmp_path / "s.db", "UPDATE monoped_meta SET value = '99' WHERE key = 'format'")
    refused(tmp_path / "s.db", ["format 99 is newer", "update pareto-monoped"], opener)


@pytest.mark.parametrize("opener", [read_study, writer])
@pytest.mark.parametrize(
    "statement",
    [
        "CREATE VIEW v AS SELECT 1",
        "CREATE TRIGGER t AFTER INSERT ON trials BEGIN DELETE FROM monoped_meta; END",
    ],
)
def test_views_and_triggers_of_a_stranger_never_run(tmp_path, statement, opener):
    copied_database(tmp_path / "s.db")
    change(tmp_path / "s.db", statement)
    refused(tmp_path / "s.db", ["view or trigger", "do not trust it"], opener)


def test_a_file_marked_read_only_can_be_read_but_not_run(tmp_path):
    path = tmp_path / "s.db"
    copied_database(path)
    path.chmod(0o444)
    refused(path, ["is read-only", "chmod"], writer)
    assert len(read_study(path).trials) == 6


def test_a_database_cut_off_in_the_middle(tmp_path):
    path = tmp_path / "s.db"
    copied_database(path)
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])
    refused(path, ["damaged"], writer)


@pytest.mark.parametrize("seed", range(12))
def test_overwritten_pages_never_end_in_another_exception(tmp_path, seed):
    """Random damage is either not noticed, because it hit nothing that is read, or it is a clear error."""
    path = tmp_path / "s.db"
    copied_database(path)
    generator = random.Random(seed)
    content = bytearray(path.read_bytes())
    for _ in range(8):
        start = generator.randrange(100, len(content))
        content[start : start + 200] = generator.randbytes(min(200, len(content) - start))
    path.write_bytes(content)
    for opener in (read_study, writer):
        with contextlib.suppress(DatabaseError):
            opener(path)


def test_a_reader_does_not_wait_for_a_writer(tmp_path):
    path = tmp_path / "s.db"
    study = copied_database(path)
    with Store(path, study) as store:
        store._connection.execute("BEGIN IMMEDIATE")
        store._connection.execute("DELETE FROM monoped_history")
        assert len(read_study(path).history) == 2
        store._connection.execute("ROLLBACK")


def test_a_database_that_another_program_holds(tmp_path, monkeypatch):
    path = tmp_path / "s.db"
    copied_database(path)
    connection = sqlite3.connect(path, isolation_level=None)
    connection.execute("BEGIN EXCLUSIVE")
    monkeypatch.setattr("pareto_monoped.storage.file.READ_TIMEOUT_S", 0.1)
    refused(path, ["is locked by another program"])
    connection.close()


def test_an_error_of_sqlite_over_several_lines_is_told_in_one(tmp_path):
    """A bit that flips in the definition of a table; SQLite repeats the rest of it, with its line ends."""
    made_database(tmp_path / "s.db")
    bent = (tmp_path / "s.db").read_bytes().replace(b"seconds REAL NOT NULL\n)", b"seconds `REAL NOT NUL\n)")
    (tmp_path / "s.db").write_bytes(bent)
    refused(tmp_path / "s.db", ["malformed database schema (monoped_history)"])


def test_an_error_of_sqlite_that_optuna_has_wrapped_twice_is_told_as_what_it_is(tmp_path):
    """A disk that was full at Optuna's commit became an unexpected error of the program."""
    from optuna.exceptions import StorageInternalError
    from sqlalchemy.exc import OperationalError

    full = sqlite3.OperationalError("database or disk is full")
    full.sqlite_errorcode = sqlite3.SQLITE_FULL
    with pytest.raises(DiskError, match="the disk is full"), storage_of(tmp_path / "s.db").translated():
        raise StorageInternalError("commit") from OperationalError("COMMIT", {}, full)
    with pytest.raises(StorageInternalError), storage_of(tmp_path / "s.db").translated():
        raise StorageInternalError("of another kind")
