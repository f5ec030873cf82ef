"""Crews that jump: who may join is decided by versions, platform and the exact results of a few probe designs."""

import hashlib
import os
import platform
import threading
from collections.abc import Callable
from dataclasses import dataclass, fields, replace
from functools import lru_cache, partial
from importlib.metadata import PackageNotFoundError, version

import numpy as np
from threadpoolctl import threadpool_info

from pareto_monoped import __version__
from pareto_monoped.actuator.search import map_for
from pareto_monoped.compute.chunks import cores, set_task_threads
from pareto_monoped.compute.cluster import DaskWorkers
from pareto_monoped.compute.crew import Crew, Limits, Staff
from pareto_monoped.compute.processes import LocalProcesses
from pareto_monoped.design import LOWER, PAPER_CASES, PAPER_MOTOR, UPPER, complete
from pareto_monoped.errors import EXTRAS, InputError
from pareto_monoped.errors import complaint as complaint_of
from pareto_monoped.jump.calibration import calibration_names, load_calibration
from pareto_monoped.jump.evaluate import Evaluator

_DRAWN = 12  #: Probe designs besides the paper's. Our own choice: all together jump in a few tenths of a second.


@dataclass(frozen=True, slots=True, kw_only=True)
class Facts:
    """What decides the numbers of a worker."""

    versions: dict[str, str]  #: Of this package and of those that compute.
    system: str
    machine: str
    numbers: str  #: Digest of every measure of the probe designs under every shipped calibration, to the last bit.
    linear_algebra: str  #: Processor for which OpenBLAS was chosen: not compared, but likely why hosts differ.


_lock = threading.Lock()


def facts() -> Facts:
    """Return the facts of this process; computed once."""
    with _lock:
        return _facts()


@lru_cache(maxsize=1)
def _facts() -> Facts:
    packages = {"pareto-monoped": __version__} | {name: version(name) for name in ("mujoco", "numpy", "numba")}
    return Facts(
        versions=packages,
        system=platform.system(),
        machine=platform.machine(),
        numbers=_numbers(),
        linear_algebra=_linear_algebra(),
    )


def _linear_algebra() -> str:
    """Return the kind of processor that numpy's linear algebra was chosen for; empty if it does not say."""
    kinds = {library.get("architecture") for library in threadpool_info() if library["user_api"] == "blas"}
    return ", ".join(sorted(kind for kind in kinds if kind))


def _numbers() -> str:
    drawn = np.random.default_rng(20250101).uniform(LOWER, UPPER, size=(_DRAWN, len(LOWER)))
    paper = np.array([case.design.as_array() for case in PAPER_CASES.values()])
    designs, gearboxes = np.vstack((paper, complete(drawn))), map_for(PAPER_MOTOR)
    found = hashlib.sha256()
    for name in calibration_names():
        jumps = Evaluator(gearboxes, load_calibration(name))(designs)
        found.update("\n".join([*jumps.status, *jumps.reason]).encode())
        for field in fields(jumps):
            if field.name not in ("status", "reason"):
                values = getattr(jumps, field.name)
                # NaN has many bit patterns, which mean the same.
                found.update(np.where(np.isnan(values), np.nan, values).tobytes())
    return found.hexdigest()


def _facts_with(extra: str | None) -> Facts:
    """Return the facts of this process, with the versions of what an extra has."""
    plain = facts()
    if extra is None:
        return plain
    found = {}
    for package in EXTRAS[extra].values():
        try:
            found[package] = version(package)
        except PackageNotFoundError:
            found[package] = "missing"
    return replace(plain, versions=plain.versions | found)


def greeting(threads: int, extra: str | None = None) -> Facts:
    """Do the first task of a worker: set the threads of its tasks, warm up, and return its facts."""
    set_task_threads(threads)
    return _facts_with(extra)


def complaint(theirs: Facts, extra: str | None = None) -> str | None:
    """Return what keeps a worker with these facts from working for this process; None if nothing does."""
    ours = _facts_with(extra)
    pairs = [(name, theirs.versions.get(name), here) for name, here in ours.versions.items()]
    pairs += [("system", theirs.system, ours.system), ("machine", theirs.machine, ours.machine)]
    different = [f"{name} {there}, here {here}" for name, there, here in pairs if there != here]
    if different:
        return "; ".join(different)
    if theirs.numbers != ours.numbers:
        digests = f"digest {theirs.numbers[:8]}, here {ours.numbers[:8]}"
        if theirs.linear_algebra != ours.linear_algebra:
            kinds = f"linear algebra for {theirs.linear_algebra}, here {ours.linear_algebra}"
            digests += f"; {kinds}: set OPENBLAS_CORETYPE=Haswell where each process starts"
        return f"computes other jumps of the probe designs ({digests})"
    return None


def crew_of(
    staff: Staff,
    *,
    tell: Callable[[str], None] = lambda _: None,
    limits: Limits | None = None,
    seat: int = 0,
    extra: str | None = None,
) -> Crew:
    """Return an executor over the workers of a staff who compute the same numbers; a context that closes both.

    ``tell`` is called with a line for the user when a worker is lost or refused. The versions of packages of ``extra``,
    such as ``cad`` for exports, must agree, too. For ``seat`` see ``Crew``.
    """
    greet, check = partial(greeting, extra=extra), partial(complaint, extra=extra)
    crew = Crew(staff, greeting=greet, check=check, tell=tell, limits=limits, seat=seat)
    try:
        facts()  # while the workers do the same
    except BaseException:
        crew.shutdown()
        raise
    return crew


def processes(
    count: int | None = None, *, tell: Callable[[str], None] = lambda _: None, limits: Limits | None = None
) -> Crew:
    """Return an executor over fresh processes of this machine, one per core if ``count`` is None; see ``crew_of``.

    Raises:
        InputError: fewer than one process.
    """
    if count is not None and count < 1:
        raise InputError(complaint_of("processes", count, "a whole number from 1", "give None for one per core"))
    number = count or cores()
    return crew_of(LocalProcesses(number, max(cores() // number, 1)), tell=tell, limits=limits)


def cluster(
    address: str,
    *,
    tell: Callable[[str], None] = lambda _: None,
    limits: Limits | None = None,
    seat: int | None = None,
    extra: str | None = None,
) -> Crew:
    """Return an executor over the workers of a Dask scheduler, see ``crew_of``; needs the extra ``cluster``.

    Dask sends tasks by pickle: only among hosts that trust each other. The default ``seat`` is the number of this
    process.

    Raises:
        InputError: Dask is not installed here.
        WorkerError: no scheduler answers.
    """
    seat = os.getpid() if seat is None else seat
    return crew_of(DaskWorkers(address), tell=tell, limits=limits, seat=seat, extra=extra)
