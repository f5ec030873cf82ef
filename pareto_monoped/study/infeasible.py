"""Why a study has no front: the limits that its designs miss, and the design that comes nearest to all of them."""

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from pareto_monoped.errors import SelectionError
from pareto_monoped.measures import measure
from pareto_monoped.study.goals import Limit
from pareto_monoped.study.place import StudyPlace
from pareto_monoped.study.reader import StudyData, read_study
from pareto_monoped.study.scoring import missed

_DIGITS = 4
"""Least significant digits of a value beside its limit; our own choice: 1 mm of a jump."""


def why_no_front(data: StudyData) -> str:
    """The limits that stand in the way of a study with trials, but without a front.

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
    """Refuse to choose from a front without designs.

    Args:
        front: of the study, or what may be chosen besides.
        study: the study, or where it is.

    Raises:
        SelectionError: there are no designs; it says why.
    """
    if len(front):
        return
    data = study if isinstance(study, StudyData) else read_study(study)
    if len(data.trials) == 0:
        raise SelectionError("front: no design has been simulated yet; run or resume the study")
    raise SelectionError(f"front: {why_no_front(data)}; run the study longer, widen its bounds or relax its limits")


def _together(jumped: pd.DataFrame, counts: dict[Limit, int], violation: NDArray[np.float64]) -> str:
    """All limits that are missed, by how many miss them, and the trial that comes nearest to all of them."""
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
    """The value nearest to a limit that all miss, such as "the least is 4.218 kg"."""
    if np.isnan(values).all():
        return "no design has a value"
    word, value = ("least", np.nanmin(values)) if limit.side == "max" else ("greatest", np.nanmax(values))
    return f"the {word} is {_value(float(value), limit)}"


def _value(value: float, limit: Limit) -> str:
    """A value with its unit, in as many digits as tell it from the limit."""
    if np.isnan(value):
        return "without a value"
    unit = measure(limit.measure).unit
    texts = (f"{value:.{digits}g}" for digits in range(_DIGITS, 18))
    text = next((text for text in texts if value == limit.value or float(text) != limit.value), repr(value))
    return f"{text} {unit}".removesuffix(" 1")
