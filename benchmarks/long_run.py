"""Many evaluations in one process: whether memory stays flat, the rate up and the database linear.

    python benchmarks/long_run.py                               # 10,000 jumps
    python benchmarks/long_run.py --evaluations 500000          # what benchmarks/long_run.md shows
    python benchmarks/long_run.py --algorithm nsga2 --db FILE   # another algorithm; keeps the database

A real study runs from its first trial to its last, audit left out. Each row is a tenth of it: resident memory and the
database's size at its end, and what each evaluation of this tenth took: wall and processor time, and bytes of database.
The size is that of the file and its write-ahead log together, as a disk sees it. Processor time counts on machines that
have other work to do. The rows of memory leave out what reading the whole study at the end takes; that has a row of its
own.
"""

import argparse
import gc
import resource
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from pareto_monoped.compute.chunks import cores
from pareto_monoped.definition.algorithms import DEFAULT_ALGORITHM
from pareto_monoped.definition.study import Study
from pareto_monoped.study.run import run
from pareto_monoped.study.session import Progress

_PARTS = 10
_PAGE_BYTES = resource.getpagesize()


@dataclass(frozen=True, slots=True, kw_only=True)
class Sample:
    """Where the process stood when ``evaluations`` were stored."""

    evaluations: int
    wall_s: float
    cpu_s: float
    resident_mb: float
    stored_bytes: int


def stored_bytes(db: Path) -> int:
    """What a study takes on the disk, in bytes: its file and its write-ahead log, if there is one."""
    return sum(file.stat().st_size for file in (db, db.with_name(f"{db.name}-wal")) if file.exists())


def sample(evaluations: int, db: Path) -> Sample:
    """Where this process and its database stand now."""
    return Sample(
        evaluations=evaluations,
        wall_s=time.perf_counter(),
        cpu_s=time.process_time(),
        resident_mb=int(Path("/proc/self/statm").read_text().split()[1]) * _PAGE_BYTES / 1e6,
        stored_bytes=stored_bytes(db),
    )


@contextmanager
def database(given: Path | None) -> Iterator[Path]:
    """The database to run into: the given one, or one that is deleted afterwards."""
    if given is not None:
        yield given
        return
    with tempfile.TemporaryDirectory() as folder:
        yield Path(folder) / "long.db"


def table(samples: list[Sample]) -> list[str]:
    """The samples in Markdown, each with what the evaluations since the one before have cost."""
    lines = [
        "| evaluations | memory, MB | database, MB | bytes each | wall, ms each | CPU, ms each |",
        "|---:|---:|---:|---:|---:|---:|",
    ]
    for before, after in pairwise(samples):
        count = after.evaluations - before.evaluations
        wall, cpu = (1000.0 * (b - a) / count for a, b in ((before.wall_s, after.wall_s), (before.cpu_s, after.cpu_s)))
        size_mb, each = after.stored_bytes / 1e6, (after.stored_bytes - before.stored_bytes) / count
        lines.append(
            f"| {after.evaluations:,} | {after.resident_mb:.1f} | {size_mb:.1f} | {each:.0f} | {wall:.3f} | {cpu:.3f} |"
        )
    return lines


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--evaluations", type=int, default=10_000, help="of the study; at least ten generations")
    parser.add_argument("--algorithm", default=DEFAULT_ALGORITHM.name)
    parser.add_argument("--workers", type=int, default=cores())
    parser.add_argument("--db", type=Path, help="keep the study here")
    arguments = parser.parse_args()
    evaluations, searched = arguments.evaluations, arguments.algorithm
    study = Study.define(name="long", case="C", evaluations=evaluations, audit=False, algorithm=searched)
    samples: list[Sample] = []

    def watch(progress: Progress) -> None:
        if progress.evaluations * _PARTS >= len(samples) * evaluations or not samples:
            samples.append(sample(progress.evaluations, db))
            print(samples[-1], file=sys.stderr, flush=True)

    with database(arguments.db) as db:
        run(study, db, workers=arguments.workers, progress=watch)
        size_mb = db.stat().st_size / 1e6
    gc.collect()
    print(
        f"{evaluations:,} evaluations of Case C by {searched}, {arguments.workers} workers, {size_mb:.0f} MB stored:\n"
    )
    print("\n".join(table(samples)))
    first, last = samples[1], samples[-1]
    rates = [(b.evaluations - a.evaluations) / (b.cpu_s - a.cpu_s) for a, b in ((samples[0], first), samples[-2:])]
    print(f"\nmemory at the end / after the first tenth  {last.resident_mb / first.resident_mb:.3f}")
    print(f"rate at the end / in the first tenth       {rates[1] / rates[0]:.3f} by processor time")
    print(
        f"greatest memory, with reading at the end   {resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e3:.0f} MB"
    )


if __name__ == "__main__":
    main()
