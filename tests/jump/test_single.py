from dataclasses import replace

import numpy as np
import pytest

from pareto_monoped.actuator.search import map_for
from pareto_monoped.design import PAPER_CASES
from pareto_monoped.jump.balance import energy_balance
from pareto_monoped.jump.calibration import load_calibration
from pareto_monoped.jump.model import torque_limit
from pareto_monoped.jump.single import TRACE_COLUMNS, simulate
from pareto_monoped.robot.population import robot_arrays

MAP = map_for("VT8020")


# Hip and knee have different ratios, so that nothing of one passes for the other's.
DESIGN = PAPER_CASES["A"].design


@pytest.fixture(scope="module", params=["reference-3", "paper"])
def jump(request):
    """With rigid drives, whose motors have the speeds of the trace's joints."""
    return simulate(DESIGN, MAP, load_calibration(request.param), trace=True)


@pytest.fixture(scope="module", params=["reference", "reference-3", "paper"])
def any_jump(request):
    return simulate(DESIGN, MAP, load_calibration(request.param), trace=True)


def robot_of(jump):
    return robot_arrays(DESIGN.as_array(), MAP, load_calibration(jump.calibration).mass)


def during_steps(jump, joint):
    """Motor torque, joint torque and speed of each step, as the work of the step is booked, and the step in s."""
    trace = jump.trace
    speed = trace[f"{joint}_rad_per_s"]
    booked = speed[:-1] if jump.calibration.startswith("paper") else 0.5 * (speed[1:] + speed[:-1])
    step = trace["time_s"][1]
    return trace[f"{joint}_motor_torque_n_m"][:-1], trace[f"{joint}_torque_n_m"][:-1], booked, step


def test_trace_and_measures_are_the_same_jump(any_jump):
    trace, measures = any_jump.trace, any_jump.measures
    assert tuple(trace) == TRACE_COLUMNS
    assert trace["base_z_m"].max() == measures["height_m"]
    assert trace["time_s"][-1] == pytest.approx(measures["apex_s"])
    assert trace["foot_clearance_m"][-1] == pytest.approx(measures["foot_clearance_m"])
    assert trace["time_s"][trace["foot_clearance_m"] <= 1e-9][-1] == pytest.approx(measures["lift_off_s"])


def test_the_floor_holds_the_foot_sideways_unless_rails_hold_the_base(jump):
    """With a coefficient of friction below 1; on rails nothing is said, as they take what the foot does not."""
    sideways, upwards = jump.trace["contact_x_n"], jump.trace["contact_z_n"]
    if jump.calibration.startswith("paper"):
        assert np.isnan(sideways).all()
    else:
        assert np.all(np.abs(sideways) <= upwards)
        assert 10.0 < np.abs(sideways).max() < 0.9 * upwards.max()


def test_the_energy_is_that_of_the_trace(jump):
    measures, work = jump.measures, 0.0
    for joint in ("hip", "knee"):
        torque, _, speed, step = during_steps(jump, joint)
        work += np.maximum(torque * speed, 0.0).sum() * step
    assert work == pytest.approx(measures["energy_j"])


@pytest.mark.parametrize("joint", ["hip", "knee"])
def test_each_joints_measures_are_those_of_its_trace(jump, joint):
    measures = jump.measures
    torque, _, speed, step = during_steps(jump, joint)
    assert measures[f"energy_{joint}_j"] == pytest.approx(np.maximum(torque * speed, 0.0).sum() * step)
    assert measures[f"peak_torque_{joint}_n_m"] == np.abs(torque).max()
    assert measures[f"peak_speed_{joint}_rad_per_s"] == np.abs(jump.trace[f"{joint}_rad_per_s"]).max()
    assert measures[f"peak_power_{joint}_w"] == pytest.approx(np.abs(torque * speed).max())


def test_absorbed_work_and_drive_loss_are_those_of_the_trace(jump):
    absorbed = lost = 0.0
    for joint in ("hip", "knee"):
        torque, delivered, speed, step = during_steps(jump, joint)
        absorbed -= np.minimum(torque * speed, 0.0).sum() * step
        lost += ((torque - delivered) * speed).sum() * step
    assert jump.measures["absorbed_j"] == pytest.approx(absorbed)
    assert jump.measures["drive_loss_j"] == pytest.approx(lost, abs=1e-12)
    assert absorbed > 0.0


def test_joule_heat_is_that_of_the_motors_currents(jump):
    """R i^2 with i = (joint torque / ratio) / k_t, summed over both motors."""
    robot, heat = robot_of(jump), 0.0
    assert robot.ratio[0, 0] < 5.0 < 7.0 < robot.ratio[0, 1]
    for k, joint in enumerate(("hip", "knee")):
        torque, _, _, step = during_steps(jump, joint)
        current = torque / robot.ratio[0, k] / robot.torque_constant_n_m_per_a[0, k]
        heat += robot.winding_resistance_ohm[0, k] * (current**2).sum() * step
    assert jump.measures["joule_heat_j"] == pytest.approx(heat, rel=1e-9)


def test_saturation_is_the_share_of_controlled_steps_at_the_limit():
    """Without a voltage limit a saturated motor has its peak torque."""
    paper = load_calibration("paper")
    calibration = replace(paper, controller=replace(paper.controller, flight=None))
    design = PAPER_CASES["B"].design.replace({"stiffness_n_per_m": 14.0})
    robot = robot_arrays(design.as_array(), MAP, calibration.mass)
    result = simulate(design, MAP, calibration, trace=True)
    torque = np.abs([result.trace[f"{joint}_motor_torque_n_m"] for joint in ("hip", "knee")])
    controlled = torque.max(axis=0) > 0.0
    share = (torque == torque_limit(robot, calibration.drive).T).sum(axis=1) / controlled.sum()
    assert [result.measures[f"saturation_{joint}"] for joint in ("hip", "knee")] == pytest.approx(share.tolist())
    assert 0.0 == share[0] < share[1] < 0.9


def test_trace_begins_at_rest_and_ends_at_the_apex(any_jump):
    trace = any_jump.trace
    assert trace["base_z_m"][0] == 0.5
    assert trace["base_z_m_per_s"][0] == 0.0
    assert trace["base_z_m_per_s"][-1] <= 0.0 < trace["base_z_m_per_s"][-2]
    assert trace["contact_z_n"].min() >= 0.0


def test_energy_and_momentum_of_the_flight_follow_gravity(any_jump):
    """While nothing touches and no torque acts, the centre of mass falls freely."""
    trace, mass = any_jump.trace, any_jump.measures["mass_kg"]
    free = trace["time_s"] > any_jump.measures["lift_off_s"] + 0.02
    height = trace["potential_j"][free] / (mass * 9.81)
    fit = np.polyfit(trace["time_s"][free], height, 2)
    assert 2.0 * fit[0] == pytest.approx(-9.81, rel=1e-3)


def test_a_calibration_by_runge_kutta_has_a_true_trace_and_balance():
    """After such a step MuJoCo's data holds forces and positions of the last stage, not of the step's start."""
    calibration, design = load_calibration("reference-3"), PAPER_CASES["C"].design
    simulation = replace(calibration.simulation, integrator="RK4", positions_read="state")
    calibration = replace(calibration, simulation=simulation)
    trace = simulate(design, map_for("VT8020"), calibration, trace=True).trace
    shank = trace["hip_rad"] + trace["knee_rad"]
    below = design.thigh_length_m * np.cos(trace["hip_rad"]) + design.shank_length_m * np.cos(shank)
    np.testing.assert_allclose(trace["foot_z_m"], trace["base_z_m"] - below, atol=1e-12)
    assert np.all(trace["contact_z_n"][trace["foot_clearance_m"] > 1e-9] == 0.0)
    robots = robot_arrays(design.as_array(), map_for("VT8020"), calibration.mass)
    assert energy_balance(robots, design.as_array()[None, 4:7], calibration).error < 0.01


def test_the_last_state_of_a_trace_has_no_step_and_so_no_torque():
    """Here the jump is cut off while the motors push."""
    calibration = load_calibration()
    calibration = replace(calibration, simulation=replace(calibration.simulation, time_limit_s=0.05))
    trace = simulate(DESIGN, MAP, calibration, trace=True).trace
    for name in ("hip_motor_torque_n_m", "knee_motor_torque_n_m", "hip_torque_n_m", "knee_torque_n_m"):
        assert trace[name][-2] != 0.0
        assert trace[name][-1] == 0.0


def test_a_design_that_cannot_stand_has_no_trace():
    design = PAPER_CASES["C"].design.replace({"thigh_length_m": 1.5})
    result = simulate(design, MAP, load_calibration(), trace=True)
    assert result.status == "cannot_stand"
    assert result.trace == {}
    assert np.isnan(result.measures["height_m"])
