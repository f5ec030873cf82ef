"""Cost of a campaign whose jumps a Dask cluster simulates over the same campaign in processes, on the same cores.

A scheduler and one worker per core, with one thread each, run on this machine. The answers come first: every study must
store the same trials, checkpoint and front, to the last bit. Then both are timed in turn, as the command that users
give: by the clock, and by the processor time of all processes that take part, scheduler and workers among them.
Scheduler and workers use some processor time while they wait, too, which counts for more the longer a busy machine
takes: it is measured before, and the overhead is also given without it ("at work").

    python benchmarks/campaign_overhead.py             # six motors x 2,000 jumps, three pairs
    python benchmarks/campaign_overhead.py --jumps 200 --pairs 1
"""

import argparse
import json
import resource
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from cluster_overhead import MOST_OVERHEAD, dask_here, processor_s

from pareto_monoped.compute.chunks import cores
from pareto_monoped.storage.reader import read_study

_WAITING_S = 10.0
"""How long scheduler and workers are watched while they wait. Our own choice: a thousand ticks of their clocks."""
MOTORS = ("VT8020", "U8", "U10", "U12", "MN8014", "MAD_M6C12")


def timed(file: Path, address: str | None, processes: list[int]) -> tuple[float, float, Path]:
    """Wall and processor time of a campaign in a new folder, and the folder."""
    folder = file.with_name(str(time.monotonic_ns()))
    command = [sys.executable, "-m", "pareto_monoped", "campaign", str(file), "--folder", str(folder), "--json"]
    command += ["--workers", str(cores())] + (["--scheduler", address] if address else [])
    wall_s, spent_s = time.perf_counter(), processor_s(processes) + _ended_s()
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    return time.perf_counter() - wall_s, processor_s(processes) + _ended_s() - spent_s, folder


def _ended_s() -> float:
    """Processor time of programs that this process has waited for, and of theirs."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def waiting_share(processes: list[int]) -> float:
    """Processor time per time that scheduler and workers use without any work."""
    wall_s, spent_s = time.perf_counter(), processor_s(processes)
    time.sleep(_WAITING_S)
    return (processor_s(processes) - spent_s) / (time.perf_counter() - wall_s)


def require_equal(one: Path, other: Path) -> int:
    """Number of trials of both campaigns; stops if a study differs."""
    names = sorted(db.name for db in one.glob("*.db"))
    assert names == sorted(db.name for db in other.glob("*.db")), "the cluster has other studies"
    count = 0
    for name in names:
        here, there = read_study(one / name), read_study(other / name)
        assert here.trials.equals(there.trials), f"{name}: the cluster stores other trials"
        assert here.checkpoint == there.checkpoint, f"{name}: the cluster stores another checkpoint"
        assert here.front().equals(there.front()), f"{name}: the cluster finds another front"
        assert here.audits.equals(there.audits), f"{name}: the cluster audits otherwise"
        count += len(here.trials)
    return count


def main() -> None:
    """Measure and print; fails if the answers differ."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--jumps", type=int, default=2000, help="of each study")
    parser.add_argument("--pairs", type=int, default=3)
    asked = parser.parse_args()
    with tempfile.TemporaryDirectory() as place:
        file = Path(place) / "motors.toml"
        file.write_text(
            f'name = "motors"\n[study]\ncase = "C"\nevaluations = {asked.jumps}\n[axes]\nmotors = {list(MOTORS)}\n'
        )
        with dask_here(cores(), Path(place)) as (address, processes):
            here = timed(file, None, processes)[2]
            there = timed(file, address, processes)[2]  # warms the workers
            count = require_equal(here, there)
            print(f"{len(MOTORS)} studies, {count} jumps on {cores()} cores; the same studies, to the last bit")
            waiting = waiting_share(processes)
            print(f"scheduler and workers use {100 * waiting:.1f} % of a core while they wait")
            pairs = []
            for _ in range(asked.pairs):
                one, other = (timed(file, where, processes)[:2] for where in (None, address))
                at_work_s = other[1] - waiting * other[0]
                pairs.append(
                    {
                        "wall": other[0] / one[0] - 1.0,
                        "processor": other[1] / one[1] - 1.0,
                        "at_work": at_work_s / one[1] - 1.0,
                    }
                )
                print(
                    f"processes {one[0]:.1f} s, processor {one[1]:.1f} s; cluster {other[0]:.1f} s, {other[1]:.1f} s; "
                    f"overhead {', '.join(f'{name} {100 * value:+.1f} %' for name, value in pairs[-1].items())}",
                    flush=True,
                )
    middle = {name: statistics.median(pair[name] for pair in pairs) for name in pairs[0]}
    print(json.dumps({"overhead": middle, "allowed": MOST_OVERHEAD}))


if __name__ == "__main__":
    main()
