"""Rows of work in chunks, given to any ``concurrent.futures.Executor`` and put together again in order.

The pieces must not depend on each other: where the cuts are then changes nothing but the time.
"""

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

LEAST_TASK_S = 0.25
"""Least work in a task. Handing a task to a cluster takes about a millisecond, which is then below one percent."""
_FIRST_ROWS = 64
"""Rows of the task that shows how long a row takes. Our own choice: a tenth of a second of jumps on one core."""
AT_ONCE = 16
"""Pieces of work that wait for an executor at a time. Our own choice: pieces of 8,000 jumps make 500 tasks together,
and their results take 50 MB."""
_REMEMBERED = 9  #: Tasks whose speed counts. Our own choice: enough that one slow task does not decide.


class Pace:
    """How long a row of some work takes, as its tasks have shown, and so how many rows make a task."""

    def __init__(self) -> None:
        self._seconds: deque[float] = deque(maxlen=_REMEMBERED)

    def note(self, rows: int, seconds: float) -> None:
        """Remember how long the rows of a task took."""
        self._seconds.append(seconds / rows)

    def cuts(self, start: int, stop: int) -> list[int]:
        """Where to cut rows ``start`` to ``stop``, both ends included, so that each task takes long enough.

        As long as nothing is known, the first task is a small one, and the rest is cut when it is done.
        """
        if not self._seconds:
            return sorted({start, min(start + _FIRST_ROWS, stop)})
        least = max(LEAST_TASK_S / max(statistics.median(self._seconds), 1e-9), 1.0)
        count = max(int((stop - start) / least), 1)
        return [start + (stop - start) * k // count for k in range(count + 1)]


_paces: WeakKeyDictionary[Executor, dict[object, Pace]] = WeakKeyDictionary()


def pace_of(executor: Executor, *work: object) -> Pace:
    """The pace of some work on an executor, which later calls with the same work go on with."""
    return _paces.setdefault(executor, {}).setdefault(work, Pace())


def spread(
    executor: Executor, pace: Pace, count: int, work: Callable[..., T], of_rows: Callable[[slice], Sequence[Any]]
) -> list[T]:
    """The results of some work on ``count`` rows, one per chunk, in the order of the rows.

    Args:
        executor: does the tasks, in any order and anywhere.
        pace: says how many rows make a task, and learns from them.
        count: number of rows, at least 1.
        work: a function at the top level of a module, which another process can find by its name.
        of_rows: its arguments for some rows, such as slices of arrays.

    Raises:
        Exception: what a task raised; tasks that have not begun are then called off.
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
    """The results of some work on items, in the order of the items.

    Work that waits for an executor leaves its workers without tasks at its end; with several under way, the next ones'
    tasks are then already there. Close the iterator where it is left before its end.

    Args:
        work: may be called by several threads at a time.
        items: what it is done on.
        at_once: how many items may be under way at a time; 1: in this thread.

    Raises:
        Exception: what the work raised; items that have not begun are then called off.
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
    """The result of some work where it is done, and how many seconds it took there."""
    start_s = time.perf_counter()
    result = work(*arguments)
    return result, time.perf_counter() - start_s
