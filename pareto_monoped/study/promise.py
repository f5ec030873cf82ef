"""Which of many designs are worth simulating, by what a model expects of them."""

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.jump.compiled import compiled
from pareto_monoped.study.archive import Standing, shortfall
from pareto_monoped.study.distances import nearest_squared
from pareto_monoped.study.protocol import Floats

_PENALTY = 10.0
"""Gain that an expected violation costs: a limit missed by a percent outweighs a gain of a tenth of the front."""
LENIENT_PENALTY = 1.0
"""The same far from all simulated designs, where the model knows little of constraints. Our own choice."""
_LOOKED_AT = 25
"""Designs whose distance to the known ones is measured, the most promising, for each that is chosen."""
CURIOSITY = 0.1
"""Gain that a distance of 1, in features from -1 to 1, is worth: errors of the model at that distance have this order.
"""


def ranked(costs: Floats, violation: Floats, standing: Standing) -> NDArray[np.intp]:
    """Rows of n designs in the order in which they are worth simulating.

    The best gain over the front in each of its parts comes first, then the second best, and so on. Without a front,
    the least violation comes first.

    Args:
        costs: expected costs, as ``Standing`` has them, shape (n, m).
        violation: expected sum of missed constraints, shape (n,).
        standing: of the simulated designs.
    """
    if len(standing.front) == 0:
        return np.argsort(violation, kind="stable")
    gain = gains(costs, violation, standing)
    order = np.argsort(-gain, kind="stable")
    return order[_in_turns(standing.parts(costs)[order], max(len(standing.posts), 1))]


@compiled
def _in_turns(parts: NDArray[np.intp], count: int) -> NDArray[np.intp]:
    """The first row of each of ``count`` parts, then the second of each, and so on, shape (n,) -> (n,)."""
    lengths, turns = np.zeros(count, dtype=np.intp), np.empty(len(parts), dtype=np.intp)
    for n in range(len(parts)):
        turns[n] = lengths[parts[n]]
        lengths[parts[n]] += 1
    first = np.zeros(len(parts) + 1, dtype=np.intp)
    for n in range(len(parts)):
        first[turns[n] + 1] += 1
    first = np.cumsum(first)
    rows = np.empty(len(parts), dtype=np.intp)
    for n in range(len(parts)):
        rows[first[turns[n]]] = n
        first[turns[n]] += 1
    return rows


def unlike(
    costs: Floats, violation: Floats, standing: Standing, points: Floats, known: Floats, count: int
) -> list[int]:
    """Rows of ``count`` of n designs that promise much and are far from what is known, and from each other.

    Args:
        costs: expected costs, as ``Standing`` has them, shape (n, m).
        violation: expected sum of missed constraints, shape (n,).
        standing: of the simulated designs; it has a front.
        points: the designs' features, shape (n, f).
        known: features of the simulated designs, shape (k, f).
        count: how many.
    """
    gain = gains(costs, violation, standing, LENIENT_PENALTY)
    looked_at = np.argsort(-gain, kind="stable")[: count * _LOOKED_AT]
    points, gain = points[looked_at], gain[looked_at]
    away = _nearest(points, known)
    chosen: list[int] = []
    for _ in range(min(count, len(points))):
        worth = gain + CURIOSITY * np.minimum(away, 1.0)
        worth[chosen] = -np.inf
        chosen.append(int(worth.argmax()))
        away = np.minimum(away, _nearest(points, points[chosen[-1:]]))
    best: list[int] = looked_at[chosen].tolist()
    return best


def gains(costs: Floats, violation: Floats, standing: Standing, penalty: float = _PENALTY) -> Floats:
    """How far n designs are ahead of the front, as a share of its extent, less what violations cost, shape (n,).

    Args:
        costs: expected costs, as ``Standing`` has them, shape (n, m).
        violation: expected sum of missed constraints, shape (n,).
        standing: of the simulated designs; it has a front.
        penalty: what a violation of 1 costs.
    """
    return -shortfall(standing.scaled(costs), standing.line) - penalty * violation


def _nearest(points: Floats, others: Floats) -> Floats:
    """Distance of each of n points to the nearest of k others, shape (n, f) and (k, f) -> (n,)."""
    return np.asarray(np.sqrt(nearest_squared(points, others)))
