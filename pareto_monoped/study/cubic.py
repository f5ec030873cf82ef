"""Cubic polynomials of many points, compiled by numba. Importing this module imports numba.

A cubic of f features has a coefficient for every product of three of (1, features), repeated ones too, in the order of
``itertools.combinations_with_replacement``.
"""

import numpy as np

from pareto_monoped.jump.compiled import compiled
from pareto_monoped.study.protocol import Floats

_TOGETHER = 64
"""Points whose sums are in the making at once: ten features of so many are 5 KB, well within the first cache. Our own
choice."""


@compiled
def cubic_terms(points: Floats) -> Floats:
    """All products of three of (1, features), shape (n, f) -> (n, t)."""
    count, width = points.shape[0], points.shape[1] + 1
    terms = np.empty((count, width * (width + 1) * (width + 2) // 6))
    row = np.ones(width)
    for n in range(count):
        row[1:] = points[n]
        t = 0
        for i in range(width):
            for j in range(i, width):
                both = row[i] * row[j]
                for k in range(j, width):
                    terms[n, t] = both * row[k]
                    t += 1
    return terms


@compiled
def cubic_values(points: Floats, coefficients: Floats) -> Floats:
    """``cubic_terms(points) @ coefficients`` but for rounding, shape (n, f) and (t, k) -> (n, k).

    Nested as by Horner, it takes a multiplication per term and point, and none of the terms is stored. A value does not
    depend on the other points.
    """
    count, width, targets = points.shape[0], points.shape[1] + 1, coefficients.shape[1]
    result = np.empty((count, targets))
    columns = np.ones((width, _TOGETHER))
    third, second, first = np.empty(_TOGETHER), np.empty(_TOGETHER), np.empty(_TOGETHER)
    for start in range(0, count, _TOGETHER):
        size = min(_TOGETHER, count - start)
        for k in range(1, width):
            for n in range(size):
                columns[k, n] = points[start + n, k - 1]
        for target in range(targets):
            t = 0
            first[:] = 0.0
            for i in range(width):
                second[:] = 0.0
                for j in range(i, width):
                    third[:] = 0.0
                    for k in range(j, width):
                        coefficient = coefficients[t, target]
                        for n in range(_TOGETHER):
                            third[n] += coefficient * columns[k, n]
                        t += 1
                    for n in range(_TOGETHER):
                        second[n] += columns[j, n] * third[n]
                for n in range(_TOGETHER):
                    first[n] += columns[i, n] * second[n]
            for n in range(size):
                result[start + n, target] = first[n]
    return result
