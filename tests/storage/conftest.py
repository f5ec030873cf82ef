"""New places on every storage for tests; the PostgreSQL server is started once per process and stopped at its end."""

import itertools
import sqlite3
from contextlib import closing
from pathlib import Path

import optuna
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
    """The address of a new study on the server."""
    return cluster.address(f"study_{next(_NUMBERS)}")


@pytest.fixture
def place(address):
    """The place of a new study on the server."""
    return place_of(address)


@pytest.fixture(params=["file", "server"])
def db(request, tmp_path):
    """The place of a new study on every storage."""
    return tmp_path / "s.db" if request.param == "file" else request.getfixturevalue("place")


@pytest.fixture
def sql(request, db):
    """A function that runs statements on ``db`` without any code of the package; the rows of the last one."""
    if not isinstance(db, Path):
        return lambda *statements: request.getfixturevalue("cluster").sql(
            f"SET search_path TO {db.schema}", *statements
        )

    def in_file(*statements):
        with closing(sqlite3.connect(db)) as connection:
            rows = [connection.execute(statement).fetchall() for statement in statements]
            connection.commit()
        return rows[-1]

    return in_file


@pytest.fixture
def load(request, db):
    """A function that loads the study of a name in ``db`` as any user of Optuna does."""
    opened, url = [], f"sqlite:///{db}"
    if not isinstance(db, Path):
        cluster = request.getfixturevalue("cluster")
        url = f"postgresql+psycopg://owner@/team?host={cluster.folder}&options=-csearch_path%3D{db.schema}"

    def loaded(name="made"):
        optuna.logging.set_verbosity(optuna.logging.WARNING)
        opened.append(optuna.storages.RDBStorage(url))
        return optuna.load_study(study_name=name, storage=opened[-1])

    yield loaded
    for storage in opened:
        storage.remove_session()
        storage.engine.dispose()
