import numpy as np
import pytest

from pareto_monoped.actuator.search import map_for
from pareto_monoped.design import LOWER, UPPER
from pareto_monoped.robot.population import robot_arrays


@pytest.fixture(scope="session")
def actuator_map():
    return map_for("VT8020")


@pytest.fixture(scope="session")
def designs():
    return np.random.default_rng(7).uniform(LOWER, UPPER, (24, len(LOWER)))


@pytest.fixture(scope="session")
def buildable(designs, actuator_map):
    """The rows of ``designs`` that have both gearboxes."""
    rows = [i for i, reason in enumerate(robot_arrays(designs, actuator_map).reason) if not reason]
    assert len(rows) >= 12
    return rows
