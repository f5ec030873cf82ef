"""Mass properties that change smoothly with one length, as Chebyshev series.

Weighing a population part by part takes thousands of small array operations. But a link is one smooth function of its
length. Interpolated in Chebyshev points, this function is exact to the last digits, and evaluating it takes a few
operations for any number of lengths (Trefethen, Approximation Theory and Approximation Practice, chapters 3 and 8).
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import reduce

import numpy as np
from numpy.polynomial.chebyshev import chebval
from numpy.typing import NDArray

from pareto_monoped.geometry.parts import MassProperties

Floats = NDArray[np.float64]
Weigh = Callable[[Floats], Sequence[MassProperties]]
"""Lengths in metres, shape (n,) -> the mass properties of each of the m units, one row per length."""

_EXACT = 1e-13  # of the largest mass, first or second moment: a few hundred roundings, which no jump can show
_MOST_NODES = 128
# Upper triangle of the second moments, which are symmetric.
_ROWS, _COLUMNS = np.triu_indices(3)
_WIDTH = 1 + 3 + len(_ROWS)


@dataclass(frozen=True, slots=True, kw_only=True)
class Tabulated:
    """The mass properties of m units over a range of lengths.

    Attributes:
        low_m, high_m: ends of the range.
        coefficients: of the Chebyshev series, shape (k, 10 m): mass, first and second moments of each unit.
    """

    low_m: float
    high_m: float
    coefficients: Floats

    def covers(self, lengths_m: Floats) -> NDArray[np.bool_]:
        """Which lengths are in the range, shape (n,)."""
        return np.asarray((self.low_m <= lengths_m) & (lengths_m <= self.high_m))

    def __call__(self, lengths_m: Floats) -> tuple[MassProperties, ...]:
        """The m units for lengths in the range, shape (n,); a row does not depend on the others.

        It is evaluated by Clenshaw's recurrence, in the same order of operations for each length.
        """
        place = (2.0 * lengths_m - (self.low_m + self.high_m)) / (self.high_m - self.low_m)
        values: Floats = np.asarray(chebval(place, self.coefficients), dtype=np.float64)
        return tuple(_unfolded(values[i : i + _WIDTH]) for i in range(0, len(values), _WIDTH))


def tabulate(weigh: Weigh, low_m: float, high_m: float) -> Tabulated:
    """Tabulate units over a range of lengths, with as many nodes as the precision needs.

    Args:
        weigh: the units, part by part.
        low_m: shortest length.
        high_m: longest length.

    Raises:
        ValueError: the units do not change smoothly with the length.
    """
    between = np.linspace(low_m, high_m, 51)
    wanted = _folded(weigh(between))
    scale = _sizes(wanted)
    nodes = 8
    while nodes <= _MOST_NODES:
        table = Tabulated(low_m=low_m, high_m=high_m, coefficients=_series(weigh, low_m, high_m, nodes))
        if np.all(np.abs(_folded(table(between)) - wanted) <= _EXACT * scale):
            return table
        nodes += 4
    raise ValueError(
        f"mass properties over {low_m} to {high_m} m: not smooth in the length to {_EXACT:g} with {_MOST_NODES} nodes; "
        "let no count or choice depend on the length"
    )


def _series(weigh: Weigh, low_m: float, high_m: float, nodes: int) -> Floats:
    """Coefficients of the interpolant in the Chebyshev points of the first kind.

    Summed term by term, because the order of the sum in a matrix product may differ from run to run.
    """
    angles = np.pi * (np.arange(nodes) + 0.5) / nodes
    values = _folded(weigh(0.5 * (low_m + high_m) + 0.5 * (high_m - low_m) * np.cos(angles)))
    waves = np.cos(np.outer(np.arange(nodes), angles))
    result = 2.0 / nodes * reduce(np.add, [np.outer(waves[:, k], values[:, k]) for k in range(nodes)])
    result[0] *= 0.5
    return np.asarray(result, dtype=np.float64)


def _folded(units: Sequence[MassProperties]) -> Floats:
    """The numbers of m units and n lengths, shape (10 m, n)."""
    rows: list[Floats] = []
    for unit in units:
        rows += [unit.mass_kg, *np.moveaxis(unit.first_kg_m, -1, 0), *unit.second_kg_m2[..., _ROWS, _COLUMNS].T]
    return np.stack(np.broadcast_arrays(*rows))


def _sizes(values: Floats) -> Floats:
    """The largest mass, first moment and second moment of each unit, for each of its rows, shape (10 m, 1)."""
    largest = np.abs(values).max(axis=1)
    kinds = [largest[i + j : i + k].max() for i in range(0, len(values), _WIDTH) for j, k in ((0, 1), (1, 4), (4, 10))]
    return np.repeat(kinds, np.tile([1, 3, len(_ROWS)], len(values) // _WIDTH))[:, None]


def _unfolded(values: Floats) -> MassProperties:
    second = np.empty((*values.shape[1:], 3, 3))
    second[..., _ROWS, _COLUMNS] = second[..., _COLUMNS, _ROWS] = values[4:].T
    return MassProperties(mass_kg=values[0], first_kg_m=values[1:4].T, second_kg_m2=second)
