"""Designs that cost about as much as a given one, and differ from it and from each other as much as possible."""

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.pareto.objectives import Objectives

Floats = NDArray[np.float64]

LEAST_DISTANCE = 0.02
"""Distance below which two designs count as the same. Our own choice: 2 percent of one variable's range, which is 4 mm
of a link, is less than anybody would call another robot."""


def prices(values: Floats, of: Floats, objectives: Objectives) -> Floats:
    """Return what designs, (n, m), cost against one, (m,): the greatest loss as a share of its value, (n,).

    A design that is worse in no objective costs at most 0. Where the given value is 0, any loss is infinite.
    """
    lost = objectives.minimised(values) - objectives.minimised(of)
    with np.errstate(divide="ignore", invalid="ignore"):
        shares = np.where(lost == 0.0, 0.0, lost / np.abs(of))
    return np.asarray(shares.max(axis=1))


def distances(points: Floats, to: Floats, categories: NDArray[np.bool_]) -> Floats:
    """Return distances of designs, shape (n, d), from one design, shape (d,), as shares of the variables' ranges, (n,).

    Numbers are scaled so that their range is 1; different values of ``categories``, without an order, are 1 apart.
    """
    apart = np.abs(points - to)
    apart[:, categories] = apart[:, categories] != 0.0
    return np.asarray(np.linalg.norm(apart, axis=1))


def most_different(points: Floats, given: int, count: int, categories: NDArray[np.bool_]) -> list[int]:
    """Return up to ``count`` rows of designs that differ most from a given one and from each other.

    Greedy: each next design is the one whose nearest design among those taken is farthest, of equals the first
    (Gonzalez 1985, who shows that the least distance is at least half of the best possible). It ends where that is
    below ``LEAST_DISTANCE``.
    """
    taken: list[int] = []
    nearest = distances(points, points[given], categories)
    while len(taken) < count:
        row = int(np.argmax(nearest))
        if nearest[row] < LEAST_DISTANCE:
            break
        taken.append(row)
        nearest = np.minimum(nearest, distances(points, points[row], categories))
    return taken
