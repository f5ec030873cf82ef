"""Where a search over motors looks at the ends of each motor's own front, so that none is given up too early."""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.study.archive import Archive, Standing
from pareto_monoped.study.distances import nearest_squared
from pareto_monoped.study.prediction import Prediction
from pareto_monoped.study.promise import CURIOSITY, LENIENT_PENALTY
from pareto_monoped.study.protocol import Floats, Space
from pareto_monoped.study.response_surface import Features
from pareto_monoped.study.variation import scans, small_steps

_ROUNDS = 3
"""Changes from a known design to a new one. Our own choice."""
_STEPS = 60
"""Small steps that are looked at for each change. Our own choice: with 16, a motor with few designs is not learned."""


def ends_of_least_tried(
    features: Features,
    archive: Archive,
    standing: Standing,
    prediction: Prediction,
    generator: np.random.Generator,
) -> Iterator[Floats]:
    """New designs of the motor that has the fewest, the most promising in one objective first; once per objective.

    The model knows little of a motor with few designs, and by what it knows, the heaviest motor, which alone jumps
    highest, never comes near the front. Without these designs, five searches over the six motors had 94.6 to 99.7
    percent of the hypervolume of four motors' fronts after 4,000 jumps, with them 99.7 in each.

    From the best design so far, each change goes to the best of all that are looked at, also if it promises less: a
    climb that may stay where it is looks at nothing new. For the same reason, distance from all known designs counts.

    Args:
        features: of the space, which has a choice of motors.
        archive: the simulated designs.
        standing: how they stand.
        prediction: the model.
        generator: source of all choices.

    Yields:
        Designs, shape (n, d).
    """
    space = archive.space
    column, motor = _least_tried(space, archive.values, standing)
    known = standing.order[archive.values[standing.order, column] == motor]
    holds = known[(archive.constraints[known] <= 0.0).all(axis=1)]
    known = holds if len(holds) else known[:1]
    for objective in range(standing.costs.shape[1]):
        best = archive.values[known[standing.costs[known, objective].argmin()]][None]
        designs, promise = [], []
        for _ in range(_ROUNDS):
            near = np.vstack((scans(space, best, generator), small_steps(space, best, _STEPS, generator)))
            near = near[near[:, column] == motor]
            costs, violation = prediction.fine(near)
            designs.append(near)
            away = np.sqrt(nearest_squared(features.scaled(near), archive.points))
            worth = -standing.scaled(costs)[:, objective] - LENIENT_PENALTY * violation
            promise.append(worth + CURIOSITY * np.minimum(away, 1.0))
            best = near[promise[-1].argmax()][None]
        yield np.vstack(designs)[np.argsort(-np.concatenate(promise), kind="stable")]


def _least_tried(space: Space, values: Floats, standing: Standing) -> tuple[int, int]:
    """Column of a choice, and the motor there, that the fewest designs have of those that jumped with it at all."""
    tried: list[tuple[int, int, int]] = []
    for column, choice in zip(space.choice_columns, space.choices, strict=True):
        for motor in range(len(choice.motors)):
            chosen: NDArray[np.bool_] = values[:, column] == motor
            if chosen[standing.order].any():
                tried.append((int(np.count_nonzero(chosen)), column, motor))
    _, column, motor = min(tried)
    return column, motor
