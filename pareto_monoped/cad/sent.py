"""Exports that an executor makes, perhaps on another machine: their files are sent back and written here."""

import tempfile
import threading
from collections.abc import Iterator, Sequence
from concurrent.futures import Executor, as_completed
from dataclasses import replace
from pathlib import Path, PurePosixPath

from pareto_monoped.cad.export import export_design
from pareto_monoped.cad.jobs import Job
from pareto_monoped.cad.write.folder import beside, files_in, move_in, require_free, write
from pareto_monoped.errors import OutputError, ParetoMonopedError

_lock = threading.Lock()
"""A process has one CAD kernel, so it makes one export at a time."""


def exported(jobs: Sequence[Job], executor: Executor) -> Iterator[Job]:
    """Export designs, and yield each job once its folder is whole, in any order.

    Args:
        jobs: the designs.
        executor: makes the files.

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
        here = replace(job, folder=folder, force=False)
        try:
            export_design(
                here.design,
                here.maps(),
                here.calibration,
                folder,
                formats=here.formats,
                source=here.source,
                strength=here.strength,
                hip_rad=here.hip_rad,
                knee_rad=here.knee_rad,
            )
        except ParetoMonopedError as error:
            raise type(error)(str(error).replace(str(folder), name)) from None
        return {Path(path).as_posix(): (folder / path).read_bytes() for path in files_in(folder)}


def _write(job: Job, content: dict[str, bytes]) -> None:
    """Put an export's files in the job's folder."""
    with beside(job.folder) as folder:
        for name, data in content.items():
            path = PurePosixPath(name)
            if path.is_absolute() or ".." in path.parts:
                raise OutputError(f"file {name!r} of an export: leads out of its folder; check the worker it came from")
            write(folder, name, data)
        move_in(folder, job.folder)
