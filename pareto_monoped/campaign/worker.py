"""A process of a campaign: runs one study after the other, each as it is told, until it is told to end.

It ends at once when its coordinator ends in any way, because the connection between them then breaks. Everything that a
study has acknowledged is on disk by then.
"""

import os
import queue
import threading
import warnings
from collections.abc import Callable, Iterator
from concurrent.futures import Executor
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

from pareto_monoped.definition.study import Study
from pareto_monoped.errors import ParetoMonopedError

STOP = "stop"
"""Tells a worker to end its study after the generation at hand; it can be continued."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Task:
    """A study to run or to continue."""

    #: study, db: what and where
    study: Study
    db: Path
    threads: int  #: that simulate
    scheduler: str | None = None  #: address of a Dask scheduler whose workers simulate in their place; None: they do
    seat: int = 0  #: tells studies that run side by side apart, see ``compute.crew.Crew``


@dataclass(frozen=True, slots=True, kw_only=True)
class Advanced:
    """A study has stored another generation; fields as of ``study.session.Progress``."""

    evaluations: int
    per_second: float
    seconds_left: float
    hypervolume: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Noted:
    """A study has something to say to the user."""

    line: str  #: for the user
    shared: bool = False  #: whether it is about scheduler and workers, of which every study hears the same


@dataclass(frozen=True, slots=True, kw_only=True)
class Ended:
    """A study has ended, or has stopped as it was told to; fields as of ``study.run.RunSummary``."""

    evaluations: int
    new_evaluations: int
    front_size: int
    hypervolume: float
    stop_reason: str
    remarks: tuple[str, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Failed:
    """A study cannot be run; the line says why."""

    line: str


Said = Advanced | Noted | Ended | Failed


def serve(connection: Connection) -> None:
    """What a worker does: run each task that comes through the connection, and say through it how it goes."""
    warnings.simplefilter("ignore")  # they are for developers, and would be written across the table
    tasks: queue.SimpleQueue[Task | None] = queue.SimpleQueue()
    stop = threading.Event()
    threading.Thread(target=_listen, args=(connection, tasks, stop), daemon=True).start()
    while (task := tasks.get()) is not None:
        try:
            connection.send(_done(task, connection, stop))
        except (BrokenPipeError, ConnectionResetError):
            os._exit(1)


def _listen(connection: Connection, tasks: "queue.SimpleQueue[Task | None]", stop: threading.Event) -> None:
    """Pass on what the coordinator says; end the process when there is no coordinator any more."""
    while True:
        try:
            message = connection.recv()
        except (EOFError, OSError):
            os._exit(1)
        if message == STOP:
            stop.set()
            continue
        # A word that came too late for the study before is not for this one.
        stop.clear()
        tasks.put(message)


@contextmanager
def _simulating(task: Task, notify: Callable[[str], None]) -> Iterator[Executor | None]:
    """What simulates in the place of threads."""
    if task.scheduler is None:
        yield None
        return
    from pareto_monoped.jump.peers import cluster

    with cluster(task.scheduler, tell=notify, seat=task.seat) as crew:
        yield crew


def _done(task: Task, connection: Connection, stop: threading.Event) -> Ended | Failed:
    from pareto_monoped.analysis.remarks import remarks
    from pareto_monoped.study.run import run

    def advance(progress: Any) -> bool:
        connection.send(
            Advanced(
                evaluations=progress.evaluations,
                per_second=progress.per_second,
                seconds_left=progress.seconds_left,
                hypervolume=progress.hypervolume,
            )
        )
        return stop.is_set()

    def note(line: str) -> None:
        connection.send(Noted(line=line))

    def note_of_workers(line: str) -> None:
        # The crew that says it does its work on, whether somebody still listens or not.
        with suppress(OSError):
            connection.send(Noted(line=line, shared=True))

    try:
        with _simulating(task, note_of_workers) as executor:
            summary = run(task.study, task.db, workers=task.threads, executor=executor, progress=advance, notify=note)
    except (BrokenPipeError, ConnectionResetError):
        os._exit(1)
    except ParetoMonopedError as error:
        return Failed(line=_one_line(str(error)))
    except Exception as error:
        return Failed(line=_one_line(f"unexpected {type(error).__name__}: {error}"))
    return Ended(
        evaluations=summary.evaluations,
        new_evaluations=summary.new_evaluations,
        front_size=summary.front_size,
        hypervolume=summary.hypervolume,
        stop_reason=summary.stop_reason,
        remarks=tuple(remarks(summary.data)),
    )


def _one_line(text: str) -> str:
    return " ".join(text.split())
