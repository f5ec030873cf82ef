"""Simple kriging in many groups at once, compiled by numba, which this imports.

Values at a group's points are alike as the Matérn kernel of smoothness 3/2 says (Rasmussen and Williams 2006, equation
4.17). All loops run over consecutive numbers in memory and add in the same order, so a result depends neither on other
groups nor on the other points that are asked for.
"""

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.compute.compiled import compiled
from pareto_monoped.search.algorithm import Floats

_TOGETHER = 64
"""Points that are corrected at once, so that all their sums stay in the first cache. Our own choice."""
_AT_ONCE = 8
"""Numbers that a processor takes at once, or a multiple: loops over fewer points than ``_TOGETHER`` are so long."""


@compiled
def _alike(squares: Floats, scale: float) -> None:
    """Replace squared distances, shape (n,), by the kernel (1 + r) exp(-r), r = sqrt(scale * square).

    exp(-r) is the 64th power of the series of exp(-r / 64) up to its tenth term: exact to 2e-13 for r up to 14, and
    points in 15 features from -1 to 1 are no farther apart. Processors compute several of these at once, but the
    library's exp one by one.
    """
    for n in range(squares.shape[0]):
        r = np.sqrt(scale * squares[n])
        x = r * -0.015625
        power = 1.0 + x * (1.0 / 8.0) * (1.0 + x * (1.0 / 9.0) * (1.0 + x * (1.0 / 10.0)))
        power = 1.0 + x * (1.0 / 5.0) * (1.0 + x * (1.0 / 6.0) * (1.0 + x * (1.0 / 7.0) * power))
        power = 1.0 + x * (1.0 + x * 0.5 * (1.0 + x * (1.0 / 3.0) * (1.0 + x * 0.25 * power)))
        power *= power
        power *= power
        power *= power
        power *= power
        power *= power
        power *= power
        squares[n] = (1.0 + r) * power


@compiled
def kriging_factors(points: Floats, ends: NDArray[np.intp], scale: float, nugget: float) -> Floats:
    """Return upper triangular factors of each group's kernel matrix, row after row, shape (numbers,).

    The points of all groups, shape (n, f), stand one group after the other; ``ends`` has the number of points up to the
    end of each. ``scale`` is of squared distances, see ``_alike``; the ``nugget`` is the share of an error that its
    neighbours do not have. No values are needed yet.

    Raises:
        numpy.linalg.LinAlgError: points of a group are equal, and the nugget is 0.
    """
    start, numbers = 0, 0
    for end in ends:
        numbers += (end - start) * (end - start)
        start = end
    factors = np.empty(numbers)
    start, place = 0, 0
    for end in ends:
        columns = points[start:end].T.copy()
        count = end - start
        matrix = np.empty((count, count))
        near = np.empty(count)
        for n in range(count):
            near[: n + 1] = 0.0
            for f in range(columns.shape[0]):
                value = columns[f, n]
                for k in range(n + 1):
                    near[k] += (value - columns[f, k]) * (value - columns[f, k])
            _alike(near[: n + 1], scale)
            near[n] += nugget
            matrix[n, : n + 1] = near[: n + 1]
            matrix[: n + 1, n] = near[: n + 1]
        # Numba has the lower factor by columns, so its transpose is by rows.
        factors[place : place + count * count] = np.linalg.cholesky(matrix).T.ravel()
        place += count * count
        start = end
    return factors


@compiled
def kriging_shares(factors: Floats, errors: Floats, ends: NDArray[np.intp]) -> Floats:
    """Return how much each point counts where values are interpolated, shape (n, k).

    Args:
        factors: what ``kriging_factors`` returned.
        errors: what is interpolated, known at the points, shape (n, k).
        ends: number of points up to the end of each group, shape (groups,).
    """
    shares = np.empty_like(errors)
    start, place = 0, 0
    for end in ends:
        count = end - start
        factor = factors[place : place + count * count].reshape(count, count)
        rows = errors[start:end].T.copy()
        for t in range(rows.shape[0]):
            row = rows[t]
            for k in range(count):
                value = row[k] / factor[k, k]
                row[k] = value
                for i in range(k + 1, count):
                    row[i] -= factor[k, i] * value
            for i in range(count - 1, -1, -1):
                value = row[i] / factor[i, i]
                row[i] = value
                for k in range(i):
                    row[k] -= factor[k, i] * value
        shares[start:end] = rows.T
        place += count * count
        start = end
    return shares


@compiled
def kriging_values(
    wanted: Floats, groups: NDArray[np.intp], points: Floats, shares: Floats, ends: NDArray[np.intp], scale: float
) -> Floats:
    """Interpolate at m points, shape (m, f), each in one of the groups, shape (m,); the result has the shape (m, k)."""
    count, width = wanted.shape
    values = np.zeros((count, shares.shape[1]))
    order = np.argsort(groups, kind="mergesort")
    columns, near = np.zeros((width, _TOGETHER)), np.empty(_TOGETHER)
    sums = np.empty((shares.shape[1], _TOGETHER))
    first = 0
    while first < count:
        group = groups[order[first]]
        size = 1
        while size < _TOGETHER and first + size < count and groups[order[first + size]] == group:
            size += 1
        for n in range(size):
            for f in range(width):
                columns[f, n] = wanted[order[first + n], f]
        filled = (size + _AT_ONCE - 1) // _AT_ONCE * _AT_ONCE
        sums[:] = 0.0
        for known in range(0 if group == 0 else ends[group - 1], ends[group]):
            near[:filled] = 0.0
            for f in range(width):
                value, column = points[known, f], columns[f]
                for n in range(filled):
                    near[n] += (column[n] - value) * (column[n] - value)
            _alike(near[:filled], scale)
            for t in range(sums.shape[0]):
                share, row = shares[known, t], sums[t]
                for n in range(filled):
                    row[n] += share * near[n]
        for n in range(size):
            for t in range(sums.shape[0]):
                values[order[first + n], t] = sums[t, n]
        first += size
    return values
