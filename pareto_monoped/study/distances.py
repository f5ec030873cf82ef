"""Distances between points and from a front, compiled by numba. Importing this module imports numba.

All sums run over the axes in order, one point after the other, so a distance does not depend on the other points.
"""

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.jump.compiled import compiled
from pareto_monoped.study.protocol import Floats


@compiled
def squared_distances(points: Floats, others: Floats) -> Floats:
    """Squares of the distances between n points and k others, shape (n, f) and (k, f) -> (n, k)."""
    away = np.zeros((points.shape[0], others.shape[0]))
    columns = others.T.copy()
    for n in range(points.shape[0]):
        row = away[n]
        for f in range(points.shape[1]):
            value, column = points[n, f], columns[f]
            for k in range(row.shape[0]):
                row[k] += (value - column[k]) * (value - column[k])
    return away


@compiled
def nearest_squared(points: Floats, others: Floats) -> Floats:
    """Square of the distance of each of n points to the nearest of k others, shape (n, f) and (k, f) -> (n,)."""
    nearest = np.full(points.shape[0], np.inf)
    columns = points.T.copy()
    away = np.empty(points.shape[0])
    # The points are the innermost loop: a processor takes several of them at once.
    for k in range(others.shape[0]):
        away[:] = 0.0
        for f in range(columns.shape[0]):
            value, column = others[k, f], columns[f]
            for n in range(away.shape[0]):
                away[n] += (column[n] - value) * (column[n] - value)
        for n in range(away.shape[0]):
            nearest[n] = min(nearest[n], away[n])
    return nearest


@compiled
def nearest_places(points: Floats, others: Floats) -> NDArray[np.intp]:
    """Which of k others is nearest each of n points, the first of equals, shape (n, f) and (k, f) -> (n,)."""
    places = np.zeros(points.shape[0], dtype=np.intp)
    for n in range(points.shape[0]):
        least = np.inf
        for k in range(others.shape[0]):
            away = 0.0
            for f in range(points.shape[1]):
                away += (points[n, f] - others[k, f]) * (points[n, f] - others[k, f])
            if away < least:
                least, places[n] = away, k
    return places


@compiled
def farthest_first(points: Floats, first: NDArray[np.intp], count: int) -> NDArray[np.intp]:
    """Up to ``count`` of n points: the ``first``, then always the farthest from all chosen, shape (n, f) -> (k,).

    It ends early where all points are equal to chosen ones.
    """
    chosen = np.empty(max(count, len(first)), dtype=np.intp)
    chosen[: len(first)] = first
    away = np.full(points.shape[0], np.inf)
    known = 0
    for place in range(len(chosen)):
        if place >= len(first):
            farthest = 0
            for n in range(points.shape[0]):
                if away[n] > away[farthest]:
                    farthest = n
            if not away[farthest] > 0.0:
                break
            chosen[place] = farthest
        for n in range(points.shape[0]):
            square = 0.0
            for f in range(points.shape[1]):
                square += (points[n, f] - points[chosen[place], f]) * (points[n, f] - points[chosen[place], f])
            away[n] = min(away[n], square)
        known += 1
    return chosen[:known]


@compiled
def shortfall_of_two(points: Floats, front: Floats) -> Floats:
    """The shift in both objectives after which no point of a front dominates a point, shape (n, 2) -> (n,).

    The lesser of what is missing in either objective is greatest where the two cross along the front.

    Args:
        points: objectives, less is better.
        front: shape (k, 2), k at least 1, by ascending first and descending second objective.
    """
    result = np.empty(points.shape[0])
    last = front.shape[0] - 1
    for n in range(points.shape[0]):
        first, second = points[n, 0], points[n, 1]
        low, high = 0, front.shape[0]
        while low < high:
            middle = (low + high) // 2
            if front[middle, 0] - front[middle, 1] < first - second:
                low = middle + 1
            else:
                high = middle
        before, after = max(low - 1, 0), min(low, last)
        result[n] = max(
            min(first - front[before, 0], second - front[before, 1]),
            min(first - front[after, 0], second - front[after, 1]),
        )
    return result


@compiled
def shortfall_of_more(points: Floats, front: Floats) -> Floats:
    """The same for any number of objectives and any order of the front, shape (n, m) and (k, m) -> (n,)."""
    columns = points.T.copy()
    result, least = np.full(points.shape[0], -np.inf), np.empty(points.shape[0])
    # The points are the innermost loop: a processor takes several of them at once.
    for k in range(front.shape[0]):
        least[:] = np.inf
        for m in range(columns.shape[0]):
            value, column = front[k, m], columns[m]
            for n in range(least.shape[0]):
                least[n] = min(least[n], column[n] - value)
        for n in range(least.shape[0]):
            result[n] = max(result[n], least[n])
    return result
