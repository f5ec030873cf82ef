"""Cores of this process, and how many threads its tasks may use; a worker's coordinator tells it."""

import os

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
