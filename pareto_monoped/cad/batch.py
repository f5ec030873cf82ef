"""Export many designs, each in its own process and folder; what is there already is not made again."""

import json
import multiprocessing
from collections.abc import Callable, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pareto_monoped import __version__
from pareto_monoped.cad.export import FORMATS, RECORD, export_design
from pareto_monoped.design import Design


@dataclass(frozen=True, slots=True, kw_only=True)
class Job:
    """One design to export: everything that another process needs.

    Attributes:
        design: as searched.
        motor: name or file.
        calibration: name or file.
        folder: where to.
        formats: of ``FORMATS``.
        force: replace an export of something else.
        source: where the design comes from.
    """

    design: Design
    motor: str
    calibration: str
    folder: Path
    formats: tuple[str, ...] = FORMATS
    force: bool = False
    source: dict[str, Any]


def run(
    job: Job,
    *,
    progress: Callable[[str], None] = lambda _: None,
    hip_rad: float | None = None,
    knee_rad: float | None = None,
) -> dict[str, Any]:
    """Export one design, see ``export_design``; the content of its ``design.json``."""
    from pareto_monoped.actuator.search import map_for
    from pareto_monoped.jump.calibration import load_calibration

    return export_design(
        job.design,
        map_for(job.motor),
        load_calibration(job.calibration),
        job.folder,
        formats=job.formats,
        force=job.force,
        source=job.source,
        hip_rad=hip_rad,
        knee_rad=knee_rad,
        progress=progress,
    ).record


def is_made(job: Job) -> bool:
    """Whether the folder holds this very design already, whole: its record is written last."""
    try:
        record = json.loads((job.folder / RECORD).read_text(encoding="utf-8"))
        return bool(
            record["made_by"] == f"pareto-monoped {__version__}"
            and record["searched"] == job.design.as_dict()
            and record["source"] == job.source
            and set(job.formats) <= set(record["formats"])
            and all((job.folder / str(name)).is_file() for name in record["files"])
        )
    except (OSError, ValueError, KeyError, TypeError):
        return False


def run_all(jobs: Sequence[Job], *, workers: int, done: Callable[[Job], None] = lambda _: None) -> int:
    """Export designs in parallel; the first failure stops the rest and is raised.

    Args:
        jobs: what to export; what is made already is left alone.
        workers: number of processes.
        done: told after each one that was made.

    Returns:
        How many were made.
    """
    todo = [job for job in jobs if not is_made(job)]
    if not todo:
        return 0
    # Fresh processes: the CAD kernel's and the simulator's threads do not survive a fork.
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(max_workers=min(workers, len(todo)), mp_context=context) as pool:
        running: dict[Future[dict[str, Any]], Job] = {pool.submit(run, job): job for job in todo}
        try:
            while running:
                finished, _ = wait(running, return_when=FIRST_COMPLETED)
                for future in finished:
                    future.result()
                    done(running.pop(future))
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            raise
    return len(todo)
