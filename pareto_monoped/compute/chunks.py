"""Rows of independent work in chunks, given to any ``concurrent.futures.Executor`` and put together again in order.

Cores of this process, and how many threads its tasks may use; a worker's coordinator tells it.
"""

import os
import statistics
import time
from collections import deque
from collections.abc import Callable, Generator, Iterable, Sequence
from concurrent.futures import Executor, Future, ThreadPoolExecutor
from itertools import pairwise
from typing import Any, TypeVar
from weakref import WeakKeyDictionary

T = TypeVar("T")
Item = TypeVar("Item")

LEAST_TASK_S = 0.25  #: Least work in a task: giving one to a cluster takes a millisecond, below one percent of it.
_FIRST_ROWS = 64  #: Rows of the task that measures the time per row: a tenth of a second of jumps. Our own choice.
AT_ONCE = 16  #: Pieces that wait for an executor at a time: results of 8,000 jumps each take 50 MB. Our own choice.
_REMEMBERED = 9  #: Tasks whose speed counts. Our own choice: enough that one slow task does not decide.


class Pace:
    """How long a row of some work takes, as its tasks have shown, and so how many rows make a task."""

    def __init__(self) -> None:
        self._seconds: deque[float] = deque(maxlen=_REMEMBERED)

    def note(self, rows: int, seconds: float) -> None:
        """Remember how long the rows of a task took."""
        self._seconds.append(seconds / rows)

    def cuts(self, start: int, stop: int) -> list[int]:
        """Return where to cut rows ``start`` to ``stop``, both ends included, so that each task takes long enough.

        While the pace is unknown, the first task is a small one, and the rest is cut when it is done.
        """
        if not self._seconds:
            return sorted({start, min(start + _FIRST_ROWS, stop)})
        least = max(LEAST_TASK_S / max(statistics.median(self._seconds), 1e-9), 1.0)
        count = max(int((stop - start) / least), 1)
        return [start + (stop - start) * k // count for k in range(count + 1)]


_paces: WeakKeyDictionary[Executor, dict[object, Pace]] = WeakKeyDictionary()


def pace_of(executor: Executor, *work: object) -> Pace:
    """Return the pace of some work on an executor, which later calls with the same work go on with."""
    return _paces.setdefault(executor, {}).setdefault(work, Pace())


def spread(
    executor: Executor, pace: Pace, count: int, work: Callable[..., T], of_rows: Callable[[slice], Sequence[Any]]
) -> list[T]:
    """Return the results of some work on ``count`` rows (at least 1), one per chunk, in the order of the rows.

    ``work`` must be a function at the top level of a module; ``of_rows`` returns its arguments for some rows. If a task
    raises an exception, so does this function, and tasks that have not begun are called off.
    """
    results: list[T] = []
    done = 0
    while done < count:
        cuts = pace.cuts(done, count)
        chunks = [slice(first, end) for first, end in pairwise(cuts)]
        futures = [executor.submit(timed, work, *of_rows(rows)) for rows in chunks]
        try:
            for rows, future in zip(chunks, futures, strict=True):
                result, seconds = future.result()
                pace.note(rows.stop - rows.start, seconds)
                results.append(result)
        except BaseException:
            for future in futures:
                future.cancel()
            raise
        done = cuts[-1]
    return results


def in_turn(work: Callable[[Item], T], items: Iterable[Item], at_once: int) -> Generator[T, None, None]:
    """Yield the results of some work on items, in the order of the items, with up to ``at_once`` items under way.

    While one item ends, the next ones' tasks keep the executor's workers busy. With ``at_once`` 1 the work is done in
    this thread, else in several. An exception of the work is raised here, and items that have not begun are called off.
    Close the iterator if it is left before its end.
    """
    if at_once == 1:
        yield from map(work, items)
        return
    pool, under_way = ThreadPoolExecutor(at_once, thread_name_prefix="in turn"), deque[Future[T]]()
    try:
        for item in items:
            if len(under_way) == at_once:
                yield under_way.popleft().result()
            under_way.append(pool.submit(work, item))
        while under_way:
            yield under_way.popleft().result()
    finally:
        # What is under way ends with its executor, which the caller may be about to close: nobody waits for it here.
        pool.shutdown(wait=False)


def timed(work: Callable[..., T], *arguments: Any) -> tuple[T, float]:
    """Return the result of some work where it is done, and how many seconds it took there."""
    start_s = time.perf_counter()
    result = work(*arguments)
    return result, time.perf_counter() - start_s


_threads = 1


def cores() -> int:
    """Return the number of cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def task_threads() -> int:
    """Return threads of a task in this process; 1 in a worker that nobody has told."""
    return _threads


def set_task_threads(count: int) -> None:
    """Let later tasks in this process use ``count`` threads."""
    global _threads
    _threads = count
