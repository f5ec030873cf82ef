"""A campaign killed at random moments ends as one that was not; an interrupt loses nothing and leaves nobody behind."""

import os
import signal
import time

import pytest

from pareto_monoped.study.reader import read_study
from tests.campaign.killed import Running, gone, storm
from tests.campaign.test_coordinator import SMALL
from tests.campaign.test_grid import written

SIX = """name = "six motors"
[study]
case = "C"
[axes]
motors = ["VT8020", "U8", "U10", "U12", "MN8014", "MAD_M6C12"]
seeds = [1, 2, 3]
evaluations = [2000]
"""


def checked(seen, kills, studies):
    assert len(seen["kills"]) == kills
    for kill in seen["kills"]:
        assert kill["lost"] == {}, kill
        assert kill["orphans"] == [], kill
        assert kill["held"] == [], kill
    # Some kills must have come while it was at work, or this shows nothing.
    assert any(kill["code"] == -9 and kill["stored"] and kill["workers"] == 2 for kill in seen["kills"])
    assert len(seen["studies"]) == studies
    assert seen["different"] == []


def test_killed_twice(tmp_path):
    path = written(tmp_path, 'motors = ["VT8020", "U8"]', SMALL.replace("40", "80"))
    checked(storm(path, kills=2, seed=1), kills=2, studies=2)


@pytest.mark.long
def test_six_motors_with_three_seeds_killed_five_times(tmp_path):
    path = tmp_path / "six.toml"
    path.write_text(SIX)
    checked(storm(path, kills=5, seed=1), kills=5, studies=18)


def test_an_interrupt_ends_it_in_order_and_a_second_coordinator_is_refused(tmp_path):
    path = written(tmp_path, "seeds = [1, 2]", SMALL.replace("40", "4000"))
    run = Running(path, tmp_path / "grid")
    run.until(lambda: len(run.acknowledged) == 2 and all(run.acknowledged.values()))
    second = Running(path, tmp_path / "grid")
    assert second.code() == 2
    refusal = second.messages
    assert f"is being run by process {run.process.pid}" in refusal
    assert refusal.count("\n") == 1
    workers = run.children()
    assert len(workers) == 2
    os.kill(run.process.pid, signal.SIGINT)
    assert run.code() == 130
    assert all(map(gone, workers))
    assert {one["state"] for one in run.states} == {"unfinished"}
    for name, count in run.acknowledged.items():
        assert len(read_study(tmp_path / "grid" / f"{name}.db").trials) >= count
    assert not [path.name for path in (tmp_path / "grid").iterdir() if path.name == "campaign-lock"]


def test_workers_end_with_their_coordinator_however_it_ends(tmp_path):
    path = written(tmp_path, "seeds = [1, 2]", SMALL.replace("40", "4000"))
    run = Running(path, tmp_path / "grid")
    run.until(lambda: any(run.acknowledged.values()))
    workers = run.children()
    assert workers
    os.kill(run.process.pid, signal.SIGKILL)
    assert run.code() == -signal.SIGKILL
    end = time.monotonic() + 30.0
    while not all(map(gone, workers)):
        assert time.monotonic() < end, "a worker outlives its coordinator"
        time.sleep(0.02)
