"""A search algorithm of the user's own, by asking and telling it; it is rebuilt from what is stored."""

import shutil
import sqlite3

import numpy as np
import pandas as pd
import pytest

import pareto_monoped as pm
from pareto_monoped.cli import _run as cli
from pareto_monoped.errors import StudyError
from pareto_monoped.search.algorithm import Proposal

STUDY = pm.Study.define(name="own", evaluations=50, audit=False, strength=False)


class Climber:
    """Steps from the best design so far."""

    def __init__(self, space, seed):
        self.lower, self.upper = space.edges
        self.random = np.random.default_rng(seed)
        self.asked, self.best, self.least = None, 0.5 * (self.lower + self.upper), np.inf

    def ask(self):
        steps = 0.2 * (self.upper - self.lower) * self.random.standard_normal((20, len(self.lower)))
        self.asked = np.clip(self.best + steps, self.lower, self.upper)
        return self.asked

    def tell(self, scores):
        costs = scores.minimised()[:, 1] + 1000.0 * scores.violation
        if costs.min() < self.least:
            self.best, self.least = self.asked[np.argmin(costs)], costs.min()


def other(space, seed):
    return Climber(space, seed + 1)


other.__name__ = "Climber"


def content(path):
    """All rows of a database; opening it for writing changes a counter in its header."""
    connection = sqlite3.connect(path)
    rows = list(connection.iterdump())
    connection.close()
    return rows


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    return pm.run(STUDY, tmp_path_factory.mktemp("own") / "own.db", algorithm=Climber)


@pytest.fixture(scope="module")
def half_once(tmp_path_factory):
    return pm.run(STUDY, tmp_path_factory.mktemp("own") / "half.db", algorithm=Climber, evaluations=30).path


@pytest.fixture
def half(half_once, tmp_path):
    return shutil.copy(half_once, tmp_path / "half.db")


def test_an_own_algorithm_learns_from_its_scores(whole):
    assert whole.study.algorithm.name == "own:Climber"
    assert len(whole.trials) == 50
    space = whole.data.coordinates.space
    twin = Climber(space, STUDY.seed)
    values = whole.data.coordinates.values(whole.trials[list(STUDY.variables)].to_numpy())
    np.testing.assert_allclose(values[:20], space.snap(twin.ask()))


def test_it_is_asked_and_told_again_when_the_study_goes_on(whole, half):
    again = pm.resume(half, evaluations=50, algorithm=Climber)
    pd.testing.assert_frame_equal(again.trials, whole.trials, check_exact=True)


def test_an_object_goes_on_where_a_fresh_one_is_given(whole, half):
    space = whole.data.coordinates.space
    used = Climber(space, STUDY.seed)
    used.ask()
    with pytest.raises(StudyError, match="asks for other designs in generation 0"):
        pm.resume(half, evaluations=50, algorithm=used)
    again = pm.resume(half, evaluations=50, algorithm=Climber(space, STUDY.seed))
    pd.testing.assert_frame_equal(again.trials, whole.trials, check_exact=True)


def test_another_algorithm_is_refused_and_the_study_stays(half, capsys):
    before = content(half)
    for given, words in (
        (None, "only your program has it"),
        (other, "asks for other designs in generation 0"),
        (test_an_own_algorithm_learns_from_its_scores, "is given; give the one that it began with"),
    ):
        with pytest.raises(StudyError, match=words) as caught:
            pm.resume(half, evaluations=50, algorithm=given)
        assert "\n" not in str(caught.value)
    assert cli(["resume", str(half), "--evaluations", "50"]) == 2
    assert "pareto_monoped.resume(db, algorithm=...)" in capsys.readouterr().err
    assert content(half) == before


def test_other_designs_in_a_generation_that_was_cut_short_are_noticed(half):
    class Late(Climber):
        def ask(self):
            self.calls = getattr(self, "calls", 0) + 1
            return super().ask() if self.calls < 2 else 0.999 * super().ask() + 0.001 * self.lower

    Late.__name__ = "Climber"
    with pytest.raises(StudyError, match="asks for other designs in trials 20 to 29"):
        pm.resume(half, evaluations=50, algorithm=Late)


@pytest.mark.parametrize(("share", "same"), [(1e-12, True), (1e-6, False)])
@pytest.mark.parametrize("calls", [1, 2], ids=["whole generations", "one that was cut short"])
def test_one_rule_says_which_designs_are_the_stored_ones(half, whole, calls, share, same):
    """A generation that was cut short had to be equal to the last bit, a whole one to nine digits."""

    class Rounded(Climber):
        def ask(self):
            self.calls = getattr(self, "calls", 0) + 1
            asked = super().ask()
            return asked + share * (np.mean((self.lower, self.upper), 0) - asked) if self.calls == calls else asked

    Rounded.__name__ = "Climber"
    if same:
        assert len(pm.resume(half, evaluations=50, algorithm=Rounded).trials) == 50
    else:
        with pytest.raises(StudyError, match="asks for other designs in"):
            pm.resume(half, evaluations=50, algorithm=Rounded)


def test_an_own_algorithm_for_a_study_of_the_package_is_refused(tmp_path):
    stored = pm.run(pm.Study.define(name="s", evaluations=20, algorithm="random"), tmp_path / "s.db")
    with pytest.raises(StudyError, match="the study's is 'random'"):
        pm.resume(stored.path, evaluations=40, algorithm=Climber)


def test_one_that_ends_before_the_stored_trials_is_refused_in_one_line(whole, tmp_path):
    class Short(Climber):
        def ask(self):
            return super().ask() if self.asked is None else None

    Short.__name__ = "Climber"
    db = shutil.copy(whole.path, tmp_path / "whole.db")
    with pytest.raises(StudyError, match="asks for other designs in generation 1"):
        pm.resume(db, evaluations=70, algorithm=Short)


def test_it_may_end_by_itself(tmp_path):
    class Once(Climber):
        def ask(self):
            return Proposal(values=super().ask()) if self.asked is None else None

    stored = pm.run(STUDY, tmp_path / "once.db", algorithm=Once)
    assert (len(stored.trials), stored.data.meta.stop_reason) == (20, "exhausted")


WRONG = {
    "words": (lambda self: "far away", "must be None, or designs"),
    "one design": (lambda self: self.lower, "shape of ask"),
    "no design": (lambda self: np.zeros((0, len(self.lower))), "shape of ask"),
    "too few variables": (lambda self: self.lower[None, 1:], "thigh_length_m, shank_length_m"),
    "beyond a bound": (lambda self: self.upper[None] + 1.0, "must be 0.3 to 0.5"),
    "no number": (lambda self: self.upper[None] * np.nan, "must be 0.3 to 0.5"),
    "a fault": (lambda self: self.nothing, "AttributeError"),
}


@pytest.mark.parametrize(("ask", "words"), WRONG.values(), ids=WRONG.keys())
def test_what_it_asks_is_checked(ask, words, tmp_path):
    kind = type("Wrong", (Climber,), {"ask": ask})
    with pytest.raises(StudyError, match=words) as caught:
        pm.run(STUDY, tmp_path / "wrong.db", algorithm=kind)
    assert "\n" not in str(caught.value)
    assert "own algorithm 'Wrong'" in str(caught.value)


@pytest.mark.parametrize("given", [5, object(), [Climber], lambda space, seed: Climber(space, seed)])
def test_what_is_no_algorithm_is_refused(given, tmp_path):
    with pytest.raises(StudyError) as caught:
        pm.run(STUDY, tmp_path / "none.db", algorithm=given)
    assert "\n" not in str(caught.value)
    assert list(tmp_path.iterdir()) == []
