"""Random calls of the command line for ``fuzz.py``: words, files that are damaged before, environment, limits."""

import random
from collections.abc import Callable, Collection
from dataclasses import dataclass, field
from pathlib import Path

import click
from fuzz_harm import EVIL, STUDIES, TEXTS, harm

ODD_PATHS: tuple[str, ...] = (
    "", ".", "no.db", "no/such/file", "x" * 300, "/proc/self/environ", "/proc/x.db", "/dev/full", "loop", "folder",
    "pipe", "pipe.toml", "socket.toml", "/dev/zero", "/dev/null", "/dev/stdin", "/dev/tty", "/dev",
)  # fmt: skip
OUTPUTS: tuple[str, ...] = (
    "new.csv", "new.html", "new.xml", "new.svg", "new.db", "out", "notes.txt", "s.db", "s.db-lock", "study.toml",
)  # fmt: skip
OUTPUTS += (
    "", ".", "no/such/file.csv", "x" * 300, "/proc/x.csv", "/dev/full", "/dev/zero", "pipe", "socket.toml", "folder",
    f"{EVIL}.csv", "busy",
)  # fmt: skip
NUMBERS = (
    "0", "1", "7", "0.5", "-1", "1e400", "nan", "inf", "1_0", "9" * 400, "x", "", "0x10", "1,1", "1,nan", "1e-320",
)  # fmt: skip
ASSIGNED = (
    "height_m=1", "energy_j=20", "mass_kg=4", "knee_ratio=6", "height_m=nan", "height_m", "=", "x=1",
    "height_m=1e400",
)  # fmt: skip
NAMES = ("height_m,energy_j", "height_m,mass_kg", "energy_j", "a,b,c,d", "height_m,height_m", "", EVIL, "mean:height_m")
MOTORS = ("VT8020", "vt8020", "U8", "m.toml", "no.toml", "VT", "", ".", "/dev/zero", EVIL, "x" * 300, "pipe.toml")
CALIBRATIONS = (
    "reference", "paper", "ideal", "reference-1", "cal.toml", "no.toml", "", "../x", "/dev/zero", "loop.toml",
    "pipe.toml", "socket.toml",
)  # fmt: skip
PROCESSES = ("1", "2", "0", "-1", "x", "1e400", "999")
SCHEDULERS = ("tcp://127.0.0.1:1", "127.0.0.1", "tcp://", "http://x:1", "tcp://127.0.0.1:99999", "", "nonsense", EVIL)
"""Addresses at which no scheduler answers."""
OUTPUT_NAMES = ("csv_file", "output", "trace", "model", "figure_file", "figures", "page", "table")
"""Parameters of commands that name an output."""
WEIGHTS = {
    "status": 12, "front": 14, "pick": 14, "verify": 8, "repair": 5, "robust": 4, "report": 3, "run": 9, "resume": 8,
    "simulate": 8, "actuators": 7, "table1": 1, "export": 6, "pareto": 4, "nonsense": 2, "sensitivity": 2, "init": 2,
    "campaign": 2, "trials": 6, "dashboard": 2,
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


def call_of(dice: random.Random, commands: click.Group, names: Collection[str] = ()) -> Call:
    """A random call, of one of the commands of these names if there are any."""
    weights = {name: weight for name, weight in WEIGHTS.items() if not names or name in names}
    command = dice.choices(list(weights), list(weights.values()))[0]
    call = Call([command, *_words(dice, command, commands)])
    if dice.random() < 0.6:
        call.harm = [harm(dice) for _ in range(dice.choice((1, 1, 1, 2, 3)))]
    for name, values in ENVIRONMENT.items():
        if dice.random() < 0.08:
            call.environment[name] = dice.choice(values)
    for name, odd in OPTIONS.items():
        if dice.random() < (0.02 if name == "fresh" else 0.04):
            call.options[name] = odd(dice)
    if command == "campaign" or "--processes" in call.words:  # in a fork, handlers at the end come in another order
        call.options["fresh"] = True
    if command == "dashboard":  # which ends in no other way where it is installed
        call.options["signal"] = ("SIGINT", 1.0)
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
            if dice.random() < 0.97 or command == "pareto":  # without a study it is the whole main job
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
    good = {"run": ("study.toml",), "campaign": ("grid.toml",)}.get(command, STUDIES)
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
    if name in ("processes", "scheduler"):  # each takes seconds to start or to fail
        odd = PROCESSES if name == "processes" else SCHEDULERS
        return [flag, dice.choice(odd)] if dice.random() < 0.5 else []
    if name == "db":
        return [flag, dice.choice((*STUDIES, "new.db", "notes.txt", *ODD_PATHS))]
    if isinstance(option.type, click.Choice):
        return [flag, dice.choice((*map(str, option.type.choices), "none"))]
    if isinstance(option.type, click.Path):
        return [flag, dice.choice((*TEXTS, *ODD_PATHS))]
    if isinstance(option.type, click.types.IntParamType | click.types.FloatParamType):
        return [flag, dice.choice(("1", "2", "3", *NUMBERS))]
    pools: dict[str, tuple[str, ...]] = {
        "motor": MOTORS,
        "hip_motor": MOTORS,
        "knee_motor": MOTORS,
        "calibration_name": CALIBRATIONS,
    }
    pools |= {"objectives": NAMES, "weights": NUMBERS, "compromise": NUMBERS, "formats": ("urdf", "none", "", EVIL)}
    return [flag, dice.choice(pools.get(name, ASSIGNED))]
