"""What a user should hear of a study's result: what keeps it from its front, and which bounds limit the front."""

import math

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from pareto_monoped.analysis.at_bounds import bound_lines
from pareto_monoped.definition.algorithms import WeightedSettings, share_of, sweep_evaluations
from pareto_monoped.definition.goals import Limit
from pareto_monoped.errors import SelectionError
from pareto_monoped.measures import Measure, is_own, measure
from pareto_monoped.search.scoring import missed
from pareto_monoped.storage.place import StudyPlace
from pareto_monoped.storage.reader import StudyData, read_study

_DIGITS = 4
"""Least significant digits of a value beside its limit; our own choice: 1 mm of a jump."""


def why_no_front(data: StudyData) -> str:
    """Return the limits that stand in the way of a study with trials, but without a front.

    These are the limits that every design misses, each with the value nearest to it. If there are none, every limit is
    met by some design, but no design meets all: then all limits that are missed, and the trial of least violation.
    """
    jumped = data.trials[data.trials["state"] != "failed"]
    total, failed = len(data.trials), len(data.trials) - len(jumped)
    if len(jumped) == 0:
        reason = data.trials["reason"].mode().iloc[0]
        return f"no design is feasible: none of {total} jumps, most often because: {reason}"
    if (jumped["state"] == "feasible").any():
        return f"no design is on the front: all of {int((jumped['state'] == 'feasible').sum())} failed their audit"
    constraints = data.study.constraints
    measures = {name: jumped[name].to_numpy(dtype=np.float64) for name in constraints.measures}
    shares = missed(constraints, measures, np.zeros(len(jumped), dtype=np.bool_))
    counts = dict(zip(constraints.limits, (shares > 0.0).sum(axis=0).tolist(), strict=True))
    lines = [
        f"{len(jumped)} of {len(jumped)} miss {_limit(limit)}; {_closest(measures[limit.measure], limit)}"
        for limit, count in counts.items()
        if count == len(jumped)
    ] or [_together(jumped, counts, np.maximum(shares, 0.0).sum(axis=1))]
    also = [f"{failed} did not jump"] if failed else []
    return f"no design is feasible: {'. '.join([*lines, *also])}"


def refuse_empty(front: pd.DataFrame, study: StudyData | StudyPlace) -> None:
    """Refuse to choose from a front without designs, and say why there are none."""
    if len(front):
        return
    data = study if isinstance(study, StudyData) else read_study(study)
    if len(data.trials) == 0:
        raise SelectionError("front: no design has been simulated yet; run or resume the study")
    raise SelectionError(f"front: {why_no_front(data)}; run the study longer, widen its bounds or relax its limits")


def _together(jumped: pd.DataFrame, counts: dict[Limit, int], violation: NDArray[np.float64]) -> str:
    """Return all limits that are missed, by how many miss them, and the trial that comes nearest to all of them."""
    told = sorted((limit for limit, count in counts.items() if count), key=lambda limit: -counts[limit])
    listed = ", ".join(f"{counts[limit]} miss {_limit(limit)}" for limit in told)
    nearest = jumped.iloc[int(np.argmin(violation))]
    values = {limit.measure: f"{limit.measure} {_value(float(nearest[limit.measure]), limit)}" for limit in told}
    return (
        f"none of {len(jumped)} meets all limits at once: {listed}; nearest is trial {int(nearest['trial'])} with "
        f"{', '.join(values.values())}"
    )


def _limit(limit: Limit) -> str:
    return f"{limit.measure} {'<=' if limit.side == 'max' else '>='} {limit.value:g}"


def _closest(values: NDArray[np.float64], limit: Limit) -> str:
    """Return the value nearest to a limit that all miss, such as "the least is 4.218 kg"."""
    if np.isnan(values).all():
        return "no design has a value"
    word, value = ("least", np.nanmin(values)) if limit.side == "max" else ("greatest", np.nanmax(values))
    return f"the {word} is {_value(float(value), limit)}"


def _value(value: float, limit: Limit) -> str:
    """Return a value with its unit, in as many digits as tell it from the limit."""
    if np.isnan(value):
        return "without a value"
    unit = measure(limit.measure).unit
    texts = (f"{value:.{digits}g}" for digits in range(_DIGITS, 18))
    text = next((text for text in texts if value == limit.value or float(text) != limit.value), repr(value))
    return f"{text} {unit}".removesuffix(" 1")


_MOST_LINES = 4
"""At most so many remarks on one result are read; our own choice."""


def remarks(data: StudyData, front: pd.DataFrame | None = None) -> list[str]:
    """Return the few lines that follow a run, warnings first; none if there is nothing to say.

    All variables at bounds are named: those that are there on most of the front with a line each, the others in the
    last line.
    """
    front = data.front() if front is None else front
    first, of_variables = warnings(data, front), bound_lines(data, front)
    room = _MOST_LINES - len(first)
    if len(of_variables) <= room:
        return [*first, *of_variables.values()]
    told, others = list(of_variables.values())[: room - 1], list(of_variables)[room - 1 :]
    return [*first, *told, f"also at bounds along the front, which the report shows: {', '.join(others)}"]


def warnings(data: StudyData, front: pd.DataFrame) -> list[str]:
    """Return what keeps a study from its result: no feasible design, an early end, or a corner amid the front."""
    if len(data.trials) == 0:
        return []
    return [*_sweep(data), *_failures(data), *_beyond_corner(data, front)] if len(front) else [why_no_front(data)]


_MANY_FAIL = 0.2
"""Share of failed jumps that is worth a line; our own choice: the bounds of the paper's cases give 2 to 9 percent."""


def _failures(data: StudyData) -> list[str]:
    """Return a line if many jumps failed, with the most frequent kind of failure."""
    failed = data.trials[data.trials["state"] == "failed"]
    share = len(failed) / len(data.trials)
    if share < _MANY_FAIL:
        return []
    # Reasons of one kind differ by their numbers.
    kinds = failed["reason"].str.replace(r"\d+(\.\d+)?", "...", regex=True)
    return [
        f"{len(failed)} of {len(data.trials)} jumps failed ({100.0 * share:.0f} percent), most often because: "
        f"{kinds.mode().iloc[0]}; narrower bounds would save them"
    ]


def _sweep(data: StudyData) -> list[str]:
    """Return a line if a weighted search's budget ended before its last weight, or is more than all weights take."""
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
    """Return a line if designs of the front are no better than the reference point, with the values behind them."""
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
    """Return the next number of one digit that is worse than ``worst``, a value times its sign, if one is allowed."""
    step = 10.0 ** math.floor(math.log10(abs(worst))) if worst else 1.0
    further = sign * (math.floor(round(worst / step, 9)) + 1.0) * step
    return None if further < 0.0 and not is_own(entry.name) else further
