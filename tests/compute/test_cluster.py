"""A crew of Dask workers that are real programs: what befalls them and their scheduler costs time, and one line."""

import shutil
import signal
import socket
import subprocess
import sys
import threading
import time
from contextlib import contextmanager
from importlib.util import find_spec
from pathlib import Path

import pytest

from pareto_monoped.cli.options import Where, executor_at
from pareto_monoped.compute.cluster import DaskWorkers, threads_of
from pareto_monoped.compute.crew import Crew, Limits
from pareto_monoped.errors import InputError, WorkerError
from pareto_monoped.jump.peers import cluster
from tests.compute import tasks
from tests.compute.dask_here import ROOT, DaskHere, free_port, until
from tests.compute.proxy import Proxy

pytestmark = pytest.mark.skipif(find_spec("distributed") is None, reason="Dask is not installed")


@pytest.fixture(autouse=True)
def quick(monkeypatch):
    """On one machine the scheduler answers at once."""
    monkeypatch.setattr("pareto_monoped.compute.cluster._NEWS_S", 0.1)


@contextmanager
def crew(address, **limits):
    """A crew with a greeting that costs nothing, and what it tells the user."""
    told = []
    made = Crew(
        DaskWorkers(address),
        greeting=tasks.greeting,
        check=lambda _: None,
        tell=told.append,
        limits=Limits(**limits),
    )
    try:
        yield made, told
    finally:
        made.shutdown()


def numbers(futures):
    return [future.result(timeout=180)[0] for future in futures]


@pytest.fixture
def two(tmp_path):
    with DaskHere(tmp_path, workers=2) as dask:
        yield dask


@pytest.fixture(scope="module")
def scheduler(tmp_path_factory):
    """A scheduler, to which ``shared`` adds workers."""
    with DaskHere(tmp_path_factory.mktemp("shared")) as dask:
        yield dask


@pytest.fixture(scope="module")
def shared(scheduler):
    """That scheduler with workers of one thread and of two, for tests that leave them as they are."""
    scheduler.workers += [scheduler.add(), scheduler.add(threads=2)]
    until(lambda: threads_of(scheduler.address) == 3)
    return scheduler


def test_the_option_of_commands_leads_to_the_scheduler_of_its_address(scheduler):
    """The first test, as long as there are no workers, which would be asked for jumps."""
    limits = Limits(absent_s=7.0)
    with executor_at(Where(scheduler=scheduler.address), limits=limits) as made:
        assert made._staff.label == f"scheduler {scheduler.address}"
        assert made._limits is limits
        until(lambda: made._staff.state() == "has no worker")


def test_a_worker_is_killed_and_another_joins(shared):
    """The other takes its place among the workers for all tests."""
    with crew(shared.address) as (made, told):
        futures = [made.submit(tasks.short, n) for n in range(40)]
        until(lambda: sum(future.done() for future in futures) > 10)
        told.clear()  # the workers may have been slow to start
        shared.workers[0].kill()
        shared.workers[0].wait()
        shared.workers[0] = shared.add()

        def the_other_is_at_work():
            done = [future for future in futures if future.done()]
            futures.extend(made.submit(tasks.short, n) for n in range(len(futures), len(done) + 4))
            return shared.workers[0].pid in {future.result()[1] for future in done}

        until(the_other_is_at_work)
        assert numbers(futures) == list(range(len(futures)))
    assert len(told) == 1
    assert told[0].startswith("worker tcp://127.0.0.1:")
    assert told[0].endswith("has gone; its work goes elsewhere")


def test_no_scheduler_at_the_address(monkeypatch):
    monkeypatch.setattr("pareto_monoped.compute.cluster._CONNECT_S", 1.0)
    with pytest.raises(WorkerError, match=r"^scheduler 127.0.0.1:\d+: does not answer within 1 s .*dask scheduler$"):
        DaskWorkers(f"127.0.0.1:{free_port()}")


@pytest.mark.long
def test_who_accepts_a_connection_and_stays_silent_is_no_scheduler(monkeypatch):
    for name, seconds in (("_CONNECT_S", 1.0), ("_ANSWER_S", 1.0)):
        monkeypatch.setattr(f"pareto_monoped.compute.cluster.{name}", seconds)
    began_s = time.monotonic()
    with socket.create_server(("127.0.0.1", 0)) as silent:
        address = f"127.0.0.1:{silent.getsockname()[1]}"
        with pytest.raises(WorkerError, match=rf"^scheduler {address}: does not answer within 1 s"):
            DaskWorkers(address)
    assert time.monotonic() - began_s < 60.0


@pytest.mark.long
def test_each_worker_answers_for_itself_and_whoever_leaves_closes_the_connection(shared):
    """The same task for two workers, such as the greeting, is two tasks: else one would vouch for the other."""
    staff = DaskWorkers(shared.address)
    try:
        until(lambda: len(staff.present()) == 2)
        answers = [member.executor.submit(tasks.greeting, 1) for member in staff.present().values()]
        assert {answer.result(timeout=60) for answer in answers} == {worker.pid for worker in shared.workers}
        for member in staff.present().values():
            assert len({process for _, process in member.executor.map(tasks.short, range(6), timeout=60)}) == 1
    finally:
        staff.close()
    assert staff._client.status == "closed"
    assert not staff._thread.is_alive()


def test_a_connection_that_comes_too_late_is_closed(shared, monkeypatch):
    """Nobody would ever end it: the scheduler kept a client, this process its threads."""
    import distributed

    may_connect, made = threading.Event(), []

    class Late(distributed.Client):
        """The real client, which a slow network keeps from connecting."""

        def __init__(self, address, *, timeout, set_as_default):
            assert may_connect.wait(120.0)
            super().__init__(address, timeout=max(timeout, 60.0), set_as_default=set_as_default)
            made.append(self)

    monkeypatch.setattr(distributed, "Client", Late)
    for name in ("_CONNECT_S", "_ANSWER_S"):
        monkeypatch.setattr(f"pareto_monoped.compute.cluster.{name}", 0.2)
    with pytest.raises(WorkerError, match="does not answer"):
        DaskWorkers(shared.address)
    may_connect.set()
    until(lambda: made)
    until(lambda: made[0].status == "closed", 30.0)


@pytest.mark.parametrize("how", [pytest.param("cut off", marks=pytest.mark.long), "closed between two questions"])
def test_after_a_connection_has_ended_workers_have_executors_of_the_next_one(shared, monkeypatch, how):
    """The workers have stayed where they were; their old executors would send tasks into the ended connection."""
    monkeypatch.setattr("pareto_monoped.compute.cluster._CONNECT_S", 2.5)  # so long the client tries to come back
    with Proxy(shared.port) as proxy:
        staff = DaskWorkers(proxy.address)
        try:
            until(staff.present)
            ended, before = staff._client, min(staff.present())
            if how == "cut off":
                proxy.broken = True
                until(lambda: ended.status == "closed")
                assert staff.present() == {}
                proxy.broken = False
            else:
                ended.close()
            until(lambda: staff._client is not ended and staff.present())
            assert staff.present()[before].executor.submit(tasks.square, 3).result(timeout=60) == 9
        finally:
            proxy.broken = False
            staff.close()


@pytest.mark.parametrize("text", ["foo", "", "nonsense://x", "tcp://foo", "tcp://:8786", "host:port", "tcp://host:0"])
def test_what_is_no_address_is_refused_at_once(text):
    """Dask was asked for 10 s, and the text was said not to answer."""
    with pytest.raises(InputError) as caught:
        DaskWorkers(text)
    assert str(caught.value) == f"scheduler {text!r}: is no address of a scheduler; give tcp://HOST:PORT"


_TLS = [f"distributed.comm.tls.{name}" for name in ("ca-file", "client.cert", "client.key")]


@pytest.mark.parametrize(
    ("settings", "lack"),
    [
        ({}, "are missing; set"),
        (dict.fromkeys(_TLS, "/nowhere/a.pem"), "cannot be used (FileNotFoundError"),
    ],
)
def test_tls_without_its_certificates_is_told_which_settings_it_needs(settings, lack):
    """It was an unexpected TypeError."""
    import dask

    with dask.config.set(settings), pytest.raises(InputError) as caught:
        DaskWorkers(f"tls://127.0.0.1:{free_port()}")
    message = str(caught.value)
    assert "\n" not in message
    assert f"its TLS certificates {lack}" in message
    assert "distributed.comm.tls.ca-file, .client.cert and .client.key" in message


def test_dask_itself_writes_nothing(shared):
    """Its own levels, which it sets when it is imported, took the place of ours."""
    script = (
        "import logging, sys; from pareto_monoped.compute.cluster import threads_of; threads_of(sys.argv[1])\n"
        "for name in ('distributed', 'distributed.client'): logging.getLogger(name).error('of Dask')"
    )
    done = subprocess.run(
        [sys.executable, "-c", script, shared.address], cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert (done.returncode, done.stderr) == (0, "")


def test_a_forgotten_client_does_not_stop_the_next_one_for_ever(shared):
    """It closed itself wherever the garbage collector found it, also while that thread held the lock for starting."""
    from distributed.utils import LoopRunner

    staff = DaskWorkers(shared.address)
    try:
        with LoopRunner._lock:
            forgetting = threading.Thread(target=staff._client.__del__, daemon=True)
            forgetting.start()
            forgetting.join(10.0)
            assert not forgetting.is_alive()
    finally:
        staff.close()


def test_a_worker_with_two_threads_has_two_tasks_at_a_time(tmp_path, shared):
    """Three tasks that wait for each other go to two workers, which have three threads together."""
    with crew(shared.address) as (made, _):
        until(lambda: len(made._able()) == 2)
        of_three = [made.submit(tasks.meets, str(tmp_path), own, other) for own, other in ("ab", "bc", "ca")]
        assert numbers(of_three) == ["a", "b", "c"]
        assert sorted(post.member.slots for post in made._posts.values()) == [1, 2]


@pytest.mark.long
def test_a_worker_hangs_and_answers_again(two):
    with crew(two.address, task_s=4.0, times=3.0) as (made, told):
        numbers([made.submit(tasks.short, n) for n in range(40)])
        told.clear()  # the workers may have been slow to start
        two.workers[0].send_signal(signal.SIGSTOP)
        assert numbers([made.submit(tasks.short, n) for n in range(100)]) == list(range(100))
        until(lambda: told)
        two.workers[0].send_signal(signal.SIGCONT)
        until(lambda: len(told) == 2)
        found = [made.submit(tasks.short, n) for n in range(40)]
        assert len({future.result(timeout=60)[1] for future in found}) == 2
    assert "has not answered for 4 s; its work goes elsewhere" in told[0]
    assert told[1].endswith("answers again")


@pytest.mark.long
def test_the_scheduler_is_restarted(two):
    with crew(two.address) as (made, told):
        futures = [made.submit(tasks.short, n) for n in range(300)]
        until(lambda: sum(future.done() for future in futures) > 20)
        told.clear()  # the workers may have been slow to start
        two.restart()
        two.workers += [two.add(), two.add()]
        assert numbers(futures) == list(range(300))
    assert len(told) <= 1
    assert all("waiting up to 60 s" in line for line in told)


@pytest.mark.long
def test_a_scheduler_that_has_just_ended_is_not_said_to_lack_workers(tmp_path):
    """The next question to it is half a second away, and its answer several seconds."""
    with DaskHere(tmp_path) as here:
        staff = DaskWorkers(here.address)
        try:
            assert staff.state() == "has no worker"
            assert staff.threads() == 0
            here.scheduler.kill()
            until(lambda: staff._client.status != "running")
            assert staff.state().startswith("does not answer")
            assert staff.present() == {}
        finally:
            staff.close()


@pytest.mark.long
def test_the_scheduler_stays_away(two):
    with crew(two.address, absent_s=6.0) as (made, told):
        futures = [made.submit(tasks.short, n) for n in range(300)]
        until(lambda: sum(future.done() for future in futures) > 20)
        told.clear()  # the workers may have been slow to start
        two.scheduler.kill()
        problem = futures[-1].exception(timeout=180)
    assert isinstance(problem, WorkerError)
    assert "\n" not in str(problem)
    assert str(problem).startswith(f"scheduler {two.address}: does not answer")
    assert str(problem).endswith("for 6 s; start scheduler and workers, then give the same command again")
    assert len(told) == 1


@pytest.mark.long
@pytest.mark.parametrize("how", ["silent", "broken"])
def test_the_network_is_cut_for_ten_seconds(tmp_path, how):
    """Between this process and the scheduler: packets get lost, or connections break and nobody can connect."""
    with DaskHere(tmp_path, workers=2) as dask, Proxy(dask.port) as proxy:
        with crew(proxy.address) as (made, told):
            futures = [made.submit(tasks.short, n) for n in range(400)]
            until(lambda: sum(future.done() for future in futures) > 20)
            told.clear()  # the workers may have been slow to start
            threading.Thread(target=proxy.cut, args=(10.0, how)).start()
            assert numbers(futures) == list(range(400))
        assert len(told) <= 1


def other_package(folder, path, before, after):
    """A copy of the package in which a file differs."""
    shutil.copytree(ROOT / "pareto_monoped", folder / "pareto_monoped", ignore=shutil.ignore_patterns("__pycache__"))
    file: Path = folder / "pareto_monoped" / path
    text = file.read_text()
    assert before in text
    file.write_text(text.replace(before, after))
    return folder


@pytest.mark.long
@pytest.mark.parametrize(
    ("path", "before", "after", "words"),
    [
        ("__init__.py", '__version__ = "', '__version__ = "9', "pareto-monoped 9"),
        ("data/materials.toml", "density_kg_per_m3 = 2", "density_kg_per_m3 = 3", "computes other jumps"),
    ],
)
def test_a_worker_with_another_version_or_other_data_is_refused(tmp_path, path, before, after, words):
    folder = tmp_path / "other"
    other = other_package(folder, path, before, after)
    told = []
    with DaskHere(tmp_path) as dask:
        dask.workers += [dask.add(package=other)]
        with cluster(dask.address, tell=told.append) as made:
            until(lambda: any("refused" in line for line in told), 300)
            problem = made.submit(tasks.short, 1).exception(timeout=300)
            assert isinstance(problem, WorkerError)
            assert "none of its 1 workers may be used" in str(problem)
            assert words in str(problem)
            dask.workers += [dask.add()]
            until(lambda: len(made._able()) == 1, 300)
            found = {made.submit(tasks.short, n).result(timeout=180)[1] for n in range(8)}
    assert found == {dask.workers[1].pid}
    (refusal,) = [line for line in told if "refused" in line]
    assert refusal.startswith("worker tcp://127.0.0.1:")
    assert words in refusal
