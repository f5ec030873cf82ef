"""What each evaluation costs those who share the work out: where larger studies will saturate.

    python benchmarks/saturation.py                            # all parts, small
    python benchmarks/saturation.py tasks --tasks 2000         # through a Dask scheduler with workers on this machine
    python benchmarks/saturation.py crew --workers 16 256 1024 # what sharing out costs with so many workers
    python benchmarks/saturation.py coordinator --evaluations 4000   # each algorithm, storage, everything else
    python benchmarks/saturation.py robustness --designs 64    # each design that is made robust
    python benchmarks/saturation.py front --fronts 1000 10000 100000 # following a long front

Processor times count on machines that have other work to do. ``tasks`` first checks that the scheduler's workers
compute the same numbers.
"""

import argparse
import os
import socket
import statistics
import struct
import tempfile
import threading
import time
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import ExitStack, suppress
from pathlib import Path
from typing import Any
from unittest.mock import patch

import numpy as np
from cluster_overhead import dask_here, processor_s
from numpy.typing import NDArray
from search_overhead import Timed

from pareto_monoped.analysis.robustness import robust
from pareto_monoped.compute.chunks import LEAST_TASK_S, cores
from pareto_monoped.compute.crew import Crew, Member, Staff
from pareto_monoped.definition.study import Study
from pareto_monoped.jump.evaluate import Evaluator
from pareto_monoped.jump.peers import cluster
from pareto_monoped.jump.shared import jumps_of, setup_text
from pareto_monoped.pareto.front import GrowingFront, front_mask
from pareto_monoped.pareto.objectives import HEIGHT_AND_ENERGY, hypervolume, reference_point
from pareto_monoped.search.registry import make_algorithm
from pareto_monoped.storage.columns import Generation
from pareto_monoped.storage.reader import read_study
from pareto_monoped.storage.store import Store
from pareto_monoped.study import session
from pareto_monoped.study.run import run
from pareto_monoped.study.session import Progress
from pareto_monoped.study.simulator import load_simulator
from pareto_monoped.uncertainty.samples import DEFAULT_SAMPLES, sobol_samples, variations
from pareto_monoped.uncertainty.settings import load_uncertainty

ALGORITHMS = ("surrogate", "nsga2", "sms_emoa", "age_moea2", "weighted_cmaes", "optuna_nsga2", "random")
_ONE_TASK = 278
"""Jumps of a quarter of a second, the least that a task has, where one takes 0.9 ms."""
_NEW = 80
"""Designs of a generation: of the default algorithm after its first ones."""
_ROUNDS = 8
"""Tasks per worker of a crew."""
_TCP_BYTES = struct.Struct("=120xQQ")
"""``struct tcp_info`` of Linux: bytes that the other side has confirmed, bytes received."""
_lock = threading.Lock()


def spent_s(processes: Sequence[int]) -> float:
    """Processor time of other processes, from the start of each."""
    return processor_s([*processes]) - time.process_time()


def nothing() -> None:
    """An empty task."""


def carried() -> tuple[int, int]:
    """Bytes sent and received so far by the open TCP connections of this process (Linux)."""
    sent = received = 0
    for name in os.listdir("/proc/self/fd"):
        with suppress(OSError), socket.socket(fileno=os.dup(int(name))) as one:
            pair = _TCP_BYTES.unpack_from(one.getsockopt(socket.IPPROTO_TCP, socket.TCP_INFO, _TCP_BYTES.size))
            sent, received = sent + pair[0], received + pair[1]
    return sent, received


def drawn(count: int) -> tuple[Study, Evaluator, NDArray[np.float64]]:
    """A study of Case C by random search, its evaluator on one thread, and the first designs that it draws."""
    settings = {"name": "random", "population": count}
    study = Study.define(name="s", case="C", evaluations=count, audit=False, algorithm=settings)
    simulator = load_simulator(study, workers=1)
    coordinates = simulator.coordinates(study)
    proposal = make_algorithm(study, coordinates).ask()
    assert proposal is not None
    return study, simulator.evaluator, coordinates.designs(proposal.values)


def tasks(asked: argparse.Namespace) -> None:
    """Tasks through a scheduler on this machine: processor time of all who take part, bytes at the coordinator."""
    _, evaluator, designs = drawn(_ONE_TASK)
    kits, text = np.zeros(len(designs), dtype=np.intp), setup_text(evaluator.actuator_maps, evaluator.calibration)
    expected = evaluator(designs)
    good = designs[int(np.flatnonzero(expected.status == "ok")[0])]
    built = variations(sobol_samples(load_uncertainty(), DEFAULT_SAMPLES), 1, evaluator.calibration)
    some: dict[str, tuple[int, Callable[..., object], tuple[Any, ...]]] = {
        "empty": (asked.tasks, nothing, ()),
        "1 jump": (asked.tasks // 10, jumps_of, (text, designs[:1], kits[:1], None)),
        f"{_ONE_TASK} jumps": (asked.tasks // 100, jumps_of, (text, designs, kits, None)),
        f"{DEFAULT_SAMPLES} jumps as built": (
            asked.tasks // 100,
            jumps_of,
            (text, np.tile(good, (DEFAULT_SAMPLES, 1)), kits[:DEFAULT_SAMPLES], built),
        ),
    }
    with (
        tempfile.TemporaryDirectory() as place,
        dask_here(cores(), Path(place)) as (address, (scheduler, *others)),
        cluster(address, tell=print) as executor,
    ):
        answer = executor.submit(jumps_of, text, designs, kits, None).result()
        assert answer.height_m.tobytes() == expected.height_m.tobytes(), "the workers compute other numbers"

        def now() -> NDArray[np.float64]:
            times = (time.perf_counter(), time.process_time(), spent_s([scheduler]), spent_s(others))
            return np.array([*times, *carried()], dtype=np.float64)

        print(f"{cores()} workers; every task carries its setup, {len(text):,} bytes of text\n")
        print("| task | tasks | wall, ms | coordinator, ms | scheduler, ms | workers, ms | sent, B | received, B |")
        print("|---|---:|---:|---:|---:|---:|---:|---:|")
        for name, (count, work, arguments) in some.items():
            count = max(count, 4)
            began = now()
            for future in [executor.submit(work, *arguments) for _ in range(count)]:
                future.result()
            each = (now() - began) / count
            times = " | ".join(f"{1000.0 * value:.2f}" for value in each[:4])
            print(f"| {name} | {count} | {times} | {each[4]:,.0f} | {each[5]:,.0f} |", flush=True)


class _Sleepers(Staff):
    """A staff of threads; their tasks only sleep, as those of other hosts do in this process."""

    label, cure = "threads", "start again"

    def __init__(self, count: int) -> None:
        self._pools = [ThreadPoolExecutor(1) for _ in range(count)]
        self._members = {str(k): Member(name=str(k), executor=pool) for k, pool in enumerate(self._pools)}

    def present(self) -> Mapping[str, Member]:
        """All of them."""
        return self._members

    def close(self) -> None:
        """End them."""
        for pool in self._pools:
            pool.shutdown()


def crew(asked: argparse.Namespace) -> None:
    """What the coordinator's crew takes per task with ever more workers, and how busy it keeps them.

    The tasks are sleeps of the least length that tasks have, so any number of workers fits on this machine.
    """
    print("| workers | tasks | coordinator, ms per task | workers busy |")
    print("|---:|---:|---:|---:|")
    for workers in asked.workers:
        with ExitStack() as stack:
            one = Crew(_Sleepers(workers), greeting=lambda _: None, check=lambda _: None)
            stack.callback(one.shutdown)
            one.submit(time.sleep, 0.0).result()
            count = workers * _ROUNDS
            wall_s, spent = time.perf_counter(), time.process_time()
            for future in [one.submit(time.sleep, LEAST_TASK_S) for _ in range(count)]:
                future.result()
            wall_s, spent = time.perf_counter() - wall_s, time.process_time() - spent
        busy = LEAST_TASK_S * _ROUNDS / wall_s
        print(f"| {workers:,} | {count:,} | {1000.0 * spent / count:.3f} | {100.0 * busy:.0f} % |", flush=True)


class Counted(ThreadPoolExecutor):
    """Threads that add up the processor time of their tasks."""

    seconds = 0.0

    def submit(self, function: Callable[..., Any], /, *arguments: Any, **named: Any) -> "Future[Any]":
        """Have a task done."""

        def work() -> Any:
            began = time.thread_time()
            try:
                return function(*arguments, **named)
            finally:
                with _lock:
                    self.seconds += time.thread_time() - began

        return super().submit(work)


def coordinator(asked: argparse.Namespace) -> None:
    """The coordinator's processor time per evaluation, by what it is spent on; other threads jump.

    The first tenth of each run, in which everything is compiled and filled, does not count.
    """
    print("| algorithm | evaluations | algorithm, ms | storage, ms | else, ms | together, ms | jumps, ms |")
    print("|---|---:|---:|---:|---:|---:|---:|")
    for name in asked.algorithms:
        study = Study.define(name="c", case="C", evaluations=asked.evaluations, audit=False, algorithm=name)
        with tempfile.TemporaryDirectory() as place:
            first, *_, last = _watched(study, Path(place) / "c.db")
        count = int(last[0] - first[0])
        whole, jumps, algorithm, storage = (1000.0 * (b - a) / count for a, b in zip(first[1:], last[1:], strict=True))
        own = whole - jumps
        parts = " | ".join(f"{value:.3f}" for value in (algorithm, storage, own - algorithm - storage, own, jumps))
        print(f"| `{name}` | {count:,} | {parts} |", flush=True)


def _watched(study: Study, db: Path) -> list[tuple[float, ...]]:
    """After each generation past the first tenth: evaluations, and seconds of process, jumps, algorithm and storage."""
    add, stored_s = Store.add, [0.0]
    made: list[Timed] = []
    found: list[tuple[float, ...]] = []

    def make(*given: Any) -> Timed:
        made.append(Timed(make_algorithm(*given)))
        return made[-1]

    def write(store: Store, generation: Generation) -> None:
        began = time.thread_time()
        add(store, generation)
        stored_s[0] += time.thread_time() - began

    def note(progress: Progress) -> None:
        if 10 * progress.evaluations >= study.evaluations:
            found.append((progress.evaluations, time.process_time(), executor.seconds, made[-1].seconds, stored_s[0]))

    with Counted(cores()) as executor, patch.object(session, "make_algorithm", make), patch.object(Store, "add", write):
        run(study, db, executor=executor, progress=note)
    return found


def robustness(asked: argparse.Namespace) -> None:
    """The coordinator's processor time per design that is made robust, after the first 32; other threads jump."""
    marks: list[tuple[float, ...]] = []
    with tempfile.TemporaryDirectory() as place, Counted(cores()) as executor:
        db = Path(place) / "r.db"
        run(Study.define(name="r", case="C", evaluations=2 * asked.designs, audit=False, algorithm="random"), db)
        trials = read_study(db).trials.query("status == 'ok'")["trial"].tolist()[: asked.designs]

        def note(done: int, _: int) -> None:
            marks.append((done, time.process_time(), executor.seconds))

        robust(db, load_uncertainty(), trials=trials, executor=executor, progress=note)
    count, whole, jumps = (b - a for a, b in zip(marks[0], marks[-1], strict=True))
    own_ms = 1000.0 * (whole - jumps) / count
    print(f"{count} designs after {marks[0][0]} others: the coordinator takes {own_ms:.1f} ms per design")


def front(asked: argparse.Namespace) -> None:
    """Processor time per generation of following a front and its hypervolume, against making both anew."""
    print(f"| designs on the front | followed, ms per {_NEW} designs | anew, ms | ratio |\n|---:|---:|---:|---:|")
    corner, generator = reference_point(HEIGHT_AND_ENERGY), np.random.default_rng(1)
    for count in asked.fronts:
        height_m = generator.uniform(0.6, 1.4, count + _NEW * _ROUNDS)
        # All are on the front, as nearly all are that a search finds late.
        values = np.column_stack((height_m, 10.0 * height_m**2))
        followed = GrowingFront(HEIGHT_AND_ENERGY)
        followed.add(np.arange(count), values[:count])
        times = []
        for first in range(count, len(values), _NEW):
            began = time.thread_time()
            followed.add(np.arange(first, first + _NEW), values[first : first + _NEW])
            volume = hypervolume(followed.values, corner)
            middle = time.thread_time()
            known = values[: first + _NEW]
            mask = front_mask(known, HEIGHT_AND_ENERGY)
            expected = hypervolume(known[mask], corner)
            times.append((middle - began, time.thread_time() - middle))
            if volume != expected or followed.numbers.tolist() != np.flatnonzero(mask).tolist():
                raise SystemExit("the front that was followed is another one; no figure counts")
        one, other = (1000.0 * statistics.median(column) for column in zip(*times, strict=True))
        ratio = statistics.median(a / b for a, b in times)
        print(f"| {count:,} | {one:.2f} | {other:.2f} | {ratio:.2f} |", flush=True)


_PARTS = {part.__name__: part for part in (tasks, crew, coordinator, robustness, front)}


def main() -> None:
    """Measure and print what was asked for."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("parts", nargs="*", metavar="PART", help=f"of {', '.join(_PARTS)}; all if none")
    parser.add_argument("--tasks", type=int, default=400, help="empty ones; of the others there are fewer")
    parser.add_argument("--workers", type=int, nargs="+", default=[16, 64], help="of the crew")
    parser.add_argument("--evaluations", type=int, default=400, help="of each algorithm")
    parser.add_argument("--algorithms", nargs="+", default=ALGORITHMS)
    parser.add_argument("--designs", type=int, default=40, help="to make robust, more than 32")
    parser.add_argument("--fronts", type=int, nargs="+", default=[1_000, 10_000], help="designs on a front")
    asked = parser.parse_args()
    if unknown := set(asked.parts) - set(_PARTS):
        parser.error(f"no such part: {', '.join(sorted(unknown))}")
    for name in asked.parts or _PARTS:
        print(f"\n{name}\n")
        _PARTS[name](asked)


if __name__ == "__main__":
    main()
