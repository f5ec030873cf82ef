"""Kill runs of studies by SIGKILL again and again, and check that nothing acknowledged is lost.

    python tools/kill_storm.py --kills 1000 --seed 1

Every algorithm runs small studies, with two and three objectives, constraints, audits and choices of motors. A run is
killed after a random time, or before a random one of its operations on files (write, sync, removal, renaming), counted
from its start or back from its end. So kills also hit moments that a clock would hardly ever hit: creation, changes of
the journal mode, the middle of a transaction, the very end. After each kill the study must be readable and hold every
trial that was acknowledged; then it is run again, to be killed again or to end. A study that ends must be equal to one
that was never killed, and sound under ``verify``.

Everything heavy is imported once; each run is a process forked from here. Exits with 1 if anything was lost.
"""

import argparse
import ctypes
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import traceback
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from pareto_monoped.analysis.verify import verify
from pareto_monoped.definition.algorithms import ALGORITHMS
from pareto_monoped.definition.study import Study, load_study
from pareto_monoped.errors import ParetoMonopedError
from pareto_monoped.storage.front_reader import read_front
from pareto_monoped.storage.reader import StudyData, read_study
from pareto_monoped.storage.status import status
from pareto_monoped.storage.store import Store
from pareto_monoped.study import run as runs
from pareto_monoped.study.session import Session

_SOURCE = Path(__file__).with_name("kill_before.c")
_LIBRARY = "KILL_STORM_LIBRARY"

_THREE = 'objectives = ["height_m", "electrical_energy_j", "mass_kg"]\n'
_LIMIT = "[constraints]\nmass_kg = { max = 4.6 }\n"
_KNEE = "[variables]\nknee_release_rad = { lower = 0.0, upper = 0.6 }\n"
_SHAPES = {
    "two objectives": ("strength = false\n", ""),
    "optional variable, strength": ("", _KNEE),
    "three objectives, limit": (_THREE + "strength = false\n", _LIMIT),
    "motors": ('motor = ["VT8020", "U8"]\nstrength = false\n', ""),
    "motors per joint, three objectives, limit": ('hip_motor = ["VT8020", "U8"]\nknee_motor = "U8"\n' + _THREE, _LIMIT),
}
"""Kind of study -> what stands before and in the tables of its file."""
_WEIGHTED = ("two objectives", "optional variable, strength")
"""The weighted search knows neither a third objective nor several motors."""
_POPULATION, _GENERATIONS = 8, 6
"""Small, so that kills come between and within many generations."""
_NEVER = 2**31 - 1
"""More operations than any run has."""
_AIMED_LAST = 25
"""Kills that are counted from the end come before one of so many last operations; closing a study takes about 20."""


@dataclass(slots=True, kw_only=True)
class Scenario:
    """A study to kill, and how it ends when it is not killed."""

    label: str
    study: Study
    whole: StudyData
    operations: int
    seconds: float


@dataclass(slots=True, kw_only=True)
class Tally:
    """What was seen so far."""

    kills: int = 0
    resumed: int = 0
    moments: Counter[str] = field(default_factory=Counter)
    algorithms: Counter[str] = field(default_factory=Counter)
    failures: list[str] = field(default_factory=list)


def main() -> int:
    """Run the storm; returns the exit code."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--kills", type=int, default=1000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--kinds", type=int, help="kinds of study, drawn at random; all if not given")
    parser.add_argument("--keep", type=Path, help="folder for studies that were lost or damaged")
    arguments = parser.parse_args()
    if _LIBRARY not in os.environ:
        _preload()
    shutil.rmtree(Path(os.environ[_LIBRARY]).parent, ignore_errors=True)
    os.environ.pop("LD_PRELOAD")
    tally = Tally()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        generator = random.Random(arguments.seed)
        ready: dict[tuple[str, str], Scenario] = {}
        began = _cpu_s()
        kinds = _kinds() if arguments.kinds is None else generator.sample(_kinds(), arguments.kinds)
        while tally.kills < arguments.kills:
            for key in generator.sample(kinds, len(kinds)):
                if tally.kills >= arguments.kills:
                    break
                if key not in ready:
                    ready[key] = _scenario(*key, folder)
                _one_study(ready[key], folder, generator, tally, arguments.keep)
            print(f"{tally.kills} kills, {len(tally.failures)} failures", file=sys.stderr, flush=True)
    seconds = _cpu_s() - began
    print(
        f"seed {arguments.seed}: {tally.kills} kills, {tally.resumed} studies ended and compared, {seconds:.0f} s CPU"
    )
    for what, counter in (("while", tally.moments), ("in", tally.algorithms)):
        print(f"  {what}: " + ", ".join(f"{key} {count}" for key, count in sorted(counter.items())))
    print(f"  lost, bricked or different: {len(tally.failures)}")
    for line in tally.failures:
        print(f"  {line}")
    return 1 if tally.failures else 0


def _cpu_s() -> float:
    """Processor time of this process and its ended children."""
    return sum(os.times()[:4])


def _preload() -> None:
    """Start this program again with the library; does not return."""
    folder = Path(tempfile.mkdtemp())
    library = str(folder / "kill_before.so")
    subprocess.run(["cc", "-shared", "-fPIC", "-o", library, _SOURCE, "-ldl"], check=True)
    environment = os.environ | {"LD_PRELOAD": library, _LIBRARY: library}
    os.execve(sys.executable, [sys.executable, *sys.orig_argv[1:]], environment)


def _kinds() -> list[tuple[str, str]]:
    """Every algorithm with every kind of study that it can search."""
    return [(name, shape) for name in ALGORITHMS for shape in _SHAPES if name != "weighted_cmaes" or shape in _WEIGHTED]


def _scenario(name: str, shape: str, folder: Path) -> Scenario:
    """A kind of study, run without being killed.

    It runs in this process, so that every fork has the imports, compiled code and maps that the study needs.
    """
    settings = [f'name = "{name}"', f"population = {_POPULATION}"]
    settings += ["height_weights = [0.3, 0.7]", "iterations = 3"] if name == "weighted_cmaes" else []
    settings += ["drawn_generations = 1"] if name == "surrogate" else []
    top, tables = _SHAPES[shape]
    place = Path(tempfile.mkdtemp(dir=folder))
    (place / "storm.toml").write_text(
        f'name = "storm"\nevaluations = {_POPULATION * _GENERATIONS}\n{top}{tables}[algorithm]\n' + "\n".join(settings)
    )
    study, library = load_study(place / "storm.toml"), ctypes.CDLL(None)
    runs.run(study, place / "warm.db", workers=1)
    began = time.monotonic()
    library.kill_before(_NEVER)
    runs.run(study, place / "whole.db", workers=1)
    return Scenario(
        label=f"{name}, {shape}",
        study=study,
        whole=read_study(place / "whole.db"),
        operations=library.operations(),
        seconds=time.monotonic() - began,
    )


def _one_study(scenario: Scenario, folder: Path, generator: random.Random, tally: Tally, keep: Path | None) -> None:
    """Run a study, killing it again and again, until it ends; then compare it."""
    place = folder / "killed"
    shutil.rmtree(place, ignore_errors=True)
    place.mkdir()
    db = place / "s.db"
    safe, history = 0, []
    try:
        while True:
            aim = _aim(scenario, generator, fresh=not db.exists())
            code, said = _run(scenario.study, db, 1 + generator.randrange(2), **aim)
            safe = max([safe, *map(int, _words(said, "safe"))])
            moment = (_words(said, "now") or ["starting"])[-1]
            history.append(f"{aim} -> {code} while {moment}, {safe} safe")
            if code == 0:
                break
            if code != -signal.SIGKILL:
                raise AssertionError(f"ended with {code}: {said}")
            tally.kills += 1
            tally.moments[moment] += 1
            tally.algorithms[scenario.study.algorithm.name] += 1
            _require_readable(db, safe)
        _require_equal(db, scenario.whole)
        left = sorted(path.name for path in place.iterdir() if path.name != db.name)
        if left:
            raise AssertionError(f"left beside the study: {left}")
        tally.resumed += 1
    except (AssertionError, ParetoMonopedError) as error:
        tally.failures.append(f"{scenario.label}: {error} after {history}")
        if keep is not None:
            shutil.copytree(place, keep / str(len(tally.failures)), dirs_exist_ok=True)


def _aim(scenario: Scenario, generator: random.Random, *, fresh: bool) -> dict[str, Any]:
    """When to kill the next run."""
    kind = generator.random()
    if kind < 0.3:
        return {"after_s": generator.uniform(0.0, 0.7 * scenario.seconds)}
    if kind < 0.5 and fresh:
        return {"kill_before": scenario.operations - generator.randrange(_AIMED_LAST)}
    most = scenario.operations if fresh else scenario.operations // 2
    return {"kill_before": 1 + generator.randrange(most)}


def _words(said: str, key: str) -> list[str]:
    return [line.removeprefix(key).strip() for line in said.splitlines() if line.startswith(f"{key} ")]


def _run(
    study: Study, db: Path, workers: int, *, kill_before: int = _NEVER, after_s: float | None = None
) -> tuple[int, str]:
    """Run or continue a study in a forked process; the code it ended with, and the complete lines that it said."""
    reading, writing = os.pipe()
    child = os.fork()
    if child == 0:
        os.close(reading)
        code = 1
        try:
            _child(study, db, workers, kill_before, writing)
            code = 0
        except BaseException:
            os.write(writing, f"error {traceback.format_exc()}\n".encode())
        finally:
            os._exit(code)
    os.close(writing)
    if after_s is not None:
        time.sleep(after_s)
        os.kill(child, signal.SIGKILL)
    with os.fdopen(reading, "rb") as pipe:
        said = pipe.read()
    code = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
    return code, said[: said.rfind(b"\n") + 1].decode()


def _child(study: Study, db: Path, workers: int, kill_before: int, pipe: int) -> None:
    """The run to be killed. It says what it is about to do, and which trials are safe."""

    def say(line: str) -> None:
        os.write(pipe, f"{line}\n".encode())

    def announced(owner: Any, name: str, moment: str, then: str) -> None:
        original = getattr(owner, name)

        def call(*args: Any, **options: Any) -> Any:
            say(f"now {moment}")
            result = original(*args, **options)
            say(f"now {then}")
            return result

        setattr(owner, name, call)

    announced(runs, "create_database", "creating", "preparing")
    announced(Store, "_open", "opening", "preparing")
    announced(Session, "go", "searching", "ending")
    announced(runs, "audit_front", "auditing", "ending")
    announced(Store, "__exit__", "closing", "ending")
    announced(Store, "add", "storing a generation", "searching")
    ctypes.CDLL(None).kill_before(kill_before)
    if db.exists() and workers == 1:
        runs.resume(db, workers=workers, progress=lambda p: say(f"safe {p.evaluations}"))
    else:
        runs.run(study, db, workers=workers, progress=lambda p: say(f"safe {p.evaluations}"))


def _require_readable(db: Path, safe: int) -> None:
    """Check that a killed study can be read and has what is safe."""
    if not db.exists():
        if safe:
            raise AssertionError(f"no database, although {safe} trials are safe")
        return
    stored = len(read_study(db).trials)
    if stored < safe or status(db)["evaluations"] != stored:
        raise AssertionError(f"{stored} trials stored, {safe} safe, status says {status(db)['evaluations']}")
    read_front(db)


def _require_equal(db: Path, whole: StudyData) -> None:
    """Check that a resumed study is sound, and equal to one that was never killed."""
    data = read_study(db)
    equal = {
        "trials": data.trials.equals(whole.trials),
        "front": read_front(db).rows.equals(whole.front()),
        "checkpoint": data.checkpoint == whole.checkpoint,
        "hash": data.meta.hash == whole.meta.hash,
        "end": (data.meta.finished, data.meta.stop_reason) == (whole.meta.finished, whole.meta.stop_reason),
        "history": data.history.drop(columns="seconds").equals(whole.history.drop(columns="seconds")),
        "audits": data.audits.equals(whole.audits),
    }
    if different := [name for name, same in equal.items() if not same]:
        raise AssertionError(f"resumed has other {', '.join(different)} than uninterrupted")
    if findings := verify(db).findings:
        raise AssertionError(f"verify: {'; '.join(findings)}")


if __name__ == "__main__":
    sys.exit(main())
