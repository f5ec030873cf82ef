"""The set of designs that were asked for, against Python's own set."""

import tracemalloc

import numpy as np
import pytest

from pareto_monoped.study import seen as module
from pareto_monoped.study.seen import Seen


def slow(before, values):
    """Which rows are new, by sets of tuples of bits."""
    known = {row.tobytes() for row in before + 0.0}
    fresh = []
    for row in values + 0.0:
        fresh.append(row.tobytes() not in known)
        known.add(row.tobytes())
    return fresh


@pytest.mark.parametrize("most_recent", [0, 70, 4096])
def test_as_a_set_of_rows(monkeypatch, most_recent):
    """Drawn from few values, so that many are equal; added in parts, old and recent."""
    monkeypatch.setattr(module, "_MOST_RECENT", most_recent)
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


def test_a_long_search_needs_little_memory():
    """Eight bytes per design, and what the recent ones take."""
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
    assert grown < 100_000 * 8 + 1_000_000  # a set of the rows' bytes takes 17 MB
