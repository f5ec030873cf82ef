"""MuJoCo's own log, switched off while jumps run: it would be a file ``MUJOCO_LOG.TXT`` in the folder one works in.

What MuJoCo warns of is counted in every simulation, and stands in the status and the reason of the jump.
"""

import threading
from collections.abc import Iterator
from contextlib import contextmanager

_lock = threading.Lock()
_users = 0
_before = (True, True)


@contextmanager
def quiet() -> Iterator[None]:
    """Let MuJoCo write neither to a file nor to standard output; what was set before holds again after the last user.

    Also a decorator.
    """
    global _users, _before
    import mujoco

    with _lock:
        if _users == 0:
            config = mujoco.MjLogConfig.get()
            _before = (config.logto_console, config.logto_file)
            config.logto_console = config.logto_file = False
            config.set()
        _users += 1
    try:
        yield
    finally:
        with _lock:
            _users -= 1
            if _users == 0:
                config = mujoco.MjLogConfig.get()
                config.logto_console, config.logto_file = _before
                config.set()
