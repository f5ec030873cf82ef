"""The run loop with made evaluations in place of jumps."""

import numpy as np
import pytest

from pareto_monoped.storage.reader import read_study
from pareto_monoped.storage.store import Store
from pareto_monoped.study.session import Interrupt, Session
from tests.study.support import made_database, made_evaluations, made_study

RANDOM = {"name": "random", "population": 10}


def session_of(path, heights, **more):
    """Run a session whose k-th generation jumps to heights[k] on 50 J; the reason it ended and its progress."""
    study = made_study(algorithm=RANDOM, **more)
    if not path.exists():
        made_database(path, [], study)
    given, seen = iter(heights), []

    def evaluate(designs, kits):
        return made_evaluations(np.full(len(designs), next(given)), np.full(len(designs), 50.0))

    with Store(path, study) as store:
        session = Session(read_study(path), study, evaluate, store, study.evaluations, seen.append)
        reason = session.go(Interrupt(lambda line: None))
    return reason, seen


def height_of(volume):
    """Height on 50 J that gives this hypervolume above 0.55 m and 100 J, in m J."""
    return 0.55 + volume / 50.0


@pytest.mark.parametrize(("growth", "evaluations"), [(0.04, 20), (0.06, 40)])
def test_a_plateau_is_a_share_of_the_hypervolume_before(tmp_path, growth, evaluations):
    """The volume grows by 4 or 6 percent per generation from 10 m J; less than 5 percent is a plateau."""
    heights = [height_of(10.0 * (1.0 + growth) ** k) for k in range(4)]
    reason, seen = session_of(
        tmp_path / "s.db", heights, stop={"plateau_evaluations": 10, "plateau_growth": 0.05}, evaluations=40
    )
    assert seen[-1].evaluations == evaluations
    assert reason == ("plateau" if growth < 0.05 else "budget")


def test_progress_counts_the_designs_and_seconds_of_this_session(tmp_path, monkeypatch):
    monkeypatch.setattr(Session, "elapsed", 2.0)
    _, first = session_of(tmp_path / "s.db", [0.7, 0.9], evaluations=20)
    assert [p.per_second for p in first] == [5.0, 10.0]
    assert [p.seconds_left for p in first] == [2.0, 0.0]
    assert [p.at_height.value for p in first] == [None, 50.0]
    _, second = session_of(tmp_path / "s.db", [0.8, 0.8], evaluations=40)
    assert [(p.evaluations, p.budget, p.per_second) for p in second] == [(30, 40, 5.0), (40, 40, 10.0)]
    assert read_study(tmp_path / "s.db").history["seconds"].tolist() == [2.0, 2.0, 4.0, 4.0]


def test_the_hypervolume_counts_feasible_designs_only(tmp_path):
    """A jump on 50 J is infeasible with a limit of 40 J, however high."""
    _, seen = session_of(tmp_path / "s.db", [0.9], evaluations=10, constraints={"max_energy_j": 40.0})
    assert seen[-1].hypervolume == 0.0
    assert seen[-1].at_height.value is None


def test_a_jump_of_exactly_the_headline_height_counts(tmp_path):
    _, seen = session_of(tmp_path / "s.db", [0.8], evaluations=10)
    assert seen[-1].at_height.value == 50.0
