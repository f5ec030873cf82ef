"""Ctrl-C while exporting: the work ends at once, whatever it is at, and leaves nothing half-written.

A signal reaches Python only between two of its instructions, and an exception may be lost in a library's callback.
After a grace period a guard therefore ends the process itself, once the unfinished folders are gone.
"""

import os
import signal
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

from pareto_monoped.cad.kernel import client as kernel
from pareto_monoped.cad.write.folder import without_unfinished

GRACE_S = 1.4
"""From the signal until the guard ends the process. Our own choice: a user waits two seconds at most."""
EXIT_CODE = 130
"""128 and the number of SIGINT, as shells have it."""


@contextmanager
def ending_at(number: signal.Signals, *, grace_s: float = GRACE_S) -> Iterator[None]:
    """A signal raises KeyboardInterrupt in the block, also where the process began with the signal ignored.

    Shells start background jobs so. A second signal is ignored, since the first is already being answered. Outside the
    main thread, where Python allows no signal handlers, this does nothing.

    Args:
        number: the signal.
        grace_s: from the signal until the guard ends the process.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    left = threading.Event()

    def end(number: int, frame: FrameType | None) -> None:
        signal.signal(number, signal.SIG_IGN)
        guard = threading.Timer(grace_s, end_process, [left])
        guard.daemon = True
        guard.start()
        # If a library's callback swallows the exception, the guard ends the process: nobody needs to read of it.
        sys.unraisablehook = lambda _: None
        raise KeyboardInterrupt

    before = signal.signal(number, end)
    try:
        yield
    except Exception:
        # A library may turn one exception into another.
        if signal.getsignal(number) is signal.SIG_IGN:
            raise KeyboardInterrupt from None
        raise
    finally:
        left.set()
        if signal.getsignal(number) is signal.SIG_IGN:
            # The interrupt may have come where a ``with`` statement is entered: its block is then never left.
            with without_unfinished():
                pass
        # After a signal the process still has to tidy up, beyond this block.
        if signal.getsignal(number) is end:
            signal.signal(number, before)


def end_process(reported: threading.Event | None = None) -> None:
    """End this process without waiting for any of its threads; no half-written folder stays.

    Args:
        reported: set once the interrupt has reached whoever reports it; None: another process does.
    """
    kernel.kill()
    with without_unfinished():
        if reported is not None and not reported.is_set():
            sys.stderr.write("interrupted\n")
            sys.stderr.flush()
        os._exit(EXIT_CODE)
