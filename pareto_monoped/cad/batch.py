"""Run export jobs: one here, or many in parallel, each in its own process and folder or on an executor."""

import time
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass
from typing import Any

from pareto_monoped.cad.export import export_design
from pareto_monoped.cad.jobs import Job
from pareto_monoped.cad.records import is_made
from pareto_monoped.cad.sent import exported
from pareto_monoped.cad.workers import Workers


@dataclass(frozen=True, slots=True, kw_only=True)
class Progress:
    """How far a batch is."""

    job: Job  #: the one that was made last
    made: int  #: how many were made so far
    total: int  #: how many there are to make
    elapsed_s: float  #: time since the beginning

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
    summary = export_design(
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
        return count(exported(todo, executor))
    with Workers(run, min(workers, len(todo))) as processes:
        return count(processes.do(todo))
