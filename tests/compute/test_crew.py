"""A crew of real processes: whatever happens to them, each task has its result, once."""

import os
import signal
import subprocess
import sys
import time
from concurrent.futures import CancelledError
from contextlib import contextmanager

import pytest

from pareto_monoped.compute.crew import Crew, Limits
from pareto_monoped.compute.processes import LocalProcesses
from pareto_monoped.errors import WorkerError
from tests.compute import tasks
from tests.compute.dask_here import ROOT, until


@contextmanager
def crew(count=2, check=lambda _: None, **limits):
    """A crew, and what it tells the user."""
    told = []
    made = Crew(
        LocalProcesses(count, 1), greeting=tasks.greeting, check=check, tell=told.append, limits=Limits(**limits)
    )
    try:
        yield made, told
    finally:
        made.shutdown()


@pytest.fixture(scope="module")
def sound():
    with crew() as (made, told):
        yield made
        assert told == []


def results(futures):
    return [future.result(timeout=60) for future in futures]


def test_results_come_in_the_order_of_the_tasks(sound):
    assert results([sound.submit(tasks.square, n) for n in range(30)]) == [n * n for n in range(30)]
    assert list(sound.map(tasks.square, range(5))) == [0, 1, 4, 9, 16]


def test_all_processes_work(sound):
    found = results([sound.submit(tasks.short, n) for n in range(12)])
    assert [number for number, _ in found] == list(range(12))
    assert len({process for _, process in found}) == 2


def test_what_a_task_raises_is_raised_and_is_no_fault_of_its_worker(sound):
    with pytest.raises(ValueError, match="no 7"):
        sound.submit(tasks.refuse, 7).result(timeout=60)


def test_named_arguments_are_refused(sound):
    with pytest.raises(TypeError, match="positional"):
        sound.submit(tasks.square, number=2)


def test_a_process_that_is_killed_is_replaced_and_nothing_is_lost(tmp_path):
    with crew() as (made, told):
        futures = [made.submit(tasks.short, n) for n in range(6)]
        futures += [made.submit(tasks.dies_once, str(tmp_path / "flag"))]
        futures += [made.submit(tasks.short, n) for n in range(6, 12)]
        found = results(futures)
    assert [entry[0] for entry in found if isinstance(entry, tuple)] == list(range(12))
    assert len(told) == 1
    assert "was lost; its work goes elsewhere" in told[0]


@pytest.mark.long
def test_a_process_that_hangs_is_given_up_and_its_tasks_are_done_elsewhere(tmp_path):
    with crew(1, task_s=3.0, times=3.0) as (made, told):
        process = made.submit(tasks.short, 1).result(timeout=60)[1]
        futures = [made.submit(tasks.stops_once, str(tmp_path / "flag"))]
        futures += [made.submit(tasks.short, n) for n in range(6)]
        found = results(futures)
    assert [number for number, _ in found[1:]] == list(range(6))
    assert told == ["process 1 has not answered for 3 s; its work goes elsewhere"]
    until(lambda: ended(process), 30)


def test_a_slow_task_is_also_given_to_who_has_nothing_to_do(tmp_path):
    with crew() as (made, told):
        results([made.submit(tasks.short, n) for n in range(6)])
        began_s = time.monotonic()
        assert made.submit(tasks.slow_once, str(tmp_path / "flag"), 50.0).result(timeout=60) == "fast"
        assert time.monotonic() - began_s < 45.0
    assert told == []


def test_a_task_that_ends_every_worker_is_given_up():
    with crew(1) as (made, told):
        with pytest.raises(WorkerError, match=r"ended 4 workers one after the other.*memory"):
            made.submit(tasks.dies, 3).result(timeout=120)
        assert len(told) == 4
        assert made.submit(tasks.square, 3).result(timeout=60) == 9


def test_workers_that_compute_other_numbers_are_refused_by_name():
    with crew(check=lambda process: "computes otherwise") as (made, told):
        problem = made.submit(tasks.square, 3).exception(timeout=60)
    assert isinstance(problem, WorkerError)
    assert str(problem).startswith("2 processes: none of its 2 workers may be used (computes otherwise); install")
    assert sorted(told) == [f"process {n} is refused: computes otherwise" for n in (1, 2)]


def test_one_refused_worker_leaves_the_work_to_the_others():
    seen = []

    def check(process):
        seen.append(process)
        return "wrong" if len(seen) == 1 else None

    with crew(check=check) as (made, told):
        found = results([made.submit(tasks.short, n) for n in range(8)])
    assert {process for _, process in found} == {seen[1]}
    assert len(told) == 1


def test_no_process_survives_its_crew():
    with crew() as (made, _):
        process = made.submit(tasks.short, 1).result(timeout=60)[1]
        waiting = [made.submit(tasks.short, n) for n in range(40)]
    assert all(future.done() for future in waiting)
    with pytest.raises(CancelledError):
        waiting[-1].result(timeout=1)
    for _ in range(100):
        try:
            os.kill(process, 0)
            if os.waitpid(process, os.WNOHANG)[0]:
                break
        except (ProcessLookupError, ChildProcessError):  # the crew may take note of its end between both calls
            break
        time.sleep(0.1)
    else:
        pytest.fail("still there")
    with pytest.raises(RuntimeError, match="shutdown"):
        made.submit(tasks.square, 1)


def test_ctrl_c_is_for_the_parent_alone(sound):
    process = sound.submit(tasks.short, 1).result(timeout=60)[1]
    os.kill(process, signal.SIGINT)
    assert sound.submit(tasks.square, 4).result(timeout=60) == 16


SCRIPT = """
from pareto_monoped.compute.crew import Crew
from pareto_monoped.compute.processes import LocalProcesses
from tests.compute import tasks

def work():
    crew = Crew(LocalProcesses(1, 1), greeting=tasks.greeting, check=lambda _: None)
    try:
        print(crew.submit(tasks.short, 1).result()[1], flush=True)
        input()
    finally:
        crew.shutdown()

"""


@contextmanager
def script(folder, last_lines):
    """A program of its own that has a crew of one process."""
    file = folder / "script.py"
    file.write_text(SCRIPT + last_lines)
    program = subprocess.Popen(
        [sys.executable, str(file)],
        env=os.environ | {"PYTHONPATH": str(ROOT)},
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    with program:
        try:
            yield program
        finally:
            program.kill()


def ended(process):
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return True
    return False


@pytest.mark.long
def test_processes_end_with_a_parent_that_is_killed(tmp_path):
    with script(tmp_path, 'if __name__ == "__main__":\n    work()\n') as program:
        process = int(program.stdout.readline())
        assert not ended(process)
        program.kill()
        until(lambda: ended(process), 60)


def test_a_script_needs_no_guard(tmp_path):
    """Each process began the whole script again, and ended with an error."""
    with script(tmp_path, "work()\n") as program:
        out, err = program.communicate("\n", timeout=120)
    assert (program.returncode, err) == (0, "")
    assert int(out)


def test_processes_that_end_before_they_did_anything_are_given_up(monkeypatch):
    monkeypatch.setattr(sys, "executable", "/bin/false")
    with crew(1) as (made, told):
        problem = made.submit(tasks.square, 3).exception(timeout=60)
    assert isinstance(problem, WorkerError)
    assert str(problem) == "1 processes: 6 ended before they did anything; use fewer processes"
    assert told == []
