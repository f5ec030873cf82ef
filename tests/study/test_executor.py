"""The same study on this process's threads and on executors: identical databases."""

from concurrent.futures import Executor, ThreadPoolExecutor

import pytest

from pareto_monoped.jump.peers import cluster, processes
from pareto_monoped.study.reader import read_study
from pareto_monoped.study.robustness import robust
from pareto_monoped.study.run import resume, run
from pareto_monoped.uncertainty.ranges import load_uncertainty
from tests.compute.dask_here import DaskHere
from tests.study.same import assert_same_study
from tests.study.support import study_of

UNCERTAINTY = load_uncertainty()
TRIALS = 80
STUDY = study_of(name="s", evaluations=TRIALS, algorithm={"name": "nsga2", "population": 40}, rules="iso6336")
"""Small, with an audit at its end, of which at least one design is not clear after the screen."""


def whole(db, executor=None):
    """The study, begun, continued to its end and made robust."""
    run(STUDY, db, workers=2, evaluations=30, executor=executor)
    resume(db, workers=2, evaluations=TRIALS, executor=executor)
    front = read_study(db).front()["trial"].tolist()
    robust(db, UNCERTAINTY, trials=front[:2], workers=2, executor=executor)


class Counting(Executor):
    """Counts what it hands on."""

    def __init__(self, inner):
        self.inner, self.tasks = inner, 0

    def submit(self, *arguments):
        self.tasks += 1
        return self.inner.submit(*arguments)


@pytest.fixture(scope="module")
def on_threads(tmp_path_factory):
    db = tmp_path_factory.mktemp("threads") / "s.db"
    whole(db)
    return db


def test_on_two_processes(on_threads, tmp_path):
    told = []
    with processes(2, tell=told.append) as crew:
        whole(tmp_path / "s.db", crew)
    assert_same_study(on_threads, tmp_path / "s.db")
    assert told == []


def test_on_an_executor_of_threads(on_threads, tmp_path):
    with ThreadPoolExecutor(2) as pool:
        counting = Counting(pool)
        whole(tmp_path / "s.db", counting)
    assert counting.tasks > 6
    assert_same_study(on_threads, tmp_path / "s.db")


@pytest.mark.long
@pytest.mark.parametrize("workers", [1, 2, 4])
def test_on_dask_workers(on_threads, tmp_path, workers):
    pytest.importorskip("distributed")
    told = []
    with DaskHere(tmp_path, workers=workers) as dask, cluster(dask.address, tell=told.append) as crew:
        crew.submit(int).result(timeout=300)
        told.clear()  # the workers may have been slow to start
        whole(tmp_path / "s.db", crew)
    assert_same_study(on_threads, tmp_path / "s.db")
    assert told == []


class Killing(Counting):
    """Kills a worker at its task of a number, and lets another one join."""

    def __init__(self, inner, dask, at):
        super().__init__(inner)
        self.dask, self.at = dask, at

    def submit(self, *arguments):
        future = super().submit(*arguments)
        if self.tasks == self.at:
            self.dask.workers[0].kill()
            self.dask.workers.append(self.dask.add())
        return future


@pytest.mark.long
@pytest.mark.parametrize("at", [2, 7])
def test_on_dask_workers_one_of_which_is_killed_while_another_joins(on_threads, tmp_path, at):
    pytest.importorskip("distributed")
    told = []
    with DaskHere(tmp_path, workers=2) as dask, cluster(dask.address, tell=told.append) as crew:
        crew.submit(int).result(timeout=300)
        told.clear()  # the workers may have been slow to start
        whole(tmp_path / "s.db", Killing(crew, dask, at))
    assert_same_study(on_threads, tmp_path / "s.db")
    assert len(told) <= 1
