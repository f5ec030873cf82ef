"""The controller inside MuJoCo's step: many steps of many jumps without going back to Python.

MuJoCo calls ``mjcb_control`` in every step, after positions and speeds are known and before forces are (its
documentation, "Programming, Simulation, Simulation loop"). The controller's record of a jump is the user data of its
simulation and thus part of MuJoCo's own state, so that the compiled callback needs no memory of its own and works on
any thread. It reads and writes the state through MuJoCo's C functions.
"""

import ctypes
import threading
import zlib
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import lru_cache
from pathlib import Path
from typing import Any

import llvmlite.binding
import mujoco
import numpy as np
from numba import types

from pareto_monoped.compute.compiled import c_function
from pareto_monoped.errors import SimulationError
from pareto_monoped.jump import controller
from pareto_monoped.jump.controller import control
from pareto_monoped.jump.controller_record import RECORD, RECORD_NUMBERS

_lock = threading.Lock()
_users = 0
_quiet_before = (True, True)


@contextmanager
def quiet() -> Iterator[None]:
    """Let MuJoCo write neither to ``MUJOCO_LOG.TXT`` nor to standard output; the last user restores the settings."""
    global _users, _quiet_before
    import mujoco

    with _lock:
        if _users == 0:
            config = mujoco.MjLogConfig.get()
            _quiet_before = (config.logto_console, config.logto_file)
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
                config.logto_console, config.logto_file = _quiet_before
                config.set()


_POSITION = types.CPointer(types.float64)
_STATE = (types.voidptr, types.voidptr, _POSITION, types.int32)
_get_state = types.ExternalFunction("mj_getState", types.void(*_STATE))
_set_state = types.ExternalFunction("mj_setState", types.void(*_STATE))
_state_size = types.ExternalFunction("mj_stateSize", types.int32(types.voidptr, types.int32))

# MuJoCo lays a state out in the order of these bits.
_USER = int(mujoco.mjtState.mjSTATE_USERDATA)
_POSITIONS = int(mujoco.mjtState.mjSTATE_QPOS)
_WRITTEN = int(mujoco.mjtState.mjSTATE_CTRL) | _USER
_READ = _POSITIONS | int(mujoco.mjtState.mjSTATE_QVEL) | _WRITTEN
_JOINTS = 2

_before: Callable[..., object] | None = None


@contextmanager
def controlled() -> Iterator[None]:
    """Let the controller act in every simulation whose user data is a controller's record, and in no other.

    A process has only one callback; the last user restores the earlier one. If MuJoCo's library is not where its
    package has it, this raises ``SimulationError``.
    """
    global _users, _before
    callback = _compiled()
    with _lock:
        if _users == 0:
            _before = mujoco.get_mjcb_control()
            mujoco.set_mjcb_control(callback)
        _users += 1
    try:
        with quiet():
            yield
    finally:
        with _lock:
            _users -= 1
            if _users == 0:
                mujoco.set_mjcb_control(_before)


@lru_cache(maxsize=1)
def _compiled() -> Any:
    """Return the callback as a C function."""
    library = ctypes.CDLL(str(_library()))
    for name in ("mj_getState", "mj_setState", "mj_stateSize"):
        llvmlite.binding.add_symbol(name, ctypes.cast(getattr(library, name), ctypes.c_void_p).value)
    return c_function(types.void(types.voidptr, types.voidptr), _controller(_origin(Path(controller.__file__))))


def _origin(source: Path) -> int:
    """A number for what the callback depends on outside this file: controller's source, record, MuJoCo's version."""
    return zlib.crc32(source.read_bytes() + f"{RECORD.descr}{mujoco.__version__}".encode())


def _library() -> Path:
    """Return the shared library that MuJoCo's package loads."""
    folder = Path(mujoco.__file__).parent
    for pattern in ("libmujoco.so*", "libmujoco*.dylib", "mujoco.dll"):
        for path in sorted(folder.glob(pattern)):
            return path
    raise SimulationError(f"mujoco {mujoco.__version__}: has no libmujoco beside its package; install mujoco from PyPI")


def _controller(origin: int) -> Callable[[Any, Any], None]:
    """Return ``mjcb_control``, not yet compiled, which MuJoCo calls in every step of every simulation of the process.

    It closes over ``origin`` so that numba loads no callback from disk that was compiled with another controller.
    """

    def act(model: Any, data: Any) -> None:
        _ = origin
        if _state_size(model, _USER) != RECORD_NUMBERS:
            return
        nv = _state_size(model, _POSITIONS)
        state = np.empty(2 * nv + _JOINTS + RECORD_NUMBERS)
        _get_state(model, data, state.ctypes, _READ)
        written = state[2 * nv :]
        jump = written[_JOINTS:].view(RECORD)[0]
        control(state[:nv], state[nv : 2 * nv], written[:_JOINTS], jump)
        _set_state(model, data, written.ctypes, _WRITTEN)

    return act
