"""The fast NSGA-II asks for what pymoo's own asks for, to the last bit, and keeps the same state."""

import json

import numpy as np
import pytest

from pareto_monoped.definition.algorithms import EvolutionSettings
from pareto_monoped.pareto.objectives import HEIGHT_AND_ENERGY, Objectives
from pareto_monoped.search.algorithm import Gear, MotorChoice, MotorKind, Scores, Space
from pareto_monoped.search.evolution import Evolution
from pareto_monoped.search.nsga2 import Nsga2

GEARS = tuple(Gear(ratio=4.0 + k, mass_kg=0.5) for k in range(6))
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


def same(first, second):
    return json.dumps(first.state()) == json.dumps(second.state())


@pytest.mark.parametrize("population", [4, 10, 40])
@pytest.mark.parametrize(("feasible", "digits"), [(0.8, 12), (0.3, 1), (-1.0, 1)], ids=("most", "few", "none"))
@pytest.mark.parametrize("name", SPACES)
def test_it_asks_for_what_pymoo_asks_for(name, feasible, digits, population):
    """Of 36 designs, "whole" comes to an end; the state is pymoo's at every step, and leads on from there."""
    space, settings = SPACES[name], EvolutionSettings(name="nsga2", population=population)
    reference, fast = Evolution(space, settings, 5), Nsga2(space, settings, 5)
    history = []
    for generation in range(12):
        assert same(fast, reference)
        if generation == 6:
            state = json.loads(json.dumps(reference.state()))
            fast = Nsga2(space, settings, 9)
            fast.restore(state, iter(history))
        expected, asked = reference.ask(), fast.ask()
        if expected is None:
            assert asked is None
            assert name == "whole"
            break
        assert np.array_equal(asked.values, expected.values)
        scores = scored(space, asked.values, feasible=feasible, digits=digits)
        reference.tell(scores)
        fast.tell(scores)
        history.append((asked.values, scores))
    else:
        assert name != "whole" or population == 4


def test_a_population_of_another_shape_is_refused():
    settings = EvolutionSettings(name="nsga2", population=4)
    fast = Nsga2(PLAIN, settings, 1)
    fast.tell(scored(PLAIN, fast.ask().values, feasible=1.0, digits=12))
    state = fast.state()
    state["F"] = [row[:1] for row in state["F"]]
    with pytest.raises(ValueError, match=r"^F of the population has the shape \(4, 1\), must be \(4, 2\)$"):
        Nsga2(PLAIN, settings, 1).restore(state, iter(()))


def test_what_is_asked_is_not_the_search_s_own():
    """Who changes the designs that were asked for does not change the search."""
    settings = EvolutionSettings(name="nsga2", population=4)
    first, second = Nsga2(PLAIN, settings, 1), Nsga2(PLAIN, settings, 1)
    scores = scored(PLAIN, second.ask().values, feasible=1.0, digits=12)
    first.ask().values[:] = 0.5
    first.tell(scores)
    second.tell(scores)
    assert same(first, second)
    assert scores.objectives == HEIGHT_AND_ENERGY
