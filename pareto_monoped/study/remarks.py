"""What a user should hear of a study's result: limits that no design holds, variables whose bounds limit the front."""

from dataclasses import dataclass

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from pareto_monoped.design import VARIABLES
from pareto_monoped.measures import measure
from pareto_monoped.study.algorithm_settings import WeightedSettings
from pareto_monoped.study.free_variables import Bounds
from pareto_monoped.study.infeasible import why_no_front
from pareto_monoped.study.motor_choice import MotorCoordinates
from pareto_monoped.study.reader import StudyData
from pareto_monoped.study.weighted_budget import sweep_evaluations

_AT = 0.005
"""Share of its range within which a variable is at its bound. Our own choice: 1 N/m of K's 195."""
_WORTH_TELLING = 0.1
"""Least share of the front that is told. Our own choice."""
_GAP = 0.1
"""Share of the front's extent in its first objective over which a part of it must be missing to divide it in two."""


@dataclass(frozen=True, slots=True, kw_only=True)
class AtBound:
    """A variable that is at one of its bounds on a share of the front.

    Attributes:
        name: of the variable.
        side: ``lower`` or ``upper``.
        bound: its value there.
        share: of the designs on the front, at most 1.
        motor: with which it is there, where the bound is that of a motor's gearboxes; else empty.
        parts: least and greatest first objective of each part of the front where it is there, in stored units.
    """

    name: str
    side: str
    bound: float
    share: float
    parts: tuple[tuple[float, float], ...]
    motor: str = ""


def remarks(data: StudyData, front: pd.DataFrame | None = None) -> list[str]:
    """One line per remark, warnings first; none if there is nothing to say.

    Args:
        data: the study.
        front: its front, if it is at hand.
    """
    front = data.front() if front is None else front
    return [*warnings(data, front), *bound_lines(data, front)]


def warnings(data: StudyData, front: pd.DataFrame) -> list[str]:
    """What keeps a study from its result: no feasible design, or a budget that ended too early."""
    if len(data.trials) == 0:
        return []
    return _unfinished_sweep(data) if len(front) else [why_no_front(data)]


def bound_lines(data: StudyData, front: pd.DataFrame) -> list[str]:
    """One line per bound that limits the front, see ``at_bounds``."""
    return [_bound_line(data, found) for found in at_bounds(data, front)] if len(front) else []


def _unfinished_sweep(data: StudyData) -> list[str]:
    """A line if the budget of a weighted search ended before its last weight."""
    settings = data.study.algorithm
    if not isinstance(settings, WeightedSettings) or not data.meta.finished:
        return []
    run, weights = int(data.checkpoint.state.get("run", 0)), len(settings.height_weights)
    if run >= weights:
        return []
    return [
        f"the budget of {len(data.trials)} ended at weight {run + 1} of {weights}; all weights need up to "
        f"{sweep_evaluations(settings)}: continue with --evaluations {sweep_evaluations(settings)}"
    ]


def at_bounds(data: StudyData, front: pd.DataFrame) -> list[AtBound]:
    """The free variables that are at a bound on at least ``_WORTH_TELLING`` of the front, the greatest share first."""
    study = data.study
    along = front[study.objectives.names[0]].to_numpy(dtype=np.float64)
    found = []
    for name in study.free:
        if not isinstance(study.variables[name], Bounds):
            continue
        values = front[name].to_numpy(dtype=np.float64)
        for motor, own, (lower, upper) in _ranges(data, front, name):
            near = _AT * (upper - lower)
            for side, bound, at in (("lower", lower, values <= lower + near), ("upper", upper, values >= upper - near)):
                there = at & own
                share = float(there.mean())
                if share >= _WORTH_TELLING:
                    parts = _parts(along[there], float(np.ptp(along)))
                    found.append(AtBound(name=name, side=side, bound=bound, share=share, parts=parts, motor=motor))
    return sorted(found, key=lambda one: -one.share)


def _ranges(
    data: StudyData, front: pd.DataFrame, name: str
) -> list[tuple[str, NDArray[np.bool_], tuple[float, float]]]:
    """Ranges of a variable: motor, designs with it, bounds. One for all designs where no motor decides the bounds."""
    where = data.coordinates
    limits = where.motor_limits(name) if isinstance(where, MotorCoordinates) else None
    if limits is None:
        return [("", np.full(len(front), True), where.limits(name))]
    motors = front[limits[0]].to_numpy()
    return [(motor, np.asarray(motors == motor), bounds) for motor, bounds in limits[1].items()]


def _parts(values: NDArray[np.float64], extent: float) -> tuple[tuple[float, float], ...]:
    """Ranges of values that are divided where none lies within ``_GAP`` of the extent."""
    values = np.sort(values)
    ends = np.flatnonzero(np.diff(values) > _GAP * extent)
    first, last = [0, *(ends + 1).tolist()], [*ends.tolist(), len(values) - 1]
    return tuple((float(values[a]), float(values[b])) for a, b in zip(first, last, strict=True))


def _bound_line(data: StudyData, found: AtBound) -> str:
    variable = next(one for one in VARIABLES if one.name == found.name)
    entry = measure(data.study.objectives.names[0])
    where = " and ".join(
        entry.text(low) if low == high else f"{low * entry.scale:.{entry.decimals}f} to {entry.text(high)}"
        for low, high in found.parts
    )
    unit = "" if variable.unit == "1" else f" {variable.unit}"
    whose = f" with {found.motor}" if found.motor else ""
    return (
        f"{found.name} is at its {found.side} bound of {found.bound:.4g}{unit}{whose} in {100.0 * found.share:.0f} % "
        f"of the front ({entry.short} {where})"
    )
