"""Exports in processes: the first failure is raised, what has begun ends, and what has not is left out."""

import os
import signal
import subprocess
import sys
import time

import pytest

from pareto_monoped.cad import batch
from pareto_monoped.cad.jobs import case_job
from pareto_monoped.cad.kernel import client as kernel
from pareto_monoped.cad.write.folder import beside
from pareto_monoped.compute.processes import Processes
from tests.cad.test_interrupt import is_running
from tests.compute.dask_here import ROOT, until


def touch(path):
    """What stands for an export."""
    if path.name == "bad":
        raise ValueError("bad task")
    if path.name == "deadly":
        os._exit(3)
    path.touch()


def slow(path):
    """The slow one ends a second after the bad one has begun, whenever their processes are up."""
    begun = path.parent / "begun"
    if path.name == "bad":
        begun.touch()
    if path.name == "slow":
        until(begun.exists)
        time.sleep(1.0)
    touch(path)


def made(monkeypatch, folder, names, count=1, function=touch):
    """Names of the jobs as they are made, and the failure."""
    monkeypatch.setattr(batch, "_make", function)
    found = []
    with Processes(count, lost=batch._lost) as processes:
        jobs = batch._made([folder / name for name in names], processes, count)
        with pytest.raises((ValueError, RuntimeError)) as caught:
            found.extend(job.name for job in jobs)
    return found, str(caught.value)


@pytest.mark.long
def test_the_first_failure_is_raised_and_what_follows_is_not_begun(tmp_path, monkeypatch):
    assert made(monkeypatch, tmp_path, ["a", "bad", "c", "d"]) == (["a"], "bad task")
    assert [path.name for path in tmp_path.iterdir()] == ["a"]


def test_what_is_in_progress_at_a_failure_ends_and_what_follows_is_not_begun(tmp_path, monkeypatch):
    assert made(monkeypatch, tmp_path, ["slow", "bad", "c"], 2, slow) == (["slow"], "bad task")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["begun", "slow"]


def test_a_process_that_dies_is_a_failure(tmp_path, monkeypatch):
    words = "a worker process ended by itself; run the same command again"
    assert made(monkeypatch, tmp_path, ["a", "deadly", "c"]) == (["a"], words)


def kernel_process():
    """Number of this process's kernel, in a process of a batch."""
    return kernel._kernel._lines[0].process.pid


@pytest.mark.long
def test_a_process_of_a_batch_keeps_its_kernel_between_designs(tmp_path):
    how = {"formats": ["urdf"], "strength": False}
    jobs = [case_job("C", folder=tmp_path / name, **how) for name in ("one", "other")]
    found = []
    with Processes(lost=batch._lost) as processes:
        for job in jobs:
            processes.submit(batch._make, job).result()
            found.append(processes.submit(kernel_process).result())
    assert found[0] == found[1]
    assert [(job.folder / "model" / "monoped.urdf").exists() for job in jobs] == [True, True]


class Half:
    """A job that stays half-written."""

    design = None

    def __init__(self, folder):
        self.folder = folder

    def maps(self):
        with beside(self.folder) as folder:
            (folder / "half").write_text(str(os.getpid()))
            while True:
                time.sleep(0.01)


@pytest.mark.parametrize(
    "what",
    [
        "coordinator killed",
        *(pytest.param(what, marks=pytest.mark.long) for what in ("worker told to end by SIGTERM", "interrupt")),
    ],
)
def test_what_is_ended_leaves_nothing_half_written(tmp_path, what):
    code = f"""
import signal
from pathlib import Path
from pareto_monoped.cad import batch
from pareto_monoped.compute.processes import Processes
from tests.cad.test_batch import Half
signal.signal(signal.SIGINT, signal.default_int_handler)
with Processes(lost=batch._lost) as processes:
    list(batch._made([Half(Path({str(tmp_path / "c")!r}))], processes, 1))
"""
    environment = os.environ | {"PYTHONPATH": str(ROOT)}
    with subprocess.Popen([sys.executable, "-c", code], env=environment, stderr=subprocess.PIPE, text=True) as parent:
        until(lambda: [path for path in tmp_path.glob(".c-*/half") if path.read_text()])
        (half,) = tmp_path.glob(".c-*/half")
        worker = int(half.read_text())
        if what == "worker told to end by SIGTERM":
            os.kill(worker, signal.SIGTERM)
        else:
            parent.send_signal(signal.SIGINT if what == "interrupt" else signal.SIGKILL)
        message = parent.communicate(timeout=120)[1]
    assert ("ended by itself; run the same command again" in message) is (what == "worker told to end by SIGTERM")
    until(lambda: not is_running(worker))
    assert list(tmp_path.iterdir()) == []
