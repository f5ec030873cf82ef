"""A campaign whose jumps are simulated by the workers of a real Dask scheduler."""

from importlib.util import find_spec

import pytest

from pareto_monoped.campaign.coordinator import run_campaign
from pareto_monoped.study.reader import read_study
from pareto_monoped.study.run import run
from tests.campaign.test_coordinator import SMALL, standings
from tests.compute.dask_here import DaskHere

pytestmark = pytest.mark.skipif(
    find_spec("distributed") is None, reason="Dask is not installed; pip install 'pareto-monoped[cluster]'"
)


@pytest.fixture
def scheduler(tmp_path):
    """The address of a scheduler with one worker."""
    with DaskHere(tmp_path, workers=1) as here:
        yield here.address


def test_equal_to_studies_run_alone(tmp_path, scheduler):
    several = standings(tmp_path, "seeds = [1, 2]", SMALL.replace("40", "20"))
    assert run_campaign(several, cores=2, scheduler=scheduler, changed=lambda _: None, notify=lambda _: None)
    for one in several:
        assert (one.state, one.reason) == ("finished", "")
        alone = tmp_path / f"{one.name}.db"
        run(one.place.study, alone, workers=1)
        assert read_study(one.place.db).trials.equals(read_study(alone).trials)


def test_a_scheduler_that_does_not_answer_is_the_reason_of_every_study(tmp_path):
    several = standings(tmp_path, "seeds = [1]", SMALL)
    assert run_campaign(several, cores=1, scheduler="tcp://127.0.0.1:1", changed=lambda _: None, notify=lambda _: None)
    assert several[0].state == "failed"
    assert "127.0.0.1:1" in several[0].reason
