"""Run export jobs: one here, or many in parallel, each in its own process and folder."""

import multiprocessing
import signal
from collections.abc import Callable, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from itertools import islice
from typing import Any

from pareto_monoped.actuator.search import map_of
from pareto_monoped.cad.export import export_design
from pareto_monoped.cad.jobs import Job
from pareto_monoped.cad.made import is_made


def run(job: Job, *, progress: Callable[[str], None] = lambda _: None) -> dict[str, Any]:
    """Export one design, see ``export_design``; returns the content of its ``design.json``."""
    return export_design(
        job.design,
        map_of(job.motor, job.rules),
        job.calibration,
        job.folder,
        formats=job.formats,
        force=job.force,
        source=job.source,
        hip_rad=job.hip_rad,
        knee_rad=job.knee_rad,
        progress=progress,
    ).record


def run_all(jobs: Sequence[Job], *, workers: int, done: Callable[[Job], None] = lambda _: None) -> int:
    """Export designs in parallel; the first failure stops the rest and is raised, as does an interrupt.

    Exports in progress are finished then, so that every folder is complete; the same call continues with the rest.

    Args:
        jobs: what to export; what is made already is left alone.
        workers: number of processes.
        done: called with each job as soon as it is made.

    Returns:
        How many were made.
    """
    todo = [job for job in jobs if not is_made(job)]
    if not todo:
        return 0
    # Fresh processes: the CAD kernel's and the simulator's threads do not survive a fork. Ctrl-C reaches them too; they
    # leave it to this process and finish the folders that they are at.
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(
        max_workers=min(workers, len(todo)),
        mp_context=context,
        initializer=signal.signal,
        initargs=(signal.SIGINT, signal.SIG_IGN),
    ) as pool:
        # Hand over no more jobs than there are workers: an executor finishes what it has, come what may.
        waiting = iter(todo)
        running: dict[Future[dict[str, Any]], Job] = {}
        while True:
            for job in islice(waiting, workers - len(running)):
                running[pool.submit(run, job)] = job
            if not running:
                break
            for future in wait(running, return_when=FIRST_COMPLETED).done:
                future.result()
                done(running.pop(future))
    return len(todo)
