"""A study's jumps for pymoo's and Optuna's own optimisers, with own objectives and constraints."""

import numpy as np
import optuna
import pandas as pd
import pytest
from pymoo.algorithms.moo.nsga2 import NSGA2
from pymoo.optimize import minimize

from pareto_monoped.definition.study import Study
from pareto_monoped.errors import InputError, StudyError
from pareto_monoped.search.scoring import FAILED_VIOLATION
from pareto_monoped.storage.reader import read_study
from pareto_monoped.study.outside import JumpFunction, OptunaObjective
from pareto_monoped.study.pymoo_problem import MonopedProblem
from pareto_monoped.study.run import run


@pytest.fixture(scope="module")
def study():
    return Study.define(
        name="s", evaluations=24, audit=False, algorithm="random", constraints={"mass_kg": {"max": 5.0}}
    )


def drawn(problem, n, seed=0):
    return np.random.default_rng(seed).uniform(problem.xl, problem.xu, (n, problem.n_var))


def test_the_problem_of_pymoo_has_the_objectives_and_constraints_of_a_stored_study(study, tmp_path):
    run(study, tmp_path / "s.db")
    data = read_study(tmp_path / "s.db")
    points = data.coordinates.values(data.trials[list(data.study.variables)].to_numpy())
    out = MonopedProblem(study).evaluate(points, return_as_dictionary=True)
    failed = (data.trials["state"] == "failed").to_numpy()
    np.testing.assert_array_equal(out["F"][~failed, 0], -data.trials["height_m"].to_numpy()[~failed])
    np.testing.assert_array_equal(out["F"][~failed, 1], data.trials["energy_j"].to_numpy()[~failed])
    missed = np.maximum(out["G"], 0.0).sum(axis=1)
    np.testing.assert_allclose(missed, data.trials["violation"].to_numpy(), rtol=1e-12)


def test_own_objectives_and_constraints_are_functions_of_the_jumps(study):
    problem = MonopedProblem(
        study,
        objectives=[lambda jumps: jumps["mass_kg"]],
        constraints=[lambda jumps: jumps["drift_m"] - 0.5 * jumps["thigh_length_m"]],
        workers=1,
    )
    points = drawn(problem, 12)
    out = problem.evaluate(points, return_as_dictionary=True)
    table = problem.decode(points)
    ok = table["status"] == "ok"
    assert ok.any()
    np.testing.assert_array_equal(out["F"][ok, 2], table["mass_kg"][ok])
    np.testing.assert_array_equal(out["G"][ok, -1], (table["drift_m"] - 0.5 * table["thigh_length_m"])[ok])


def test_a_failed_jump_misses_every_constraint(study):
    problem = MonopedProblem(
        Study.define(
            name="s",
            evaluations=10,
            variables={"thigh_length_m": {"lower": 0.05, "upper": 0.06}, "shank_length_m": 0.45},
        ),
        constraints=[lambda jumps: -np.ones(len(jumps["mass_kg"]))],
    )
    points = drawn(problem, 8)
    out = problem.evaluate(points, return_as_dictionary=True)
    failed = problem.decode(points)["status"] != "ok"
    assert 0 < failed.sum() < 8
    assert (out["F"][failed] == 0.0).all()
    assert (out["G"][failed] == FAILED_VIOLATION).all()
    assert (out["G"][~failed, -1] == -1.0).all()


def test_an_algorithm_of_pymoo_finds_designs_that_hold_every_constraint(study):
    problem = MonopedProblem(study, constraints=[lambda jumps: jumps["mass_kg"] - 4.8])
    result = minimize(problem, NSGA2(pop_size=24), ("n_gen", 5), seed=1)
    found = problem.decode(result.X)
    assert (found["mass_kg"] <= 4.8).all()
    assert (found["height_m"] >= 0.55).all()


def test_numbers_between_gearboxes_are_rounded(study):
    jump = JumpFunction(study)
    point = np.full(len(jump.space.names), 0.5) * (jump.space.lower + jump.space.upper)
    whole = np.where(jump.space.whole, np.round(point), point)
    np.testing.assert_array_equal(jump(whole).objectives, jump(whole + 0.3 * jump.space.whole).objectives)


def test_optuna_optimises_a_study_with_a_choice_of_motor():
    study = Study.define(name="s", evaluations=10, motor=["VT8020", "U8"])
    objective = OptunaObjective(study, constraints=[lambda jumps: jumps["mass_kg"] - 5.0])
    sampler = optuna.samplers.NSGAIISampler(seed=1, population_size=10)
    found = optuna.create_study(directions=objective.directions, sampler=sampler)
    assert objective.directions == ["maximize", "minimize"]
    found.optimize(objective, n_trials=30)
    assert {trial.params["motor"] for trial in found.trials} == {"VT8020", "U8"}
    done = [trial for trial in found.trials if trial.values is not None]
    assert done
    for trial in done:
        assert trial.values == [trial.user_attrs["height_m"], trial.user_attrs["energy_j"]]
    for trial in found.best_trials:
        assert trial.user_attrs["mass_kg"] <= 5.0
        assert trial.user_attrs["height_m"] >= 0.55


def test_one_function_alone_is_a_list_of_one(study):
    def light(jumps):
        return jumps["mass_kg"] - 5.0

    problem = MonopedProblem(study, objectives=light, constraints=light)
    assert problem.jump.names[-1] == problem.jump.constraint_names[-1] == "light"
    assert OptunaObjective(study, objectives=light).directions == ["maximize", "minimize", "minimize"]
    with pytest.raises(StudyError, match=r"^constraints = \{'mass_kg': 5.0\}: must be a function of the jumps"):
        MonopedProblem(study, constraints={"mass_kg": 5.0})


@pytest.mark.parametrize("workers", [0, True, "two", np.ones(3), pd.DataFrame({"workers": [1, 2]})])
def test_workers_that_are_no_number_are_refused(workers, study):
    with pytest.raises(InputError, match=r"^workers = [^\n]*: must be a whole number from 1 to [^\n]*$"):
        MonopedProblem(study, workers=workers)


WRONG = {
    "a number": lambda jumps: 1.0,
    "too few": lambda jumps: jumps["mass_kg"][:-1],
    "words": lambda jumps: ["heavy"] * len(jumps["mass_kg"]),
    "no numbers": lambda jumps: jumps["mass_kg"] * np.nan,
}


@pytest.mark.parametrize("function", WRONG.values(), ids=WRONG.keys())
def test_an_own_function_that_returns_nonsense_is_named(function, study):
    problem = MonopedProblem(study, objectives=[function])
    with pytest.raises(StudyError, match=r"own function .*<lambda>") as caught:
        problem.evaluate(drawn(problem, 6))
    assert "\n" not in str(caught.value)
