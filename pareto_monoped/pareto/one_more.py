"""What a little more of the first objective costs, at one design of a front."""

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.measures import nominal
from pareto_monoped.pareto.objectives import Objectives
from pareto_monoped.pareto.scores import losses

if TYPE_CHECKING:
    from pandas import DataFrame

_STEPS = {"height_m": (0.01, "one more centimetre of")}
"""Stored step and words of measures for which people have a natural step, also under uncertainty."""
_PART = 0.1
"""Share of the front's extent that the step of any other measure is at most. Our own choice: ten steps cross it."""


@dataclass(frozen=True, slots=True, kw_only=True)
class OneMore:
    """What a step in the first objective costs.

    Attributes:
        objectives: of the front.
        step: in the first objective, in its stored unit, above 0.
        step_words: the step in words.
        trial: the design that is better by at least the step and costs least; None if there is none.
        costs: by how much each other objective becomes worse with it, in stored units; negative where it gets better.
        values: of that design's objectives.
    """

    objectives: Objectives
    step: float
    step_words: str
    trial: int | None
    costs: tuple[float, ...] = ()
    values: tuple[float, ...] = ()

    def text(self) -> str:
        """In one sentence, such as "one more centimetre of height costs 0.52 J of energy (trial 3: ...)"."""
        if self.trial is None:
            return f"{self.step_words} cannot be had on this front"
        others = self.objectives.measures[1:]
        parts = []
        for entry, cost in zip(others, self.costs, strict=True):
            verb, worse = ("costs", cost) if cost >= 0.0 else ("saves", -cost)
            if entry.direction == "maximise":
                verb = {"costs": "takes", "saves": "adds"}[verb]
            shown = f"{worse * entry.scale:.3g} {entry.shown_unit}".removesuffix(" 1")
            parts.append(f"{verb} {shown} of {entry.words}")
        return f"{self.step_words} {' and '.join(parts)} (trial {self.trial}: {self.objectives.text(self.values)})"

    def as_dict(self) -> dict[str, object]:
        """As JSON values: the step, and the cost in each other objective."""
        first, *others = self.objectives.names
        costs = dict(zip(others, self.costs, strict=True)) if self.trial is not None else None
        return {"objective": first, "step": self.step, "trial": self.trial, "costs": costs}


def one_more(front: "DataFrame", trial: int, objectives: Objectives) -> OneMore:
    """What the next step in the first objective costs at a trial of the front.

    Differences between neighbours on a front jump, because a search finds designs at random distances. The cost is
    therefore that of the cheapest design that is better by at least a whole step. With three objectives the cheapest is
    that with the least sum of losses in the other two, scaled to the front's extent.

    Args:
        front: one row per design, in any order.
        trial: one of them.
        objectives: of the front.
    """
    values = front[list(objectives.names)].to_numpy(dtype=np.float64)
    row = int(np.flatnonzero(front["trial"].to_numpy() == trial)[0])
    step, words = _step(values[:, 0], objectives)
    loss, scaled = objectives.minimised(values), losses(values, objectives)
    # A design exactly one step away must not be lost to the last digit.
    better = np.flatnonzero(loss[:, 0] <= loss[row, 0] - step * (1.0 - 1e-9))
    if len(better) == 0:
        return OneMore(objectives=objectives, step=step, step_words=words, trial=None)
    found = int(better[np.argmin(scaled[better, 1:].sum(axis=1))])
    return OneMore(
        objectives=objectives,
        step=step,
        step_words=words,
        trial=int(front["trial"].iloc[found]),
        costs=tuple((loss[found, 1:] - loss[row, 1:]).tolist()),
        values=tuple(values[found].tolist()),
    )


def _step(values: NDArray[np.float64], objectives: Objectives) -> tuple[float, str]:
    """Step in the stored unit, and in words: a power of ten in the shown unit for what has no natural step."""
    entry = objectives.measures[0]
    if nominal(entry.name) in _STEPS:
        step, words = _STEPS[nominal(entry.name)]
        return step, f"{words} {entry.words}"
    extent = float(np.ptp(values)) * entry.scale
    power = math.floor(math.log10(_PART * extent)) if extent > 0.0 else 0
    shown = f"{10.0**power:g} {entry.shown_unit}".removesuffix(" 1")
    more = "more" if entry.direction == "maximise" else "less"
    return 10.0**power / entry.scale, f"{shown} {more} {entry.words}"
