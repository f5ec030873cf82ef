"""How long a generation takes to store on a PostgreSQL server beside a file, and to read again.

    python benchmarks/server_storage.py postgresql://USER@HOST/DATABASE [--size 100] [--generations 40]

The same generations of made numbers go into a new file and a new schema of the server, in turns, each in a transaction
that waits for the disk. Before anything is timed, both must have the same rows and the same running hash. The schema is
dropped at the end. Times are medians; the ratio is the median of the ratios of the pairs.
"""

import argparse
import tempfile
import time
from collections.abc import Callable, Sequence
from contextlib import closing
from datetime import UTC, datetime
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np

from pareto_monoped.definition import provenance
from pareto_monoped.definition.study import Study, study_from_dict
from pareto_monoped.jump.evaluate import Evaluations
from pareto_monoped.measures import MEASURE_NAMES
from pareto_monoped.search.registry import make_algorithm
from pareto_monoped.search.scoring import judge
from pareto_monoped.storage.address import Server
from pareto_monoped.storage.columns import Generation
from pareto_monoped.storage.front_reader import read_front
from pareto_monoped.storage.meta import StudyMeta
from pareto_monoped.storage.place import StudyPlace, place_of, storage_of
from pareto_monoped.storage.reader import read_study
from pareto_monoped.storage.status import read_summary
from pareto_monoped.storage.store import Store, create_database

SCHEMA = "monoped_server_storage"


def generation(study: Study, number: int, size: int) -> Generation:
    """A generation of drawn numbers, the same for the same ``number``."""
    draw = np.random.default_rng(number)
    columns = {name: draw.random(size) for name in MEASURE_NAMES}
    evaluations = Evaluations(status=np.array(["ok"] * size), reason=("",) * size, **columns)
    now = datetime(2025, 1, 1, tzinfo=UTC)
    return Generation(
        number=number,
        first_trial=number * size,
        designs=draw.uniform(study.lower, study.upper, (size, len(study.lower))),
        evaluations=evaluations,
        judgement=judge(evaluations, study.constraints, study.objectives),
        height_weight=None,
        state={"population": draw.random((size, 8)).tolist()},
        hypervolume=float(number),
        seconds=float(number),
        started=now,
        ended=now,
    )


def meta(study: Study) -> StudyMeta:
    """What a study stores of itself, without motor and calibration."""
    versions = provenance.versions(study)
    return StudyMeta(
        study=study.as_dict(),
        motor=study.motor_text,
        calibration="none",
        seed=study.seed,
        contents={},
        files={},
        versions=versions,
        environment=provenance.environment(),
        hash="",
        probe=[],
        created="2025-01-01T00:00:00+00:00",
        budget=study.evaluations,
        finished=False,
        stop_reason=None,
    )


def rows(place: StudyPlace) -> list[Any]:
    """All trials and the chain of the running hash."""
    with storage_of(place).reading() as connection:
        trials: list[Any] = connection.execute("SELECT * FROM monoped_trials ORDER BY trial").fetchall()
        trials += connection.execute("SELECT link, hash FROM monoped_seals ORDER BY link").fetchall()
        return trials


def timed(act: Callable[..., Any], *arguments: Any) -> float:
    """Seconds that a call takes."""
    began = time.perf_counter()
    act(*arguments)
    return time.perf_counter() - began


def report(what: str, pairs: Sequence[tuple[float, float]], size: int | None = None) -> None:
    """Print the medians of pairs of seconds: in a file and on the server."""
    here, there = (median(side) for side in zip(*pairs, strict=True))
    line = f"{what:<28} file {1e3 * here:8.2f} ms, server {1e3 * there:8.2f} ms, "
    line += f"ratio {median(b / a for a, b in pairs):.2f}"
    if size:
        line += f"; {size / here:,.0f} and {size / there:,.0f} trials per second"
    print(line)


def compare(file: Path, server: Server, size: int, generations: int) -> None:
    """Store, compare and read in both places."""
    study = study_from_dict({"name": "storage", "evaluations": size * generations}, source="benchmark")
    for place in (file, server):
        create_database(place, study, meta(study), make_algorithm(study).state())
    pairs = []
    with Store(file, study) as here, Store(server, study) as there:
        for number in range(generations):
            made = generation(study, number, size)
            first, second = (here, there) if number % 2 else (there, here)
            seconds = [timed(store.add, made) for store in (first, second)]
            pairs.append((seconds[0], seconds[1]) if number % 2 else (seconds[1], seconds[0]))
    if rows(file) != rows(server):
        raise SystemExit("the two places hold different rows")
    report(f"store {size} trials", pairs, size)
    for what, read in (("summary", read_summary), ("front", read_front), ("all trials", read_study)):
        report(f"read {what}", [(timed(read, file), timed(read, server)) for _ in range(5)])


def main() -> None:
    """Compare a file in a temporary folder with the server of the command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("address")
    parser.add_argument("--size", type=int, default=100)
    parser.add_argument("--generations", type=int, default=40)
    given = parser.parse_args()
    server = place_of(given.address)
    if isinstance(server, Path):
        raise SystemExit("give the address of a server")
    from pareto_monoped.storage.server import ServerConnection

    server = server.of_schema(SCHEMA)
    try:
        with tempfile.TemporaryDirectory() as folder:
            compare(Path(folder) / "s.db", server, given.size, given.generations)
    finally:
        with closing(ServerConnection(server)) as session:
            session.execute(f"DROP SCHEMA IF EXISTS {SCHEMA} CASCADE")


if __name__ == "__main__":
    main()
