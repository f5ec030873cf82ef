"""Ctrl-C in two steps: the first asks for an orderly end, the second ends at once."""

import signal
import threading
from collections.abc import Callable
from types import FrameType


class Interrupt:
    """A context that catches the first SIGINT and sets ``asked``.

    Outside the main thread, where Python allows no signal handlers, it does nothing.
    """

    def __init__(self, notify: Callable[[str], None]) -> None:
        self.asked = False
        self._notify = notify
        self._main = threading.current_thread() is threading.main_thread()

    def __enter__(self) -> "Interrupt":
        if self._main:
            self._before = signal.signal(signal.SIGINT, self._first)
        return self

    def __exit__(self, *_: object) -> None:
        if self._main:
            signal.signal(signal.SIGINT, self._before)

    def _first(self, number: int, frame: FrameType | None) -> None:
        self.asked = True
        signal.signal(signal.SIGINT, signal.default_int_handler)
        self._notify("interrupted: ending after this generation; press Ctrl-C again to end at once")
