"""The same study on this process's threads and on executors: identical databases."""

from concurrent.futures import Executor, ThreadPoolExecutor

import pytest

from pareto_monoped.analysis.robustness import robust
from pareto_monoped.analysis.sensitivity import sensitivity
from pareto_monoped.analysis.verify import verify
from pareto_monoped.jump import audit, shared
from pareto_monoped.jump.peers import cluster, processes
from pareto_monoped.storage.reader import read_study
from pareto_monoped.study.run import resume, run
from pareto_monoped.uncertainty.settings import load_uncertainty
from tests.compute.dask_here import DaskHere
from tests.study.same import assert_same_study
from tests.study.support import study_of

UNCERTAINTY = load_uncertainty()
TRIALS = 80
STUDY = study_of(name="s", evaluations=TRIALS, algorithm={"name": "nsga2", "population": 40}, rules="iso6336")
"""Small, with an audit at its end."""


def whole(db, executor=None):
    """The study, begun, continued, made robust, asked what matters, verified: the executor is asked each time."""
    before = 0
    for step in (_begin, _continue, _make_robust, _ask_what_matters, _verify):
        step(db, executor)
        if isinstance(executor, Counting):
            assert executor.tasks > before, step
            before = executor.tasks


def _begin(db, executor):
    run(STUDY, db, workers=2, evaluations=30, executor=executor)


def _continue(db, executor):
    resume(db, workers=2, evaluations=TRIALS, executor=executor)


def _ask_what_matters(db, executor):
    trial = int(read_study(db).front()["trial"].iloc[-1])
    sensitivity(db, trial, UNCERTAINTY, blocks=32, workers=2, executor=executor)


def _verify(db, executor):
    assert verify(db, simulate=20, workers=2, executor=executor).findings == ()


def _make_robust(db, executor):
    front = read_study(db).front()["trial"].tolist()
    robust(db, UNCERTAINTY, trials=front[:1], workers=2, executor=executor)


class Counting(Executor):
    """Counts what it hands on, and knows which functions they are."""

    def __init__(self, inner):
        self.inner, self.tasks, self.functions = inner, 0, set()

    def submit(self, *arguments):
        self.tasks += 1
        self.functions.add(arguments[1])
        return self.inner.submit(*arguments)


@pytest.fixture(scope="module")
def on_threads(tmp_path_factory):
    db = tmp_path_factory.mktemp("threads") / "s.db"
    whole(db)
    return db


@pytest.fixture(scope="module")
def two_processes():
    """Their executor, and what it has told."""
    told = []
    with processes(2, tell=told.append) as crew:
        yield crew, told


@pytest.mark.long
def test_on_two_processes(on_threads, two_processes, tmp_path):
    crew, told = two_processes
    counting = Counting(crew)
    whole(tmp_path / "s.db", counting)
    assert counting.tasks > 6
    assert counting.functions == {shared.jumps_of, audit._balanced_of}
    assert_same_study(on_threads, tmp_path / "s.db")
    assert told == []


@pytest.mark.long
def test_the_default_search_on_two_processes(two_processes, tmp_path):
    """Its model is made here; only what it proposes jumps elsewhere."""
    study = study_of(name="s", evaluations=60, algorithm={"name": "surrogate", "population": 20}, audit=False)
    run(study, tmp_path / "threads.db", workers=2)
    counting = Counting(two_processes[0])
    run(study, tmp_path / "s.db", workers=2, executor=counting)
    assert counting.functions == {shared.jumps_of}
    assert_same_study(tmp_path / "threads.db", tmp_path / "s.db")


@pytest.mark.long
def test_on_an_executor_of_threads(on_threads, tmp_path):
    with ThreadPoolExecutor(2) as pool:
        whole(tmp_path / "s.db", pool)
    assert_same_study(on_threads, tmp_path / "s.db")


def test_audits_after_the_screen_are_done_by_the_executor(tmp_path):
    """Under the paper's calibration the screen clears no design."""
    study = study_of(name="s", evaluations=20, algorithm={"name": "nsga2", "population": 10}, calibration="paper")
    run(study, tmp_path / "threads.db", workers=2)
    with ThreadPoolExecutor(2) as pool:
        counting = Counting(pool)
        run(study, tmp_path / "s.db", workers=2, executor=counting)
    assert counting.functions == {shared.jumps_of, audit._balanced_of}
    assert_same_study(tmp_path / "threads.db", tmp_path / "s.db")


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
