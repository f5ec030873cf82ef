"""A PostgreSQL server for the tests of this folder, started once per process and stopped at its end."""

import itertools

import pytest

from pareto_monoped.storage.place import place_of

_NUMBERS = itertools.count()


@pytest.fixture(scope="session")
def cluster():
    pytest.importorskip("psycopg", reason="the extra postgres is not installed")
    from tests.storage.server.cluster import Cluster, programs

    bin_folder = programs()
    if bin_folder is None:
        pytest.skip("PostgreSQL's server (initdb) is not installed")
    made = Cluster(bin_folder)
    yield made
    made.remove()


@pytest.fixture
def address(cluster):
    """The address of a new study."""
    return cluster.address(f"study_{next(_NUMBERS)}")


@pytest.fixture
def place(address):
    return place_of(address)
