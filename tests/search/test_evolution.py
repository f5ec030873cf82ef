"""pymoo's algorithms go on from their states in every kind of space, and ask for no design twice."""

import json

import numpy as np
import pytest

from pareto_monoped.definition.algorithms import EvolutionSettings
from pareto_monoped.pareto.objectives import Objectives
from pareto_monoped.search.algorithm import Gear, MotorChoice, MotorKind, Scores, Space
from pareto_monoped.search.evolution import Evolution
from tests.search.gears import ALIKE

GEARS = tuple(Gear(ratio=4.0 + k, mass_kg=0.5, **ALIKE) for k in range(6))
MOTORS = tuple(
    MotorKind(name=name, peak_torque_n_m=1.0, no_load_speed_rad_per_s=40.0, gears={"knee_ratio": GEARS[:count]})
    for name, count in (("A", 4), ("B", 6))
)
PLAIN = Space(names=("a", "b", "c"), lower=np.array([0.0, 4.0, -1e-16]), upper=np.array([1e-15, 9.0, 1e3]))
OF_THREE = Space(
    names=("a", "b", "c"),
    lower=np.zeros(3),
    upper=np.array([1.0, 2.0, 3.0]),
    objectives=Objectives(names=("height_m", "energy_j", "mass_kg")),
)
WITH_GEARS = Space(
    names=("a", "knee_ratio"), lower=np.zeros(2), upper=np.array([1.0, 5.0]), gears={"knee_ratio": GEARS}
)
WITH_MOTORS = Space(
    names=("a", "knee_ratio", "motor"),
    lower=np.zeros(3),
    upper=np.ones(3),
    choices=(MotorChoice(name="motor", motors=MOTORS),),
)
ALL_WHOLE = Space(
    names=("hip_ratio", "knee_ratio"),
    lower=np.zeros(2),
    upper=np.array([5.0, 5.0]),
    gears={"hip_ratio": GEARS, "knee_ratio": GEARS},
)
SPACES = {"plain": PLAIN, "three": OF_THREE, "gears": WITH_GEARS, "motors": WITH_MOTORS, "whole": ALL_WHOLE}


def scored(space, values, *, feasible, digits):
    """Scores that conflict; rounded, so that equal ones occur, and with designs that miss a limit or fail."""
    unit = (values - space.lower) / (space.upper - space.lower)
    f1 = unit[:, 0]
    others = [(1.0 + unit[:, -1] + k * unit[:, 1]) * (1.2 - f1) for k in range(1, len(space.objectives.names))]
    objectives = np.round(np.column_stack((f1, *others)), digits)
    violation = np.round(np.maximum(0.0, unit[:, 1] - feasible), 2)
    failed = unit[:, -1] > 0.9
    objectives[failed], violation[failed] = np.nan, 100.0
    return Scores(objectives=space.objectives, values=objectives, violation=violation, constraints=violation[:, None])


def searched(space, settings, *, feasible, digits, restored):
    """Some generations and the last state; ``restored``: each by a new algorithm that goes on from the last state."""
    algorithm, history = Evolution(space, settings, 5), []
    for generation in range(12 if space is SPACES["whole"] else 8):
        if restored and generation:
            state = json.loads(json.dumps(algorithm.state()))
            algorithm = Evolution(space, settings, 9)
            algorithm.restore(state, iter(history))
            assert json.loads(json.dumps(algorithm.state())) == state
        proposal = algorithm.ask()
        if proposal is None:
            break
        scores = scored(space, proposal.values, feasible=feasible, digits=digits)
        algorithm.tell(scores)
        history.append((proposal.values, scores))
    return np.vstack([values for values, _ in history]), algorithm.state()


FEASIBLE = {"most": (0.8, 12), "few": (0.3, 1), "none": (-1.0, 1)}
"""How much is feasible, and how many digits scores have; rounded ones are equal now and then."""
ONCE = ("sms_emoa", "whole")
"""The end of a space is the same code for both, and takes a second: every time with NSGA-II alone."""
CASES = [
    pytest.param(name, space, *how, population, id=f"{name}-{space}-{many}-{population}", marks=marks)
    for name in ("nsga2", "sms_emoa")
    for space in SPACES
    for many, how in FEASIBLE.items()
    for population in (4, 10)
    for marks in [
        ()
        if (many, population) == (("most", 10) if space == "whole" else ("few", 4)) and (name, space) != ONCE
        else pytest.mark.long
    ]
]


@pytest.mark.parametrize(("name", "space", "feasible", "digits", "population"), CASES)
def test_restored_before_each_generation_it_asks_for_the_same(name, space, feasible, digits, population):
    """Of 36 designs, "whole" comes to an end: pymoo has no new offspring then."""
    settings = EvolutionSettings(name=name, population=population)
    values, state = searched(SPACES[space], settings, feasible=feasible, digits=digits, restored=False)
    again, last = searched(SPACES[space], settings, feasible=feasible, digits=digits, restored=True)
    assert np.array_equal(values, again)
    assert json.dumps(state) == json.dumps(last)
    assert len(np.unique(values, axis=0)) == len(values)
    if space != "whole":
        assert len(values) == 8 * population
    elif population == 10:
        assert len(values) == 36


STORED = {
    "generator": np.random.default_rng(1).bit_generator.state,
    "iteration": 3,
    "X": [[0.0, 4.0, 1.0], [1e-15, 5.0, 2.0], [5e-16, 6.0, 3.0], [0.0, 9.0, 7.5]],
    "F": [[-1.0, 3.0], [-0.5, 2.0], [-0.75, 2.5], [0.0, 0.0]],
    "G": [[0.0], [0.0], [0.0], [0.25]],
    "rank": [0.0, 0.0, 0.0, None],
    "crowding": ["inf", "inf", 2.0, None],
}
"""As ``nsga2.py`` of earlier versions stored it."""


def test_a_state_of_an_earlier_version_is_kept():
    algorithm = Evolution(PLAIN, EvolutionSettings(name="nsga2", population=4), 7)
    algorithm.restore(STORED, iter(()))
    assert json.dumps(algorithm.state()) == json.dumps(STORED)
    assert algorithm.ask().values.shape == (4, 3)


@pytest.mark.parametrize("key", ["X", "F", "G"])
def test_a_population_of_another_shape_is_refused(key):
    algorithm = Evolution(PLAIN, EvolutionSettings(name="nsga2", population=4), 1)
    state = STORED | {key: [[*row, 0.0] for row in STORED[key]]}
    n = len(state[key][0])
    with pytest.raises(
        ValueError, match=rf"^{key} of the population has the shape \(4, {n}\), must be \(4, {n - 1}\)$"
    ):
        algorithm.restore(state, iter(()))


def test_what_is_asked_is_not_the_search_s_own():
    """Who changes the designs that were asked for does not change the search."""
    settings = EvolutionSettings(name="nsga2", population=4)
    first, second = Evolution(PLAIN, settings, 1), Evolution(PLAIN, settings, 1)
    scores = scored(PLAIN, second.ask().values, feasible=1.0, digits=12)
    first.ask().values[:] = 0.5
    first.tell(scores)
    second.tell(scores)
    assert json.dumps(first.state()) == json.dumps(second.state())
