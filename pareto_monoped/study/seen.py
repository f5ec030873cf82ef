"""Designs that have been asked for, so that none is simulated twice."""

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.study.protocol import Floats, Space

TRIES = 100
"""How often an algorithm draws again before it ends for want of new designs; pymoo's own number for its offspring."""


class Seen:
    """A set of designs, compared bit for bit: nearly equal designs are different jumps."""

    def __init__(self) -> None:
        self._rows: set[bytes] = set()

    def add(self, values: Floats) -> None:
        """Add designs, shape (n, d)."""
        self._rows.update(_keys(values))

    def new(self, values: Floats) -> NDArray[np.bool_]:
        """Which of n designs are neither in the set nor equal to one before them, shape (n, d) -> (n,)."""
        fresh = np.zeros(len(values), dtype=bool)
        before: set[bytes] = set()
        for i, key in enumerate(_keys(values)):
            fresh[i] = key not in self._rows and key not in before
            before.add(key)
        return fresh


def drawn(space: Space, seen: Seen, generator: np.random.Generator, count: int) -> Floats:
    """Up to ``count`` new designs, uniform within the bounds, shape (n, d); none if ``TRIES`` draws find none."""
    lower, upper = space.edges
    for _ in range(TRIES):
        values = space.snap(lower + generator.random((count, len(lower))) * (upper - lower))
        if (new := seen.new(values)).any():
            return values[new]
    return values[:0]


def _keys(values: Floats) -> list[bytes]:
    # Adding zero makes -0.0 and 0.0, which are the same value, the same bits.
    return [row.tobytes() for row in np.ascontiguousarray(values, dtype=np.float64) + 0.0]
