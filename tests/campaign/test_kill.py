"""A campaign killed at random moments ends as one that was not; an interrupt loses nothing and leaves nobody behind."""

import os
import signal

import pytest

from pareto_monoped.campaign.grid import load_campaign
from pareto_monoped.storage.reader import read_study
from pareto_monoped.study.run import run as run_alone
from tests.campaign.killed import Running, differences, gone, left_behind, storm
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


def safe(kill, code):
    """Assert what holds after every kill."""
    assert kill["lost"] == {}, kill
    assert kill["orphans"] == [], kill
    assert kill["held"] == [], kill
    assert kill["code"] == code, kill


def test_killed_twice(tmp_path):
    """A coordinator is killed while both workers are at it, then one of the next coordinator's workers."""
    path = written(tmp_path, 'motors = ["VT8020", "U8"]', SMALL.replace("40", "200"))
    folder, alone = tmp_path / "grid", tmp_path / "alone"

    first = Running(path, folder)
    first.until(lambda: len(first.children()) == 2)
    workers = first.children()
    first.until(lambda: all(first.acknowledged.values()))
    os.kill(first.process.pid, signal.SIGKILL)
    kill = left_behind(first, workers, folder)
    safe(kill, -signal.SIGKILL)
    assert kill["workers"] == 2
    before = kill["stored"]
    assert sum(before.values()) < 2 * 200

    second = Running(path, folder)
    second.until(lambda: any(count > before[name] for name, count in second.acknowledged.items()))
    workers = second.children()
    os.kill(workers[0], signal.SIGKILL)
    kill = left_behind(second, workers, folder)
    safe(kill, 0)
    assert "its process was ended by SIGKILL; the study goes on later from what is stored" in second.messages

    alone.mkdir()
    for member in load_campaign(path).members:
        run_alone(member.study, alone / f"{member.name}.db", workers=2)
    assert differences(alone, folder) == (["U8", "VT8020"], [])


@pytest.mark.long
def test_six_motors_with_three_seeds_killed_five_times(tmp_path):
    path = tmp_path / "six.toml"
    path.write_text(SIX)
    seen = storm(path, kills=5, seed=1)
    assert len(seen["kills"]) == 5
    for kill in seen["kills"]:
        safe(kill, -signal.SIGKILL)
    # Some kills must have come while it was at work, or this shows nothing.
    assert any(kill["workers"] == 2 and 0 < sum(kill["stored"].values()) < 18 * 2000 for kill in seen["kills"])
    assert len(seen["studies"]) == 18
    assert seen["different"] == []


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
