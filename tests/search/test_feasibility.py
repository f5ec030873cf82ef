"""Limits and failed jumps steer the surrogate search: what misses a limit promises nothing, failed jumps are learned.

A fixed bug: counted in the extent of a front of two designs, gains outweighed any violation, and a search with three
tight limits found 0 to 2 feasible designs of 200.
"""

from dataclasses import replace

import numpy as np
import pytest

from pareto_monoped.search.archive import Archive
from pareto_monoped.search.prediction import Prediction, gains
from pareto_monoped.search.response_surface import features_of
from pareto_monoped.search.surrogate import SurrogateSearch
from pareto_monoped.search.variation import spread
from tests.search.test_surrogate import SETTINGS, SPACE, archive_of, scored


def fails(values):
    """A third of the space, which the front would reach into."""
    return values[:, 0] > 0.43


def failing(values):
    scores = scored(values)
    wrong = fails(values)
    return replace(
        scores,
        values=np.where(wrong[:, None], np.nan, scores.values),
        violation=np.where(wrong, 100.0, 0.0),
        constraints=np.where(wrong, 100.0, -1.0)[:, None],
    )


@pytest.mark.parametrize(("violation", "promises"), [(0.0, True), (0.009, True), (0.011, False), (0.3, False)])
def test_a_design_that_is_expected_to_miss_a_limit_promises_no_gain(violation, promises):
    standing = archive_of().standing()
    ahead = standing.low - 5.0 * standing.extent  # far better than the front in everything
    assert bool(gains(ahead[None], np.array([violation]), standing)[0] > 0.0) is promises


def test_the_extent_of_two_equal_designs_is_a_tenth_of_what_is_known():
    values = np.unique(spread(SPACE, 200, np.random.default_rng(1)), axis=0)
    scores = scored(values)
    best = np.argsort(scores.values[:, 1])[:2]
    violation = np.ones(len(values))
    violation[best] = 0.0
    archive = Archive(SPACE)
    archive.add(values, replace(scores, violation=violation, constraints=violation[:, None]))
    standing = archive.standing()
    every = np.ptp(np.column_stack((-np.log(scores.values[:, 0]), np.log(scores.values[:, 1]))), axis=0)
    assert standing.extent == pytest.approx(np.maximum(0.1 * every, np.ptp(standing.costs[standing.front], axis=0)))
    assert (standing.extent > np.ptp(standing.costs[best], axis=0)).all()


def test_a_search_with_narrow_limits_stays_where_they_hold():
    """One design of 2,000 reaches 0.9 m on 16 J."""
    algorithm, held = SurrogateSearch(SPACE, SETTINGS, 3), []
    for _ in range(25):
        values = algorithm.ask().values
        scores = scored(values)
        missed = np.column_stack((1.0 - scores.values[:, 0] / 0.9, scores.values[:, 1] / 16.0 - 1.0))
        violation = np.maximum(missed, 0.0).sum(axis=1)
        held.append((violation == 0.0).mean())
        algorithm.tell(replace(scores, violation=violation, constraints=missed))
    assert np.mean(held[:3]) < 0.05
    assert np.mean(held[-10:]) > 0.7


def test_failed_jumps_near_by_count_as_a_violation():
    values = np.unique(spread(SPACE, 400, np.random.default_rng(2)), axis=0)
    archive = Archive(SPACE)
    archive.add(values, failing(values))
    prediction = Prediction(archive, archive.standing(), features_of(SPACE))
    many = spread(SPACE, 2000, np.random.default_rng(8))
    points, known = features_of(SPACE).scaled(many), archive.points
    nearest = np.argsort(((points[:, None] - known[None]) ** 2).sum(axis=2), axis=1)[:, :4]
    share = fails(values)[nearest].mean(axis=1)
    for predict in (prediction.rough, prediction.fine):
        _, violation = predict(many)
        assert violation == pytest.approx(share, abs=1e-12)
    assert share[many[:, 0] > 0.45].min() > 0.2
    assert share[many[:, 0] < 0.40].max() < 0.3


def test_where_hardly_any_jump_fails_no_neighbour_is_looked_for():
    archive = archive_of(300)
    prediction = Prediction(archive, archive.standing(), features_of(SPACE))
    assert prediction._tree is None


def test_a_search_learns_where_jumps_fail():
    algorithm, failed = SurrogateSearch(SPACE, SETTINGS, 4), []
    for _ in range(20):
        values = algorithm.ask().values
        failed.append(fails(values).mean())
        algorithm.tell(failing(values))
    assert np.mean(failed[:3]) > 0.3
    assert np.mean(failed[-8:]) < 0.3


def test_a_fifth_of_a_generation_is_plain_evolution(monkeypatch):
    """Whatever the model thinks of it, if it is not expected to miss a limit."""
    algorithm = SurrogateSearch(SPACE, SETTINGS, 6)
    for _ in range(6):
        values = algorithm.ask().values
        algorithm.tell(scored(values))
    monkeypatch.setattr("pareto_monoped.search.surrogate.ranked", lambda costs, *_: np.arange(len(costs))[::-1])
    upside_down = SurrogateSearch(SPACE, SETTINGS, 6)
    upside_down.restore(algorithm.state(), iter([(algorithm._archive.values, scored(algorithm._archive.values))]))
    asked = upside_down.ask().values
    monkeypatch.undo()
    usual = algorithm.ask().values
    same = (asked[:, None] == usual[None]).all(axis=2).any(axis=1)
    assert same[-4:].all()
    assert not same[:10].all()
