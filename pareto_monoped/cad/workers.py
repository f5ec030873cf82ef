"""Worker processes that do one task after the other and can be ended at any moment."""

import multiprocessing
import signal
import time
from collections.abc import Callable, Iterable, Iterator
from multiprocessing.connection import Connection, wait
from typing import Any, Generic, TypeVar

from pareto_monoped.cad.interrupt import WORKER_GRACE_S, ending_at

_MARGIN_S = 0.3
"""For a worker to end after its guard has begun to end it."""

Task = TypeVar("Task")


class Workers(Generic[Task]):
    """Processes that call one function, each with one task at a time.

    As a context: leaving it by an exception ends the processes at once, and each tidies up what it was at.

    Args:
        function: called in another process; it and its tasks can be pickled.
        count: number of processes.
    """

    def __init__(self, function: Callable[[Task], Any], count: int) -> None:
        # Fresh processes: the CAD kernel's and the simulator's threads do not survive a fork.
        context = multiprocessing.get_context("spawn")
        self._processes: list[Any] = []
        self._idle: list[Connection] = []
        # A signal mask is inherited: Ctrl-C reaches the whole group of processes, and this one ends the workers.
        before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
        try:
            for _ in range(count):
                ours, theirs = context.Pipe()
                process = context.Process(target=_serve, args=(function, theirs), daemon=True)
                process.start()
                theirs.close()  # the worker has its own: when it dies, ours reads the end of the file
                self._processes.append(process)
                self._idle.append(ours)
        finally:
            signal.pthread_sigmask(signal.SIG_SETMASK, before)

    def __enter__(self) -> "Workers[Task]":
        return self

    def __exit__(self, kind: type[BaseException] | None, *_: object) -> None:
        if kind is None:
            for connection in self._idle:
                connection.send(None)
        else:
            for process in self._processes:
                process.terminate()
        end_s = time.monotonic() + WORKER_GRACE_S + _MARGIN_S
        for process in self._processes:
            process.join(None if kind is None else max(end_s - time.monotonic(), 0.0))
            process.kill()
            process.join()

    def do(self, tasks: Iterable[Task]) -> Iterator[Task]:
        """Do all tasks and yield each as soon as it is done, in any order.

        The first failure lets the tasks in progress end, starts no more, and is raised.
        """
        waiting = iter(tasks)
        running: dict[Connection, Task] = {}
        failure: BaseException | None = None
        while True:
            while failure is None and self._idle and (task := next(waiting, None)) is not None:
                connection = self._idle.pop()
                connection.send(task)
                running[connection] = task
            if not running:
                break
            for ready in wait(list(running)):
                assert isinstance(ready, Connection)
                task = running.pop(ready)
                problem = _answer(ready)
                if problem is None:
                    self._idle.append(ready)
                    yield task
                failure = failure or problem
        if failure is not None:
            raise failure


def _answer(connection: Connection) -> BaseException | None:
    """The exception that a task ended with, None if it is done."""
    try:
        problem = connection.recv()
    except EOFError:
        return RuntimeError("a worker process ended by itself; run the same command again")
    return problem if isinstance(problem, BaseException) else None


def _serve(function: Callable[[Any], Any], connection: Connection) -> None:
    """What a worker does: answer every task with None, or with the exception that it raised."""
    try:
        with ending_at(signal.SIGTERM, grace_s=WORKER_GRACE_S):
            while (task := connection.recv()) is not None:
                try:
                    function(task)
                except Exception as problem:
                    connection.send(problem)
                else:
                    connection.send(None)
    except (EOFError, KeyboardInterrupt):
        # The parent has gone, or wants no more.
        return
