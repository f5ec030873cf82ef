"""Knee release, rest length and start height do what they say, and nothing at their defaults."""

from dataclasses import replace

import numpy as np

from pareto_monoped.actuator.search import map_for
from pareto_monoped.design import BASE_START_HEIGHT_M, PAPER_CASES, REST_LENGTH_M
from pareto_monoped.jump.calibration import load_calibration
from pareto_monoped.jump.evaluate import Evaluator
from pareto_monoped.jump.single import simulate
from pareto_monoped.leg.dimensions import leg_dimensions
from pareto_monoped.leg.stops import knee_stop

REFERENCE, RIGID = load_calibration("reference"), load_calibration("reference-3")
CASES = [case.design for case in PAPER_CASES.values()]


def jump(designs, calibration=REFERENCE):
    return Evaluator(map_for("VT8020"), calibration)(np.array([design.as_array() for design in designs]))


def test_defaults_are_the_papers_controller():
    seven = Evaluator(map_for("VT8020"), REFERENCE)(np.array([design.as_array()[:7] for design in CASES]))
    for name, values in jump(CASES).as_columns().items():
        np.testing.assert_array_equal(values, seven.as_columns()[name], err_msg=name)


def test_a_knee_release_saves_energy_at_the_stop():
    plain, released = jump(CASES), jump([design.replace({"knee_release_rad": 0.4}) for design in CASES])
    assert np.all(released.energy_j < 0.97 * plain.energy_j)
    assert np.all(released.stop_energy_j < plain.stop_energy_j)
    assert np.all(np.abs(released.height_m - plain.height_m) < 0.06)


def test_the_release_is_a_ramp_down_to_the_stop():
    """It ends at the stop, and it begins no earlier than it is asked to."""
    design = PAPER_CASES["C"].design.replace({"knee_release_rad": 0.5})
    trace = simulate(design, map_for("VT8020"), RIGID, trace=True).trace
    lower_rad = knee_stop(leg_dimensions(map_for("VT8020"))).lower_rad
    # The controller reads the knee half a step before the trace has it; an elastic drive's reads the motor instead.
    read = trace["knee_rad"] - 0.5 * RIGID.simulation.timestep_s * trace["knee_rad_per_s"]
    near = read < lower_rad - 1e-3
    assert near[:-1].any()
    assert np.all(trace["knee_motor_torque_n_m"][near] == 0.0)
    plain = simulate(PAPER_CASES["C"].design, map_for("VT8020"), RIGID, trace=True).trace
    first, torque = slice(0, 20), "knee_motor_torque_n_m"
    assert np.all(trace["knee_rad"][first] > lower_rad + 0.5)
    np.testing.assert_array_equal(trace[torque][first], plain[torque][first])


def test_the_release_passes_a_share_of_what_the_motor_can_do():
    """The nominal design asks for more than its motor's peak on the whole ramp; that must not hide the ramp."""
    design = PAPER_CASES["nominal"].design.replace({"knee_release_rad": 0.5})
    trace = simulate(design, map_for("VT8020"), RIGID, trace=True).trace
    lower_rad = knee_stop(leg_dimensions(map_for("VT8020"))).lower_rad
    read = trace["knee_rad"] - 0.5 * RIGID.simulation.timestep_s * trace["knee_rad_per_s"]
    share = (read - lower_rad) / 0.5
    ramp = (share < 1.0) & (trace["foot_clearance_m"] <= 0.0)
    assert np.count_nonzero(ramp) > 5
    peak_n_m = 5.5 * 6.0  # the motor's, times the ratio
    np.testing.assert_allclose(-trace["knee_motor_torque_n_m"][ramp], share[ramp] * peak_n_m, rtol=1e-3)


def test_a_rest_length_is_the_springs():
    """F_l = K (l0 - l): half the stiffness at twice the distance to the rest length is nearly the same force."""
    design = PAPER_CASES["C"].design
    length = BASE_START_HEIGHT_M
    other = design.replace({"stiffness_n_per_m": design.stiffness_n_per_m / 2.0, "rest_length_m": 20.0 - length})
    plain, changed = jump([design]), jump([other])
    np.testing.assert_allclose(changed.height_m, plain.height_m, rtol=0.02)


def test_a_design_without_a_rest_length_takes_its_calibrations():
    shorter = replace(REFERENCE, controller=replace(REFERENCE.controller, rest_length_m=5.0))
    by_calibration = jump(CASES, shorter)
    by_design = jump([design.replace({"rest_length_m": 5.0}) for design in CASES])
    np.testing.assert_array_equal(by_calibration.height_m, by_design.height_m)
    assert REFERENCE.controller.rest_length_m == REST_LENGTH_M


def test_a_jump_starts_where_it_is_asked_to():
    for height in (0.40, 0.5, 0.6):
        design = PAPER_CASES["nominal"].design.replace({"start_height_m": height})
        result = simulate(design, map_for("VT8020"), REFERENCE, trace=True)
        assert result.trace["base_z_m"][0] == height
        # At rest the floor carries the robot, so that nothing moves before the motors do.
        weight = result.measures["mass_kg"] * 9.81
        np.testing.assert_allclose(result.trace["contact_z_n"][0], weight, rtol=0.7)
        rise = result.measures["height_m"] - height
        np.testing.assert_allclose(result.measures["efficiency"], weight * rise / result.measures["energy_j"])


def test_a_start_height_out_of_reach_is_named():
    result = jump([PAPER_CASES["nominal"].design.replace({"start_height_m": 0.9})])
    assert result.status[0] == "cannot_stand"
    assert "shorter" in result.reason[0]
