import dataclasses

import pytest

from pareto_monoped.actuator.search import map_for
from pareto_monoped.leg.dimensions import CHAIN_DRIVES, leg_dimensions


@pytest.fixture(scope="session")
def leg():
    return leg_dimensions(map_for("VT8020"))


@pytest.fixture(scope="session", params=CHAIN_DRIVES, ids=lambda drive: drive.name)
def leg_of_each_chain(request, leg):
    return dataclasses.replace(leg, chain=request.param)
