"""Worker processes as the coordinator sees them: started, given a study, listened to, ended."""

import multiprocessing
import signal
import time
from collections.abc import Iterator, Sequence
from contextlib import suppress
from multiprocessing.connection import Connection, wait
from typing import Any

from pareto_monoped.campaign.worker import STOP, Said, Task, serve

GRACE_S = 1.0
"""From the word to stop until a worker is killed. Our own choice: a user waits a second, and a generation takes less;
what a killed worker was at is not lost but simulated again."""
_INHERITED = {signal.SIGINT, signal.SIGHUP}
"""Signals of the terminal reach all its processes; the coordinator alone answers them, and tells the workers."""


class WorkerProcess:
    """A process that runs studies, one at a time."""

    def __init__(self) -> None:
        # Fresh processes: the simulator's threads do not survive a fork.
        context = multiprocessing.get_context("spawn")
        self.connection: Connection
        self.connection, theirs = context.Pipe()
        self._process: Any = context.Process(target=serve, args=(theirs,), daemon=True)
        before = signal.pthread_sigmask(signal.SIG_BLOCK, _INHERITED)
        try:
            self._process.start()
        finally:
            signal.pthread_sigmask(signal.SIG_SETMASK, before)
        theirs.close()  # the worker has its own: when it dies, ours reads the end of the file

    @property
    def process_id(self) -> int:
        """Of the operating system."""
        return int(self._process.pid)

    def begin(self, task: Task) -> None:
        """Give it a study; a worker that has died meanwhile is noticed by ``said``."""
        with suppress(OSError):
            self.connection.send(task)

    def stop(self) -> None:
        """Tell it to end its study after the generation at hand."""
        with suppress(OSError):
            self.connection.send(STOP)

    def said(self) -> Said | None:
        """What it said next; None if it has died."""
        try:
            said: Said = self.connection.recv()
        except (EOFError, OSError):
            return None
        return said

    def death(self) -> str:
        """How it died, in words."""
        self._process.join(GRACE_S)
        code = self._process.exitcode
        if code is not None and code < 0:
            with suppress(ValueError):
                return f"its process was ended by {signal.Signals(-code).name}"
        return f"its process ended by itself with code {code}"

    def kill(self) -> None:
        """End it at once."""
        self._process.kill()
        self._process.join()
        self.connection.close()


def speakers(workers: Sequence[WorkerProcess], timeout_s: float) -> Iterator[WorkerProcess]:
    """The workers that have something to say, or have died, as soon as there are any, or none after a time."""
    by_connection = {worker.connection: worker for worker in workers}
    for ready in wait(list(by_connection), timeout_s):
        assert isinstance(ready, Connection)
        yield by_connection[ready]


def dismiss(workers: Sequence[WorkerProcess]) -> None:
    """Let idle workers end; those that do not are killed."""
    for worker in workers:
        with suppress(OSError):
            worker.connection.send(None)
    end_s = time.monotonic() + GRACE_S
    for worker in workers:
        worker._process.join(max(end_s - time.monotonic(), 0.0))
        worker.kill()
