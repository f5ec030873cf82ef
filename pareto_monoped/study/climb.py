"""Local searches on the model alone: where designs lead once every variable is chosen anew."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.study.archive import Standing
from pareto_monoped.study.prediction import Prediction
from pareto_monoped.study.promise import gains
from pareto_monoped.study.protocol import Floats, Space
from pareto_monoped.study.variation import scans, small_steps

_ROUNDS = 3
"""Changes that a climb makes, one after the other. Our own choice."""
_STEPS = 16
"""Small steps that are looked at for each change. Our own choice: about as many as a scan of all variables has."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Climbs:
    """What several climbs have looked at.

    Attributes:
        values: all designs on the way, shape (n, d).
        costs, violation: what is expected of them, as ``Prediction.fine`` has it, shape (n, m) and (n,).
        ends: rows of the designs at which the climbs ended, shape (number of climbs,).
    """

    values: Floats
    costs: Floats
    violation: Floats
    ends: NDArray[np.intp]


def climbs(
    space: Space, start: Floats, prediction: Prediction, standing: Standing, generator: np.random.Generator
) -> Climbs:
    """Climb from each of s designs, shape (s, d), to where the model expects more and more gain over the front.

    Each change is the best of single variables elsewhere and of small steps of several, or none. A climb ends in one
    generation where evolution arrives after many, or never, since it drops designs that do not yet gain.

    Args:
        space: the space.
        start: where the climbs begin, at least one design.
        prediction: the model.
        standing: of the simulated designs; it has a front.
        generator: source of all choices.
    """
    count, dimensions = start.shape
    best, every, looked_at = start, np.arange(count), 0
    rounds: list[tuple[Floats, Floats, Floats]] = []
    for _ in range(_ROUNDS):
        near = (scans(space, best, generator), small_steps(space, best, _STEPS, generator), best)
        around = np.concatenate([part.reshape(count, -1, dimensions) for part in near], axis=1)
        values = around.reshape(-1, dimensions)
        costs, violation = prediction.fine(values)
        most = gains(costs, violation, standing).reshape(count, -1).argmax(axis=1)
        best, ends = around[every, most], looked_at + every * around.shape[1] + most
        rounds.append((values, costs, violation))
        looked_at += len(values)
    values, costs, violation = (np.concatenate(column) for column in zip(*rounds, strict=True))
    return Climbs(values=values, costs=costs, violation=violation, ends=ends)
