"""Cost of robust evaluation on a Dask cluster over that in one process, on the same cores.

A scheduler and one worker per core, with one thread each, run on this machine. The answers come first: both must store
the same, to the last bit. Then both are timed in turn, by the clock and by the processor time of all processes that
take part, scheduler and coordinator among them.

    python benchmarks/cluster_overhead.py              # 60 designs x 256 jumps, three pairs
    python benchmarks/cluster_overhead.py --designs 12 --pairs 1
"""

import argparse
import json
import os
import shutil
import socket
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from concurrent.futures import Executor
from contextlib import contextmanager
from pathlib import Path

from pareto_monoped.analysis.robustness import robust
from pareto_monoped.compute.chunks import cores
from pareto_monoped.definition.study import study_from_dict
from pareto_monoped.jump.peers import cluster
from pareto_monoped.storage.extra_rows import read_robustness
from pareto_monoped.storage.reader import read_study
from pareto_monoped.study.run import run
from pareto_monoped.uncertainty.settings import load_uncertainty

MOST_OVERHEAD = 0.15
"""What the executor may cost of what it shares out."""
_TICKS = os.sysconf("SC_CLK_TCK")


@contextmanager
def dask_here(workers: int, folder: Path) -> Iterator[tuple[str, list[int]]]:
    """A scheduler with workers of one thread each: its address, and the numbers of all processes."""
    with socket.socket() as found:
        found.bind(("127.0.0.1", 0))
        port = found.getsockname()[1]
    address = f"tcp://127.0.0.1:{port}"
    options = ["--nthreads", "1", "--no-nanny", "--local-directory", str(folder)]
    programs = [["scheduler", "--host", "127.0.0.1", "--port", str(port)]] + [["worker", address, *options]] * workers
    processes = []
    with (folder / "log").open("w") as log:
        for program, *rest in programs:
            command = [sys.executable, "-m", f"distributed.cli.dask_{program}", *rest, "--no-dashboard"]
            processes.append(subprocess.Popen(command, stdout=log, stderr=log))
    try:
        yield address, [process.pid for process in processes]
    finally:
        for process in processes:
            process.kill()
            process.wait()


def processor_s(processes: list[int]) -> float:
    """Processor time of this process and of others, from the start of each (Linux, ``proc(5)``: utime and stime)."""
    others = 0
    for process in processes:
        values = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()
        others += int(values[11]) + int(values[12])
    return time.process_time() + others / _TICKS


def timed(db: Path, trials: list[int], executor: Executor | None, processes: list[int]) -> tuple[float, float, Path]:
    """Wall and processor time of making trials robust in a copy of a study, and the copy."""
    copy = db.with_name(f"{time.monotonic_ns()}.db")
    shutil.copy(db, copy)
    wall_s, spent_s = time.perf_counter(), processor_s(processes)
    robust(copy, load_uncertainty(), trials=trials, workers=cores(), executor=executor)
    return time.perf_counter() - wall_s, processor_s(processes) - spent_s, copy


def main() -> None:
    """Measure and print; fails if the answers differ."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--designs", type=int, default=60)
    parser.add_argument("--pairs", type=int, default=3)
    asked = parser.parse_args()
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        study = {"name": "s", "evaluations": 4 * asked.designs, "audit": False, "algorithm": {"name": "random"}}
        run(study_from_dict(study, source="benchmark"), folder / "s.db")
        jumped = read_study(folder / "s.db").trials.query("status == 'ok'")["trial"].tolist()
        trials = jumped[: asked.designs]
        assert len(trials) == asked.designs, "too few designs jump"
        with dask_here(cores(), folder) as (address, processes), cluster(address, tell=print) as executor:
            here = timed(folder / "s.db", trials, None, processes)[2]
            there = timed(folder / "s.db", trials, executor, processes)[2]  # warms the workers
            assert read_robustness(here) == read_robustness(there), "the cluster stores other numbers"
            print(f"{len(trials)} designs x 256 jumps on {cores()} cores; the same numbers, to the last bit")
            pairs = []
            for _ in range(asked.pairs):
                one, other = (timed(folder / "s.db", trials, where, processes)[:2] for where in (None, executor))
                pairs.append({"wall": other[0] / one[0] - 1.0, "processor": other[1] / one[1] - 1.0})
                print(
                    f"threads {one[0]:.1f} s, processor {one[1]:.1f} s; cluster {other[0]:.1f} s, {other[1]:.1f} s; "
                    f"overhead {100 * pairs[-1]['wall']:+.1f} %, processor {100 * pairs[-1]['processor']:+.1f} %"
                )
    middle = {name: statistics.median(pair[name] for pair in pairs) for name in ("wall", "processor")}
    print(json.dumps({"overhead": middle, "allowed": MOST_OVERHEAD}))


if __name__ == "__main__":
    main()
