"""Processes: every task is done once, a death is named, messages come back, leaving early ends them at once."""

import os
import signal
import subprocess
import sys
import threading
import time
from concurrent.futures import CancelledError, wait
from pathlib import Path

import pytest

from pareto_monoped.compute import processes as module
from pareto_monoped.compute.crew import LostError
from pareto_monoped.compute.processes import Processes, asked_to_stop, end_by, say
from tests.compute import tasks
from tests.compute.dask_here import ROOT, until


def begun(path):
    """Stay until the process is ended, which tidies up if the path says so."""
    if path.name == "tidy":
        end_by(Tidy(path))
    path.write_text(str(os.getpid()))
    while True:
        time.sleep(0.01)


class Tidy:
    def __init__(self, path):
        self.path = path

    def __call__(self):
        self.path.with_name("tidied").touch()
        os._exit(0)


def speak(count):
    for number in range(count):
        say(number)
    return "said"


def until_asked():
    say("begun")
    while not asked_to_stop():
        time.sleep(0.01)
    return "stopped"


def is_asked():
    return asked_to_stop()


def lock():
    return threading.Lock()


class OddError(Exception):
    """An exception that cannot be made again from its text."""

    def __init__(self, one, two):
        super().__init__(f"{one}, {two}")


def raise_odd():
    raise OddError(1, 2)


def raise_lock():
    raise ValueError(threading.Lock())


def printing():
    print("printed", flush=True)


def gone(process):
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return True
    return False


@pytest.fixture
def one():
    with Processes() as made:
        yield made


def test_all_tasks_are_done_by_several_processes():
    with Processes(2) as made:
        found = [future.result(timeout=60) for future in [made.submit(tasks.short, n) for n in range(9)]]
        pids = set(tasks.ids_of(made))
    assert [number for number, _ in found] == list(range(9))
    assert {process for _, process in found} == pids
    assert len(pids) == 2
    assert all(map(gone, pids))
    with pytest.raises(RuntimeError, match="after shutdown"):
        made.submit(tasks.square, 1)


def test_processes_take_no_named_arguments(one):
    with pytest.raises(TypeError, match="positional"):
        one.submit(tasks.square, number=2)


def test_what_a_task_raises_is_raised_here_with_where_it_was_raised(one):
    with pytest.raises(ValueError, match=r"^no 7$") as caught:
        one.submit(tasks.refuse, 7).result(timeout=60)
    assert "in refuse" in str(caught.value.__cause__)


@pytest.mark.parametrize(
    ("function", "arguments", "error", "words"),
    [
        (tasks.square, (threading.Lock(),), TypeError, "cannot pickle"),
        (lock, (), TypeError, "cannot pickle"),
        (raise_lock, (), RuntimeError, "ValueError: <unlocked"),
        (raise_odd, (), TypeError, "missing 1 required positional argument"),
    ],
)
def test_what_cannot_be_sent_is_an_error_of_its_task_and_of_no_other(one, function, arguments, error, words):
    with pytest.raises(error, match=words):
        one.submit(function, *arguments).result(timeout=60)
    assert one.submit(tasks.square, 3).result(timeout=60) == 9


@pytest.mark.parametrize(
    ("function", "argument", "words"),
    [
        (os._exit, 3, "its process ended by itself with code 3"),
        (signal.raise_signal, signal.SIGKILL, "its process was ended by SIGKILL"),
    ],
)
def test_a_death_is_named_and_the_other_process_goes_on(function, argument, words):
    with Processes(2) as made:
        dead = made.submit(function, argument)
        with pytest.raises(LostError, match=f"^{words}$"):
            dead.result(timeout=60)
        assert not made.ended
        assert [made.submit(tasks.square, n).result(timeout=60) for n in range(3)] == [0, 1, 4]


def test_when_the_last_process_has_died_everything_fails():
    with Processes(lost=lambda code: OSError(f"code {code}")) as made:
        futures = [made.submit(os._exit, 4), *(made.submit(tasks.square, n) for n in range(3))]
        assert futures[-1].cancel()
        assert [str(future.exception(timeout=60)) for future in futures[:-1]] == ["code 4"] * 3
        assert made.ended
        with pytest.raises(RuntimeError, match="after shutdown"):
            made.submit(tasks.square, 1)
    with pytest.raises(CancelledError):
        futures[-1].result(timeout=1)


def test_one_that_dies_while_it_has_nothing_to_do_is_found_out_by_its_next_task(one):
    assert one.submit(tasks.square, 2).result(timeout=60) == 4
    one.kill()
    with pytest.raises(LostError, match="SIGKILL"):
        one.submit(tasks.square, 2).result(timeout=60)


def test_messages_are_heard_before_the_result_and_in_order():
    heard = []
    with Processes(hear=heard.append) as made:
        future = made.submit(speak, 50)
        future.add_done_callback(lambda future: heard.append(future.result()))
        wait([future], 60)
    assert heard == [*range(50), "said"]


def test_a_task_that_is_asked_to_stop_stops_and_the_next_is_not_asked():
    said = threading.Event()
    with Processes(hear=lambda _: said.set()) as made:
        future = made.submit(until_asked)
        assert said.wait(60)
        made.stop()
        assert future.result(timeout=60) == "stopped"
        made.stop()  # too late
        time.sleep(0.2)
        assert made.submit(is_asked).result(timeout=60) is False


def test_a_task_that_is_asked_to_stop_before_it_has_begun_stops():
    """The word could come before the task, which then did not hear it."""
    with Processes() as made:
        futures = [made.submit(until_asked) for _ in range(3)]
        made.stop()
        assert [future.result(timeout=60) for future in futures] == ["stopped"] * 3


def test_a_process_does_not_hear_the_terminal_and_this_one_still_does(one):
    """Ctrl-C goes to every process of the terminal's group; the one that started the others decides."""
    assert one.submit(tasks.square, 2).result(timeout=60) == 4
    for number in (signal.SIGINT, signal.SIGHUP):
        os.kill(tasks.ids_of(one)[0], number)
    assert one.submit(tasks.square, 3).result(timeout=60) == 9
    assert not signal.pthread_sigmask(signal.SIG_BLOCK, ()) & {signal.SIGINT, signal.SIGHUP}


@pytest.mark.parametrize("name", ["plain", "tidy"])
def test_leaving_by_an_exception_ends_tasks_in_progress(tmp_path, name):
    path, made = tmp_path / name, Processes(2)

    def interrupted():
        with made:
            futures.extend([made.submit(begun, path), made.submit(tasks.square, 3)])
            until(lambda: path.exists() and path.read_text())
            raise KeyboardInterrupt

    futures = []
    began_s = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        interrupted()
    assert time.monotonic() - began_s < 60.0
    assert gone(int(path.read_text()))
    assert (tmp_path / "tidied").exists() is (name == "tidy")
    assert isinstance(futures[0].exception(timeout=1), LostError)
    assert futures[1].result(timeout=1) == 9


@pytest.mark.parametrize("leaving", ["in order", pytest.param("by an exception", marks=pytest.mark.long)])
def test_one_that_hangs_is_killed(leaving):
    made = Processes()
    assert made.submit(tasks.square, 2).result(timeout=60) == 4
    (process,) = tasks.ids_of(made)
    os.kill(process, signal.SIGSTOP)
    os.waitpid(process, os.WUNTRACED)  # until it has stopped
    began_s = time.monotonic()
    made.__exit__(None if leaving == "in order" else ValueError, None, None)
    assert gone(process)
    assert 0.5 * module.GRACE_S < time.monotonic() - began_s < 30.0


def test_one_that_dies_without_having_read_what_was_said_to_it_is_lost_all_the_same():
    """The system then says that the connection was reset rather than that it ended."""
    said = threading.Event()
    with Processes(hear=lambda _: said.set()) as made:
        future = made.submit(until_asked)
        assert said.wait(60)
        (process,) = tasks.ids_of(made)
        os.kill(process, signal.SIGSTOP)
        os.waitpid(process, os.WUNTRACED)  # until it has stopped
        made.stop()
        made.kill()
        with pytest.raises(LostError, match="SIGKILL"):
            future.result(timeout=60)
        made.stop()  # nobody is there any more, which is no error


def test_sigterm_lets_a_task_tidy_up(tmp_path):
    path = tmp_path / "tidy"
    with Processes() as made:
        future = made.submit(begun, path)
        until(lambda: path.exists() and path.read_text())
        os.kill(tasks.ids_of(made)[0], signal.SIGTERM)
        assert isinstance(future.exception(timeout=60), LostError)
    assert (tmp_path / "tidied").exists()


@pytest.mark.parametrize("name", ["plain", pytest.param("tidy", marks=pytest.mark.long)])
def test_processes_end_with_the_one_that_started_them(tmp_path, name):
    code = f"""
from pathlib import Path
from pareto_monoped.compute.processes import Processes
from tests.compute.test_processes import begun
Processes().submit(begun, Path({str(tmp_path / name)!r})).result()
"""
    path: Path = tmp_path / name
    environment = os.environ | {"PYTHONPATH": str(ROOT)}
    with subprocess.Popen([sys.executable, "-c", code], env=environment) as parent:
        until(lambda: path.exists() and path.read_text())
        parent.kill()
    until(lambda: gone(int(path.read_text())), 60)
    assert (tmp_path / "tidied").exists() is (name == "tidy")


def test_what_a_task_prints_is_not_among_the_results_of_a_command(capfd):
    with Processes() as made:
        made.submit(printing).result(timeout=60)
    assert capfd.readouterr() == ("", "printed\n")
