"""How a coordinator shares out cores: rules that need no process."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pareto_monoped.campaign.coordinator import WORTH_S, _Coordinator, _Job
from tests.campaign.test_coordinator import standings


class Stopping:
    """A worker that is told to stop."""

    stopped = 0

    def stop(self):
        self.stopped += 1


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
    told = []

    class Listening(Stopping):
        def begin(self, task):
            told.append(task.seat)

    monkeypatch.setattr("pareto_monoped.campaign.coordinator.WorkerProcess", Listening)
    made = _Coordinator(3, "tcp://x:1", lambda _: None, lambda _: None)
    made.waiting.extend(several)
    made.slots = 3
    made._fill()
    made._release(made.jobs[1], "finished")
    made._fill()
    assert told == [0, 1, 2, 1]


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
