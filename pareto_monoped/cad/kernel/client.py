"""The CAD kernel in a process of its own: this side asks, ``process`` answers.

The kernel holds Python's lock while it works, so that a thread would gain nothing; in its own process it builds, checks
and writes solids while this one simulates, makes meshes and draws. The process is started once and serves every later
export. It ends with this one, or by ``give_up``: it keeps nothing, so that it is killed and nobody waits for it.

An export so has two processes. Once the solids are made the second one also draws, see ``do``. What it has not begun
when the first one has nothing else to do is done there, see ``help_out``, so that both end at about the same time.
"""

import atexit
import os
import pickle
import subprocess
import sys
from collections import deque
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Future
from contextlib import suppress
from dataclasses import dataclass
from functools import lru_cache
from threading import Condition, Thread
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    # Not at run time: the process is to start before anything else is imported.
    from pareto_monoped.geometry.parts import Part

Floats = NDArray[np.float64]
Answer = TypeVar("Answer")
Question = str | Callable[..., Any]
"""What is asked: the name of an answer that needs the CAD kernel, or a function of any module."""
Asked = tuple["Future[Any]", Question, tuple[Any, ...]]


COLLECT_AFTER = 100_000
"""New objects after which an exporting process looks for unreachable ones. Python's 700 cost 1.2 s of processor time,
since there are half a million lasting objects, and found next to nothing (our own measurement)."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SolidFacts:
    """What the kernel finds about a part's solid, in the part's own frame."""

    valid: bool  #: whether it passes the kernel's own check of topology and geometry
    bodies: int  #: of how many separate bodies it is
    volume_mm3: float  #: its volume
    centre_mm: Floats  #: its centre, shape (3,)
    inertia_mm5: Floats  #: volume integrals of the inertia tensor about the centre, shape (3, 3)


@dataclass(frozen=True, slots=True, kw_only=True)
class StepPlacement:
    """A part placed in a unit: name of the unique part, and the 4 x 4 matrix to the assembly's frame in millimetres."""

    part: str
    matrix: Floats


@dataclass(frozen=True, slots=True, kw_only=True)
class StepAssembly:
    """What the STEP files of a robot are written from."""

    name: str  #: of the robot
    parts: "Mapping[str, Part]"  #: its unique parts by name
    units: Mapping[str, tuple[StepPlacement, ...]]  #: its units by name, each with its placed parts


def start() -> None:
    """Start the kernel, which then loads while this process does other things."""
    _process()


def give_up() -> None:
    """End the kernel if it owes an answer; its unanswered questions fail. A later question starts another."""
    if _process.cache_info().currsize:
        process = _process()
        if process.owes:
            _process.cache_clear()
            process.close()


def kill() -> None:
    """End the kernel without waiting for anything: for a process that ends itself."""
    if _process.cache_info().currsize:
        _process().process.kill()


def solid_facts(parts: "Sequence[Part]") -> "Future[list[SolidFacts]]":
    """Facts of the solids of some parts, in their order."""
    return _process().ask("solid_facts", (list(parts),))


def step_files(assembly: StepAssembly) -> "Future[tuple[bytes, dict[str, bytes]]]":
    """The STEP file of the assembly, and those of its unique parts by name."""
    return _process().ask("step_files", (assembly,))


def do(function: Callable[..., Answer], *arguments: Any) -> "Future[Answer]":
    """Call a function in the kernel's process, once it has answered all earlier questions, or here in ``help_out``.

    Args:
        function: of a module, as it is sent by its name.
        arguments: all that it needs; they are copied.
    """
    return _process().ask(function, arguments)


def help_out() -> None:
    """Answer here what the kernel has not begun, from what was asked last; what only the kernel can answer is left."""
    if not _process.cache_info().currsize:
        return
    process = _process()
    while (asked := process.taken_back()) is not None:
        future, function, arguments = asked
        assert callable(function)
        try:
            answer = function(*arguments)
        except Exception as problem:
            future.set_exception(problem)
        else:
            future.set_result(answer)


class _Process:
    """One kernel process; questions are answered in the order in which they are asked."""

    def __init__(self) -> None:
        environment = os.environ | {
            # Use this process's import path, never the working directory.
            "PYTHONPATH": os.pathsep.join(path for path in sys.path if path),
            # This process is busy, too: a second thread of numpy's would only wait for a core.
            "OPENBLAS_NUM_THREADS": "1",
        }
        # In a process group of its own, so that Ctrl-C reaches only this process, which then ends the kernel.
        self.process = subprocess.Popen(
            [sys.executable, "-P", "-m", "pareto_monoped.cad.kernel.process"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            env=environment,
            process_group=0,
        )
        self.waiting: deque[Asked] = deque()
        self.changed = Condition()
        self.closed = False
        self.asked: list[Future[Any]] = []
        # A daemon: the end of this process does not wait for an answer.
        self.line = Thread(target=self._serve, name="cad-kernel", daemon=True)
        self.line.start()
        atexit.register(self.close)

    def ask(self, question: Question, arguments: tuple[Any, ...]) -> "Future[Any]":
        future: Future[Any] = Future()
        with self.changed:
            self.asked = [earlier for earlier in self.asked if not earlier.done()] + [future]
            self.waiting.append((future, question, arguments))
            self.changed.notify()
        return future

    def taken_back(self) -> Asked | None:
        """The question asked last of those that are not begun and can be answered anywhere; it is not asked then."""
        with self.changed:
            for place in reversed(range(len(self.waiting))):
                if callable(self.waiting[place][1]):
                    asked = self.waiting[place]
                    del self.waiting[place]
                    return asked
        return None

    def _serve(self) -> None:
        """Ask one question after the other until the process is closed; then those that are left fail."""
        while True:
            with self.changed:
                self.changed.wait_for(lambda: self.closed or self.waiting)
                if not self.waiting:
                    return
                future, question, arguments = self.waiting.popleft()
            try:
                answer = self._talk(question, arguments)
            except Exception as problem:
                future.set_exception(problem)
            else:
                future.set_result(answer)

    def _talk(self, question: Question, arguments: tuple[Any, ...]) -> Any:
        assert self.process.stdin is not None
        assert self.process.stdout is not None
        try:
            pickle.dump((question, arguments), self.process.stdin, protocol=pickle.HIGHEST_PROTOCOL)
            self.process.stdin.flush()
            answer = pickle.load(self.process.stdout)  # noqa: S301 - from our own process
        except (OSError, EOFError, pickle.UnpicklingError) as problem:
            if self.current:
                _process.cache_clear()  # a later question starts another
            raise RuntimeError(f"the CAD kernel's process ended (exit code {self.process.wait()})") from problem
        if isinstance(answer, BaseException):
            raise answer
        return answer

    @property
    def current(self) -> bool:
        """Whether questions go to this process, not to one that replaced it."""
        return bool(_process.cache_info().currsize) and _process() is self

    @property
    def owes(self) -> bool:
        """Whether a question is unanswered."""
        return any(not future.done() for future in self.asked)

    def close(self) -> None:
        """End the process, whatever it works at."""
        atexit.unregister(self.close)
        self.process.kill()
        with self.changed:
            self.closed = True
            self.changed.notify()
        self.line.join()
        for stream in (self.process.stdin, self.process.stdout):
            if stream is not None and not stream.closed:
                with suppress(OSError):  # it has ended already
                    stream.close()
        self.process.wait()


@lru_cache(maxsize=1)
def _process() -> _Process:
    return _Process()
