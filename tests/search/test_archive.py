"""Parts of a front and distances behind it, against their definitions, to the last bit."""

import numpy as np
import pytest

from pareto_monoped.pareto.objectives import HEIGHT_AND_ENERGY
from pareto_monoped.search.algorithm import Scores, Space
from pareto_monoped.search.archive import Archive, _posts, shortfall
from pareto_monoped.search.prediction import _in_turns


def staircase(count, objectives, seed):
    """A front of ``count`` designs; the last of two objectives stands twice."""
    front = np.random.default_rng(seed).random((count, objectives))
    if objectives == 2:
        front = np.sort(front, axis=0)
        front[:, 1] = front[::-1, 1]
        front = np.vstack((front, front[-1:]))
    return front


@pytest.mark.parametrize("objectives", [2, 3])
@pytest.mark.parametrize("known", [1, 2, 40])
def test_shortfall_is_the_least_shift_by_definition(known, objectives):
    points, front = np.random.default_rng(known).random((300, objectives)), staircase(known, objectives, known)
    points[:known] = front[:known]  # points on the front, too
    wanted = [max(min(p - f for p, f in zip(point, member, strict=True)) for member in front) for point in points]
    assert shortfall(points, front).tolist() == wanted


def test_posts_are_the_best_and_then_always_the_farthest_from_all_chosen():
    front = staircase(60, 2, 5)[:60]
    posts = _posts(front).tolist()
    assert sorted(posts[:2]) == [0, 59]
    assert len(set(posts)) == len(posts) == 20
    for place in range(2, 20):
        away = [min(((point - front[one]) ** 2).sum() for one in posts[:place]) for point in front]
        assert posts[place] == int(np.argmax(away))


def test_posts_end_where_all_designs_are_equal_to_chosen_ones():
    front = np.array([[0.0, 2.0], [1.0, 1.0], [0.0, 2.0], [2.0, 0.0]])
    assert _posts(front).tolist() == [0, 3, 1]


def test_of_equally_near_posts_and_equally_far_designs_the_first_counts():
    front = np.array([[0.0, 4.0], [1.0, 3.0], [3.0, 1.0], [4.0, 0.0]])
    assert _posts(front).tolist() == [0, 3, 1, 2]


@pytest.mark.parametrize("count", [0, 1, 5, 200])
def test_each_part_has_its_turn(count):
    parts = np.random.default_rng(count).integers(0, 7, count)
    left = {part: [row for row in range(count) if parts[row] == part] for part in range(7)}
    wanted, turn = [], 0
    while len(wanted) < count:
        wanted += sorted(rows[turn] for rows in left.values() if turn < len(rows))
        turn += 1
    assert _in_turns(parts).tolist() == wanted


def test_costs_are_logarithms_by_the_range_of_what_is_feasible():
    """Failed and infeasible designs, however small their energy, do not make the scale of the others."""
    archive = Archive(Space(names=("a",), lower=np.zeros(1), upper=np.ones(1)))
    energies, violation = np.array([30.0, 1e-9, 60.0, 90.0]), np.array([0.0, 2.0, 0.0, 0.0])
    values = np.column_stack(([0.8, 0.9, 1.0, 1.1], energies))
    scores = Scores(objectives=HEIGHT_AND_ENERGY, values=values, violation=violation, constraints=violation[:, None])
    archive.add(np.array([[0.1], [0.2], [0.3], [0.4]]), scores)
    np.testing.assert_allclose(archive.standing().costs[:, 1], np.log(energies))


@pytest.mark.parametrize(("variables", "most"), [(9, 300), (16, 300), (24, 200), (30, 160)])
def test_a_process_leads_as_long_as_designs_and_their_features_are_few(variables, most):
    """Its fit takes time for each feature of each pair of designs."""
    space = Space(names=tuple(f"x{k}" for k in range(variables)), lower=np.zeros(variables), upper=np.ones(variables))
    for count, few in ((most, True), (most + 1, False)):
        archive = Archive(space)
        values = np.random.default_rng(1).random((count, variables))
        points = 1.0 + values[:, :2]
        none = np.zeros((count, 0))
        archive.add(
            values, Scores(objectives=HEIGHT_AND_ENERGY, values=points, violation=none.sum(1), constraints=none)
        )
        assert archive.few is few
