"""Random calls of the command line for ``fuzz.py``: words, files that are damaged before, environment, limits."""

import contextlib
import json
import random
import sqlite3
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path

import click

STUDIES = ("s.db", "old.db", "own.db")
"""Studies in every folder: of today's format, of version 0.1.0, and of that with files of the user's own."""
TEXTS = ("study.toml", "m.toml", "cal.toml", "unc.toml", "design.json")
EVIL = "e\u001b[31m\u202e\n[/]"
ODD_PATHS = (
    "",
    ".",
    "no.db",
    "no/such/file",
    "x" * 300,
    "/proc/self/environ",
    "/proc/x.db",
    "/dev/full",
    "loop",
    "folder",
)
OUTPUTS: tuple[str, ...] = (
    "new.csv",
    "new.html",
    "new.xml",
    "new.svg",
    "new.db",
    "out",
    "notes.txt",
    "s.db",
    "s.db-lock",
    "study.toml",
)
OUTPUTS += ("", ".", "no/such/file.csv", "x" * 300, "/proc/x.csv", "/dev/full", "loop", "folder", f"{EVIL}.csv", "busy")
NUMBERS = (
    "0",
    "1",
    "7",
    "0.5",
    "-1",
    "1e400",
    "nan",
    "inf",
    "1_0",
    "9" * 400,
    "x",
    "",
    "0x10",
    "1,1",
    "1,nan",
    "1e-320",
)
ASSIGNED = (
    "height_m=1",
    "energy_j=20",
    "mass_kg=4",
    "knee_ratio=6",
    "height_m=nan",
    "height_m",
    "=",
    "x=1",
    "height_m=1e400",
)
NAMES = ("height_m,energy_j", "height_m,mass_kg", "energy_j", "a,b,c,d", "height_m,height_m", "", EVIL, "mean:height_m")
MOTORS = ("VT8020", "vt8020", "U8", "m.toml", "no.toml", "VT", "", ".", "/dev/zero", EVIL, "x" * 300, "loop")
CALIBRATIONS = (
    "reference",
    "paper",
    "ideal",
    "reference-1",
    "cal.toml",
    "no.toml",
    "",
    "../x",
    "/dev/zero",
    "loop.toml",
)
WEIRD = (
    "nan",
    "-inf",
    "1e400",
    "-1",
    "10" * 20,
    '""',
    "[]",
    "{}",
    "true",
    "1979-05-27",
    '"\\u001b[2J"',
    "[" * 2000,
    '"U8"',
)
OUTPUT_NAMES = ("csv_file", "output", "trace", "model", "figure_file", "figures")
"""Parameters of commands that name an output."""
WEIGHTS = {
    "status": 12, "front": 14, "pick": 14, "verify": 8, "repair": 5, "robust": 4, "report": 3, "run": 9, "resume": 8,
    "simulate": 8, "actuators": 7, "table1": 1, "export": 6, "pareto": 4, "nonsense": 2,
}  # fmt: skip


@dataclass(slots=True)
class Call:
    """One call.

    Attributes:
        words: of the command line.
        harm: changes the folder before the call.
        environment: variables; None for one that is unset.
        options: of the process, see ``fuzz.child``.
    """

    words: list[str]
    harm: list[Callable[[Path], None]] = field(default_factory=list)
    environment: dict[str, str | None] = field(default_factory=dict)
    options: dict[str, object] = field(default_factory=dict)


def call_of(dice: random.Random, commands: click.Group) -> Call:
    """A random call."""
    command = dice.choices(list(WEIGHTS), list(WEIGHTS.values()))[0]
    call = Call([command, *_words(dice, command, commands)])
    if dice.random() < 0.6:
        call.harm = [_harm(dice) for _ in range(dice.choice((1, 1, 1, 2, 3)))]
    for name, values in ENVIRONMENT.items():
        if dice.random() < 0.08:
            call.environment[name] = dice.choice(values)
    for name, odd in OPTIONS.items():
        if dice.random() < (0.01 if name == "fresh" else 0.04):
            call.options[name] = odd(dice)
    return call


ENVIRONMENT: dict[str, tuple[str | None, ...]] = {
    "COLUMNS": ("0", "-1", "1", "abc", "100000", ""),
    "LINES": ("0", "-1", "x"),
    "HOME": (None, "/nonexistent", "", "folder"),
    "TERM": ("dumb", None, "", "xterm-256color"),
    "LANG": ("C", "xx_YY.UTF-9", ""),
    "LC_ALL": ("C", "POSIX", ""),
    "PYTHONIOENCODING": ("ascii", "latin-1", "utf-16"),
    "TMPDIR": ("/nonexistent", "", "notes.txt"),
    "NO_COLOR": ("1",),
    "FORCE_COLOR": ("1", ""),
    "MPLCONFIGDIR": ("/nonexistent", "notes.txt"),
    "MPLBACKEND": ("none", "TkAgg"),
    "MUJOCO_GL": ("nonsense",),
    "OMP_NUM_THREADS": ("0", "x"),
}
OPTIONS: dict[str, Callable[[random.Random], object]] = {
    "stdout": lambda dice: dice.choice(("full", "closed", "broken")),
    "stderr": lambda dice: dice.choice(("full", "closed", "broken")),
    "stdin": lambda dice: "closed",
    "file_size": lambda dice: dice.choice((0, 100, 4096, dice.randrange(400_000))),
    "files": lambda dice: dice.choice((8, 12, 20)),
    "read_only": lambda dice: True,
    "signal": lambda dice: (dice.choice(("SIGINT", "SIGTERM", "SIGHUP")), dice.choice((0.01, 0.1, 0.4, 1.0))),
    "fresh": lambda dice: True,
    "tiny_disk": lambda dice: dice.randrange(0, 300_000),
    "umask": lambda dice: dice.choice((0o777, 0o000)),
    "gone": lambda dice: True,
}


def _words(dice: random.Random, command: str, commands: click.Group) -> list[str]:
    """Arguments and options of a command, by what it declares."""
    if command == "nonsense":
        return [dice.choice(("--help", "--version", EVIL, "-x", "--", "")) for _ in range(dice.randrange(3))]
    known = commands.get_command(click.Context(commands), command)
    assert known is not None
    words: list[str] = []
    for parameter in known.params:
        if isinstance(parameter, click.Argument):
            if dice.random() < 0.97:
                words += [_argument(dice, command)] * (2 if parameter.nargs == -1 and dice.random() < 0.3 else 1)
        elif parameter.name in LIMITED or dice.random() < 0.18 or (parameter.required and dice.random() < 0.95):
            assert isinstance(parameter, click.Option)
            words += _option(dice, parameter, command)
    if command in ("pick", "export") and dice.random() < 0.7:
        words += dice.choice((["--knee"], ["--min-height", "0.8"], ["--trial", "3"], ["--weights", "1,1"]))
    if dice.random() < 0.02:
        words.append(dice.choice(("--nonsense", EVIL, "extra", "--")))
    return words


LIMITED = {"evaluations": ("20", "30", "5", "0", "x"), "samples": ("64", "0", "65", "x"), "every": ("9", "50", "0")}
"""Options that bound how long a call takes: always given."""


def _argument(dice: random.Random, command: str) -> str:
    if command == "pareto":  # a whole one makes an export, which takes a minute
        return dice.choice(("no.toml", "notes.txt", *ODD_PATHS, "m.toml"))
    good = ("study.toml",) if command == "run" else STUDIES
    return dice.choice(good) if dice.random() < 0.85 else dice.choice((*ODD_PATHS, *TEXTS, *STUDIES, "notes.txt"))


def _option(dice: random.Random, option: click.Option, command: str) -> list[str]:
    flag, name = dice.choice(option.opts), option.name or ""
    if option.is_flag:
        return [flag]
    if name in LIMITED:
        return [flag, dice.choice(LIMITED[name][:1] * 6 + LIMITED[name])]
    if name in OUTPUT_NAMES:
        # An export that begins takes a minute: its folder is one that it refuses.
        return [flag, dice.choice(("busy", "notes.txt", "s.db", "/proc/x") if command == "export" else OUTPUTS)]
    if name == "db":
        return [flag, dice.choice((*STUDIES, "new.db", "notes.txt", *ODD_PATHS))]
    if isinstance(option.type, click.Choice):
        return [flag, dice.choice((*map(str, option.type.choices), "none"))]
    if isinstance(option.type, click.Path):
        return [flag, dice.choice((*TEXTS, *ODD_PATHS))]
    if isinstance(option.type, click.types.IntParamType | click.types.FloatParamType):
        return [flag, dice.choice(("1", "2", "3", *NUMBERS))]
    pools = {"motor": MOTORS, "hip_motor": MOTORS, "knee_motor": MOTORS, "calibration_name": CALIBRATIONS}
    pools |= {"objectives": NAMES, "weights": NUMBERS, "compromise": NUMBERS, "formats": ("urdf", "none", "", EVIL)}
    return [flag, dice.choice(pools.get(name, ASSIGNED))]


def _harm(dice: random.Random) -> Callable[[Path], None]:
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
)
VALUES: tuple[object, ...] = (
    None, "", "abc", EVIL, "\ud7ff" * 3, b"\xff\xfe", 0, -1, 2**62, -(2**63), 1e308, -1e308, float("inf"), 0.5, "[]",
    "{}", "null", "[" * 3000 + "]" * 3000, '{"name": "x"}', "NaN", "1e999", "[1,2,3]", '["VT8020"]', "9" * 5000, '"x"',
    "true",
)  # fmt: skip


def _change_rows(path: Path, dice: random.Random) -> None:
    """Change values, rows or tables by SQL; half of the studies lose their running hash, which would find it."""
    with contextlib.suppress(sqlite3.Error, OSError), contextlib.closing(sqlite3.connect(path)) as connection:
        if dice.random() < 0.5:
            for statement in UNSEALED:
                connection.execute(statement)
        tables = [row[0] for row in connection.execute("SELECT name FROM sqlite_master WHERE type = 'table'")]
        for _ in range(dice.choice((1, 1, 2, 5))):
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
    key, text = dice.choice(connection.execute("SELECT key, value FROM monoped_meta").fetchall())
    value = json.loads(text)
    places = list(_places(value))
    if places:
        holder, place = dice.choice(places)
        holder[place] = dice.choice([v for v in VALUES if not isinstance(v, bytes)])  # type: ignore[index]
    connection.execute("UPDATE monoped_meta SET value = ? WHERE key = ?", (json.dumps(value), key))


def _places(value: object) -> Iterator[tuple[object, object]]:
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
