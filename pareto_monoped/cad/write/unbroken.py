"""Interrupts while an export is written: its move into place is not broken off, its temporary folders are deleted."""

import shutil
import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from types import FrameType

_SIGNALS = (signal.SIGINT, signal.SIGTERM)
"""Ctrl-C, and what ends the worker processes of a batch."""
_TRIES = 100
"""To delete a folder: what a thread was writing when the folder got another name may come during the first."""
_moving = threading.Lock()
_unfinished: set[Path] = set()


@contextmanager
def unbroken() -> Iterator[None]:
    """Hold interrupts back until the block has ended, then deliver them."""
    with _moving:
        if threading.current_thread() is not threading.main_thread():
            # Python runs signal handlers in the main thread only.
            yield
            return
        came: list[tuple[int, FrameType | None]] = []
        before = {held: signal.signal(held, lambda number, frame: came.append((number, frame))) for held in _SIGNALS}
        try:
            yield
        finally:
            for held, handler in before.items():
                signal.signal(held, handler)
    for number, frame in came:
        handler = before[signal.Signals(number)]
        if callable(handler):
            handler(number, frame)
        elif handler is signal.SIG_DFL:
            signal.raise_signal(number)


@contextmanager
def noted(folder: Path) -> Iterator[None]:
    """Remember a temporary folder while the block runs, and delete what is still in it at the end."""
    _unfinished.add(folder)
    try:
        yield
    finally:
        _delete(folder)
        _unfinished.discard(folder)


@contextmanager
def without_unfinished() -> Iterator[None]:
    """Delete all temporary folders; nothing takes its place while the block runs."""
    with _moving:
        for folder in tuple(_unfinished):
            _delete(folder)
        yield


def _delete(folder: Path) -> None:
    """Delete a folder, to which another thread may still write: under another name, no thread finds it any more."""
    gone = folder.with_name(f"{folder.name}-deleted")
    with suppress(OSError):
        folder.rename(gone)
    for path in (gone, folder):
        for _ in range(_TRIES):
            shutil.rmtree(path, ignore_errors=True)
            if not path.exists():
                break
