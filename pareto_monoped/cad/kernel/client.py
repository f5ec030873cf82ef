"""The CAD kernel in a process of its own: this side asks, ``process`` answers.

The kernel holds Python's lock while it works, so that a thread would gain nothing; in its own process it builds, checks
and writes solids while this one simulates, makes meshes and draws. The process is started once and serves every later
export. It ends with this one, or by ``give_up``: it keeps nothing, so that it is killed and nobody waits for it.

An export so has two processes. Once the solids are made the second one also draws, see ``do``. What it has not begun
when the first one has nothing else to do is done there, see ``help_out``, so that both end at about the same time.
"""

import gc
import importlib
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Future
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.compute.processes import Processes

if TYPE_CHECKING:
    # Not at run time: the process is to start before anything else is imported.
    from pareto_monoped.geometry.parts import Part

Floats = NDArray[np.float64]
Answer = TypeVar("Answer")

COLLECT_AFTER = 100_000
"""New objects after which an exporting process looks for unreachable ones. Python's 700 cost 1.2 s of processor time,
since there are half a million lasting objects, and found next to nothing (our own measurement)."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SolidFacts:
    """What the kernel finds about a part's solid, in the part's own frame."""

    valid: bool  #: whether it passes the kernel's own check of topology and geometry
    bodies: int  #: of how many separate bodies it is
    volume_mm3: float
    centre_mm: Floats
    inertia_mm5: Floats  #: volume integrals of the inertia tensor about the centre, shape (3, 3)


@dataclass(frozen=True, slots=True, kw_only=True)
class StepPlacement:
    """A part placed in a unit: name of the unique part, and the 4 x 4 matrix to the assembly's frame in millimetres."""

    part: str
    matrix: Floats


@dataclass(frozen=True, slots=True, kw_only=True)
class StepAssembly:
    """What the STEP files of a robot are written from: its name, unique parts, and units with their placed parts."""

    name: str
    parts: "Mapping[str, Part]"
    units: Mapping[str, tuple[StepPlacement, ...]]


def start() -> None:
    """Start the kernel, which then loads while this process does other things."""
    _process()


def give_up() -> None:
    """End the kernel if it owes an answer; its unanswered questions fail. A later question starts another."""
    global _kernel
    if _kernel is not None and any(not future.done() for future in _asked):
        _kernel.kill()
        _kernel.shutdown()
        _kernel = None


def kill() -> None:
    """End the kernel without waiting for anything: for a process that ends itself."""
    if _kernel is not None:
        _kernel.kill()


def solid_facts(parts: "Sequence[Part]") -> "Future[list[SolidFacts]]":
    """Facts of the solids of some parts, in their order."""
    return do(_answer, "solid_facts", list(parts))


def step_files(assembly: StepAssembly) -> "Future[tuple[bytes, dict[str, bytes]]]":
    """The STEP file of the assembly, and those of its unique parts by name."""
    return do(_answer, "step_files", assembly)


def do(function: Callable[..., Answer], *arguments: Any) -> "Future[Answer]":
    """Call a function in the kernel's process, once it has answered all earlier questions, or here in ``help_out``.

    Args:
        function: of a module, as it is sent by its name.
        arguments: all that it needs; they are copied.
    """
    future = _process().submit(function, *arguments)
    _asked[:] = [earlier for earlier in _asked if not earlier.done()] + [future]
    return future


def help_out() -> None:
    """Answer here what the kernel has not begun, from what was asked last; what only the kernel can answer is left."""
    while _kernel is not None and _kernel.do_here(lambda task: task.function is not _answer):
        pass


_kernel: Processes | None = None
_asked: list[Future[Any]] = []


def _process() -> Processes:
    global _kernel
    if _kernel is None or _kernel.ended:
        # This process is busy, too: a second thread of numpy's would only wait for a core.
        _kernel = Processes(lost=_ended, environment={"OPENBLAS_NUM_THREADS": "1"})
        _kernel.submit(_answer, "solid_facts", [])  # so that it loads
    return _kernel


def _ended(code: int) -> Exception:
    return RuntimeError(f"the CAD kernel's process ended (exit code {code})")


def _answer(question: str, argument: Any) -> Any:
    """Answer a question in the kernel's process; no other process imports ``process``, which loads the kernel."""
    gc.set_threshold(COLLECT_AFTER)
    return getattr(importlib.import_module("pareto_monoped.cad.kernel.process"), question)(argument)
