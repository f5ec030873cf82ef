"""Export jobs: one here, or many in parallel, each in a process of this machine or on an executor.

What an executor makes, perhaps on another machine, is sent back as files and written here.
"""

import tempfile
import threading
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Executor, Future, as_completed, wait
from dataclasses import dataclass, replace
from pathlib import Path, PurePosixPath
from typing import Any

from pareto_monoped.cad.export import ExportSummary, export_design
from pareto_monoped.cad.interrupt import end_process
from pareto_monoped.cad.jobs import Job
from pareto_monoped.cad.records import is_made
from pareto_monoped.cad.write.folder import beside, files_in, move_in, require_free, write
from pareto_monoped.compute.processes import Processes, end_by
from pareto_monoped.errors import OutputError, ParetoMonopedError

_lock = threading.Lock()
"""A process has one CAD kernel, so it makes one export at a time."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Progress:
    """How far a batch is."""

    job: Job  #: the one that was made last
    made: int  #: how many were made so far
    total: int  #: how many there are to make
    elapsed_s: float

    @property
    def left_s(self) -> float:
        """Time that the rest takes at the mean speed so far."""
        return self.elapsed_s / self.made * (self.total - self.made)


def run(
    job: Job, *, progress: Callable[[str], None] = lambda _: None, note: Callable[[str], None] = lambda _: None
) -> dict[str, Any]:
    """Export one design, see ``export_design``; returns the content of its ``design.json``.

    Args:
        job: the design, and where it goes.
        progress: called with the name of each step as it begins.
        note: called with a line of advice, if there is any.
    """
    summary = _exported(job, progress)
    if summary.gear_life is not None and summary.gear_life.advice:
        note(summary.gear_life.advice)
    return summary.record


def run_all(
    jobs: Sequence[Job],
    *,
    workers: int,
    executor: Executor | None = None,
    progress: Callable[[Progress], None] = lambda _: None,
) -> int:
    """Export designs in parallel; the same call continues with what is not made yet.

    The first failure is raised when the exports in progress have ended. An interrupt ends them at once; each folder is
    then complete or absent.

    Args:
        jobs: what to export; what is made already is left alone.
        workers: number of processes.
        executor: makes the exports in their place, perhaps elsewhere; their files are written here.
        progress: called after every job.

    Returns:
        How many were made.
    """
    todo = [job for job in jobs if not is_made(job)]
    if not todo:
        return 0
    start_s = time.monotonic()

    def count(done: Iterable[Job]) -> int:
        for made, job in enumerate(done, 1):
            progress(Progress(job=job, made=made, total=len(todo), elapsed_s=time.monotonic() - start_s))
        return len(todo)

    if executor is not None:
        return count(sent(todo, executor))
    number = min(workers, len(todo))
    with Processes(number, lost=_lost) as processes:
        return count(_made(todo, processes, number))


def _made(jobs: Sequence[Job], processes: Processes, count: int) -> Iterator[Job]:
    """Each job as soon as it is made; after the first failure, which is raised at the end, none is begun."""
    waiting, running = iter(jobs), dict[Future[None], Job]()
    failure: BaseException | None = None
    while True:
        while failure is None and len(running) < count and (job := next(waiting, None)) is not None:
            running[processes.submit(_make, job)] = job
        if not running:
            break
        for future in wait(running, return_when=FIRST_COMPLETED).done:
            job = running.pop(future)
            if (problem := future.exception()) is None:
                yield job
            failure = failure or problem
    if failure is not None:
        raise failure


def _make(job: Job) -> None:
    """Make an export in a process of a batch."""
    end_by(end_process)
    run(job)


def _lost(_: int) -> Exception:
    return RuntimeError("a worker process ended by itself; run the same command again")


def sent(jobs: Sequence[Job], executor: Executor) -> Iterator[Job]:
    """Export designs on an executor, and yield each job once its folder is whole, in any order.

    Raises:
        ParetoMonopedError: see ``export_design``; exports that have not begun are then called off.
    """
    for job in jobs:
        require_free(job.folder, force=job.force)
    # The folder's text is only for messages: another machine may have other paths.
    futures = {executor.submit(made_files, job, str(job.folder)): job for job in jobs}
    try:
        for future in as_completed(futures):
            job = futures.pop(future)
            _write(job, future.result())
            yield job
    finally:
        for future in futures:
            future.cancel()


def made_files(job: Job, name: str) -> dict[str, bytes]:
    """What a worker does: make an export in a folder of its own, and return its files: content by path.

    Args:
        job: the design; its folder plays no part.
        name: the folder that messages speak of.

    Raises:
        ParetoMonopedError: see ``export_design``.
    """
    with _lock, tempfile.TemporaryDirectory(prefix="export-") as place:
        folder = Path(place) / "made"
        try:
            _exported(replace(job, folder=folder, force=False))
        except ParetoMonopedError as error:
            raise type(error)(str(error).replace(str(folder), name)) from None
        return {Path(path).as_posix(): (folder / path).read_bytes() for path in files_in(folder)}


def _exported(job: Job, progress: Callable[[str], None] = lambda _: None) -> ExportSummary:
    return export_design(
        job.design,
        job.maps(),
        job.calibration,
        job.folder,
        formats=job.formats,
        force=job.force,
        source=job.source,
        strength=job.strength,
        hip_rad=job.hip_rad,
        knee_rad=job.knee_rad,
        progress=progress,
    )


def _write(job: Job, content: dict[str, bytes]) -> None:
    """Put an export's files in the job's folder."""
    with beside(job.folder) as folder:
        for name, data in content.items():
            path = PurePosixPath(name)
            if path.is_absolute() or ".." in path.parts:
                raise OutputError(f"file {name!r} of an export: leads out of its folder; check the worker it came from")
            write(folder, name, data)
        move_in(folder, job.folder)
