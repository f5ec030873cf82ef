"""Worker processes of this machine."""

import multiprocessing
import os
import signal
import threading
from collections.abc import Mapping
from concurrent.futures import Executor, Future, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from multiprocessing.connection import wait

from pareto_monoped.compute.staff import Member


class LocalProcesses:
    """A number of fresh processes; each that is lost is replaced.

    Each is a pool of its own, because the end of one process breaks its whole pool.

    Args:
        count: number of processes.
        threads: of each.
    """

    replaces = True
    cure = "call it from a file that starts its work under \"if __name__ == '__main__'\", or use fewer processes"

    def __init__(self, count: int, threads: int) -> None:
        self.label = f"{count} processes"
        self._threads = threads
        self._started = 0
        self._pools: dict[str, tuple[ProcessPoolExecutor, Future[int], Member]] = {}
        for _ in range(count):
            self._start()

    def _start(self) -> None:
        self._started += 1
        # Fresh processes: the simulator's threads do not survive a fork.
        context = multiprocessing.get_context("spawn")
        pool = ProcessPoolExecutor(1, mp_context=context, initializer=_begin)
        name = f"process {self._started}"
        executor: Executor = pool
        self._pools[name] = (pool, pool.submit(os.getpid), Member(name=name, threads=self._threads, executor=executor))

    def present(self) -> Mapping[str, Member]:
        """All processes; one that has ended is found out by its tasks."""
        return {name: member for name, (_, _, member) in self._pools.items()}

    def state(self) -> str:
        """Why none may be there."""
        return "its processes end at once"

    def is_loss(self, problem: BaseException) -> bool:
        """Whether a process has ended under its task."""
        return isinstance(problem, BrokenProcessPool)

    def dismiss(self, name: str) -> None:
        """End a process, whatever it is at, and start another."""
        self._end(name)
        self._start()

    def close(self) -> None:
        """End all processes."""
        for name in list(self._pools):
            self._end(name)

    def _end(self, name: str) -> None:
        pool, process, _ = self._pools.pop(name)
        # It keeps nothing, so nobody waits for it.
        if process.done() and process.exception() is None:
            # By way of our children: the number of a process that has ended may be another program's by now.
            for child in multiprocessing.active_children():
                if child.pid == process.result():
                    child.kill()
        pool.shutdown(wait=False, cancel_futures=True)


def _begin() -> None:
    """Begin a worker process: Ctrl-C is for its parent, with which it ends."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    parent = multiprocessing.parent_process()
    if parent is not None:
        threading.Thread(target=_end_with, args=(parent.sentinel,), daemon=True).start()


def _end_with(sentinel: int) -> None:
    wait([sentinel])
    os._exit(0)
