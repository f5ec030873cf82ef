from dataclasses import replace

import numpy as np
import pytest

from pareto_monoped.definition.goals import constraints_of
from pareto_monoped.measures import MEASURE_NAMES
from pareto_monoped.pareto.objectives import Objectives
from pareto_monoped.search.scoring import FAILED_VIOLATION, judge, scores
from tests.study.support import made_evaluations


def test_constraints_are_shares_of_their_limits_feasible_at_zero():
    judgement = judge(made_evaluations([0.55, 0.5225, 1.1], [5.0, 5.0, 5.0]), constraints_of({}))
    assert judgement.constraints[:, 0] == pytest.approx([0.0, 0.05, -1.0], abs=1e-15)
    assert judgement.violation == pytest.approx([0.0, 0.05, 0.0], abs=1e-15)
    assert judgement.state.tolist() == ["feasible", "infeasible", "feasible"]


def test_the_violation_is_graded():
    heights = np.linspace(0.5, 0.6, 21)
    violation = judge(made_evaluations(heights, np.full(21, 5.0)), constraints_of({})).violation
    below = heights < 0.55
    assert (np.diff(violation[below]) < 0.0).all()
    assert (violation[~below] == 0.0).all()


def test_violations_of_several_constraints_add_up_and_are_all_named():
    evaluations = made_evaluations([0.44, 0.8], [24.0, 12.0])
    judgement = judge(evaluations, constraints_of({"max_energy_j": 16.0}))
    assert judgement.violation == pytest.approx([0.2 + 0.5, 0.0])
    assert judgement.reason == (
        "height_m = 0.44 is below the limit of 0.55; energy_j = 24 is above the limit of 16",
        "",
    )


def test_failed_jumps_keep_their_reason_and_are_farther_off_than_any_real_one():
    evaluations = made_evaluations([np.nan, 0.5], [np.nan, 1.0], ["no_lift_off", "ok"])
    judgement = judge(evaluations, constraints_of({}))
    assert judgement.state.tolist() == ["failed", "infeasible"]
    assert judgement.reason[0] == "it was no_lift_off"
    assert judgement.violation[0] == FAILED_VIOLATION > judgement.violation[1]
    assert np.isfinite(scores(evaluations, judgement).minimised()).all()


def test_an_ok_status_without_numbers_is_still_a_failure():
    evaluations = made_evaluations([np.inf, 1.0, 1.0], [1.0, np.inf, np.nan])
    assert judge(evaluations, constraints_of({})).state.tolist() == ["failed"] * 3


@pytest.mark.parametrize(
    ("key", "limit", "measure", "values", "violation"),
    [
        ("min_height_m", 0.8, "height_m", [0.6, 0.8, 1.0], [0.25, 0.0, 0.0]),
        ("max_energy_j", 20.0, "energy_j", [15.0, 20.0, 30.0], [0.0, 0.0, 0.5]),
        ("max_mass_kg", 4.0, "mass_kg", [3.0, 4.0, 5.0], [0.0, 0.0, 0.25]),
        ("min_foot_clearance_m", 0.02, "foot_clearance_m", [0.01, 0.02, 0.03], [0.5, 0.0, 0.0]),
        ("min_sustained_jumps_per_minute", 100.0, "sustained_jumps_per_minute", [50.0, 100.0, 200.0], [0.5, 0.0, 0.0]),
        *(
            (f"max_{name}", 20.0, name, [15.0, 20.0, 30.0], [0.0, 0.0, 0.5])
            for name in (
                "electrical_energy_j",
                "peak_gear_torque_hip_n_m",
                "peak_gear_torque_knee_n_m",
                "peak_chain_tension_n",
                "peak_stop_torque_n_m",
                "stop_energy_j",
                "peak_foot_force_n",
                "drift_m",
            )
        ),
    ],
)
def test_each_constraint_refuses_the_values_on_its_wrong_side(key, limit, measure, values, violation):
    evaluations = replace(made_evaluations([1.0, 1.0, 1.0], [5.0, 5.0, 5.0]), **{measure: np.array(values)})
    judgement = judge(evaluations, constraints_of({key: limit}))
    assert judgement.violation == pytest.approx(violation, abs=1e-12)
    assert judgement.state.tolist() == ["infeasible" if v else "feasible" for v in violation]
    for value, missed, reason in zip(values, violation, judgement.reason, strict=True):
        side = "below" if key.startswith("min") else "above"
        assert reason == (f"{measure} = {value:g} is {side} the limit of {limit:g}" if missed else "")


def test_a_limit_that_is_not_set_is_not_judged():
    judgement = judge(made_evaluations([1.0], [5.0]), constraints_of({}))
    assert judgement.constraints.shape == (1, 1)


@pytest.mark.parametrize("name", MEASURE_NAMES)
def test_every_measure_is_judged_by_its_limits(name):
    values = np.array([0.6, 0.8, 1.2])
    evaluations = replace(made_evaluations([1.0, 1.0, 1.0], [5.0, 5.0, 5.0]), **{name: values})
    judgement = judge(evaluations, constraints_of({name: {"min": 0.75, "max": 1.0}}))
    assert judgement.violation == pytest.approx([0.2, 0.0, 0.2])
    assert judgement.reason == (
        f"{name} = 0.6 is below the limit of 0.75",
        "",
        f"{name} = 1.2 is above the limit of 1",
    )


def test_a_measure_without_a_value_misses_its_limit():
    evaluations = replace(made_evaluations([1.0], [5.0]), mass_kg=np.array([np.nan]))
    judgement = judge(evaluations, constraints_of({"mass_kg": {"max": 4.0}}))
    assert judgement.state.tolist() == ["infeasible"]
    assert judgement.reason == ("mass_kg = nan is above the limit of 4",)


def test_a_jump_without_a_value_of_an_objective_failed():
    evaluations = replace(made_evaluations([1.0, 1.0], [5.0, 5.0]), electrical_energy_j=np.array([9.0, np.inf]))
    objectives = Objectives(names=("height_m", "electrical_energy_j"))
    assert judge(evaluations, constraints_of({}), objectives).state.tolist() == ["feasible", "failed"]
    assert judge(evaluations, constraints_of({})).state.tolist() == ["feasible", "feasible"]


def test_scores_hold_the_objectives_in_their_order():
    evaluations = replace(made_evaluations([1.0], [5.0]), mass_kg=np.array([4.0]))
    objectives = Objectives(names=("mass_kg", "height_m", "energy_j"))
    found = scores(evaluations, judge(evaluations, constraints_of({}), objectives), objectives)
    assert found.values.tolist() == [[4.0, 1.0, 5.0]]
    assert found.minimised().tolist() == [[4.0, -1.0, 5.0]]
