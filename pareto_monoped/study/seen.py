"""Designs that have been asked for, so that none is simulated twice."""

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.study.protocol import Floats, Space

TRIES = 100
"""How often an algorithm draws again before it ends for want of new designs; pymoo's own number for its offspring."""


_MOST_RECENT = 4096
"""Designs kept in a Python set before they join the sorted array: our own choice; a set takes 20 times the memory, and
sorting the array after every generation would take time."""
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
        self._old = np.zeros(0, dtype=np.uint64)
        self._recent: set[int] = set()

    def add(self, values: Floats) -> None:
        """Add designs, shape (n, d)."""
        self._recent.update(_digests(values).tolist())
        if len(self._recent) > _MOST_RECENT:
            recent = np.sort(np.array(list(self._recent), dtype=np.uint64))
            recent = recent[~self._is_old(recent)]
            self._old = np.insert(self._old, np.searchsorted(self._old, recent), recent)
            self._recent = set()

    def new(self, values: Floats) -> NDArray[np.bool_]:
        """Which of n designs are neither in the set nor equal to one before them, shape (n, d) -> (n,)."""
        digests = _digests(values)
        fresh: list[bool] = []
        before: set[int] = set()
        for digest, old in zip(digests.tolist(), self._is_old(digests).tolist(), strict=True):
            fresh.append(not (old or digest in before or digest in self._recent))
            before.add(digest)
        return np.array(fresh, dtype=bool)

    def _is_old(self, digests: NDArray[np.uint64]) -> NDArray[np.bool_]:
        if len(self._old) == 0:
            return np.zeros(len(digests), dtype=bool)
        places = np.minimum(np.searchsorted(self._old, digests), len(self._old) - 1)
        return np.asarray(self._old[places] == digests)


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
