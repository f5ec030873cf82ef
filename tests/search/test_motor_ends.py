"""The ends of the fronts of motors that a search has hardly tried."""

from dataclasses import replace

import numpy as np
import pytest

from pareto_monoped.definition.algorithms import SurrogateSettings
from pareto_monoped.definition.study import load_study
from pareto_monoped.definition.study_file import shipped_studies
from pareto_monoped.pareto.objectives import HEIGHT_AND_ENERGY, Objectives
from pareto_monoped.search.algorithm import Gear, MotorChoice, MotorKind, Scores, Space
from pareto_monoped.search.archive import Archive
from pareto_monoped.search.prediction import Prediction
from pareto_monoped.search.response_surface import features_of
from pareto_monoped.search.surrogate import SurrogateSearch, ends_of_least_tried
from pareto_monoped.search.variation import spread
from pareto_monoped.storage.reader import read_study
from pareto_monoped.study.run import run
from tests.search.gears import ALIKE

GEARS = tuple(Gear(ratio=4.0 + 0.5 * k, mass_kg=0.4 + 0.02 * k, **ALIKE) for k in range(8))
MOTORS = tuple(
    MotorKind(name=name, peak_torque_n_m=torque, no_load_speed_rad_per_s=40.0, gears={"knee_ratio": GEARS})
    for name, torque in (("light", 5.0), ("middle", 10.0), ("heavy", 20.0))
)
SPACE = Space(
    names=("thigh_length_m", "knee_ratio", "damping_n_s_per_m", "knee_motor"),
    lower=np.array([0.3, 0.0, 0.0, 0.0]),
    upper=np.array([0.5, 1.0, 10.0, 2.0]),
    choices=(MotorChoice(name="knee_motor", motors=MOTORS),),
)


def jump(values):
    """Only the heavy motor jumps highest, with a long thigh alone; the gearbox must not be one of the first two."""
    x = (values - SPACE.lower) / (SPACE.upper - SPACE.lower)
    high = 0.6 + 0.2 * x[:, 3] + 0.4 * x[:, 0] * (0.5 + x[:, 3]) - 0.1 * x[:, 2]
    missed = 0.2 - x[:, 1]
    return Scores(
        objectives=HEIGHT_AND_ENERGY,
        values=np.column_stack((high, 10.0 * np.exp(x[:, 0] + x[:, 3]))),
        violation=np.maximum(missed, 0.0),
        constraints=missed[:, None],
    )


def known(counts):
    """An archive with so many designs of each motor."""
    values = spread(SPACE, 900, np.random.default_rng(1))
    archive = Archive(SPACE)
    rows = [np.flatnonzero(values[:, 3] == motor)[:count] for motor, count in enumerate(counts)]
    archive.add(values[np.concatenate(rows)], jump(values[np.concatenate(rows)]))
    return archive


def ends_of(archive, seed=2):
    features, standing = features_of(SPACE), archive.standing()
    prediction = Prediction(archive, standing, features)
    return list(ends_of_least_tried(features, archive, standing, prediction, np.random.default_rng(seed)))


@pytest.mark.parametrize(("counts", "motor"), [((60, 60, 12), 2.0), ((60, 12, 60), 1.0), ((12, 12, 60), 0.0)])
def test_it_is_the_motor_with_the_fewest_designs(counts, motor):
    for found in ends_of(known(counts)):
        assert len(found) > 100
        assert set(found[:, 3]) == {motor}
        assert (SPACE.snap(found) == found).all()
        assert (found >= SPACE.lower).all()
        assert (found <= SPACE.upper).all()


def test_they_lead_beyond_the_motors_best_design_in_each_objective():
    archive = known((200, 200, 12))
    mine = archive.values[archive.values[:, 3] == 2.0]
    scores = jump(mine)
    holds = scores.values[scores.violation == 0.0]
    highest, cheapest = ends_of(archive)
    reached = [jump(found[:2]) for found in (highest, cheapest)]
    assert reached[0].values[:, 0].max() > holds[:, 0].max() + 0.01
    assert reached[1].values[:, 1].min() < holds[:, 1].min() - 0.1
    assert all((scores.violation == 0.0).any() for scores in reached)


def test_a_motor_that_never_jumped_is_left_to_chance():
    """It has no design to begin with, and would take the turn of all others for ever."""
    archive = known((60, 12, 0))
    for found in ends_of(archive):
        assert set(found[:, 3]) == {1.0}


@pytest.mark.parametrize("population", [4, 10])
def test_a_small_generation_of_three_objectives_keeps_its_size(population):
    """Two designs per objective would be more than it has; half of them, after those drawn."""
    three = Objectives(names=("height_m", "energy_j", "mass_kg"))
    space = replace(SPACE, objectives=three)
    search = SurrogateSearch(space, SurrogateSettings(name="surrogate", population=population), seed=3)
    for generation in range(15):
        proposal = search.ask()
        assert len(proposal.values) == (population if generation < 2 else population // 2)
        scores = jump(proposal.values)
        mass = 3.0 + 0.5 * proposal.values[:, 3:] + 0.2 * proposal.values[:, :1]
        search.tell(replace(scores, objectives=three, values=np.hstack((scores.values, mass))))


@pytest.mark.long
def test_no_motor_is_given_up_by_a_search_over_six(tmp_path):
    """The heaviest motor, which alone jumps above 1.46 m, had 9 of the 1,080 designs after those drawn at first."""
    study = replace(load_study(shipped_studies()["any_motor"]), audit=False)
    run(study, tmp_path / "any.db", evaluations=600)
    trials = read_study(tmp_path / "any.db").trials
    later = trials[trials["trial"] >= 120]["motor"].value_counts()
    assert len(later) == 6
    assert later.min() >= 20
