"""Climbs on the model: what they promise against the model itself, and where they lead on a known function."""

import numpy as np
import pytest

from pareto_monoped.pareto.objectives import HEIGHT_AND_ENERGY
from pareto_monoped.search.algorithm import Gear, Scores, Space
from pareto_monoped.search.archive import Archive
from pareto_monoped.search.prediction import Prediction, gains
from pareto_monoped.search.response_surface import features_of
from pareto_monoped.search.surrogate import climbs
from pareto_monoped.search.variation import spread
from tests.search.gears import ALIKE

SPACE = Space(
    names=("thigh_length_m", "knee_ratio", "damping_n_s_per_m", "torsional_stiffness_n_m_per_rad"),
    lower=np.array([0.3, 0.0, 0.0, 0.0]),
    upper=np.array([0.5, 7.0, 10.0, 50.0]),
    gears={"knee_ratio": tuple(Gear(ratio=4.0 + 0.5 * k, mass_kg=0.5, **ALIKE) for k in range(8))},
)


def jump(values):
    """Height of the link; energy least without damping, but also less at 10 N s/m than at any damping between."""
    x = (values - SPACE.lower) / (SPACE.upper - SPACE.lower)
    lost = 0.1 * x[:, 2] + 0.8 * x[:, 2] * (1.0 - x[:, 2]) + 0.2 * x[:, 1] + 0.1 * np.square(x[:, 3] - 0.4)
    points = np.column_stack((0.6 + 0.4 * x[:, 0], 10.0 * np.exp(x[:, 0] + lost)))
    missed = 0.2 - x[:, 1]
    return Scores(
        objectives=HEIGHT_AND_ENERGY, values=points, violation=np.maximum(missed, 0.0), constraints=missed[:, None]
    )


@pytest.fixture(scope="module")
def model():
    """An archive that knows no design with less damping than 4 N s/m, and the model of it."""
    values = spread(SPACE, 600, np.random.default_rng(1), 0.1)
    values = values[values[:, 2] > 4.0]
    archive = Archive(SPACE)
    archive.add(values, jump(values))
    standing = archive.standing()
    return archive, standing, Prediction(archive, standing, features_of(SPACE))


def test_a_climb_crosses_a_valley_to_the_other_bound(model):
    """From the side of a front with damping 10 N s/m; steps of a tenth of the range all look worse."""
    _, standing, prediction = model
    start = np.array([[0.35, 3.0, 10.0, 20.0], [0.45, 2.0, 9.9, 25.0], [0.4, 2.0, 10.0, 20.0]])
    climbed = climbs(SPACE, start, prediction, standing, np.random.default_rng(2))
    ends = climbed.values[climbed.ends]
    assert ends[:, 2].tolist() == [0.0, 0.0, 0.0]
    assert (jump(ends).violation == 0.0).all()
    before, after = jump(start).values, jump(ends).values
    gained = np.maximum(after[:, 0] - before[:, 0], -np.log(after[:, 1] / before[:, 1]))
    assert gained.min() > 0.05


def test_climbs_say_what_the_model_says_and_never_lead_down(model):
    archive, standing, prediction = model
    # Some have climbed before, so that most changes lead down.
    start = archive.values[:30]
    for seed in (5, 6):
        before = climbs(SPACE, start[:10], prediction, standing, np.random.default_rng(seed))
        start = np.vstack((before.values[before.ends], start[10:]))
    climbed = climbs(SPACE, start, prediction, standing, np.random.default_rng(3))
    costs, violation = prediction.fine(climbed.values)
    assert climbed.costs == pytest.approx(costs, rel=1e-9)
    assert climbed.violation == pytest.approx(violation, rel=1e-9, abs=1e-12)
    assert (SPACE.snap(climbed.values) == climbed.values).all()
    assert (climbed.values >= SPACE.lower).all()
    assert (climbed.values <= SPACE.upper).all()
    promised = gains(climbed.costs, climbed.violation, standing)
    began = gains(*prediction.fine(start), standing)
    assert (promised[climbed.ends] >= began - 1e-9).all()
    # No change is looked at, too, after the others.
    assert (climbed.values.reshape(3, len(start), -1, 4)[0, :, -1] == start).all()
    # Each climb ends at the best that it has looked at: the rows of a round stand together, climb by climb.
    rounds = promised.reshape(3, len(start), -1)
    assert promised[climbed.ends] == pytest.approx(rounds.max(axis=(0, 2)), rel=1e-9)


def test_the_same_generator_climbs_alike(model):
    archive, standing, prediction = model
    first, second = (
        climbs(SPACE, archive.values[:5], prediction, standing, np.random.default_rng(4)) for _ in range(2)
    )
    assert (first.values == second.values).all()
    assert first.ends.tolist() == second.ends.tolist()


@pytest.mark.parametrize(
    ("variables", "designs", "climbed"), [(16, 1000, True), (16, 900, False), (17, 1000, False), (17, 280, True)]
)
def test_climbs_follow_a_process_or_a_cubic_but_no_quadratic(variables, designs, climbed):
    """A cubic of 16 variables has 969 terms. Climbs on quadratics made searches of 25 variables worse."""
    space = Space(names=tuple(f"x{k}" for k in range(variables)), lower=np.zeros(variables), upper=np.ones(variables))
    values = spread(space, designs, np.random.default_rng(4))
    points = np.column_stack((0.5 + values[:, 0], 10.0 + (values**2).sum(axis=1)))
    archive = Archive(space)
    none = np.zeros(designs)
    archive.add(values, Scores(objectives=HEIGHT_AND_ENERGY, values=points, violation=none, constraints=none[:, None]))
    assert Prediction(archive, archive.standing(), features_of(space)).determined == climbed
