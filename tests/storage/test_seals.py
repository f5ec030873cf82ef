"""Damage to any stored number or text is refused, and named."""

import hashlib
import json
import random
import shutil
import sqlite3
import struct
from dataclasses import replace

import numpy as np
import pytest

from pareto_monoped.errors import DatabaseError, InputError
from pareto_monoped.storage import reader
from pareto_monoped.storage.base import FORMAT
from pareto_monoped.storage.front_reader import read_front
from pareto_monoped.storage.reader import read_study
from pareto_monoped.storage.status import status
from pareto_monoped.storage.store import Store
from pareto_monoped.study.run import run
from tests.study.support import (
    change,
    copied_database,
    made_database,
    made_evaluations,
    made_generation,
    made_study,
    study_of,
)

TEXTS = ("state", "status", "reason", "motor", "hip_motor", "knee_motor")


@pytest.fixture
def path(tmp_path):
    """A study of two generations with an audit of each kind."""
    study = copied_database(tmp_path / "s.db")
    with Store(tmp_path / "s.db", study) as store:
        store.set_audits([(0, True, {"spread_height_m": 1e-5}), (3, False, {"spread_height_m": float("inf")})])
        store.set_meta({"finished": True, "stop_reason": "budget"})
    return tmp_path / "s.db"


def values(path):
    """Every value of every table of ours, as (table, column, key column, key, value)."""
    connection = sqlite3.connect(path)
    found = []
    for (table,) in connection.execute("SELECT name FROM sqlite_master WHERE name LIKE 'monoped_%' AND type = 'table'"):
        cursor = connection.execute(f"SELECT rowid, * FROM {table}")
        columns = [entry[0] for entry in cursor.description][1:]
        for rowid, *row in cursor.fetchall():
            found += [(table, column, rowid, value) for column, value in zip(columns, row, strict=True)]
    connection.close()
    return found


def other(value, generator):
    """A value that damage may leave in place of ``value``."""
    if value is None:
        return 1.5
    if isinstance(value, str):
        bent = bytearray(value.encode() or b"x")
        bent[generator.randrange(len(bent))] ^= 1
        return bent.decode("latin-1") if value else "x"
    return float(np.nextafter(value, np.inf)) if isinstance(value, float) else value + 1


def test_every_value_is_guarded(path, tmp_path):
    """One value after the other is changed as little as can be: one of each column of the trials, all of the others."""
    generator, copy = random.Random(1), tmp_path / "copy.db"
    chosen = {}
    for table, column, rowid, value in values(path):
        chosen.setdefault((table, column) if table == "monoped_trials" else (table, column, rowid), []).append(
            (table, column, rowid, value)
        )
    passed, lines = [], []
    for candidates in chosen.values():
        table, column, rowid, value = generator.choice(candidates)
        shutil.copy(path, copy)
        connection = sqlite3.connect(copy)
        try:
            connection.execute(f"UPDATE {table} SET {column} = ? WHERE rowid = ?", (other(value, generator), rowid))
        except sqlite3.IntegrityError:  # a second row of a table of one, which SQLite itself refuses
            continue
        finally:
            connection.commit()
            connection.close()
        try:
            read_study(copy)
        except InputError as error:
            lines.append(str(error))
        else:
            passed.append((table, column, rowid, value))
    assert passed == []
    assert not any("\n" in line for line in lines)
    assert len(chosen) > 120


@pytest.mark.parametrize(
    ("statement", "words"),
    [
        ("UPDATE monoped_trials SET height_m = 50 WHERE trial = 3", "trial 3 does not match its hash"),
        ("UPDATE monoped_trials SET trial = -5 WHERE trial = 4", "trial -5 has no hash"),
        ("DELETE FROM monoped_trials WHERE trial = 5", "1 trials are missing"),
        ("UPDATE monoped_trials SET motor = 'U8' WHERE trial = 1", "trial 1 does not match"),
        ("UPDATE monoped_checkpoint SET told = 100000", "row 1 of its checkpoint"),
        ("UPDATE monoped_checkpoint SET generation = -3", "row 1 of its checkpoint"),
        ("UPDATE monoped_history SET hypervolume = 9e9 WHERE generation = 1", "row 1 of its history"),
        ("DELETE FROM monoped_audits WHERE trial = 3", "row 3 of its audits is missing"),
        ("INSERT INTO monoped_audits VALUES (4, 0, '{}')", "row 4 of its audits has no hash"),
        ("UPDATE monoped_meta SET value = '41' WHERE key = 'budget'", "row budget of its meta"),
        ("UPDATE monoped_front SET feasible = 5", "row 1 of its front"),
        ("DELETE FROM monoped_seals WHERE link = 1", "link 1 of its running hash"),
        ("DELETE FROM monoped_seals", "its running hash is empty"),
        ("DROP TABLE monoped_seals", "lacks the table 'monoped_seals'"),
    ],
)
@pytest.mark.parametrize("block", [20_000, 2])
def test_the_row_is_named(path, statement, words, block, monkeypatch):
    monkeypatch.setattr(reader, "_BLOCK", block)
    change(path, statement)
    with pytest.raises(DatabaseError, match="is damaged") as caught:
        read_study(path)
    assert words in str(caught.value)


def test_links_cut_off_at_the_end_are_missed(path):
    change(path, "DELETE FROM monoped_seals WHERE link > 2")
    with pytest.raises(DatabaseError, match=r"does not match|has no hash"):
        read_study(path)


def test_the_kept_front_is_the_front(tmp_path):
    """Over generations, audits that fail, and generations after them."""
    path, study, generator = tmp_path / "s.db", made_study(), np.random.default_rng(2)
    made_database(path, [], study)
    for number in range(6):
        with Store(path, study) as store:
            drawn = made_evaluations(generator.uniform(0.5, 1.0, 50), generator.uniform(1.0, 9.0, 50), seed=number)
            store.add(made_generation(study, number, 50 * number, drawn, state={}))
            front = read_study(path).front()["trial"].tolist()
            store.set_audits([(trial, k % 3 != number % 3, {}) for k, trial in enumerate(front)])
        connection = sqlite3.connect(path)
        trials, *counts = connection.execute(
            "SELECT trials, feasible, infeasible, failed FROM monoped_front"
        ).fetchone()
        connection.close()
        data = read_study(path)
        assert trials == str(sorted(data.front()["trial"])).replace(" ", "")
        assert len(data.ill_conditioned) > number
        assert counts == [(data.trials["state"] == state).sum() for state in ("feasible", "infeasible", "failed")]


def test_new_studies_have_the_format_with_a_hash(path):
    assert FORMAT == 2
    assert read_study(path).sealed


def test_the_content_hash_does_not_depend_on_grouping(tmp_path):
    study = study_of(evaluations=20, strength=False, audit=False, algorithm={"name": "random"})
    once = run(study, tmp_path / "once.db").data
    for total in (3, 17, 20):  # ends within generations of 16
        parts = run(study, tmp_path / "parts.db", evaluations=total, workers=2).data
        assert (parts.content_hash == once.content_hash) == (total == 20)
    assert once.links != parts.links
    assert status(tmp_path / "parts.db")["content_hash"] == once.content_hash
    assert read_front(tmp_path / "parts.db").content_hash == once.content_hash
    assert run(replace(study, seed=2), tmp_path / "other.db").data.content_hash != once.content_hash


def test_the_content_hash_is_computed_from_what_is_documented(path):
    """By hand, from the rows as they are read and SHA-256 alone."""
    data = read_study(path)
    connection = sqlite3.connect(path)
    rows = {key: json.loads(text) for key, text in connection.execute("SELECT key, value FROM monoped_meta")}
    study = {k: v for k, v in rows["study"].items() if k not in ("audit", "description", "evaluations", "stop")}
    decisive = {"study": study, "contents": rows["contents"], "versions": rows["versions"]}
    text = hashlib.sha256(json.dumps(decisive, sort_keys=True, separators=(",", ":")).encode()).hexdigest()
    cursor = connection.execute("SELECT * FROM monoped_trials ORDER BY trial")
    names = [column[0] for column in cursor.description]
    text += json.dumps(names)
    for row in cursor:
        values = dict(zip(names, row, strict=True))
        words = [values[n] or "" for n in names if n in TEXTS]
        numbers = [float("nan") if values[n] is None else float(values[n]) for n in names if n not in TEXTS]
        packed = struct.pack(f"<{len(numbers)}d", *numbers)
        text += hashlib.sha256("\x1f".join(words).encode() + b"\x1e" + packed).hexdigest()[:16]
    assert data.content_hash == hashlib.sha256(text.encode()).hexdigest()
