"""Worker processes: every task is done once, the first failure is raised, leaving early ends them at once."""

import os
import signal
import time
from pathlib import Path

import pytest

from pareto_monoped.cad.workers import Workers


def touch(path: Path) -> None:
    if path.name == "bad":
        raise ValueError("bad task")
    if path.name == "deadly":
        os._exit(3)
    path.with_name(f"{path.name}.pid").write_text(str(os.getpid()))
    path.write_text("begun")
    while path.name == "endless":
        time.sleep(0.01)
    path.write_text("done")


def test_all_tasks_are_done_by_several_processes(tmp_path):
    tasks = [tmp_path / str(k) for k in range(9)]
    with Workers(touch, 2) as workers:
        done = list(workers.do(tasks))
    assert sorted(done) == tasks
    assert {path.read_text() for path in tasks} == {"done"}
    pids = {path.with_name(f"{path.name}.pid").read_text() for path in tasks}
    assert 1 <= len(pids) <= 2
    assert str(os.getpid()) not in pids


def test_the_first_failure_is_raised_and_what_follows_is_not_begun(tmp_path):
    tasks = [tmp_path / name for name in ("a", "bad", "c", "d")]
    done = []
    with pytest.raises(ValueError, match=r"^bad task$"), Workers(touch, 1) as workers:
        done += workers.do(tasks)
    assert [path.name for path in tasks if path.exists()] == ["a"]


def test_a_worker_that_dies_is_a_failure(tmp_path):
    with pytest.raises(RuntimeError, match="a worker process ended by itself"), Workers(touch, 2) as workers:
        list(workers.do([tmp_path / "deadly", tmp_path / "b"]))


def test_leaving_by_an_exception_ends_tasks_in_progress(tmp_path):
    endless = tmp_path / "endless"

    def interrupted():
        with Workers(touch, 2) as workers:
            next(workers.do([endless, tmp_path / "b"]))
            while not endless.exists():
                time.sleep(0.01)
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        interrupted()
    with pytest.raises(ProcessLookupError):
        os.kill(int((tmp_path / "endless.pid").read_text()), 0)
    assert endless.read_text() == "begun"


def test_workers_do_not_hear_the_terminal(tmp_path):
    """Ctrl-C goes to every process of the terminal's group; the one that started the workers decides."""
    first = tmp_path / "first"
    with Workers(touch, 1) as workers:
        tasks = workers.do([first, tmp_path / "second"])
        assert next(tasks) == first
        os.kill(int((tmp_path / "first.pid").read_text()), signal.SIGINT)
        assert [path.name for path in tasks] == ["second"]
