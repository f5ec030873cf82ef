"""Every algorithm behind the same face holds the same promises, on a problem whose front is known."""

import json
from functools import cache

import numpy as np
import pytest

from pareto_monoped.definition.algorithms import ALGORITHMS
from pareto_monoped.definition.study import study_from_dict
from pareto_monoped.pareto.objectives import HEIGHT_AND_ENERGY, Objectives, hypervolume, reference_point
from pareto_monoped.search.algorithm import Scores
from pareto_monoped.search.registry import make_algorithm
from pareto_monoped.search.weighted import weighted_cost

# AGE-MOEA2 compiles itself for some six seconds in every process.
SLOW = {"age_moea2": pytest.mark.long}
NAMES = tuple(pytest.param(name, marks=SLOW.get(name, ())) for name in ALGORITHMS)
LEARNING = tuple(param for param in NAMES if param.values[0] not in ("random", "weighted_cmaes"))
GENETIC = LEARNING[:3]


def study(name, *, seed=1, **more):
    algorithm = {"name": name}
    if name == "weighted_cmaes":
        algorithm |= {"height_weights": [0.3, 0.7], "iterations": 12}
    return study_from_dict({"name": name, "evaluations": 1, "seed": seed, "algorithm": algorithm} | more, source="test")


def zdt1(values, lower, upper):
    """ZDT1 (Zitzler, Deb, Thiele 2000) with 1 - f1 for the height, f2 for the energy, infeasible below f1 = 0.1.

    Its front is f2 = 1 - sqrt(f1); some designs fail, to see that every algorithm takes that.
    """
    unit = (values - lower) / (upper - lower)
    f1 = unit[:, 0]
    g = 1.0 + 9.0 * unit[:, 1:].mean(axis=1)
    f2 = g * (1.0 - np.sqrt(f1 / g))
    failed = unit[:, -1] > 0.97
    violation = np.where(failed, 100.0, np.maximum(0.0, 0.1 - f1))
    values = np.where(failed[:, None], np.nan, np.column_stack((1.0 - f1, f2)))
    return Scores(objectives=HEIGHT_AND_ENERGY, values=values, violation=violation, constraints=violation[:, None])


def free_bounds(definition):
    """Lower and upper bounds of the free variables."""
    free = np.array([name in definition.free for name in definition.variables])
    return definition.lower[free], definition.upper[free]


def search(definition, generations, algorithm=None, history=None, problem=zdt1):
    """Ask and tell; returns the algorithm and [(values, scores)]."""
    algorithm = algorithm or make_algorithm(definition)
    history = [] if history is None else history
    for _ in range(generations):
        proposal = algorithm.ask()
        if proposal is None:
            break
        scores = problem(proposal.values, *free_bounds(definition))
        algorithm.tell(scores)
        history.append((proposal.values, scores))
    return algorithm, history


def designs(history):
    return np.vstack([values for values, _ in history])


# Each generation of Optuna's takes most of the time of a test.
FEW = {"optuna_nsga2": (0, 2), "optuna_tpe": (0, 2)}
GENERATIONS = 15


@cache
def whole(name, *, three=False, long=False):
    """One search of an algorithm: what it asked and was told, and its state as JSON before each generation and last.

    As long as the tests that are not long need it.
    """
    definition, states = study(name, **({"objectives": THREE} if three else {})), []
    algorithm, history = make_algorithm(definition), []
    for _ in range(FEW[name][-1] + 2 if name in FEW and not long else GENERATIONS):
        states.append(json.dumps(algorithm.state()))
        search(definition, 1, algorithm, history, problem=dtlz2 if three else zdt1)
    return definition, history, [*states, json.dumps(algorithm.state())]


@pytest.mark.parametrize("name", NAMES)
def test_asks_for_designs_within_the_bounds(name):
    definition, history, _ = whole(name)
    values = designs(history)
    assert values.shape[1] == 7
    lower, upper = free_bounds(definition)
    assert (values >= lower).all()
    assert (values <= upper).all()


@pytest.mark.parametrize("name", NAMES)
def test_works_in_the_free_variables_only(name):
    definition = study(name, variables={"thigh_length_m": 0.4, "hip_ratio": 5.0})
    assert make_algorithm(definition).ask().values.shape[1] == 5


@pytest.mark.parametrize("name", NAMES)
def test_the_seed_decides_all_and_the_global_random_state_is_left_alone(name):
    first = designs(whole(name)[1][:3])
    np.random.seed(5)  # noqa: NPY002
    before = np.random.get_state()[1].copy()  # noqa: NPY002
    assert np.array_equal(first, designs(search(study(name), 3)[1]))
    assert np.array_equal(before, np.random.get_state()[1])  # noqa: NPY002
    other = search(study(name, seed=2), 1)[1][0][0]
    assert not np.array_equal(first[: len(other)], other)


def restores(names, all_told):
    """Cases of an algorithm and how many generations it was told before; the slow and long ones are marked."""
    cases = []
    for param in names:
        name, marks = (param, ()) if isinstance(param, str) else (param.values[0], param.marks)
        for told in all_told:
            long = told not in FEW.get(name, all_told)
            cases.append(pytest.param(name, told, long, marks=[*marks, *([pytest.mark.long] if long else [])]))
    return cases


@pytest.mark.parametrize(("name", "told", "long"), restores(NAMES, (0, 1, 2, 5, 13)))
def test_restored_from_json_it_goes_on_exactly(name, told, long):
    """For two generations: the second is made by what the restored one was told, too."""
    definition, history, states = whole(name, long=long)
    restored = make_algorithm(definition)
    restored.restore(json.loads(states[told]), iter(history[:told]))
    assert json.dumps(restored.state()) == states[told]
    _, got = search(definition, 2, restored)
    assert len(got) == 2
    for (values, _), (wanted, _) in zip(got, history[told:], strict=False):
        assert np.array_equal(values, wanted)
    assert json.dumps(restored.state()) == states[told + 2]


# That TPE learns, every time: tests/study/test_motor_pairs.py.
@pytest.mark.parametrize(
    "name",
    [
        pytest.param("optuna_tpe", marks=pytest.mark.long) if param.values[0] == "optuna_tpe" else param
        for param in LEARNING
    ],
)
def test_beats_random_search_at_equal_evaluations(name):
    reference = reference_point(HEIGHT_AND_ENERGY, {"height_m": 0.0, "energy_j": 5.0})

    # TPE takes nine tenths of the time that all of them take together at 400.
    def volume(algorithm_name, evaluations=160 if name == "optuna_tpe" else 400):
        definition = study(algorithm_name)
        batch = len(make_algorithm(definition).ask().values)
        _, history = search(definition, evaluations // batch)
        feasible = [s.values[s.violation == 0.0] for _, s in history]
        return hypervolume(np.vstack(feasible), reference)

    assert volume(name) > 1.1 * volume("random")


@pytest.mark.parametrize("name", GENETIC)
def test_infeasible_designs_give_way_to_feasible_ones(name):
    """With the feasible region a tenth of one variable, late generations live in it."""
    definition = study(name, variables={"knee_ratio": 5.0, "hip_ratio": 5.0})
    algorithm = make_algorithm(definition)
    lower, upper = free_bounds(definition)
    for _ in range(25):
        values = algorithm.ask().values
        unit = (values - lower) / (upper - lower)
        violation = np.maximum(0.0, unit[:, 0] - 0.1)
        algorithm.tell(
            Scores(
                objectives=HEIGHT_AND_ENERGY, values=unit[:, 1:3], violation=violation, constraints=violation[:, None]
            )
        )
    assert (violation == 0.0).mean() > 0.8


def test_a_sweep_of_weights_runs_one_after_the_other_and_ends():
    algorithm, history = search(study("weighted_cmaes"), 1000)
    assert len(history) == 2 * 12
    assert algorithm.ask() is None
    assert algorithm.state() == {"run": 2, "iteration": 0}


def test_each_weighted_run_draws_its_own_designs():
    settings = {"name": "weighted_cmaes", "height_weights": [0.5, 0.5], "iterations": 1}
    definition = study_from_dict({"name": "w", "evaluations": 1, "algorithm": settings}, source="test")
    first, second = (values for values, _ in search(definition, 2)[1])
    assert not np.array_equal(first, second)


def test_the_first_weighted_designs_gather_around_the_papers_start_vector():
    """Step 0.1 in scaled variables: the mean of many first designs is the start within a few standard errors."""
    definition = study_from_dict(
        {"name": "w", "evaluations": 1, "algorithm": {"name": "weighted_cmaes", "population": 4000}}, source="test"
    )
    values = make_algorithm(definition).ask().values
    start = np.array([0.4, 0.4, 6.0, 6.0, 50.0, 2.5, 10.0])
    lower, upper = free_bounds(definition)
    extent = upper - lower
    # 0.1 / sqrt(4000) = 0.0016; variables near a bound are folded back into it and shift a little more.
    assert np.abs((values.mean(axis=0) - start) / extent).max() < 0.01
    # Far from the bounds the spread is the step size itself.
    assert np.std((values[:, 0] - 0.4) / 0.2) == pytest.approx(0.1, rel=0.05)


def test_random_search_that_goes_on_asks_for_no_design_of_the_history():
    """Its generator alone would draw the same designs again in a space of few."""
    from pareto_monoped.definition.algorithms import RandomSettings
    from pareto_monoped.search.algorithm import Space
    from pareto_monoped.search.random_search import RandomSearch

    space = Space(names=("a", "b"), lower=np.zeros(2), upper=np.ones(2))
    first, second = (RandomSearch(space, RandomSettings(name="random", population=8), 3) for _ in range(2))
    state, drawn = first.state(), first.ask().values
    second.restore(state, [(drawn[:3], None), (drawn[3:], None)])
    assert not {tuple(row) for row in second.ask().values} & {tuple(row) for row in drawn}


def test_the_weighted_cost_is_the_papers():
    from pareto_monoped.definition.algorithms import WeightedSettings
    from pareto_monoped.search.algorithm import Space
    from pareto_monoped.search.weighted import WeightedSearch

    settings = WeightedSettings(name="weighted_cmaes", height_weights=(0.25,), height_scale_j=80.0)
    space = Space(names=("a", "b"), lower=np.zeros(2), upper=np.ones(2))
    algorithm = WeightedSearch(space, settings, np.full(2, 0.5), 1, reference_point(HEIGHT_AND_ENERGY))
    scores = Scores(
        objectives=HEIGHT_AND_ENERGY,
        values=np.array([[0.8, 20.0], [0.52, 1.0], [np.nan, np.nan]]),
        violation=np.array([0, 0.05, 100]),
        constraints=np.zeros((3, 0)),
    )
    cost = algorithm.cost(scores)
    assert cost[0] == pytest.approx(0.25 * 80.0 * np.exp(-0.8) + 0.75 * 20.0, rel=1e-14)
    # However cheap, a design that misses a constraint costs more than one that holds it; a failed one most.
    assert cost[0] < cost[1] < cost[2] < np.inf


def test_the_default_height_scale_makes_both_terms_equal_at_the_papers_nominal_design():
    from pareto_monoped.definition.algorithms import WeightedSettings

    assert WeightedSettings(name="weighted_cmaes").height_scale_j * np.exp(-0.887) == pytest.approx(31.44, rel=1e-12)


THREE = ["height_m", "electrical_energy_j", "mass_kg"]
OF_THREE = (
    "sms_emoa",
    "nsga2",
    "optuna_nsga2",
    "optuna_tpe",
    "random",
    "surrogate",
    pytest.param("age_moea2", marks=pytest.mark.long),
)


def dtlz2(values, lower, upper):
    """DTLZ2 (Deb, Thiele, Laumanns, Zitzler 2002) of three objectives, the first of them negated for the height."""
    unit = (values - lower) / (upper - lower)
    radius = 1.0 + ((unit[:, 2:] - 0.5) ** 2).sum(axis=1)
    a, b = 0.5 * np.pi * unit[:, 0], 0.5 * np.pi * unit[:, 1]
    columns = (-radius * np.cos(a) * np.cos(b), radius * np.cos(a) * np.sin(b), radius * np.sin(a))
    violation = np.maximum(0.0, 0.05 - unit[:, 0])
    return Scores(
        objectives=Objectives(names=tuple(THREE)),
        values=np.column_stack(columns),
        violation=violation,
        constraints=violation[:, None],
    )


@pytest.mark.parametrize(("name", "told", "long"), restores(OF_THREE, (0, 2, 6)))
def test_with_three_objectives_it_goes_on_exactly_from_json(name, told, long):
    definition, history, states = whole(name, three=True, long=long)
    restored = make_algorithm(definition)
    restored.restore(json.loads(states[told]), iter(history[:told]))
    _, got = search(definition, 2, restored, problem=dtlz2)
    assert len(got) == 2
    for (values, _), (wanted, _) in zip(got, history[told:], strict=False):
        assert np.array_equal(values, wanted)


@pytest.mark.parametrize(
    "name", ["nsga2", *(pytest.param(name, marks=pytest.mark.long) for name in ("sms_emoa", "surrogate"))]
)
def test_with_three_objectives_it_beats_random_search(name):
    reference = reference_point(
        Objectives(names=tuple(THREE)), {"height_m": -2.5, "electrical_energy_j": 2.5, "mass_kg": 2.5}
    )

    def missed(algorithm_name):
        """Volume between the front and the sphere of radius 1, which it cannot pass; mean of three seeds."""
        found = []
        for seed in (1, 2, 3):
            _, history = search(study(algorithm_name, objectives=THREE, seed=seed), 20, problem=dtlz2)
            feasible = [s.values[s.violation == 0.0] for _, s in history]
            found.append(2.5**3 - np.pi / 6.0 - hypervolume(np.vstack(feasible), reference))
        return np.mean(found)

    assert missed(name) < 0.67 * missed("random")


def test_the_weighted_cost_of_another_pair_is_the_sum_of_shares_of_the_reference_point():
    corner = reference_point(Objectives(names=("height_m", "electrical_energy_j")))
    values = np.array([[0.8, 50.0], [1.1, 20.0]])
    cost = weighted_cost(values, 0.25, corner, 80.0)
    expected = [0.25 * -h / 0.55 + 0.75 * e / 200.0 for h, e in values]
    assert cost == pytest.approx(expected, rel=1e-14)


def test_the_weighted_search_runs_on_another_pair():
    more = {"objectives": ["mass_kg", "electrical_energy_j"], "algorithm": {"name": "weighted_cmaes"}}
    definition = study_from_dict({"name": "w", "evaluations": 1} | more, source="test")
    algorithm = make_algorithm(definition)
    objectives, violation = definition.objectives, np.zeros(8)
    lower, upper = free_bounds(definition)
    first = None
    for _ in range(25):
        unit = (algorithm.ask().values - lower) / (upper - lower)
        away = ((unit - 0.3) ** 2).sum(axis=1)
        first = away.mean() if first is None else first
        algorithm.tell(
            Scores(
                objectives=objectives,
                values=np.column_stack((1 + away, away)),
                violation=violation,
                constraints=violation[:, None],
            )
        )
    assert away.mean() < 0.2 * first
