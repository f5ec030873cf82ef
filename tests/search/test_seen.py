"""The set of designs that were asked for, against Python's own set."""

import tracemalloc

import numpy as np

from pareto_monoped.search import seen as module
from pareto_monoped.search.seen import Seen


def slow(before, values):
    """Which rows are new, by sets of tuples of bits."""
    known = {row.tobytes() for row in before + 0.0}
    fresh = []
    for row in values + 0.0:
        fresh.append(row.tobytes() not in known)
        known.add(row.tobytes())
    return fresh


def test_as_a_set_of_rows():
    """Drawn from few values, so that many are equal; added in parts."""
    generator, seen, added = np.random.default_rng(1), Seen(), np.zeros((0, 3))
    for _ in range(20):
        part = generator.integers(-3, 4, (30, 3)) / 2.0
        assert seen.new(part).tolist() == slow(added, part)
        seen.add(part)
        added = np.vstack((added, part))


def test_neighbours_are_different_and_both_zeros_are_one():
    seen = Seen()
    seen.add(np.array([[0.1, 0.0, 4.0]]))
    values = [[0.1, -0.0, 4.0], [np.nextafter(0.1, 1.0), 0.0, 4.0], [0.0, 0.1, 4.0], [0.1, 0.0, 4.0000000000000009]]
    assert seen.new(np.array(values)).tolist() == [False, True, True, True]


def test_designs_on_a_grid_have_different_digests():
    """Values with few bits set, and rows that are permutations of each other, which simple sums would confuse."""
    axis = np.arange(64) / 4.0
    grid = np.stack(np.meshgrid(axis, axis, axis, indexing="ij"), axis=-1).reshape(-1, 3)
    assert len(np.unique(module._digests(grid))) == len(grid) == 64**3


def test_a_digest_is_that_of_the_finaliser():
    """Against Python's whole numbers; the digest of zeros alone is 0."""

    def mixed(word):
        for multiplier in (0xFF51AFD7ED558CCD, 0xC4CEB9FE1A85EC53):
            word = ((word ^ (word >> 33)) * multiplier) % 2**64
        return word ^ (word >> 33)

    values = np.vstack((np.zeros((1, 3)), np.random.default_rng(3).standard_normal((20, 3))))
    for row, digest in zip(values, module._digests(values).tolist(), strict=True):
        expected = 0
        for word in row.view(np.uint64).tolist():
            expected = mixed((expected + mixed(word)) % 2**64)
        assert digest == expected
    seen = Seen()
    assert seen.new(values[[0, 0, 1]]).tolist() == [True, False, True]


def test_a_long_search_needs_little_memory():
    """Eight bytes per design, and at most as many again while some are added."""
    generator = np.random.default_rng(2)
    tracemalloc.start()
    try:
        seen = Seen()
        before = tracemalloc.get_traced_memory()[0]
        for _ in range(200):
            seen.add(generator.random((500, 10)))
        grown = tracemalloc.get_traced_memory()[0] - before
    finally:
        tracemalloc.stop()
    assert grown < 100_000 * 32  # a set of the rows' bytes takes 17 MB
