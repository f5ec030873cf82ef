"""What a user should hear of a study's result: what keeps it from its front, and which bounds limit the front."""

import math

import numpy as np
import pandas as pd

from pareto_monoped.measures import Measure, is_own
from pareto_monoped.study.algorithm_settings import WeightedSettings
from pareto_monoped.study.at_bounds import bound_lines
from pareto_monoped.study.infeasible import why_no_front
from pareto_monoped.study.reader import StudyData
from pareto_monoped.study.weighted_budget import share_of, sweep_evaluations

_MOST_LINES = 4
"""At most so many remarks on one result are read; our own choice."""


def remarks(data: StudyData, front: pd.DataFrame | None = None) -> list[str]:
    """The few lines that follow a run, warnings first; none if there is nothing to say.

    All variables at bounds are named: those that are there on most of the front with a line each, the others in the
    last line.

    Args:
        data: the study.
        front: its front, if it is at hand.
    """
    front = data.front() if front is None else front
    first, of_variables = warnings(data, front), bound_lines(data, front)
    room = _MOST_LINES - len(first)
    if len(of_variables) <= room:
        return [*first, *of_variables.values()]
    told, others = list(of_variables.values())[: room - 1], list(of_variables)[room - 1 :]
    return [*first, *told, f"also at bounds along the front, which the report shows: {', '.join(others)}"]


def warnings(data: StudyData, front: pd.DataFrame) -> list[str]:
    """What keeps a study from its result: no feasible design, a budget that ended early, or a corner amid the front."""
    if len(data.trials) == 0:
        return []
    return [*_sweep(data), *_beyond_corner(data, front)] if len(front) else [why_no_front(data)]


def _sweep(data: StudyData) -> list[str]:
    """A line if the budget of a weighted search ended before its last weight, or is more than all weights take."""
    settings = data.study.algorithm
    if not isinstance(settings, WeightedSettings) or not data.meta.finished:
        return []
    run, weights = int(data.checkpoint.state.get("run", 0)), len(settings.height_weights)
    if run >= weights:
        share = share_of(settings, data.meta.budget)
        if len(data.trials) >= data.meta.budget or share <= settings.iterations:
            return []
        return [
            f"of {data.meta.budget} evaluations, {len(data.trials)} were made: each weight's iterations were fixed at "
            f"{settings.iterations} when the database was made; for {share}, run into a new one (--db), with "
            "iterations left out of the study file"
        ]
    return [
        f"the budget of {len(data.trials)} ended at weight {run + 1} of {weights}; all weights need up to "
        f"{sweep_evaluations(settings)}: continue with --evaluations {sweep_evaluations(settings)}"
    ]


def _beyond_corner(data: StudyData, front: pd.DataFrame) -> list[str]:
    """A line if designs of the front are no better than the reference point, with the values that lie behind them."""
    corner, beyond, cures = data.reference_point, np.full(len(front), False), []
    for entry, limit in zip(corner.objectives.measures, corner.values, strict=True):
        sign = -1.0 if entry.direction == "maximise" else 1.0
        loss = sign * front[entry.name].to_numpy(dtype=np.float64)
        further = _further(entry, sign, float(loss.max()))
        if loss.max() >= sign * limit and further is not None:
            beyond |= loss >= sign * limit
            cures.append(f"{entry.name} = {further:g}")
    if not cures:
        return []
    return [
        f"{int(beyond.sum())} of the front's {len(front)} designs are beyond the reference point ({corner.text()}) and "
        f"add nothing to the hypervolume, nor to a plateau; set {' and '.join(cures)} in [reference_point] of a new "
        "study"
    ]


def _further(entry: Measure, sign: float, worst: float) -> float | None:
    """The next number of one digit that is worse than ``worst``, a value times its sign; None if none is allowed."""
    step = 10.0 ** math.floor(math.log10(abs(worst))) if worst else 1.0
    further = sign * (math.floor(round(worst / step, 9)) + 1.0) * step
    return None if further < 0.0 and not is_own(entry.name) else further
