"""Designs that cost about as much as a given one, and differ from it and from each other as much as possible."""

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.pareto.objectives import Objectives

Floats = NDArray[np.float64]

LEAST_DISTANCE = 0.02
"""Distance below which two designs count as the same. Our own choice: 2 percent of one variable's range, which is 4 mm
of a link, is less than anybody would call another robot."""


def prices(values: Floats, of: Floats, objectives: Objectives) -> Floats:
    """What designs cost compared with a given one: the greatest loss in any objective, as a share of its value there.

    Args:
        values: of the objectives, shape (n, m), in stored units.
        of: those of the given design, shape (m,).
        objectives: which m measures these are.

    Returns:
        Shape (n,); at most 0 for a design that is worse in no objective. Where the given value is 0, any loss is
        infinite.
    """
    lost = objectives.minimised(values) - objectives.minimised(of)
    with np.errstate(divide="ignore", invalid="ignore"):
        shares = np.where(lost == 0.0, 0.0, lost / np.abs(of))
    return np.asarray(shares.max(axis=1))


def distances(points: Floats, to: Floats, categories: NDArray[np.bool_]) -> Floats:
    """Distances of designs from one design, as shares of the variables' ranges.

    Args:
        points: shape (n, d): numbers scaled so that the range is 1, and categories as any numbers.
        to: shape (d,).
        categories: which variables have values without an order, shape (d,); two different ones are 1 apart.

    Returns:
        The root of the sum of squares over the variables, shape (n,).
    """
    apart = np.abs(points - to)
    apart[:, categories] = apart[:, categories] != 0.0
    return np.asarray(np.linalg.norm(apart, axis=1))


def most_different(points: Floats, given: int, count: int, categories: NDArray[np.bool_]) -> list[int]:
    """Up to ``count`` designs that differ most from a given one and from each other.

    Greedy: each next design is the one whose nearest design among those taken is farthest (Gonzalez 1985, who shows
    that the least distance is at least half of the best possible). It ends where that is below ``LEAST_DISTANCE``.

    Args:
        points: see ``distances``; of equally far ones, the first is taken.
        given: row of the given design, which is not among the result.
        count: how many at most.
        categories: see ``distances``.
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
