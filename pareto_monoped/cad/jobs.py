"""Export many designs, each in its own process and folder; what is there already is not made again."""

import json
import math
import multiprocessing
import signal
from collections.abc import Callable, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from typing import Any

from pareto_monoped.actuator.motors import Motor
from pareto_monoped.actuator.search import map_of
from pareto_monoped.cad.export import FORMATS, RECORD, chosen_formats, export_design
from pareto_monoped.cad.write.documents import MADE_BY, contents
from pareto_monoped.config import checked
from pareto_monoped.design import NAMES, Design
from pareto_monoped.errors import CalibrationError, InputError, MotorError
from pareto_monoped.jump.calibration import Calibration


@dataclass(frozen=True, slots=True, kw_only=True)
class Job:
    """One design to export: everything that another process needs.

    Attributes:
        design: as searched.
        motor, calibration: what it was found with.
        folder: where to.
        formats: of ``FORMATS``.
        force: replace an export of something else.
        source: where the design comes from.
        hip_rad, knee_rad: angles of the assembly, in place of the start pose's.
    """

    design: Design
    motor: Motor
    calibration: Calibration
    folder: Path
    formats: tuple[str, ...] = FORMATS
    force: bool = False
    source: dict[str, Any]
    hip_rad: float | None = None
    knee_rad: float | None = None


def recorded(
    path: Path,
    *,
    folder: Path,
    formats: Sequence[str] | None = None,
    force: bool = False,
    note: Callable[[str], None] = lambda _: None,
) -> Job:
    """The job that makes an export again from its ``design.json``: the same bytes, by the same version.

    Args:
        path: the record.
        folder: where to.
        formats: some of ``FORMATS``; default those of the record.
        force: replace an earlier export there.
        note: told if another version made the record.

    Raises:
        InputError: the file is missing, or no record of an export, or its motor or calibration is impossible.
    """
    told = f"design record {str(path)!r}"
    try:
        record = json.loads(path.read_text(encoding="utf-8"))
        design = Design.from_array([_finite(record["searched"][name]) for name in NAMES])
        angles = {name: _finite(record["pose"][name]) for name in ("hip_rad", "knee_rad")}
        values, model = dict(record["motor_data"]), dict(record["calibration_data"])
        source = dict(record["source"])
        wanted = [str(name) for name in record["formats"]]
        maker = str(record["made_by"])
    except OSError as problem:
        raise InputError(f"{told}: cannot be read ({problem.strerror}); give the design.json of an export") from None
    except (ValueError, KeyError, TypeError, AttributeError, OverflowError, RecursionError) as problem:
        why = f"no {problem}" if isinstance(problem, KeyError) else str(problem).splitlines()[0]
        raise InputError(f"{told}: is no record of an export ({why}); give the design.json of one") from None
    if maker != MADE_BY:
        note(f"{told} was made by {maker!r}, this is {MADE_BY}: files may differ")
    return Job(
        design=design,
        motor=checked(Motor, values, source=told, error=MotorError),
        calibration=checked(Calibration, model, source=told, error=CalibrationError),
        folder=folder,
        formats=chosen_formats(wanted if formats is None else formats),
        force=force,
        source=source,
        **angles,
    )


def _finite(value: Any) -> float:
    number = float(value)
    if not math.isfinite(number):
        raise ValueError(f"{number} is no number")
    return number


def run(job: Job, *, progress: Callable[[str], None] = lambda _: None) -> dict[str, Any]:
    """Export one design, see ``export_design``; the content of its ``design.json``."""
    return export_design(
        job.design,
        map_of(job.motor),
        job.calibration,
        job.folder,
        formats=job.formats,
        force=job.force,
        source=job.source,
        hip_rad=job.hip_rad,
        knee_rad=job.knee_rad,
        progress=progress,
    ).record


def is_made(job: Job) -> bool:
    """Whether the folder holds this very design already, whole: its record is written last."""
    try:
        record = json.loads((job.folder / RECORD).read_text(encoding="utf-8"))
        return bool(
            record["made_by"] == MADE_BY
            and record["searched"] == job.design.as_dict()
            and record["source"] == job.source
            and record["motor_data"] == contents(job.motor)
            and record["calibration_data"] == contents(job.calibration)
            and set(job.formats) <= set(record["formats"])
            and all((job.folder / str(name)).is_file() for name in record["files"])
        )
    except (OSError, ValueError, KeyError, TypeError):
        return False


def run_all(jobs: Sequence[Job], *, workers: int, done: Callable[[Job], None] = lambda _: None) -> int:
    """Export designs in parallel; the first failure stops the rest and is raised, as does an interrupt.

    Exports in progress are finished then, so that every folder is whole; the same call goes on with the rest.

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
    # Fresh processes: the CAD kernel's and the simulator's threads do not survive a fork. Ctrl-C reaches them too; they
    # leave it to this process and finish the folders that they are at.
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(
        max_workers=min(workers, len(todo)),
        mp_context=context,
        initializer=signal.signal,
        initargs=(signal.SIGINT, signal.SIG_IGN),
    ) as pool:
        # No more are handed over than are worked on: an executor finishes what it has, come what may.
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
