"""Designs that have been asked for, so that none is simulated twice. Importing this module imports numba."""

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.compute.compiled import compiled
from pareto_monoped.search.algorithm import Floats, Space

Digests = NDArray[np.uint64]

TRIES = 100
"""How often an algorithm draws again before it ends for want of new designs; pymoo's own number for its offspring."""

_LEAST_PLACES = 1024
"""Places of the smallest table. Our own choice; always a power of two."""
_MIX = (np.uint64(0xFF51AFD7ED558CCD), np.uint64(0xC4CEB9FE1A85EC53))
"""The multipliers of MurmurHash3's 64-bit finaliser (Appleby 2011, public domain)."""
_SHIFT = np.uint64(33)
"""Its shift."""
_FREE = np.uint64(0)
"""What a free place of a table has; no digest is 0."""


class Seen:
    """A set of designs, compared bit for bit: nearly equal designs are different jumps.

    It keeps a digest of 8 bytes per design, in a table that is at most half full, so that a long search needs little
    memory. Two of 200,000 designs have the same digest with a chance of 1e-9; the second of them would not be
    simulated.
    """

    def __init__(self) -> None:
        self._table = np.zeros(_LEAST_PLACES, dtype=np.uint64)
        self._count = 0

    def add(self, values: Floats) -> None:
        """Add designs, shape (n, d)."""
        if 2 * (self._count + len(values)) > len(self._table):
            known, self._table = self._table, _table_for(self._count + len(values))
            _insert(self._table, known[known != _FREE])
        self._count += int(_insert(self._table, _digests(values)).sum())

    def new(self, values: Floats) -> NDArray[np.bool_]:
        """Which of n designs are neither in the set nor equal to one before them, shape (n, d) -> (n,)."""
        digests = _digests(values)
        return ~_contains(self._table, digests) & _insert(_table_for(len(digests)), digests)


def _table_for(count: int) -> Digests:
    """An empty table for so many digests, which is at most half full with them."""
    return np.zeros(max(_LEAST_PLACES, 1 << (2 * count - 1).bit_length()), dtype=np.uint64)


@compiled
def _place(table: Digests, digest: np.uint64) -> np.uint64:
    """Where a digest is in a table with free places, or else the free place for it."""
    last = np.uint64(len(table) - 1)
    place = digest & last
    while table[place] != _FREE and table[place] != digest:
        place = (place + np.uint64(1)) & last
    return place


@compiled
def _insert(table: Digests, digests: Digests) -> NDArray[np.bool_]:
    """Put n digests into a table with free places; which of them were not in it before, shape (n,)."""
    fresh = np.zeros(len(digests), dtype=np.bool_)
    for n in range(len(digests)):
        place = _place(table, digests[n])
        fresh[n] = table[place] == _FREE
        table[place] = digests[n]
    return fresh


@compiled
def _contains(table: Digests, digests: Digests) -> NDArray[np.bool_]:
    """Which of n digests are in a table, shape (n,)."""
    found = np.zeros(len(digests), dtype=np.bool_)
    for n in range(len(digests)):
        found[n] = table[_place(table, digests[n])] != _FREE
    return found


def drawn(space: Space, seen: Seen, generator: np.random.Generator, count: int) -> Floats:
    """Up to ``count`` new designs, uniform within the bounds, shape (n, d); none if ``TRIES`` draws find none."""
    lower, upper = space.edges
    for _ in range(TRIES):
        values = space.snap(lower + generator.random((count, len(lower))) * (upper - lower))
        if (new := seen.new(values)).any():
            return values[new]
    return values[:0]


def _digests(values: Floats) -> Digests:
    """A digest of each of n designs, shape (n, d) -> (n,)."""
    # Adding zero makes -0.0 and 0.0, which are the same value, the same bits.
    return _mixed_rows((np.ascontiguousarray(values, dtype=np.float64) + 0.0).view(np.uint64))


@compiled
def _mixed_rows(words: Digests) -> Digests:
    """A digest of each row, shape (n, d) -> (n,), by a bijection in which every bit depends on every other."""
    digests = np.zeros(words.shape[0], dtype=np.uint64)
    for n in range(words.shape[0]):
        digest = np.uint64(0)
        for d in range(words.shape[1]):
            word = words[n, d]
            for multiplier in _MIX:
                word = (word ^ (word >> _SHIFT)) * multiplier
            digest += word ^ (word >> _SHIFT)
            for multiplier in _MIX:
                digest = (digest ^ (digest >> _SHIFT)) * multiplier
            digest ^= digest >> _SHIFT
        digests[n] = max(digest, np.uint64(1))
    return digests
