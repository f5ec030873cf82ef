"""Settings of the process that have several users at once, such as MuJoCo's own log, which is off while jumps run.

Importing this module imports neither MuJoCo nor numba.
"""

import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any


@dataclass(slots=True)
class Setting:
    """A setting of the process that its first user makes and its last one takes back, on whatever threads."""

    make: Callable[[], Any]  #: returns what was set before
    restore: Callable[[Any], object]
    lock: threading.Lock = field(default_factory=threading.Lock)
    users: int = 0
    before: Any = None

    @contextmanager
    def used(self) -> Iterator[None]:
        """Have the setting while the block runs."""
        with self.lock:
            if self.users == 0:
                self.before = self.make()
            self.users += 1
        try:
            yield
        finally:
            with self.lock:
                self.users -= 1
                if self.users == 0:
                    self.restore(self.before)


def _set_log(wanted: tuple[bool, bool] = (False, False)) -> tuple[bool, bool]:
    """Let MuJoCo write to standard output and to its file, or not, and return whether it did before."""
    import mujoco

    config = mujoco.MjLogConfig.get()
    before = (config.logto_console, config.logto_file)
    config.logto_console, config.logto_file = wanted
    config.set()
    return before


_LOG = Setting(_set_log, _set_log)


@contextmanager
def quiet() -> Iterator[None]:
    """Let MuJoCo write neither to ``MUJOCO_LOG.TXT`` nor to standard output; the last user restores the settings."""
    with _LOG.used():
        yield
