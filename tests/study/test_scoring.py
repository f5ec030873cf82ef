from dataclasses import fields, replace

import numpy as np
import pytest

from pareto_monoped.measures import MEASURE_NAMES
from pareto_monoped.study.definition import Constraints
from pareto_monoped.study.scoring import CONSTRAINTS, FAILED_VIOLATION, judge, scores
from tests.study.support import made_evaluations


def test_constraints_are_shares_of_their_limits_feasible_at_zero():
    judgement = judge(made_evaluations([0.55, 0.5225, 1.1], [5.0, 5.0, 5.0]), Constraints())
    assert judgement.constraints[:, 0] == pytest.approx([0.0, 0.05, -1.0], abs=1e-15)
    assert judgement.violation == pytest.approx([0.0, 0.05, 0.0], abs=1e-15)
    assert judgement.state.tolist() == ["feasible", "infeasible", "feasible"]


def test_the_violation_is_graded():
    heights = np.linspace(0.5, 0.6, 21)
    violation = judge(made_evaluations(heights, np.full(21, 5.0)), Constraints()).violation
    below = heights < 0.55
    assert (np.diff(violation[below]) < 0.0).all()
    assert (violation[~below] == 0.0).all()


def test_violations_of_several_constraints_add_up_and_are_all_named():
    evaluations = made_evaluations([0.44, 0.8], [24.0, 12.0])
    judgement = judge(evaluations, Constraints(max_energy_j=16.0))
    assert judgement.violation == pytest.approx([0.2 + 0.5, 0.0])
    assert judgement.reason == (
        "height_m = 0.44 is below the limit of 0.55; energy_j = 24 is above the limit of 16",
        "",
    )


def test_failed_jumps_keep_their_reason_and_are_farther_off_than_any_real_one():
    evaluations = made_evaluations([np.nan, 0.5], [np.nan, 1.0], ["no_lift_off", "ok"])
    judgement = judge(evaluations, Constraints())
    assert judgement.state.tolist() == ["failed", "infeasible"]
    assert judgement.reason[0] == "it was no_lift_off"
    assert judgement.violation[0] == FAILED_VIOLATION > judgement.violation[1]
    assert np.isfinite(scores(evaluations, judgement).minimised()).all()


def test_an_ok_status_without_numbers_is_still_a_failure():
    evaluations = made_evaluations([np.inf, 1.0, 1.0], [1.0, np.inf, np.nan])
    assert judge(evaluations, Constraints()).state.tolist() == ["failed"] * 3


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
    judgement = judge(evaluations, Constraints(**{key: limit}))
    assert judgement.violation == pytest.approx(violation, abs=1e-12)
    assert judgement.state.tolist() == ["infeasible" if v else "feasible" for v in violation]
    for value, missed, reason in zip(values, violation, judgement.reason, strict=True):
        side = "below" if key.startswith("min") else "above"
        assert reason == (f"{measure} = {value:g} is {side} the limit of {limit:g}" if missed else "")


def test_every_limit_of_a_study_is_judged_and_the_other_way_round():
    assert [constraint.key for constraint in CONSTRAINTS] == [field.name for field in fields(Constraints)]
    assert {constraint.measure for constraint in CONSTRAINTS} <= set(MEASURE_NAMES)


def test_a_limit_that_is_not_set_is_not_judged():
    judgement = judge(made_evaluations([1.0], [5.0]), Constraints())
    assert judgement.constraints.shape == (1, 1)
