"""Designs that have been asked for, so that none is simulated twice."""

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.study.protocol import Floats, Space

Digests = NDArray[np.uint64]

TRIES = 100
"""How often an algorithm draws again before it ends for want of new designs; pymoo's own number for its offspring."""


_MOST_RECENT = 4096
"""Designs in an array of their own before they join the large one, which takes time to copy. Our own choice."""
_MIX = (np.uint64(0xFF51AFD7ED558CCD), np.uint64(0xC4CEB9FE1A85EC53))
"""The multipliers of MurmurHash3's 64-bit finaliser (Appleby 2011, public domain)."""
_SHIFT = np.uint64(33)
"""Its shift."""


class Seen:
    """A set of designs, compared bit for bit: nearly equal designs are different jumps.

    It keeps a digest of 8 bytes per design, so that a long search needs little memory. Two of 200,000 designs have the
    same digest with a chance of 1e-9; the second of them would not be simulated.
    """

    def __init__(self) -> None:
        self._old = self._recent = np.zeros(0, dtype=np.uint64)

    def add(self, values: Floats) -> None:
        """Add designs, shape (n, d)."""
        self._recent = _union(self._recent, np.unique(_digests(values)))
        if len(self._recent) > _MOST_RECENT:
            self._old, self._recent = _union(self._old, self._recent), self._recent[:0]

    def new(self, values: Floats) -> NDArray[np.bool_]:
        """Which of n designs are neither in the set nor equal to one before them, shape (n, d) -> (n,)."""
        digests, first = np.unique(_digests(values), return_index=True)
        fresh = np.zeros(len(values), dtype=bool)
        fresh[first] = ~(_among(self._old, digests) | _among(self._recent, digests))
        return fresh


def _union(digests: Digests, others: Digests) -> Digests:
    """All of two ascending arrays, ascending and each once."""
    others = others[~_among(digests, others)]
    return np.insert(digests, np.searchsorted(digests, others), others)


def _among(digests: Digests, others: Digests) -> NDArray[np.bool_]:
    """Which of n ``others`` are in an ascending array, shape (n,)."""
    if len(digests) == 0:
        return np.zeros(len(others), dtype=bool)
    places = np.minimum(np.searchsorted(digests, others), len(digests) - 1)
    return np.asarray(digests[places] == others)


def drawn(space: Space, seen: Seen, generator: np.random.Generator, count: int) -> Floats:
    """Up to ``count`` new designs, uniform within the bounds, shape (n, d); none if ``TRIES`` draws find none."""
    lower, upper = space.edges
    for _ in range(TRIES):
        values = space.snap(lower + generator.random((count, len(lower))) * (upper - lower))
        if (new := seen.new(values)).any():
            return values[new]
    return values[:0]


def _digests(values: Floats) -> NDArray[np.uint64]:
    """A digest of each of n designs, shape (n, d) -> (n,)."""
    # Adding zero makes -0.0 and 0.0, which are the same value, the same bits.
    words = (np.ascontiguousarray(values, dtype=np.float64) + 0.0).view(np.uint64)
    digests = np.zeros(len(words), dtype=np.uint64)
    for column in words.T:
        digests = _mixed(digests + _mixed(column))
    return digests


def _mixed(words: NDArray[np.uint64]) -> NDArray[np.uint64]:
    """A bijection of 64-bit words in which every bit depends on every other."""
    for multiplier in _MIX:
        words = (words ^ (words >> _SHIFT)) * multiplier
    return words ^ (words >> _SHIFT)
