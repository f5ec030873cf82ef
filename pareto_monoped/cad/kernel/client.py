"""The CAD kernel in a process of its own: this side asks, ``process`` answers.

The kernel holds Python's lock while it works, so that a thread would gain nothing; in its own process it builds, checks
and writes solids while this one simulates, makes meshes and draws. The process is started once and serves every later
export; it ends with this one.
"""

import atexit
import os
import pickle
import subprocess
import sys
from collections.abc import Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import suppress
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.geometry.parts import Part

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class SolidFacts:
    """What the kernel finds about a part's solid, in the part's own frame.

    Attributes:
        valid: whether it passes the kernel's own check of topology and geometry.
        bodies: of how many separate bodies it is.
        volume_mm3: its volume.
        centre_mm: its centre, shape (3,).
        inertia_mm5: volume integrals of the inertia tensor about the centre, shape (3, 3).
    """

    valid: bool
    bodies: int
    volume_mm3: float
    centre_mm: Floats
    inertia_mm5: Floats


@dataclass(frozen=True, slots=True, kw_only=True)
class StepPlacement:
    """A part placed in a unit: name of the unique part, and the 4 x 4 matrix to the assembly's frame in millimetres."""

    part: str
    matrix: Floats


@dataclass(frozen=True, slots=True, kw_only=True)
class StepAssembly:
    """What the STEP files of a robot are written from.

    Attributes:
        name: of the robot.
        parts: its unique parts by name.
        units: its units by name, each with its placed parts.
    """

    name: str
    parts: Mapping[str, Part]
    units: Mapping[str, tuple[StepPlacement, ...]]


def start() -> None:
    """Start the kernel, which then loads while this process does other things."""
    _process()


def solid_facts(parts: Sequence[Part]) -> "Future[list[SolidFacts]]":
    """Facts of the solids of some parts, in their order."""
    return _process().ask("solid_facts", list(parts))


def step_files(assembly: StepAssembly) -> "Future[tuple[bytes, dict[str, bytes]]]":
    """The STEP file of the assembly, and those of its unique parts by name."""
    return _process().ask("step_files", assembly)


class _Process:
    """One kernel process; questions are answered in the order in which they are asked."""

    def __init__(self) -> None:
        # Use this process's import path, never the working directory.
        environment = os.environ | {"PYTHONPATH": os.pathsep.join(path for path in sys.path if path)}
        self.process = subprocess.Popen(
            [sys.executable, "-P", "-m", "pareto_monoped.cad.kernel.process"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            env=environment,
        )
        self.line = ThreadPoolExecutor(max_workers=1, thread_name_prefix="cad-kernel")
        atexit.register(self.close)

    def ask(self, question: str, argument: Any) -> "Future[Any]":
        return self.line.submit(self._talk, question, argument)

    def _talk(self, question: str, argument: Any) -> Any:
        assert self.process.stdin is not None
        assert self.process.stdout is not None
        try:
            pickle.dump((question, argument), self.process.stdin)
            self.process.stdin.flush()
            answer = pickle.load(self.process.stdout)  # noqa: S301 - from our own process
        except (OSError, EOFError) as problem:
            _process.cache_clear()  # a later question starts another
            raise RuntimeError(f"the CAD kernel's process ended (exit code {self.process.wait()})") from problem
        if isinstance(answer, BaseException):
            raise answer
        return answer

    def close(self) -> None:
        """End the process: it ends when its input does."""
        self.line.shutdown(cancel_futures=True)
        for stream in (self.process.stdin, self.process.stdout):
            if stream is not None and not stream.closed:
                with suppress(OSError):  # it has ended already
                    stream.close()
        self.process.wait()


@lru_cache(maxsize=1)
def _process() -> _Process:
    return _Process()
