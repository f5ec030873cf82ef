"""Ctrl-C in two steps: the first asks for an orderly end, the second ends at once; SIGTERM and SIGHUP likewise."""

import signal
import threading
from collections.abc import Callable
from types import FrameType

_SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)


class Interrupt:
    """A context that catches the first SIGINT, SIGTERM or SIGHUP and sets ``asked``.

    Outside the main thread, where Python allows no signal handlers, it does nothing.
    """

    def __init__(self, notify: Callable[[str], None]) -> None:
        self.asked = False
        self._notify = notify
        self._main = threading.current_thread() is threading.main_thread()

    def __enter__(self) -> "Interrupt":
        if self._main:
            # What began with SIGHUP ignored (nohup) shall outlive its terminal.
            numbers = [n for n in _SIGNALS if n != signal.SIGHUP or signal.getsignal(n) is not signal.SIG_IGN]
            self._before = {number: signal.signal(number, self._first) for number in numbers}
        return self

    def __exit__(self, *_: object) -> None:
        if self._main:
            for number, handler in self._before.items():
                signal.signal(number, handler)

    def _first(self, number: int, frame: FrameType | None) -> None:
        self.asked = True
        for each in self._before:
            signal.signal(each, signal.default_int_handler)
        self._notify("interrupted: ending after this generation; press Ctrl-C again to end at once")
