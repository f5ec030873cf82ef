"""A campaign whose jumps are simulated by the workers of a real Dask scheduler."""

from importlib.util import find_spec

import pytest

from pareto_monoped.campaign.coordinator import run_campaign
from pareto_monoped.compute.cluster import threads_of
from pareto_monoped.errors import WorkerError
from pareto_monoped.storage.reader import read_study
from pareto_monoped.study.run import run
from tests.campaign.test_coordinator import SMALL, standings
from tests.compute.dask_here import DaskHere, until

pytestmark = pytest.mark.skipif(
    find_spec("distributed") is None, reason="Dask is not installed; pip install 'pareto-monoped[cluster]'"
)


@pytest.mark.parametrize("cores", [pytest.param(None, marks=pytest.mark.long), 2])
def test_a_scheduler_that_does_not_answer_is_told_once_before_any_study(tmp_path, monkeypatch, cores):
    """Each study tried to connect by itself, and said so twice."""
    monkeypatch.setattr("pareto_monoped.compute.cluster._CONNECT_S", 1.0)
    several, changes = standings(tmp_path, "seeds = [1, 2]", SMALL), []
    with pytest.raises(WorkerError, match=r"^scheduler tcp://127.0.0.1:1: does not answer"):
        run_campaign(several, cores=cores, scheduler="tcp://127.0.0.1:1", changed=changes.append, notify=changes.append)
    assert changes == []
    assert [one.state for one in several] == ["waiting", "waiting"]


def test_a_campaign_that_has_ended_needs_no_scheduler(tmp_path):
    assert run_campaign([], scheduler="tcp://127.0.0.1:1", changed=lambda _: None, notify=lambda _: None)


@pytest.mark.long
def test_as_many_studies_run_as_the_scheduler_has_threads_and_equal_those_run_alone(tmp_path, monkeypatch):
    """It was as many as the coordinator has cores."""
    monkeypatch.setattr("pareto_monoped.campaign.coordinator.cores_here", lambda: 1)
    several, most = standings(tmp_path, "seeds = [1, 2]", SMALL.replace("40", "20")), []
    with DaskHere(tmp_path) as here:
        here.workers += [here.add(threads=2)]
        until(lambda: threads_of(here.address) == 2)
        assert run_campaign(
            several,
            scheduler=here.address,
            changed=lambda _: most.append([one.state for one in several].count("running")),
            notify=lambda _: None,
        )
    assert max(most) == 2
    for one in several:
        assert (one.state, one.reason) == ("finished", "")
        alone = tmp_path / f"{one.name}.db"
        run(one.place.study, alone, workers=1)
        assert read_study(one.place.db).trials.equals(read_study(alone).trials)
