"""The controller inside MuJoCo's step: many steps of many jumps without going back to Python.

MuJoCo calls ``mjcb_control`` in every step, after positions and speeds are known and before forces are (its
documentation, "Programming, Simulation, Simulation loop"). The controller's record of a jump is the user data of its
simulation and thus part of MuJoCo's own state, so that the compiled callback needs no memory of its own and works on
any thread. It reads and writes the state through MuJoCo's C functions.
"""

import ctypes
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
from pareto_monoped.jump.controller import control
from pareto_monoped.jump.controller_record import RECORD, RECORD_NUMBERS, origin
from pareto_monoped.jump.quiet import Setting, quiet


def _install() -> Any:
    before = mujoco.get_mjcb_control()
    mujoco.set_mjcb_control(_compiled())
    return before


_CALLBACK = Setting(_install, mujoco.set_mjcb_control)


@contextmanager
def controlled() -> Iterator[None]:
    """Let the controller act in every simulation whose user data is a controller's record, and in no other.

    A process has only one callback; the last user restores the earlier one. If MuJoCo's library is not where its
    package has it, this raises ``SimulationError``.
    """
    with _CALLBACK.used(), quiet():
        yield


def _set_clock(wanted: int | None = None) -> int | None:
    """Give MuJoCo a C function to read the time with, or none, and return which it had."""
    clock = ctypes.c_void_p.in_dll(ctypes.CDLL(str(_library())), "mjcb_time")
    before, clock.value = clock.value, wanted
    return before


_CLOCK = Setting(_set_clock, _set_clock)


@contextmanager
def untimed() -> Iterator[None]:
    """Let MuJoCo not time the parts of its steps for its profiler, which takes a sixth of a step as small as ours."""
    with _CLOCK.used():
        yield


_POSITION = types.CPointer(types.float64)
_STATE = (types.voidptr, types.voidptr, _POSITION, types.int32)
_get_state = types.ExternalFunction("mj_getState", types.void(*_STATE))
_set_state = types.ExternalFunction("mj_setState", types.void(*_STATE))
_state_size = types.ExternalFunction("mj_stateSize", types.int32(types.voidptr, types.int32))

# MuJoCo lays a state out in the order of these bits.
_USER = int(mujoco.mjtState.mjSTATE_USERDATA)
_POSITIONS = int(mujoco.mjtState.mjSTATE_QPOS)
_CTRL = int(mujoco.mjtState.mjSTATE_CTRL)
_WRITTEN = _CTRL | _USER
_READ = _POSITIONS | int(mujoco.mjtState.mjSTATE_QVEL) | _WRITTEN


@lru_cache(maxsize=1)
def _compiled() -> Any:
    library = ctypes.CDLL(str(_library()))
    for name in ("mj_getState", "mj_setState", "mj_stateSize"):
        llvmlite.binding.add_symbol(name, ctypes.cast(getattr(library, name), ctypes.c_void_p).value)
    return c_function(
        types.void(types.voidptr, types.voidptr), _controller(zlib.crc32(f"{origin()}{mujoco.__version__}".encode()))
    )


def _library() -> Path:
    folder = Path(mujoco.__file__).parent
    for pattern in ("libmujoco.so*", "libmujoco*.dylib", "mujoco.dll"):
        for path in sorted(folder.glob(pattern)):
            return path
    raise SimulationError(f"mujoco {mujoco.__version__}: has no libmujoco beside its package; install mujoco from PyPI")


def _controller(sources: int) -> Callable[[Any, Any], None]:
    """Return ``mjcb_control``, not yet compiled, which MuJoCo calls in every step of every simulation of the process.

    It closes over ``sources`` so that numba loads no callback from disk that was compiled with another controller.
    """

    def act(model: Any, data: Any) -> None:
        _ = sources
        if _state_size(model, _USER) != RECORD_NUMBERS:
            return
        nv, nu = _state_size(model, _POSITIONS), _state_size(model, _CTRL)
        state = np.empty(2 * nv + nu + RECORD_NUMBERS)
        _get_state(model, data, state.ctypes, _READ)
        written = state[2 * nv :]
        jump = written[nu:].view(RECORD)[0]
        control(state[:nv], state[nv : 2 * nv], written[:nu], jump)
        _set_state(model, data, written.ctypes, _WRITTEN)

    return act
