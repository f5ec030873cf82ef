"""Rules of a crew that real programs show only now and then: here its workers do what the test tells them."""

import threading
import time
from concurrent.futures import CancelledError
from contextlib import contextmanager

import pytest

from pareto_monoped.compute.crew import Crew, Limits
from pareto_monoped.errors import WorkerError
from tests.compute.dask_here import until
from tests.compute.staff_here import StaffHere, Worker


def hello(threads):
    return threads


def plain():
    return "plain"


def slow():
    return "slow"


@pytest.fixture(autouse=True)
def quick(monkeypatch):
    """Nobody waits here for a real program: the crew looks at the clock more often."""
    monkeypatch.setattr("pareto_monoped.compute.crew._TICK_S", 0.02)


@pytest.fixture
def impatient(monkeypatch):
    """The user hears sooner that nobody is there."""
    monkeypatch.setattr("pareto_monoped.compute.crew._PATIENT_S", 0.2)


@contextmanager
def crew(staff, *, check=lambda _: None, **limits):
    told = []
    made = Crew(staff, greeting=hello, check=check, tell=told.append, limits=Limits(**limits))
    try:
        yield made, told
    finally:
        made.shutdown()


def test_a_worker_is_greeted_with_its_threads():
    heard = []
    with crew(StaffHere({"one": Worker()}), check=heard.append) as (made, _):
        assert made.submit(plain).result(timeout=30) == "plain"
    assert heard == [3]


def test_crews_with_different_seats_prefer_different_workers():
    """All crews of a campaign gave their tasks to the first worker, and the others had nothing to do."""
    given = []
    for seat in range(4):
        workers = {name: Worker(later=(slow,)) for name in ("two", "one", "three")}
        made = Crew(StaffHere(workers), greeting=hello, check=lambda _: None, seat=seat)
        until(lambda here=workers: all(worker.given for worker in here.values()))
        tasks = [made.submit(slow) for _ in range(3)]
        until(lambda here=workers: sum(len(worker.kept) for worker in here.values()) == 3)
        assert [len(worker.kept) for worker in workers.values()] == [1, 1, 1]
        for worker in workers.values():
            worker.tell()
        [task.result(timeout=30) for task in tasks]
        last = made.submit(slow)
        until(lambda here=workers: any(worker.kept for worker in here.values()))
        given += [name for name, worker in workers.items() if worker.kept]
        for worker in workers.values():
            worker.tell()
        assert last.result(timeout=30) == "slow"
        made.shutdown()
    assert given == ["one", "three", "two", "one"]


def test_a_worker_with_more_threads_is_preferred_by_more_seats():
    given = []
    for seat in range(5):
        workers = {"a": Worker(later=(slow,)), "b": Worker(later=(slow,), slots=3)}
        made = Crew(StaffHere(workers), greeting=hello, check=lambda _: None, seat=seat)
        until(lambda here=workers: all(worker.given for worker in here.values()))
        until(lambda here=made: len(here._able()) == 2)
        first = made.submit(slow)
        until(lambda here=workers: any(worker.kept for worker in here.values()))
        given += [name for name, worker in workers.items() if worker.kept]
        for worker in workers.values():
            worker.tell()
        assert first.result(timeout=30) == "slow"
        made.shutdown()
    assert given == ["a", "b", "b", "b", "a"]


@pytest.mark.parametrize(
    ("count", "words"),
    [pytest.param(1, "its only worker does not answer", marks=pytest.mark.long), (2, "none of its 2 workers ans")],
)
def test_workers_that_all_hang_are_not_said_to_be_absent(impatient, count, words):
    """It was "has no worker; start scheduler and workers"."""
    workers = {str(number): Worker(later=(slow,)) for number in range(count)}
    with crew(StaffHere(workers), task_s=0.2, times=0.0, absent_s=0.6) as (made, told):
        problem = made.submit(slow).exception(timeout=60)
    assert isinstance(problem, WorkerError)
    assert str(problem).startswith(f"staff here: {words}")
    assert str(problem).endswith("end what hangs and start it again, then give the same command again")
    assert words in told[-1]


def test_a_worker_whose_greeting_fails_is_refused():
    def unknown(threads):
        raise AttributeError("no such module")

    made = Crew(StaffHere({"one": Worker()}), greeting=unknown, check=lambda _: None)
    problem = made.submit(plain).exception(timeout=30)
    made.shutdown()
    assert isinstance(problem, WorkerError)
    assert "none of its 1 workers may be used (AttributeError: no such module)" in str(problem)


def test_a_worker_whose_answer_cannot_be_read_is_refused():
    """Facts of another version may lack a field; the worker was neither accepted nor refused then, for ever."""

    def check(answer):
        raise AttributeError("Facts has no numbers")

    with crew(StaffHere({"one": Worker()}), check=check) as (made, told):
        problem = made.submit(plain).exception(timeout=30)
    assert "none of its 1 workers may be used (AttributeError: Facts has no numbers)" in str(problem)
    assert told == ["one is refused: AttributeError: Facts has no numbers"]


def test_a_refused_worker_that_leaves_and_comes_again_is_asked_again():
    staff = StaffHere({"one": Worker(), "two": Worker()})
    answers = iter([None, "wrong", None])
    with crew(staff, check=lambda _: next(answers)) as (made, told):
        until(lambda: told, 30)
        assert told == ["two is refused: wrong"]
        two = staff.workers.pop("two")
        until(lambda: not made._refused, 30)
        staff.workers["two"] = two
        until(lambda: len(made._able()) == 2, 30)
    assert two.given == [hello, hello]


def test_a_task_that_is_cancelled_while_it_waits_is_never_done():
    worker = Worker(later=(slow,))
    with crew(StaffHere({"one": worker})) as (made, _):
        first = [made.submit(slow) for _ in range(2)]
        until(lambda: len(worker.given) == 3, 30)
        waiting = made.submit(plain)
        assert waiting.cancel()
        last = made.submit(slow)
        until(lambda: not made._news.qsize(), 30)
        worker.tell()
        until(lambda: len(worker.given) == 4, 30)
        worker.tell()
        assert [future.result(timeout=30) for future in (*first, last)] == ["slow"] * 3
    assert plain not in worker.given


def test_two_answers_to_a_task_are_one_result():
    """A late task is given to a second worker; both answer in the end."""
    workers = {"one": Worker(later=(slow,)), "two": Worker(later=(slow,))}
    with crew(StaffHere(workers)) as (made, told):
        late = made.submit(slow)
        until(lambda: all(worker.kept for worker in workers.values()), 30)
        workers["one"].tell()
        assert late.result(timeout=30) == "slow"
        # The crew fails what is open if the second answer upsets it.
        others = [made.submit(slow) for _ in range(4)]
        until(lambda: len(workers["one"].kept) == 2, 30)
        workers["two"].tell()
        assert made.submit(plain).result(timeout=30) == "plain"
        while not all(other.done() for other in others):
            for worker in workers.values():
                worker.tell()
        assert [other.result() for other in others] == ["slow"] * 4
    assert told == []


@pytest.mark.long
def test_a_late_task_is_given_to_one_more_worker_only():
    workers = {name: Worker(later=(slow,)) for name in ("one", "two", "three")}
    with crew(StaffHere(workers)) as (made, _):
        late = made.submit(slow)
        until(lambda: sum(bool(worker.kept) for worker in workers.values()) == 2, 30)
        time.sleep(1.2)  # longer than the second before a task is late
        assert sum(len(worker.kept) for worker in workers.values()) == 2
        for worker in workers.values():
            worker.tell()
        assert late.result(timeout=30) == "slow"


def test_each_task_goes_to_who_has_least_to_do():
    workers = {name: Worker(later=(slow,)) for name in ("one", "two", "three")}
    with crew(StaffHere(workers)) as (made, _):
        until(lambda: len(made._able()) == 3, 30)
        for count in (1, 2):
            for _ in workers:
                made.submit(slow)
            until(lambda wanted=3 * count: sum(len(worker.kept) for worker in workers.values()) == wanted, 30)
            assert [len(worker.kept) for worker in workers.values()] == [count] * 3


def test_a_worker_with_more_slots_has_more_tasks_at_a_time():
    worker = Worker(later=(slow,))
    with crew(StaffHere({"one": worker}, slots=3)) as (made, _):
        tasks = [made.submit(slow) for _ in range(9)]
        until(lambda: len(worker.kept) == 4, 30)
        time.sleep(0.3)
        assert len(worker.kept) == 4  # three at work, and the next is already there
        while not all(task.done() for task in tasks):
            worker.tell()


def test_only_tasks_that_had_begun_are_blamed_for_a_lost_worker():
    """The task behind one that ends its worker three times may still lose one itself."""
    worker = Worker(later=(slow, plain))
    with crew(StaffHere({"one": worker}, replaces=True)) as (made, told):
        tasks = [made.submit(slow), made.submit(plain)]
        for _ in range(3):
            until(lambda: len(worker.kept) == 2, 30)
            worker.lose()
        until(lambda: len(worker.kept) == 2, 30)
        worker.tell(1)
        assert tasks[0].result(timeout=30) == "slow"
        worker.lose()
        until(lambda: worker.kept, 30)
        worker.tell()
        assert tasks[1].result(timeout=30) == "plain"
    assert told == ["one was lost; its work goes elsewhere"] * 4


def test_a_replaced_worker_that_answered_once_is_not_stillborn(monkeypatch):
    """Six processes ended before their first answer, but never one after the other."""
    number = [0]

    class Frail(Worker):
        def submit(self, function, *arguments):
            number[0] += 1
            self.lost = (hello,) if number[0] % 3 == 1 else (plain,) if number[0] < 24 else ()
            return super().submit(function, *arguments)

    monkeypatch.setattr("pareto_monoped.compute.crew._MOST_LOSSES", 99)
    with crew(StaffHere({"one": Frail()}, replaces=True)) as (made, _):
        assert made.submit(plain).result(timeout=30) == "plain"


def test_workers_that_end_before_they_did_anything_are_given_up():
    with crew(StaffHere({"one": Worker(lost=(hello,))}, replaces=True)) as (made, told):
        problem = made.submit(plain).exception(timeout=30)
    assert isinstance(problem, WorkerError)
    assert str(problem) == "staff here: 6 ended before they did anything; call others"
    assert told == []


def test_nobody_comes(impatient):
    with crew(StaffHere({}), absent_s=1.0) as (made, told):
        problem = made.submit(plain).exception(timeout=30)
    assert str(problem) == "staff here: nobody came, for 1 s; call others"
    assert told == ["staff here: nobody came; waiting up to 1 s"]


def test_a_staff_that_cannot_replace_a_worker_fails_the_tasks_rather_than_the_crew():
    """The thread of the crew ended without a word, and whoever waited for a task waited for ever."""

    def dismiss(name):
        raise OSError("no more processes")

    staff = StaffHere({"one": Worker(lost=(slow,))}, replaces=True, dismiss=dismiss)
    with crew(staff) as (made, _):
        with pytest.raises(OSError, match="no more processes"):
            made.submit(slow).result(timeout=30)
        assert made.submit(plain).result(timeout=30) == "plain"


def test_a_line_that_cannot_be_told_fails_the_tasks_rather_than_the_crew():
    lines = []

    def tell(line):
        lines.append(line)
        raise OSError("no terminal")

    made = Crew(
        StaffHere({"one": Worker(lost=(slow,))}, replaces=True), greeting=hello, check=lambda _: None, tell=tell
    )
    with pytest.raises(OSError, match="no terminal"):
        made.submit(slow).result(timeout=30)
    assert made.submit(plain).result(timeout=30) == "plain"
    made.shutdown()
    assert lines == ["one was lost; its work goes elsewhere"]


def test_a_task_that_comes_just_before_the_end_is_called_off():
    """It was still in the queue of the crew's thread, and nobody answered it any more."""
    asked, go = threading.Event(), threading.Event()

    def check(_):
        asked.set()
        go.wait(30)

    staff = StaffHere({"one": Worker(later=(slow,))})
    made = Crew(staff, greeting=hello, check=check)
    assert asked.wait(30)
    task = made.submit(slow)
    ending = threading.Thread(target=made.shutdown)
    ending.start()
    until(lambda: made._closed, 30)
    with pytest.raises(RuntimeError, match="shutdown"):
        made.submit(plain)
    go.set()
    ending.join(30)
    with pytest.raises(CancelledError):
        task.result(timeout=5)
    assert staff.closed


def test_a_first_task_may_take_longer_than_later_ones():
    worker = Worker(later=(hello,))
    with crew(StaffHere({"one": worker}), task_s=0.1) as (made, told):
        task = made.submit(plain)
        until(lambda: worker.kept, 30)
        time.sleep(0.4)
        worker.tell()
        assert task.result(timeout=30) == "plain"
    assert told == []


def test_a_task_may_take_a_multiple_of_the_longest_so_far():
    worker = Worker(later=(slow,))
    with crew(StaffHere({"one": worker}), task_s=0.5, times=1e3) as (made, told):
        first = made.submit(slow)
        until(lambda: worker.kept, 30)
        time.sleep(0.1)
        worker.tell()
        first.result(timeout=30)
        second = made.submit(slow)
        time.sleep(0.9)
        assert told == []
        worker.tell()
        assert second.result(timeout=30) == "slow"
        worker.later = ()


def test_a_worker_that_hangs_is_left_out_until_it_answers_again():
    workers = {"one": Worker(later=(slow,))}
    staff = StaffHere(workers)
    with crew(staff, task_s=1.0, times=1.0) as (made, told):
        task = made.submit(slow)
        until(lambda: told, 30)
        assert told == ["one has not answered for 1 s; its work goes elsewhere"]
        next_one = made.submit(plain)
        time.sleep(0.5)
        assert plain not in workers["one"].given
        staff.workers = {**workers, "two": Worker()}
        assert (task.result(timeout=30), next_one.result(timeout=30)) == ("slow", "plain")
        workers["one"].tell()
        until(lambda: len(told) == 2, 30)
        assert told[1] == "one answers again"
        until(lambda: len(made._able()) == 2, 30)
