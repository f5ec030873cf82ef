"""What each evaluation costs in the database: storing by size of generation, and reading by number of rows.

    python benchmarks/storage.py                                        # both, small
    python benchmarks/storage.py --rows 20000 --sizes 40 80 400 2000    # rows per second, bytes per row
    python benchmarks/storage.py --rows 1000000 --sizes 2000 --db FILE  # also what the commands take that read FILE

What is stored are real jumps of a random search, the same ones again and again, each generation as a run stores it;
only safety factors differ, so that reasons of infeasible trials are as many texts as in a study. What was stored is
read back and compared. Processor times count on machines that have other work to do.
"""

import argparse
import subprocess
import sys
import tempfile
import time
from collections.abc import Mapping
from dataclasses import replace
from datetime import UTC, datetime
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from saturation import drawn

from pareto_monoped.compute.chunks import cores
from pareto_monoped.definition.algorithms import RandomSettings
from pareto_monoped.definition.study import Study
from pareto_monoped.jump.evaluate import Evaluations
from pareto_monoped.jump.variations import take
from pareto_monoped.search.scoring import judge
from pareto_monoped.storage.columns import Generation
from pareto_monoped.storage.lock import locked
from pareto_monoped.storage.reader import read_study
from pareto_monoped.storage.store import Store
from pareto_monoped.study.run import run

_JUMPED = 2_000
"""Jumps that are stored again and again."""
_SAFETIES = ("gear_safety", "chain_safety", "joint_safety", "link_safety")
_GOLDEN = 0.6180339887498949
_OBSERVED = """
import resource, subprocess, sys
subprocess.run(sys.argv[1:], check=True, stdout=subprocess.DEVNULL)
used = resource.getrusage(resource.RUSAGE_CHILDREN)
print(used.ru_utime + used.ru_stime, used.ru_maxrss)
"""
"""Prints processor time, s, and greatest memory, kB, of a command. In a small process of its own: Linux says that a
program has had the memory of who started it."""


def store(rows: int, sizes: list[int], kept: Path | None) -> None:
    """Rows per second of the store by size of generation."""
    print("| generation | rows | rows per second | CPU, ms per row | bytes per row | written, bytes per row |")
    print("|---:|---:|---:|---:|---:|---:|")
    study, evaluator, designs = drawn(min(rows, _JUMPED))
    jumped = evaluator(designs)
    for size in sizes:
        with tempfile.TemporaryDirectory() as place:
            db = kept or Path(place) / "s.db"
            one = replace(study, algorithm=RandomSettings(name="random", population=size))
            run(one, db, evaluations=size, workers=cores())
            data, empty = read_study(db), db.stat().st_size
            following = partial(_generation, one, size, designs, jumped, data.checkpoint.state, data.wall_time_s)
            wall_s, spent_s, written = time.perf_counter(), time.process_time(), _written()
            with locked(db) as lock, Store(db, one, lock=lock) as opened:
                for number in range(1, rows // size):
                    opened.add(following(number))
            wall_s, spent_s = time.perf_counter() - wall_s, time.process_time() - spent_s
            count = (rows // size - 1) * size
            each = [1000.0 * spent_s / count, (db.stat().st_size - empty) / count, (_written() - written) / count]
            print(f"| {size:,} | {count:,} | {count / wall_s:,.0f} | {each[0]:.3f} | {each[1]:,.0f} | {each[2]:,.0f} |")
            _require_all(db, size, count, jumped)


def _require_all(db: Path, size: int, count: int, jumped: Evaluations) -> None:
    """Stop if what is read back is not what was stored."""
    found = read_study(db).trials["height_m"].to_numpy()[size:]
    expected = jumped.height_m[np.arange(size, size + count) % len(jumped.height_m)]
    if not np.array_equal(found, expected, equal_nan=True):
        raise SystemExit(f"{db}: other heights are read than were stored; no figure counts")


def _generation(
    study: Study,
    size: int,
    designs: NDArray[np.float64],
    jumped: Evaluations,
    state: Mapping[str, Any],
    begun_s: float,
    number: int,
) -> Generation:
    """A generation of the jumps that come next."""
    rows = np.arange(number * size, (number + 1) * size) % len(designs)
    evaluations, now = take(jumped, rows), datetime.now(UTC)
    share = 1.0 - 0.1 * (number * _GOLDEN % 1.0)
    safeties: dict[str, Any] = {name: share * evaluations.of(name) for name in _SAFETIES}
    evaluations = replace(evaluations, **safeties)
    return Generation(
        number=number,
        first_trial=number * size,
        designs=designs[rows],
        evaluations=evaluations,
        judgement=judge(evaluations, study.constraints, study.objectives),
        height_weight=None,
        state=state,
        hypervolume=1.0,
        seconds=begun_s + number,
        started=now,
        ended=now,
    )


def _written() -> int:
    """Bytes that this process has had written to disks so far (Linux, ``proc(5)``)."""
    lines = Path("/proc/self/io").read_text().splitlines()
    return int(dict(line.split(": ") for line in lines)["write_bytes"])


def read(db: Path) -> None:
    """Processor time, wall time and greatest memory of the commands that read a study, each in a new process."""
    print(f"\n{db.stat().st_size / 1e6:,.0f} MB\n\n| command | CPU, s | wall, s | memory, MB |\n|---|---:|---:|---:|")
    with tempfile.TemporaryDirectory() as place:
        for words in (
            ["--version"],
            ["status", str(db)],
            ["front", str(db), "--json"],
            ["pick", str(db), "--knee"],
            ["trials", str(db), "--csv", f"{place}/t.csv"],
            ["report", str(db), "--no-jumps", "-o", f"{place}/r.html"],
            ["verify", str(db)],
        ):
            wall_s = time.perf_counter()
            command = [sys.executable, "-m", "pareto_monoped", *words]
            said = subprocess.run([sys.executable, "-c", _OBSERVED, *command], check=True, capture_output=True).stdout
            wall_s = time.perf_counter() - wall_s
            busy_s, peak_kb = map(float, said.split())
            print(f"| `{words[0]}` | {busy_s:.2f} | {wall_s:.2f} | {peak_kb / 1e3:.0f} |", flush=True)


def main() -> None:
    """Measure and print; a database that is there is only read."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--rows", type=int, default=4_000)
    parser.add_argument("--sizes", type=int, nargs="+", default=[40, 1_000], help="of generations")
    parser.add_argument("--db", type=Path, help="store here, or only read what is here; one size")
    asked = parser.parse_args()
    if asked.db is not None and len(asked.sizes) > 1 and not asked.db.exists():
        parser.error("one database takes one of --sizes")
    with tempfile.TemporaryDirectory() as place:
        kept = asked.db or Path(place) / "last.db"
        if asked.db is None:
            store(asked.rows, asked.sizes, None)
        if not kept.exists():
            store(asked.rows, asked.sizes[-1:], kept)
        read(kept)


if __name__ == "__main__":
    main()
