"""How a coordinator shares out cores and what it makes of its workers' words: rules that need no process."""

import os
import signal
from concurrent.futures import Future

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pareto_monoped.campaign import coordinator as module
from pareto_monoped.campaign.coordinator import WORTH_S, _Coordinator, _Job
from pareto_monoped.campaign.worker import Advanced, Ended, Noted
from pareto_monoped.compute.crew import LostError
from tests.campaign.test_coordinator import standings


class Stopping:
    """A worker that is told to stop, and remembers what it was given."""

    stopped = killed = shut = 0

    def __init__(self, hear=None):
        self.given = []

    def submit(self, function, *arguments):
        self.given.append(arguments)
        return Future()

    def stop(self):
        self.stopped += 1

    def kill(self):
        self.killed += 1

    def shutdown(self, wait=True):
        self.shut += 1


def ending(result=None, problem=None):
    """What is heard when a study has ended."""
    future = Future()
    if problem is None:
        future.set_result(result)
    else:
        future.set_exception(problem)
    return future


class Recording(_Coordinator):
    """Begins studies with a worker that does nothing."""

    def _begin(self, standing, threads, worker=None):
        standing.threads, standing.state = threads, "running"
        self.jobs.append(_Job(standing=standing, worker=Stopping(), before=0, seat=0))


def coordinator(cores, several, scheduler=None):
    made = Recording(cores, scheduler, lambda _: None, lambda _: None)
    made.waiting.extend(several)
    made.slots = min(cores, len(several))
    return made


@pytest.fixture(scope="module")
def several(tmp_path_factory):
    return standings(tmp_path_factory.mktemp("shares"), "seeds = [1, 2, 3, 4, 5, 6]")


@given(cores=st.integers(1, 20), count=st.integers(1, 6))
def test_all_cores_are_given_and_none_twice(several, cores, count):
    for one in several:
        one.threads = 0
    made = coordinator(cores, several[:count])
    made._fill()
    threads = [job.standing.threads for job in made.jobs]
    assert len(threads) == min(cores, count)
    assert sum(threads) == cores
    assert threads == sorted(threads, reverse=True)
    assert threads[0] - threads[-1] <= 1
    assert list(made.waiting) == several[len(threads) : count]


@pytest.mark.parametrize(("cores", "count"), [(4, 4), (2, 2), (6, 6)])
def test_with_a_scheduler_as_many_studies_run_as_there_are_cores(several, cores, count):
    """The cores are those of its workers; a study's own process hardly has any work."""
    made = coordinator(cores, several, scheduler="tcp://x:1")
    made._fill()
    assert [job.standing.threads for job in made.jobs] == [1] * count


def test_studies_side_by_side_have_seats_of_their_own(several, monkeypatch):
    """So that they give their tasks to different workers of a scheduler; a seat that has become free is taken again."""
    made_workers = []
    monkeypatch.setattr(module, "Processes", lambda hear: made_workers.append(Stopping()) or made_workers[-1])
    made = _Coordinator(3, "tcp://x:1", lambda _: None, lambda _: None)
    made.waiting.extend(several)
    made.slots = 3
    made._fill()
    made._release(made.jobs[1], "finished")
    made._fill()
    assert [arguments[-1] for worker in made_workers for arguments in worker.given] == [0, 1, 2, 1]


@pytest.mark.parametrize(
    ("left_s", "chosen"),
    [
        ((2.0 * WORTH_S, 3.0 * WORTH_S), [0, 1]),  # the one that takes longest
        ((2.0 * WORTH_S, 0.5 * WORTH_S), [1, 0]),
        ((0.5 * WORTH_S, None), [0, 0]),  # not worth it, or not known yet
    ],
)
def test_idle_cores_go_to_one_study_that_still_takes_long(several, left_s, chosen):
    made = coordinator(2, several[:2])
    made._fill()
    for job, seconds in zip(made.jobs, left_s, strict=True):
        job.standing.seconds_left = seconds
    made._widen()
    assert not any(job.worker.stopped for job in made.jobs)  # both have their share
    made.cores = 4
    made._widen()
    made._widen()  # while one stops, no other does
    assert [job.worker.stopped for job in made.jobs] == chosen
    assert [job.again_with for job in made.jobs] == [2 if one else None for one in chosen]


@pytest.mark.parametrize(("scheduler", "waiting"), [("tcp://x:1", 0), (None, 1)])
def test_a_study_does_not_widen_over_a_scheduler_or_while_others_wait(several, scheduler, waiting):
    """A scheduler's workers simulate, whatever the threads are; and cores that have become free are for who waits."""
    made = coordinator(1, several[:1], scheduler)
    made._fill()
    made.cores = 4
    made.jobs[0].standing.seconds_left = 3.0 * WORTH_S
    made.waiting.extend(several[1 : 1 + waiting])
    made._widen()
    assert made.jobs[0].worker.stopped == 0


def ended(**other):
    fields = {"evaluations": 60, "front_size": 4, "hypervolume": 1.0, "remarks": ()}
    return Ended(**fields, **{"stop_reason": "interrupted"} | other)


def test_what_stops_to_widen_goes_on_unless_the_user_has_interrupted_meanwhile(several):
    for interrupted, threads in ((False, [4]), (True, [])):
        made = coordinator(1, several[:1])
        made._fill()
        made.cores = 4
        made.jobs[0].standing.seconds_left = 3.0 * WORTH_S
        made._widen()
        if interrupted:
            made._stop_all()
        made._end(made.jobs[0], ended())
        assert [job.standing.threads for job in made.jobs] == threads
        assert several[0].state == ("unfinished" if interrupted else "running")


def test_trials_of_earlier_sessions_are_not_new(several):
    """The rate of a campaign, and how long it still takes, are of its new trials."""
    made = coordinator(1, several[:1])
    made._fill()
    (job,) = made.jobs
    job.before = 30
    made._hear(job.worker, Advanced(evaluations=50, per_second=1.0, seconds_left=1.0, hypervolume=0.5))
    assert (job.standing.evaluations, job.standing.new_evaluations) == (50, 20)
    made._hear(job.worker, ending(ended(stop_reason="budget")))
    assert (job.standing.evaluations, job.standing.new_evaluations) == (60, 30)


def test_notes_of_a_study_name_it_and_those_of_its_audit_are_left_out(several):
    told = []
    made = Recording(1, None, lambda _: None, told.append)
    made.waiting.append(several[0])
    made._fill()
    (job,) = made.jobs
    gone = Noted(line="worker a has gone")
    job.standing.evaluations = job.standing.budget - 1
    made._hear(job.worker, gone)
    assert told == [f"{several[0].name}: worker a has gone"]
    job.standing.evaluations = job.standing.budget
    made._hear(job.worker, gone)
    assert len(told) == 1


def test_a_worker_whose_study_has_ended_gets_the_next_one_and_a_dead_one_is_buried(several, monkeypatch):
    made_workers = []
    monkeypatch.setattr(module, "Processes", lambda hear: made_workers.append(Stopping()) or made_workers[-1])
    made = _Coordinator(1, None, lambda _: None, lambda _: None)
    made.waiting.extend(several[:2])
    for one in several[:2]:
        one.deaths = 0
    made._fill()
    made._end(made.jobs[0], ended(stop_reason="budget"))
    made._fill()
    assert len(made_workers) == 1
    made._hear(made_workers[0], ending(problem=LostError("its process was ended by SIGKILL")))
    assert made_workers[0].shut == 1
    assert made.idle == []
    made._fill()
    assert len(made_workers) == 2


def test_a_worker_that_does_not_stop_after_an_interrupt_is_killed(several, monkeypatch):
    """A generation that takes minutes does not keep the user waiting."""
    made_workers = []

    class Deaf(Stopping):
        def __init__(self, hear):
            super().__init__()
            made_workers.append(self)

        def submit(self, function, *arguments):
            os.kill(os.getpid(), signal.SIGINT)
            return Future()

    monkeypatch.setattr(module, "Processes", Deaf)
    monkeypatch.setattr(module, "GRACE_S", 0.1)
    several[0].deaths, several[0].evaluations = 0, 0
    told = []
    assert not _Coordinator(1, None, lambda _: None, told.append).run(several[:1])
    assert [(one.stopped, one.killed) for one in made_workers] == [(1, 1)]
    assert (several[0].state, several[0].threads) == ("unfinished", 0)
    assert told == ["interrupted: ending after these generations; press Ctrl-C again to end at once"]


def test_what_befalls_the_workers_of_a_scheduler_is_told_once_and_during_audits_too(several, monkeypatch):
    """Each study said so of the same worker, and none once it had all its trials."""
    told, now_s = [], [100.0]
    monkeypatch.setattr(module.time, "monotonic", lambda: now_s[0])
    made = _Coordinator(2, "tcp://x:1", lambda _: None, told.append)
    auditing = Noted(line="auditing 9 designs of the front")
    gone = Noted(line="worker a has gone", shared=True)
    made.jobs = [_Job(standing=one, worker=Stopping(), before=0, seat=0) for one in several[:2]]
    jobs = [(job.worker, iter((gone, auditing, gone, Noted(line="of this study")))) for job in made.jobs]
    monkeypatch.setattr(made.jobs[0].standing, "evaluations", made.jobs[0].standing.budget)
    monkeypatch.setattr(made.jobs[1].standing, "evaluations", 0)
    for _ in range(2):
        for worker, words in jobs:
            made._hear(worker, next(words))
    assert told == ["worker a has gone", f"{several[1].name}: auditing 9 designs of the front"]
    told.clear()
    now_s[0] += 100.0
    for _ in range(2):
        for worker, words in jobs:
            made._hear(worker, next(words))
    assert told == ["worker a has gone", f"{several[1].name}: of this study"]
