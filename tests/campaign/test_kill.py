"""A campaign killed at random moments ends as one that was not; an interrupt loses nothing and leaves nobody behind."""

import os
import signal

import pytest

from pareto_monoped.campaign.grid import load_campaign
from pareto_monoped.study.run import run
from tests.campaign.killed import Running, differences, left_behind, storm
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


@pytest.mark.long
def test_killed_and_interrupted(tmp_path):
    """A coordinator is killed while both workers are at it; of the next one a worker, before an interrupt ends it."""
    path = written(tmp_path, 'motors = ["VT8020", "U8"]', SMALL.replace("40", "4000"))
    folder, alone = tmp_path / "grid", tmp_path / "alone"

    first = Running(path, folder)
    first.until(lambda: len(first.children()) == 2)
    refused = Running(path, folder)
    assert refused.code() == 2
    assert f"is being run by process {first.process.pid}" in refused.messages
    assert refused.messages.count("\n") == 1
    first.until(lambda: len(first.acknowledged) == 2 and all(first.acknowledged.values()))
    workers = first.children()
    os.kill(first.process.pid, signal.SIGKILL)
    kill = left_behind(first, workers, folder)
    safe(kill, -signal.SIGKILL)
    assert kill["workers"] == 2
    before = kill["stored"]
    assert sum(before.values()) < 2 * 4000

    second = Running(path, folder)
    second.until(lambda: any(count > before[name] for name, count in second.acknowledged.items()))
    workers = second.children()
    os.kill(workers[0], signal.SIGKILL)
    second.until(lambda: set(second.children()) - set(workers))
    workers += set(second.children()) - set(workers)
    os.kill(second.process.pid, signal.SIGINT)
    kill = left_behind(second, workers, folder)
    safe(kill, 130)
    assert "its process was ended by SIGKILL; the study goes on later from what is stored" in second.messages
    assert {one["state"] for one in second.states} == {"unfinished"}
    assert not (folder / "campaign-lock").exists()

    alone.mkdir()
    for member in load_campaign(path).members:
        for place in (alone, folder):
            run(member.study, place / f"{member.name}.db", evaluations=kill["stored"][member.name] + 25, workers=2)
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
