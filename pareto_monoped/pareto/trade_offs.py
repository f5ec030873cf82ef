"""Scores of designs by where a front bends most, and what a little more of the first objective costs at one design."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from pareto_monoped.measures import nominal
from pareto_monoped.pareto.objectives import HEIGHT_AND_ENERGY, Floats, Objectives

if TYPE_CHECKING:
    from pandas import DataFrame


@dataclass(frozen=True, slots=True, kw_only=True)
class Scored:
    """How good each of n designs is for a choice."""

    score: Floats  #: more is better, shape (n,)
    why: Callable[[int], str]  #: the reason for choosing the design in a row, as a part of a sentence


def scaled(values: Floats, front: Floats) -> Floats:
    """Return each column scaled to its extent on a front, from 0 to 1 there; zeros where all values are equal."""
    least, extent = front.min(axis=0), np.ptp(front, axis=0)
    return np.where(extent > 0.0, (values - least) / np.where(extent > 0.0, extent, 1.0), 0.0)


def losses(values: Floats, front: Floats, objectives: Objectives) -> Floats:
    """Return objectives scaled to the extent of a front, shape (n, m): 0 is its best of each, 1 its worst."""
    return scaled(objectives.minimised(values), objectives.minimised(front))


NEIGHBOURHOOD = 0.125
"""Distance on the scaled front within which designs are neighbours. Source: pymoo, ``mcdm.high_tradeoff``."""


def knee(values: Floats, front: Floats, objectives: Objectives) -> Scored:
    """Compute scores by the distance from the chord (Das 1999, On characterizing the "knee" of the Pareto curve).

    With each objective scaled to the extent of the front and its better end at 1, the ends of a front of two objectives
    are (0, 1) and (1, 0), and a point's distance from the chord between them is (sum of the scaled objectives - 1) /
    sqrt(2). For three objectives the chord becomes the plane through (1, 0, 0), (0, 1, 0) and (0, 0, 1), and the
    divisor sqrt(3). ``front``, shape (n, m), is sorted by the first objective.
    """
    n, m = front.shape
    # The better end of a minimised objective lies at 1 - scaled. The ones are added last: with the paper's objectives
    # nothing is left of them, so that no digit is lost.
    ones = (objectives.signs > 0.0).sum() - 1
    distance = (-(scaled(values, front) * objectives.signs).sum(axis=1) + ones) / np.sqrt(float(m))

    def why(row: int) -> str:
        if n < m + 1:
            return f"the front has only {n} design(s), so its knee is an end of it"
        return f"the knee, farthest ({distance[row]:.3f} of the scaled front) from {_flat(front, objectives)}"

    return Scored(score=distance, why=why)


def _flat(front: Floats, objectives: Objectives) -> str:
    """Return what the knee is farthest from."""
    if len(objectives.names) > 2:
        return "the plane through the best of each objective"
    first, last = front[0], front[-1]
    if objectives == HEIGHT_AND_ENERGY:
        ends = [f"{height:.3f} m at {energy:.2f} J" for height, energy in (first, last)]
    else:
        ends = [objectives.text(end.tolist()) for end in (first, last)]
    return f"the chord between the front's ends {ends[0]} and {ends[1]}"


def tradeoff(values: Floats, front: Floats, objectives: Objectives) -> Scored:
    """Compute scores by what the best step to a neighbour gives up for what it gains (Rachmawati and Srinivasan 2009).

    Both are sums over the objectives, scaled to the extent of the front. Neighbours are the ``values`` within
    ``NEIGHBOURHOOD``, and at least the 2 m nearest ones and all that are as near.
    """
    points = losses(values, front, objectives)
    least = np.array([_least_bargain(points, i) for i in range(len(points))])

    def why(row: int) -> str:
        if len(points) < 2:
            return "the only design on the front"
        return (
            f"the largest trade-off: every neighbour on the front gives up at least {least[row]:.3g} times what it "
            "gains (objectives scaled to the front's extent)"
        )

    return Scored(score=least, why=why)


def _least_bargain(points: Floats, i: int) -> float:
    """Return the least ratio of sacrifice to gain among the neighbours of one design; infinite without any gain."""
    apart = np.linalg.norm(points - points[i], axis=1)
    others = np.arange(len(points)) != i
    nearest = np.sort(apart[others])[: 2 * points.shape[1]]
    # Equally far designs are all neighbours or none, whatever their order and last digits.
    reach = max(NEIGHBOURHOOD, nearest[-1] if len(nearest) else 0.0) + 1e-9
    change = points[others & (apart <= reach)] - points[i]
    sacrifice, gain = np.maximum(change, 0.0).sum(axis=1), np.maximum(-change, 0.0).sum(axis=1)
    gains = gain > 0.0
    return float((sacrifice[gains] / gain[gains]).min()) if gains.any() else np.inf


_STEPS = {"height_m": (0.01, "one more centimetre of")}
"""Stored step and words of measures for which people have a natural step, also under uncertainty."""
_PART = 0.1
"""Share of the front's extent that the step of any other measure is at most. Our own choice: ten steps cross it."""


@dataclass(frozen=True, slots=True, kw_only=True)
class OneMore:
    """What a step in the first objective costs."""

    objectives: Objectives  #: of the front
    step: float  #: in the first objective, in its stored unit, above 0
    step_words: str  #: the step in words
    trial: int | None  #: the design that is better by at least the step and costs least; None if there is none
    #: By how much each other objective becomes worse with it, in stored units; negative where it gets better
    costs: tuple[float, ...] = ()
    values: tuple[float, ...] = ()  #: of that design's objectives
    between: bool = False  #: whether ``costs`` are those of the step alone, on the straight line to that design

    def text(self) -> str:
        """Return a sentence such as "one more centimetre of height costs 0.52 J of energy (trial 3: ...)"."""
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
        towards = "on the straight line to " if self.between else ""
        found = f"{towards}trial {self.trial}: {self.objectives.text(self.values)}"
        return f"{self.step_words} {' and '.join(parts)} ({found})"

    def as_dict(self) -> dict[str, object]:
        """Return the step, and the cost in each other objective, as JSON values."""
        first, *others = self.objectives.names
        costs = dict(zip(others, self.costs, strict=True)) if self.trial is not None else None
        return {"objective": first, "step": self.step, "trial": self.trial, "costs": costs}


def one_more(front: "DataFrame", trial: int, objectives: Objectives, *, between: bool = False) -> OneMore:
    """Return what the next step in the first objective costs at a trial of the front.

    Neighbours on a front are at random distances, so the cost is that of the cheapest design that is better by at least
    a whole step: with three objectives that with the least sum of losses in the other two, scaled to the front's
    extent. Where only few designs of a front are known, ``between`` gives the cost on the straight line to that one.
    """
    values = front[list(objectives.names)].to_numpy(dtype=np.float64)
    row = int(np.flatnonzero(front["trial"].to_numpy() == trial)[0])
    step, words = _step(values[:, 0], objectives)
    loss, scaled = objectives.minimised(values), losses(values, values, objectives)
    # A design exactly one step away must not be lost to the last digit.
    better = np.flatnonzero(loss[:, 0] <= loss[row, 0] - step * (1.0 - 1e-9))
    if len(better) == 0:
        return OneMore(objectives=objectives, step=step, step_words=words, trial=None)
    found = int(better[np.argmin(scaled[better, 1:].sum(axis=1))])
    share = step / (loss[row, 0] - loss[found, 0]) if between else 1.0
    return OneMore(
        objectives=objectives,
        step=step,
        step_words=words,
        trial=int(front["trial"].iloc[found]),
        costs=tuple((share * (loss[found, 1:] - loss[row, 1:])).tolist()),
        values=tuple(values[found].tolist()),
        between=between,
    )


def _step(values: Floats, objectives: Objectives) -> tuple[float, str]:
    """Return the step in the stored unit, and in words: a power of ten in the shown unit without a natural step."""
    entry = objectives.measures[0]
    if nominal(entry.name) in _STEPS:
        step, words = _STEPS[nominal(entry.name)]
        return step, f"{words} {entry.words}"
    extent = float(np.ptp(values)) * entry.scale
    power = math.floor(math.log10(_PART * extent)) if extent > 0.0 else 0
    shown = f"{10.0**power:g} {entry.shown_unit}".removesuffix(" 1")
    more = "more" if entry.direction == "maximise" else "less"
    return 10.0**power / entry.scale, f"{shown} {more} {entry.words}"
