"""Tasks that worker processes find by their names."""

import os
import signal
import time
from pathlib import Path


def ids_of(processes):
    """Of the operating system, of an executor's processes."""
    return [line.process.pid for line in processes._lines]


def greeting(threads):
    return os.getpid()


def square(number):
    return number * number


def short(number):
    time.sleep(0.1)
    return number, os.getpid()


def refuse(number):
    raise ValueError(f"no {number}")


def _first(flag):
    """Whether nobody was here before."""
    try:
        Path(flag).touch(exist_ok=False)
    except FileExistsError:
        return False
    return True


def dies_once(flag):
    if _first(flag):
        os.kill(os.getpid(), signal.SIGKILL)
    return os.getpid()


def dies(code):
    os._exit(code)


def stops_once(flag):
    """The whole process hangs, as one that is swapped out or has lost its disk."""
    if _first(flag):
        os.kill(os.getpid(), signal.SIGSTOP)
    return os.getpid()


def slow_once(flag, seconds):
    if _first(flag):
        time.sleep(seconds)
        return "slow"
    return "fast"


def meets(folder, own, other):
    """Waits for another task that waits for this one."""
    Path(folder, own).touch()
    for _ in range(600):
        if Path(folder, other).exists():
            return own, os.getpid()
        time.sleep(0.1)
    raise TimeoutError(f"{other} has not come")
