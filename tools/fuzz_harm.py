"""How ``fuzz.py`` damages files and databases before a call."""

import contextlib
import json
import random
import sqlite3
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

STUDIES = ("s.db", "old.db", "own.db")
"""Studies in every folder: of today's format, of version 0.1.0, and of that with files of the user's own."""
TEXTS = ("study.toml", "grid.toml", "m.toml", "cal.toml", "unc.toml", "design.json")
EVIL = "e\u001b[31m\u202e\n[/]"
WEIRD = (
    "nan", "-inf", "1e400", "-1", "10" * 20, '""', "[]", "{}", "true", "1979-05-27", '"\\u001b[2J"', "[" * 2000,
    '"U8"',
)  # fmt: skip


def harm(dice: random.Random) -> Callable[[Path], None]:
    """A change of one of the folder's files."""
    state = dice.getrandbits(64)
    kind = dice.choices(("text", "bytes", "sql", "beside"), (3, 3, 4, 1))[0]
    if kind == "text":
        return lambda folder: _change_text(folder / random.Random(state).choice(TEXTS), random.Random(state))
    if kind == "beside":
        return lambda folder: _beside(folder, random.Random(state))
    name = dice.choice(STUDIES)
    if kind == "bytes":
        return lambda folder: _change_bytes(folder / name, random.Random(state))
    return lambda folder: _change_rows(folder / name, random.Random(state))


def _change_text(path: Path, dice: random.Random) -> None:
    lines = path.read_text(errors="replace").splitlines() or [""]
    k = dice.randrange(len(lines))
    kind = dice.randrange(8)
    if kind <= 2 and ("=" in lines[k] or ":" in lines[k]):
        mark = "=" if "=" in lines[k] else ":"
        lines[k] = f"{lines[k].partition(mark)[0]}{mark} {dice.choice(WEIRD)}{',' if lines[k].endswith(',') else ''}"
    elif kind == 3:
        del lines[k]
    elif kind == 4:
        lines.insert(
            k, dice.choice((lines[k], f"[{EVIL!r}]", 'unknown = "x"', "\u0000", '"k\\u0000" = 1', "a.b.c = 1"))
        )
    text = "\n".join(lines).encode()
    if kind == 5:
        text = text[: dice.randrange(len(text) + 1)]
    elif kind == 6:
        text = dice.choice((b"", b"\xff\xfe", b"\xef\xbb\xbf" + text, dice.randbytes(300), text + b"#" * 2_000_000))
    elif kind == 7:
        damaged = bytearray(text or b" ")
        for _ in range(dice.randrange(1, 8)):
            damaged[dice.randrange(len(damaged))] = dice.randrange(256)
        text = bytes(damaged)
    path.write_bytes(text)


def _change_bytes(path: Path, dice: random.Random) -> None:
    content = bytearray(path.read_bytes())
    kind = dice.randrange(5)
    if not content:
        return
    if kind <= 1:
        for _ in range(dice.choice((1, 1, 5, 50))):
            content[dice.randrange(len(content))] ^= 1 << dice.randrange(8)
    elif kind == 2:
        del content[dice.choice((dice.randrange(len(content)), 4096 * dice.randrange(1 + len(content) // 4096))) :]
    elif kind == 3:
        page = 4096 * dice.randrange(1 + len(content) // 4096)
        content[page : page + 4096] = dice.choice((bytes(4096), dice.randbytes(4096), content[:4096]))
    else:
        content += dice.randbytes(dice.randrange(9000))
    path.write_bytes(content)


UNSEALED = (
    "DROP TABLE IF EXISTS monoped_seals",
    "DROP TABLE IF EXISTS monoped_front",
    "UPDATE monoped_meta SET value = '1' WHERE key = 'format'",
    "UPDATE monoped_meta SET value = '{\"pareto-monoped\": \"0.2.0\"}' WHERE key = 'versions'",
)
VALUES: tuple[object, ...] = (
    None, "", "abc", EVIL, "\ud7ff" * 3, b"\xff\xfe", 0, -1, 2**62, -(2**63), 1e308, -1e308, float("inf"), 0.5, "[]",
    "{}", "null", "[" * 3000 + "]" * 3000, '{"name": "x"}', "NaN", "1e999", "[1,2,3]", '["VT8020"]', "9" * 5000, '"x"',
    "true",
)  # fmt: skip


def _change_rows(path: Path, dice: random.Random) -> None:
    """Change values, rows or tables by SQL; half of the studies lose their running hash, which would find it."""
    with (
        contextlib.suppress(sqlite3.Error, OSError, UnicodeError),
        contextlib.closing(sqlite3.connect(path)) as connection,
    ):
        if dice.random() < 0.5:
            for statement in UNSEALED:
                connection.execute(statement)
        tables = [row[0] for row in connection.execute("SELECT name FROM sqlite_master WHERE type = 'table'")]
        # An earlier harm may have left an empty file, which has no tables.
        for _ in range(dice.choice((1, 1, 2, 5)) if tables else 0):
            table = dice.choice([name for name in tables if name.startswith("monoped")] * 3 + tables)
            with contextlib.suppress(sqlite3.Error):
                _change_table(connection, table, dice)
        connection.commit()


def _change_table(connection: sqlite3.Connection, table: str, dice: random.Random) -> None:
    columns = [row[1] for row in connection.execute(f"PRAGMA table_info({table})")]
    if not columns:  # it was dropped before
        return
    kind, column = dice.randrange(12), dice.choice(columns)
    row = f"rowid = (SELECT rowid FROM {table} ORDER BY random() LIMIT 1)"
    if kind <= 6:
        connection.execute(f"UPDATE {table} SET {column} = ? WHERE {row}", (dice.choice(VALUES),))
    elif kind == 7:
        connection.execute(f"UPDATE {table} SET {column} = ?", (dice.choice(VALUES),))
    elif kind == 8:
        connection.execute(f"DELETE FROM {table}" + (f" WHERE {row}" if dice.random() < 0.7 else ""))
    elif kind == 9:
        connection.execute(dice.choice((f"DROP TABLE {table}", f"ALTER TABLE {table} DROP COLUMN {column}")))
    elif kind == 10:
        connection.execute(dice.choice((f"ALTER TABLE {table} ADD COLUMN extra", "CREATE VIEW v AS SELECT 1")))
    elif table == "monoped_meta":
        _change_setting(connection, dice)


def _change_setting(connection: sqlite3.Connection, dice: random.Random) -> None:
    """Change a value somewhere within a row of JSON."""
    rows = connection.execute("SELECT key, value FROM monoped_meta").fetchall()
    if not rows:  # an earlier harm has deleted all
        return
    key, text = dice.choice(rows)
    try:
        value = json.loads(text)
    except ValueError:  # an earlier harm has made it no JSON, or a number of too many digits
        return
    places = list(_places(value))
    if places:
        holder, place = dice.choice(places)
        holder[place] = dice.choice([v for v in VALUES if not isinstance(v, bytes)])
    connection.execute("UPDATE monoped_meta SET value = ? WHERE key = ?", (json.dumps(value), key))


def _places(value: object) -> Iterator[tuple[Any, Any]]:
    """Every container within a JSON value with each of its keys."""
    inner = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for place, each in inner:
        yield value, place
        yield from _places(each)


def _beside(folder: Path, dice: random.Random) -> None:
    """Put something beside a study that has the name of one of its files."""
    path = folder / f"{dice.choice(STUDIES)}{dice.choice(('-wal', '-shm', '-journal', '-lock'))}"
    kind = dice.randrange(4)
    if kind == 0:
        path.mkdir(exist_ok=True)
    elif kind == 1:
        path.write_bytes(dice.choice((b"", dice.randbytes(5000), b"my notes\n")))
    elif kind == 2 and not path.exists():
        path.symlink_to("notes.txt")
