"""The process of a command: standard streams that always work, signals that end it in order, and a quick end.

Whatever a command raises becomes one line on stderr and an exit code here. Code below the command line raises its own
errors (``errors``); what else comes up is an error of the system or a fault of this program.
"""

import _thread
import atexit
import difflib
import os
import re
import signal
import sys
import threading
import traceback
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from io import TextIOWrapper
from pathlib import Path
from typing import NoReturn

import click

from pareto_monoped.cli.terminal import name, wrapped
from pareto_monoped.errors import ParetoMonopedError
from pareto_monoped.files import ADRIFT, cure_of, is_adrift, is_failure

_STANDARD = (0, 1, 2)
_INTERRUPTED = 130  #: 128 and the number of SIGINT, as shells have it.


@contextmanager
def owned() -> Iterator[Callable[[int], NoReturn]]:
    """Take over the process for one command; yield the function that ends it with an exit code.

    - Closed standard streams lead nowhere. Otherwise what is printed would be written into the next file that is
      opened.
    - Text that the streams' encoding lacks is written as escapes.
    - SIGTERM and SIGHUP are an interrupt, as Ctrl-C is, so that no temporary file stays. An ignored SIGHUP (nohup)
      stays ignored.
    - At the end, handlers of other modules run, but Python does not take its modules apart, which takes longer than
      many commands.
    """
    _open_streams()
    for stream in (sys.stdout, sys.stderr):
        assert isinstance(stream, TextIOWrapper)
        stream.reconfigure(errors="backslashreplace")
    for number in {signal.SIGTERM, getattr(signal, "SIGHUP", signal.SIGTERM)}:  # Windows has no SIGHUP
        if signal.getsignal(number) is signal.SIG_DFL:
            signal.signal(number, signal.default_int_handler)
    if not sys.warnoptions:
        # Warnings are for developers, who switch them on with -W; tests turn them into errors.
        warnings.simplefilter("ignore")
    # No command draws with MuJoCo, whose import otherwise takes a third longer for a library of windows.
    os.environ["MUJOCO_GL"] = "disable"
    sys.unraisablehook = _raised_again
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
        if signal.getsignal(signal.SIGINT) is not signal.SIG_IGN:
            signal.signal(signal.SIGINT, signal.default_int_handler)
        yield ended
    except KeyboardInterrupt:
        # A signal at the last moment, while the command's end is being told.
        ended(_INTERRUPTED)


def _raised_again(lost: "sys.UnraisableHookArgs") -> None:
    """Raise an interrupt that came in a destructor, where Python would print and forget it, once more."""
    if lost.exc_type is KeyboardInterrupt:
        # Not at once, when it would be raised in here; as SIGTERM, because SIGINT may be ignored.
        threading.Timer(0.01, _thread.interrupt_main, (signal.SIGTERM,)).start()
    else:
        sys.__unraisablehook__(lost)


def _open_streams() -> None:
    for number in _STANDARD:
        try:
            os.fstat(number)
        except OSError:
            # The lowest free number, which is this one, as all below it are open.
            os.open(os.devnull, os.O_RDONLY if number == 0 else os.O_WRONLY)
    for stream, number in (("stdout", 1), ("stderr", 2)):
        if getattr(sys, stream) is None:
            setattr(sys, stream, os.fdopen(number, "w", encoding="utf-8", errors="backslashreplace", closefd=False))


def _flush() -> None:
    for stream in (sys.stdout, sys.stderr):
        try:
            stream.flush()
        except (OSError, ValueError):
            # What could be told has been told.
            continue


TRACEBACK = "PARETO_MONOPED_TRACEBACK"  #: Environment variable that makes faults of the program show their origin.
_KINDS = {"integer": "whole number", "float": "number"}
_KIND = re.compile(rf"is not a valid ({'|'.join(_KINDS)})(?: range)?")  #: How click calls what must be a number.
_LONGEST = 1200  #: Characters of a message; longer ones, such as of a megabyte, lose their middle. Our own choice.


def told(error: BaseException) -> tuple[str, int]:
    """Return the line on stderr and the exit code for what a command raised."""
    if isinstance(error, click.exceptions.Abort | KeyboardInterrupt):
        return "interrupted", 130
    if isinstance(error, click.ClickException):
        # One line, as for our own errors; by default click prints the usage text, too.
        hint = ""
        if isinstance(error, click.UsageError):
            hint = f" (see '{'pareto-monoped' if error.ctx is None else error.ctx.command_path} --help')"
        return f"error: {_line(_of_click(error))}{hint}", error.exit_code
    if isinstance(error, ParetoMonopedError):
        return f"error: {_line(str(error))}", error.exit_code
    if isinstance(error, MemoryError):
        return "error: memory: is used up; close other programs, or give less", 1
    if isinstance(error, OSError) and error.errno is not None:
        return _of_system(error)
    where = _place(error)
    return (
        f"error: unexpected {type(error).__name__}{where}: {_line(str(error)) or 'without a message'}; "
        f"check the files given, or report it with what {TRACEBACK}=1 shows"
    ), 1


def _of_click(error: click.ClickException) -> str:
    if isinstance(error, click.NoSuchOption):
        # The first is the most similar.
        near = difflib.get_close_matches(error.option_name, error.possibilities or (), n=1)
        return f"option {error.option_name!r}: is unknown; {f'did you mean {near[0]!r}?' if near else 'drop it'}"
    return _KIND.sub(lambda found: f"is no {_KINDS[found[1]]}", error.format_message())


def _of_system(error: OSError) -> tuple[str, int]:
    """Return an error of the system that no other code has answered."""
    if error.filename is None and is_adrift():
        return f"error: {ADRIFT}", 2
    files = [os.fsdecode(part) for part in (error.filename, error.filename2) if isinstance(part, str | bytes)]
    what = f"file {', '.join(map(repr, files))}: cannot be used" if files else "output: cannot be written"
    said = error.strerror or str(error)
    return f"error: {_line(what)} ({_line(said)}); {cure_of(error)}", 1 if is_failure(error) else 2


def _line(text: str) -> str:
    """Return a message on one line, of bounded length and without anything that a terminal would obey."""
    line = name(" ".join(text.splitlines()).strip())
    if len(line) <= _LONGEST:
        return line
    return f"{line[: _LONGEST // 2]} ... {line[-_LONGEST // 3 :]}"


def _place(error: BaseException) -> str:
    package = Path(__file__).parent.parent
    for frame in reversed(traceback.extract_tb(error.__traceback__)):
        path = Path(frame.filename)
        if path.is_relative_to(package):
            return f" in {path.relative_to(package)}, line {frame.lineno}"
    return ""


def report(error: BaseException) -> int:
    """Print what a command raised; returns the exit code."""
    if isinstance(error, BrokenPipeError):
        # The reader (head, less) has closed the pipe, which is no error.
        return 0
    line, code = told(error)
    if os.environ.get(TRACEBACK) and isinstance(error, Exception):
        traceback.print_exception(error)
    with suppress(OSError, ValueError):
        # One line for programs; a terminal would break it within words. A closed stderr is None.
        terminal = sys.stderr is not None and sys.stderr.isatty()
        click.echo(wrapped(line) if terminal else line, err=True)
    return code
