"""The process of a command: standard streams that always work, signals that end it in order, and a quick end."""

import atexit
import os
import signal
import sys
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from io import TextIOWrapper
from typing import NoReturn

_STANDARD = (0, 1, 2)
_INTERRUPTED = 130
"""128 and the number of SIGINT, as shells have it."""


@contextmanager
def owned() -> Iterator[Callable[[int], NoReturn]]:
    """Take over the process for one command; yields the function that ends it with an exit code.

    - Closed standard streams lead nowhere. Otherwise the next file that is opened would take their place, and what is
      printed would be written into it.
    - Text that the streams' encoding lacks is written as escapes.
    - SIGTERM and SIGHUP are an interrupt, as Ctrl-C is, so that no temporary file stays. A SIGHUP that the process
      began with ignored (nohup) stays ignored.
    - At the end, handlers of other modules run, but Python does not take its modules and their objects apart, which
      takes longer than many commands.
    """
    _open_streams()
    for stream in (sys.stdout, sys.stderr):
        assert isinstance(stream, TextIOWrapper)
        stream.reconfigure(errors="backslashreplace")
    for number in (signal.SIGTERM, signal.SIGHUP):
        if signal.getsignal(number) is signal.SIG_DFL:
            signal.signal(number, signal.default_int_handler)
    if not sys.warnoptions:
        # Warnings are for developers, who switch them on with -W; tests turn them into errors.
        warnings.simplefilter("ignore")
    # No command draws with MuJoCo, whose import fails at a value that it does not know.
    os.environ.pop("MUJOCO_GL", None)
    code = 0

    def leave() -> None:
        _flush()
        os._exit(code)

    def ended(number: int) -> NoReturn:
        nonlocal code
        code = number
        sys.exit(number)

    # Handlers run in the reverse order in which they were registered: this one, the first, runs last.
    atexit.register(leave)
    try:
        yield ended
    except KeyboardInterrupt:
        # A signal at the last moment, while the command's end is being told.
        ended(_INTERRUPTED)


def _open_streams() -> None:
    for number in _STANDARD:
        try:
            os.fstat(number)
        except OSError:
            # The lowest free number, which is this one, as all below it are open.
            os.open(os.devnull, os.O_RDONLY if number == 0 else os.O_WRONLY)
    for name, number in (("stdout", 1), ("stderr", 2)):
        if getattr(sys, name) is None:
            setattr(sys, name, os.fdopen(number, "w", encoding="utf-8", errors="backslashreplace", closefd=False))


def _flush() -> None:
    for stream in (sys.stdout, sys.stderr):
        try:
            stream.flush()
        except (OSError, ValueError):
            # What could be told has been told.
            continue
