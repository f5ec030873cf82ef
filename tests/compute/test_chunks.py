"""Work cut into chunks: whatever the cuts and the order of the answers, every row counts once and in its place."""

import gc
import threading
import time
import weakref
from concurrent.futures import Executor, Future, ThreadPoolExecutor
from contextlib import closing

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pareto_monoped.compute.chunks import LEAST_TASK_S, Pace, in_turn, pace_of, spread


class Backwards(Executor):
    """Does nothing until somebody waits, then everything from the last task to the first."""

    def __init__(self):
        self.tasks = []

    def submit(self, function, *arguments):
        future = Waited(self)
        self.tasks.append((future, function, arguments))
        return future


class Waited(Future):
    def __init__(self, executor):
        super().__init__()
        self.executor = executor

    def result(self, timeout=None):
        while self.executor.tasks:
            future, function, arguments = self.executor.tasks.pop()
            future.set_result(function(*arguments))
        return super().result(timeout)


class Cut(Pace):
    """Cuts where it is told, a few rows further at a time."""

    def __init__(self, places, at_once):
        super().__init__()
        self.places, self.at_once = places, at_once

    def cuts(self, start, stop):
        inner = [place for place in self.places if start < place < stop]
        return [start, *inner, stop][: self.at_once + 1]


def double(values):
    return 2.0 * values


@given(count=st.integers(1, 60), places=st.sets(st.integers(1, 60)), at_once=st.integers(1, 9))
def test_any_cuts_give_every_row_once_and_in_order(count, places, at_once):
    values = np.arange(float(count))
    cut = Cut(sorted(places), at_once)
    results = spread(Backwards(), cut, count, double, lambda rows: [values[rows]])
    np.testing.assert_array_equal(np.concatenate(results), 2.0 * values)


@given(
    seconds=st.floats(1e-6, 3.0),
    rows=st.integers(1, 500),
    start=st.integers(0, 1000),
    count=st.integers(1, 20000),
)
def test_tasks_take_long_enough_unless_there_is_too_little_work(seconds, rows, start, count):
    pace = Pace()
    pace.note(rows, seconds * rows)
    cuts = pace.cuts(start, start + count)
    assert cuts[0] == start
    assert cuts[-1] == start + count
    lengths = np.diff(cuts)
    assert (lengths > 0).all()
    # A chunk may be a row shorter than the others.
    assert len(lengths) == 1 or (lengths.min() + 1) * seconds >= LEAST_TASK_S
    # Nor much longer than needed, so that all workers have something to do.
    assert lengths.max() * seconds <= 2.0 * LEAST_TASK_S + 2.0 * seconds


def test_the_first_task_is_small_and_shows_the_pace():
    values, sizes = np.arange(1000.0), []

    def slow(part):
        sizes.append(len(part))
        return part

    pace = Pace()
    pace.cuts(0, 1000)
    with ThreadPoolExecutor(1) as pool:
        spread(pool, pace, 1000, slow, lambda rows: [values[rows]])
    assert sizes[0] == 64
    assert sum(sizes) == 1000


class Noting(Pace):
    def __init__(self):
        super().__init__()
        self.noted = []

    def note(self, rows, seconds):
        self.noted.append((rows, seconds))
        super().note(rows, seconds)


def test_the_pace_is_told_how_many_rows_took_how_long():
    def slow(first, count):
        time.sleep(0.001 * count)
        return first

    pace, began_s = Noting(), time.perf_counter()
    with ThreadPoolExecutor(1) as pool:
        spread(pool, pace, 500, slow, lambda rows: (rows.start, rows.stop - rows.start))
    taken_s = time.perf_counter() - began_s
    assert sum(rows for rows, _ in pace.noted) == 500
    assert all(seconds >= 0.001 * rows for rows, seconds in pace.noted)
    assert sum(seconds for _, seconds in pace.noted) <= taken_s


def test_one_slow_task_does_not_decide_and_old_ones_are_forgotten():
    def cuts(*row_seconds):
        pace = Pace()
        for seconds in row_seconds:
            pace.note(10, 10 * seconds)
        return pace.cuts(0, 10_000)

    usual = cuts(0.001)
    assert len(usual) == 41
    assert cuts(*[0.001] * 4, 9.0, *[0.001] * 4) == usual
    assert cuts(*[0.001] * 8, 9.0) == usual
    assert cuts(*[9.0] * 50, *[0.001] * 9) == usual


def test_no_executor_is_kept_for_its_pace():
    pool = ThreadPoolExecutor(1)
    pace_of(pool, double, "a")
    pool.shutdown()
    kept = weakref.ref(pool)
    del pool
    gc.collect()
    assert kept() is None


def test_the_pace_of_some_work_is_remembered_by_executor_and_by_work():
    with ThreadPoolExecutor(1) as one, ThreadPoolExecutor(1) as other:
        assert pace_of(one, double, "a") is pace_of(one, double, "a")
        assert pace_of(one, double, "a") is not pace_of(one, double, "b")
        assert pace_of(one, double, "a") is not pace_of(other, double, "a")


def test_a_failure_is_raised_and_calls_off_what_has_not_begun():
    done = []

    def work(number):
        done.append(number)
        if number == 1:
            raise ValueError("one")
        time.sleep(0.01)
        return number

    with ThreadPoolExecutor(1) as pool, pytest.raises(ValueError, match="one"):
        spread(pool, Cut(range(1, 200), 200), 200, work, lambda rows: [rows.start])
    assert len(done) < 200


@pytest.mark.parametrize("at_once", [1, 2, 5, 40])
def test_pieces_in_turn_come_in_their_order(at_once):
    """Whatever piece is done first."""
    begun = []

    def work(piece):
        begun.append(piece)
        time.sleep(0.02 if piece % 5 == 0 else 0.0)
        return 2 * piece

    for k, result in enumerate(in_turn(work, range(20), at_once)):
        assert result == 2 * k
        assert len(begun) <= k + 1 + at_once


def test_pieces_in_turn_wait_for_each_other_no_more_than_they_must():
    """Three pieces, each of which ends only when all are under way."""
    together = threading.Barrier(3)
    assert list(in_turn(lambda _: together.wait(timeout=30.0) >= 0, range(9), 3)) == [True] * 9


def test_pieces_in_turn_that_are_left_do_not_begin():
    begun, ended, go_on = [], [], threading.Event()

    def work(piece):
        begun.append(piece)
        if piece == 0:
            raise ValueError("the first piece")
        go_on.wait(timeout=10.0)
        ended.append(piece)

    with closing(in_turn(work, iter(range(100)), 2)) as results, pytest.raises(ValueError, match="the first piece"):
        next(results)
    assert ended == []  # nobody has waited for the second piece
    go_on.set()
    time.sleep(0.2)
    assert set(begun) <= {0, 1}
