"""Remember the designs that have been asked for, so that none is simulated twice; draw new ones at random."""

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.search.algorithm import Floats, Space

Digests = NDArray[np.uint64]

TRIES = 100
"""How often an algorithm draws again before it ends for want of new designs; pymoo's own number for its offspring."""

_MIX = (np.uint64(0xFF51AFD7ED558CCD), np.uint64(0xC4CEB9FE1A85EC53))
"""The multipliers of MurmurHash3's 64-bit finaliser (Appleby 2011, public domain)."""
_SHIFT = np.uint64(33)
"""Its shift."""


class Seen:
    """A set of designs, compared bit for bit: nearly equal designs are different jumps.

    It keeps a sorted digest of 8 bytes per design. Two of 200,000 designs have the same one with a chance of 1e-9; the
    second would not be simulated.
    """

    def __init__(self) -> None:
        self._known: Digests = np.zeros(0, dtype=np.uint64)

    def add(self, values: Floats) -> None:
        """Add designs, shape (n, d)."""
        digests = np.unique(_digests(values)[self.new(values)])
        self._known = np.insert(self._known, np.searchsorted(self._known, digests), digests)

    def new(self, values: Floats) -> NDArray[np.bool_]:
        """Find which of n designs are neither in the set nor equal to one before them, shape (n, d) -> (n,)."""
        digests = _digests(values)
        fresh = np.zeros(len(digests), dtype=np.bool_)
        fresh[np.unique(digests, return_index=True)[1]] = True
        before, after = (np.searchsorted(self._known, digests, side=side) for side in ("left", "right"))
        return np.asarray(fresh & (before == after))


def drawn(space: Space, seen: Seen, generator: np.random.Generator, count: int) -> Floats:
    """Draw up to ``count`` new designs, uniform within the bounds, shape (n, d); none if ``TRIES`` draws find none."""
    lower, upper = space.edges
    for _ in range(TRIES):
        values = space.snap(lower + generator.random((count, len(lower))) * (upper - lower))
        if (new := seen.new(values)).any():
            return values[new]
    return values[:0]


def _digests(values: Floats) -> Digests:
    """Compute a digest of each of n designs, shape (n, d) -> (n,), in which every bit depends on every other."""
    # Adding zero makes -0.0 and 0.0, which are the same value, the same bits.
    words = (np.ascontiguousarray(values, dtype=np.float64) + 0.0).view(np.uint64)
    digests = np.zeros(len(words), dtype=np.uint64)
    for column in words.T:
        digests = _mixed(digests + _mixed(column))
    return digests


def _mixed(words: Digests) -> Digests:
    """Mix the bits of n words by a bijection."""
    for multiplier in _MIX:
        words = (words ^ (words >> _SHIFT)) * multiplier
    return words ^ (words >> _SHIFT)
