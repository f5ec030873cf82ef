"""A worker process between two studies."""

import pytest

from pareto_monoped.campaign.processes import WorkerProcess, speakers
from pareto_monoped.campaign.worker import Failed, Task
from tests.campaign.test_coordinator import SMALL, standings


@pytest.fixture
def idle(tmp_path):
    """A worker that has had a study, which could not be run, and waits for another."""
    (one,) = standings(tmp_path, 'motors = ["Nope.toml"]', SMALL)
    worker = WorkerProcess()
    worker.begin(Task(study=one.place.study, db=one.place.db, threads=1))
    assert list(speakers([worker], 120.0)) == [worker]
    assert isinstance(worker.said(), Failed)
    yield worker
    worker.kill()


def test_it_ends_by_itself_when_its_connection_is_closed(idle):
    assert list(speakers([idle], 0.5)) == []
    assert idle._process.exitcode is None
    idle.connection.close()
    idle._process.join(60.0)
    assert idle._process.exitcode == 1


def test_it_is_heard_when_it_dies(idle):
    idle._process.kill()
    assert list(speakers([idle], 60.0)) == [idle]
    assert idle.said() is None
    assert idle.death() == "its process was ended by SIGKILL"
