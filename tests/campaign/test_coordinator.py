"""Studies side by side in processes of their own: equal to those run alone, whatever happens to the processes."""

import os
import signal

import pytest

from pareto_monoped.campaign import coordinator
from pareto_monoped.campaign.coordinator import run_campaign, standings_of
from pareto_monoped.campaign.folder import places_of
from pareto_monoped.campaign.grid import load_campaign
from pareto_monoped.storage.reader import read_study
from pareto_monoped.study.run import run
from tests.campaign.killed import gone
from tests.campaign.test_grid import written
from tests.compute.tasks import ids_of

SMALL = 'name = "grid"\n[study]\nevaluations = 40\naudit = false\nalgorithm = { name = "nsga2", population = 10 }\n'


def standings(folder, axes, head=SMALL):
    campaign = load_campaign(written(folder, axes, head))
    campaign.folder.mkdir(exist_ok=True)
    return standings_of(places_of(campaign, campaign.folder))


def states(all_of_them):
    return {one.name: one.state for one in all_of_them}


def test_equal_to_studies_run_alone_also_with_other_shares_and_after_being_stopped(tmp_path, monkeypatch):
    """Two studies have a thread each; the longer one gets both once it is alone, however little time is left."""
    monkeypatch.setattr(coordinator, "WORTH_S", 0.0)
    # With 1000 jumps the longer one still runs when the other process, which may start a second later, has ended.
    several = standings(tmp_path, "evaluations = [20, 1000]", SMALL.replace("audit", "strength = false\naudit"))
    seen = []
    assert run_campaign(
        several, cores=2, changed=lambda one: seen.append((one.name, one.threads)), notify=lambda _: None
    )
    assert set(states(several).values()) == {"finished"}
    assert seen[0] == ("jumps1000", 1)  # the longest begins first
    threads = {name: {count for other, count in seen if other == name} - {0} for name, _ in seen}
    assert threads == {"jumps20": {1}, "jumps1000": {1, 2}}
    for one in several:
        alone = tmp_path / f"{one.name}.db"
        run(one.place.study, alone, workers=1)
        expected, found = read_study(alone), read_study(one.place.db)
        assert found.trials.equals(expected.trials)
        assert (found.checkpoint, found.meta.hash) == (expected.checkpoint, expected.meta.hash)
        assert (one.evaluations, one.new_evaluations) == (len(expected.trials), len(expected.trials))


@pytest.mark.long
def test_what_fails_says_why_and_stops_nothing_else(tmp_path, monkeypatch):
    head = SMALL.replace("evaluations = 40", "evaluations = 20")
    axes = 'motors = ["Nope.toml", "U8"]\nconstraints = [{}, { mass_kg = { max = 0.1 } }]'
    several = standings(tmp_path, axes, head)
    pids = Killer(monkeypatch, 0).pids
    told = []
    assert run_campaign(several, cores=1, changed=lambda _: None, notify=told.append), told
    reasons = {one.name: one.reason for one in several}
    failing = {"Nope_study", "Nope_mass_kg-max-0.1", "U8_mass_kg-max-0.1"}
    assert states(several) == {"U8_study": "finished"} | dict.fromkeys(failing, "failed"), (reasons, told)
    assert "no such file; check the path" in reasons["Nope_study"]
    assert "mass" in reasons["U8_mass_kg-max-0.1"]
    assert all(map(gone, pids))  # idle workers are let go
    # Ended is ended: only what could not be run is tried again.
    seen = []
    again = standings(tmp_path, axes, head)
    assert run_campaign(again, cores=1, changed=lambda one: seen.append(one.name), notify=lambda _: None)
    assert set(seen) == {"Nope_study", "Nope_mass_kg-max-0.1"}
    assert states(again) == states(several)


class Killer:
    """Kills the worker of a study whenever it has stored a generation, so many times."""

    def __init__(self, monkeypatch, times):
        self.left, self.pids, self.lines = times, [], []
        killer = self

        class Watched(coordinator.Processes):
            def __init__(self, hear):
                super().__init__(hear=hear)
                killer.pids += ids_of(self)

        monkeypatch.setattr(coordinator, "Processes", Watched)

    def __call__(self, one):
        if self.left and one.state == "running" and one.per_second:
            self.left -= 1
            os.kill(self.pids[-1], signal.SIGKILL)


# Killed once and finished, another is in test_kill.py every time.
@pytest.mark.parametrize(("times", "state"), [pytest.param(1, "finished", marks=pytest.mark.long), (2, "failed")])
@pytest.mark.long
def test_a_killed_worker_is_replaced_once(tmp_path, monkeypatch, times, state):
    (one,) = standings(tmp_path, "evaluations = [80]")
    killer = Killer(monkeypatch, times)
    assert run_campaign([one], cores=1, changed=killer, notify=killer.lines.append)
    assert (one.state, one.deaths) == (state, times)
    assert killer.lines == [
        f"{one.name}: its process was ended by SIGKILL; the study goes on later from what is stored"
    ]
    assert ("for the second time" in one.reason) is (state == "failed")
    if state == "finished":
        run(one.place.study, tmp_path / "alone.db", workers=1)
        assert read_study(one.place.db).trials.equals(read_study(tmp_path / "alone.db").trials)
