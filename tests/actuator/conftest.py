import pytest

from pareto_monoped.actuator.motors import load_motor
from pareto_monoped.actuator.search import map_for
from pareto_monoped.actuator.settings import ActuatorSettings


@pytest.fixture(scope="session")
def settings():
    return ActuatorSettings(rules="paper")


@pytest.fixture(scope="session")
def vt8020():
    return load_motor("VT8020")


@pytest.fixture(scope="session")
def vt_map():
    return map_for("VT8020", "paper")
