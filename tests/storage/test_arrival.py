"""A new study where a reader has made the file by asking for it too early."""

import sqlite3
import subprocess
import sys

import optuna
import pytest

from pareto_monoped.errors import DatabaseError, OutputError
from pareto_monoped.storage.place import storage_of
from pareto_monoped.storage.reader import read_study
from pareto_monoped.study.run import run
from tests.study.support import change, made_database, study_of

SMALL = {"algorithm": {"name": "random", "population": 5}, "audit": False}


def optuna_asks(path):
    """What ``optuna.load_study`` leaves when there is no study of the name."""
    with pytest.raises(KeyError):
        optuna.load_study(study_name="s", storage=f"sqlite:///{path}")


def opens(path):
    connection = sqlite3.connect(path)
    connection.execute("SELECT * FROM sqlite_master").fetchall()
    connection.close()
    path.touch()


@pytest.mark.parametrize("ask", [optuna_asks, opens])
def test_a_file_that_a_reader_has_made_is_vacant_and_filled(tmp_path, ask):
    path = tmp_path / "s.db"
    ask(path)
    assert storage_of(path).is_vacant()
    there = path.stat().st_ino
    assert run(study_of(**SMALL), path, workers=1).evaluations == 10
    assert path.stat().st_ino == there
    assert len(optuna.load_study(study_name="s", storage=f"sqlite:///{path}").trials) == 10
    assert [file.name for file in tmp_path.iterdir()] == ["s.db"]


def test_a_reader_that_stays_open_sees_the_study_arrive(tmp_path):
    path = tmp_path / "s.db"
    storage = optuna.storages.RDBStorage(f"sqlite:///{path}")
    assert storage.get_all_studies() == []
    run(study_of(**SMALL), path, workers=1)
    assert [study.study_name for study in storage.get_all_studies()] == ["s"]
    storage.remove_session()
    storage.engine.dispose()


@pytest.mark.parametrize(
    "statements",
    [
        ["CREATE TABLE mine (x)"],
        ["CREATE VIEW mine AS SELECT 1"],
        ["CREATE TABLE studies (study_id)", "INSERT INTO studies VALUES (1)"],
        ["CREATE TABLE trials (trial_id)", "INSERT INTO trials VALUES (1)"],
    ],
)
def test_a_database_that_holds_anything_is_left_alone(tmp_path, statements):
    path = tmp_path / "s.db"
    change(path, *statements)
    before = path.read_bytes()
    assert not storage_of(path).is_vacant()
    with pytest.raises(DatabaseError, match="is not a study database"):
        run(study_of(**SMALL), path, workers=1)
    assert path.read_bytes() == before


def test_a_study_and_damage_are_not_vacant(tmp_path):
    path = tmp_path / "s.db"
    made_database(path)
    assert not storage_of(path).is_vacant()
    with pytest.raises((DatabaseError, OutputError)):
        made_database(path)
    assert len(read_study(path).trials) == 6
    path.write_bytes(path.read_bytes()[:5000])
    assert not storage_of(path).is_vacant()
    path.write_text("name = 's'\n")
    assert not storage_of(path).is_vacant()


def test_a_reader_that_keeps_the_file_locked_is_told(tmp_path, monkeypatch):
    path = tmp_path / "s.db"
    path.touch()
    monkeypatch.setattr("pareto_monoped.storage.file.READ_TIMEOUT_S", 0.2)
    other = sqlite3.connect(path)
    other.execute("BEGIN IMMEDIATE")
    with pytest.raises(DatabaseError, match="is locked by another program"):
        made_database(path)
    other.close()
    assert path.stat().st_size == 0
    assert [file.name for file in tmp_path.iterdir()] == ["s.db"]


POLL = """
import sys, optuna
optuna.logging.set_verbosity(optuna.logging.ERROR)
while True:
    try:
        optuna.load_study(study_name="s", storage="sqlite:///" + sys.argv[1]).trials
    except KeyError:
        pass
    print(flush=True)
"""


@pytest.mark.long
def test_a_study_made_while_a_reader_polls(tmp_path):
    path = tmp_path / "s.db"
    reader = subprocess.Popen([sys.executable, "-c", POLL, path], stdout=subprocess.PIPE, text=True)
    try:
        assert reader.stdout.readline() == "\n"
        assert run(study_of(**SMALL), path, evaluations=40, workers=1).evaluations == 40
        for _ in range(2):
            assert reader.stdout.readline() == "\n"
        assert reader.poll() is None
    finally:
        reader.kill()
        reader.wait()
        reader.stdout.close()
    assert len(read_study(path).trials) == 40
