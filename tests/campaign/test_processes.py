"""A worker process between two studies."""

import os
import signal

import pytest

from pareto_monoped.campaign import processes
from pareto_monoped.campaign.processes import WorkerProcess, dismiss, speakers
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


def test_ctrl_c_is_for_the_coordinator_which_still_hears_it(idle):
    """The terminal sends it to all processes at once."""
    for number in (signal.SIGINT, signal.SIGHUP):
        os.kill(idle.process_id, number)
    assert list(speakers([idle], 0.5)) == []
    assert idle._process.exitcode is None
    assert not signal.pthread_sigmask(signal.SIG_BLOCK, ()) & {signal.SIGINT, signal.SIGHUP}


def test_it_is_heard_when_it_dies_without_having_read_what_was_said_to_it(idle):
    """The system then says that the connection was reset rather than that it ended."""
    os.kill(idle.process_id, signal.SIGSTOP)
    os.waitpid(idle.process_id, os.WUNTRACED)  # until it has stopped
    idle.stop()
    idle._process.kill()
    assert list(speakers([idle], 60.0)) == [idle]
    assert idle.said() is None


def test_what_is_said_to_one_that_has_died_is_no_error(idle, tmp_path):
    """It is found out when it is listened to."""
    idle._process.kill()
    idle._process.join()
    (one,) = standings(tmp_path, "seeds = [1]", SMALL)
    idle.begin(Task(study=one.place.study, db=one.place.db, threads=1))
    idle.stop()
    assert idle.said() is None
    dismiss([idle])


def test_one_that_is_dismissed_ends_by_itself_and_leaves_no_connection(idle, monkeypatch):
    monkeypatch.setattr(processes, "GRACE_S", 60.0)
    dismiss([idle])
    assert idle._process.exitcode == 0
    assert idle.connection.closed


def test_one_that_is_dismissed_and_hangs_is_killed(idle, monkeypatch):
    monkeypatch.setattr(processes, "GRACE_S", 0.2)
    os.kill(idle.process_id, signal.SIGSTOP)
    dismiss([idle])
    assert idle._process.exitcode == -signal.SIGKILL
