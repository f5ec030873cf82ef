"""The control period and the integrator's step are two things; a delay shifts what the drivers do."""

import importlib.util
import json
import subprocess
import sys
from dataclasses import asdict, replace
from importlib import resources
from itertools import pairwise

import mujoco
import numpy as np
import pytest

from pareto_monoped.actuator.search import map_for
from pareto_monoped.cad.write.mjcf import jump_record
from pareto_monoped.design import LOWER, PAPER_CASES, UPPER
from pareto_monoped.errors import CalibrationError
from pareto_monoped.jump import controller
from pareto_monoped.jump.calibration import calibration_of, load_calibration
from pareto_monoped.jump.controller_record import RECORD
from pareto_monoped.jump.document import mjcf
from pareto_monoped.jump.evaluate import Evaluator
from pareto_monoped.jump.single import simulate
from pareto_monoped.robot.population import robot_arrays

REFERENCE = load_calibration("reference-1")
CASES = np.array([case.design.as_array() for case in PAPER_CASES.values()])


def timed(**changes):
    return replace(REFERENCE, simulation=replace(REFERENCE.simulation, **changes))


def jump(calibration):
    return Evaluator(map_for("VT8020"), calibration)(CASES)


def test_a_period_of_one_step_is_no_period_of_its_own():
    plain, named = jump(REFERENCE), jump(timed(control_period_s=1e-3))
    for name, values in plain.as_columns().items():
        np.testing.assert_array_equal(values, named.as_columns()[name], err_msg=name)


def test_a_finer_step_keeps_the_held_torques():
    """With the period held, halving the step converges linearly, to another jump than a finer period does."""
    held = [jump(timed(timestep_s=1e-3 / n, control_period_s=1e-3)).energy_j for n in (1, 2, 4, 8)]
    faster = jump(timed(timestep_s=1e-3 / 8)).energy_j
    changes = [np.abs(b / a - 1.0).max() for a, b in pairwise(held)]
    assert changes[0] < 0.006
    for coarse, fine in pairwise(changes):
        assert 0.4 < fine / coarse < 0.6
    assert np.all(np.abs(faster / held[-1] - 1.0) > 4.0 * changes[-1])


def test_motor_torque_changes_only_with_the_period():
    calibration = timed(timestep_s=2.5e-4, control_period_s=1e-3)
    trace = simulate(PAPER_CASES["C"].design, map_for("VT8020"), calibration, trace=True).trace
    torque = trace["knee_motor_torque_n_m"]
    changed = np.flatnonzero(np.diff(torque) != 0.0) + 1
    assert len(changed) > 50
    assert np.all(changed % 4 == 0)


@pytest.mark.parametrize("periods", [1, 3, 8])
def test_a_delay_shifts_the_first_torque(periods):
    calibration = timed(delay_s=periods * 1e-3)
    trace = simulate(PAPER_CASES["C"].design, map_for("VT8020"), calibration, trace=True).trace
    torque = trace["knee_motor_torque_n_m"]
    assert np.all(torque[:periods] == 0.0)
    assert torque[periods] != 0.0


def test_the_driver_works_off_commands_under_way_after_lift_off():
    """A late command acts in the air: the torque ends as many periods later as the delay is long."""
    for periods in (0, 3):
        trace = simulate(PAPER_CASES["C"].design, map_for("VT8020"), timed(delay_s=periods * 1e-3), trace=True).trace
        off = int(np.flatnonzero(trace["foot_clearance_m"] >= REFERENCE.gate.length_m)[0])
        last = int(np.flatnonzero(trace["knee_motor_torque_n_m"])[-1])
        assert last == off - 1 + periods


def test_each_millisecond_of_delay_costs_no_more_than_it_may():
    heights = np.array([jump(timed(delay_s=k * 1e-3)).height_m for k in range(4)])
    assert np.all(np.isfinite(heights))
    assert np.abs(np.diff(heights, axis=0)).max() < 0.05


@pytest.mark.parametrize(
    ("changes", "complaint"),
    [
        ({"control_period_s": 1.5e-3}, "0.0015 must be a whole multiple of timestep_s 0.001; change one"),
        ({"control_period_s": 5e-4}, "whole multiple"),
        ({"delay_s": 1.5e-3}, "whole control periods of 0.001 s; correct it"),
        ({"delay_s": 9e-3}, "0 to 8"),
    ],
)
def test_periods_that_do_not_fit_are_refused(changes, complaint):
    values = asdict(REFERENCE)
    values["simulation"] |= changes
    with pytest.raises(CalibrationError, match=complaint):
        calibration_of(values, source="test")


@pytest.mark.parametrize("periods", [0, 8])
def test_a_delay_is_at_most_of_eight_periods(periods):
    values = asdict(REFERENCE)
    values["simulation"] |= {"delay_s": periods * REFERENCE.simulation.period_s}
    assert calibration_of(values, source="test").simulation.delay_s == values["simulation"]["delay_s"]


def test_reading_a_calibration_imports_no_numba():
    """It knows how many commands the controller's record keeps, which thus stands apart from the compiled code."""
    code = "import sys; import pareto_monoped.jump.calibration; print('numba' in sys.modules)"
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert run.stdout == "False\n"


# From here on: positions and speeds of one time, as in `reference` from version 2 on; drives are rigid up to version 3.

PRESENT = load_calibration("reference-3")


def present(**changes):
    return replace(PRESENT, simulation=replace(PRESENT.simulation, **changes))


def converged(designs):
    """The jumps with a step of 50 us by MuJoCo's Runge-Kutta integrator, and torques held for 1 ms."""
    fine = present(integrator="RK4", positions_read="state", timestep_s=5e-5)
    return Evaluator(map_for("VT8020"), fine)(designs)


def test_held_torques_act_neither_early_nor_late():
    """Energies scatter around the converged ones; read from the state as it is, they are 1 percent low."""
    designs = np.vstack([CASES[:, :7], np.random.default_rng(3).uniform(LOWER, UPPER, (3, len(LOWER)))])
    exact = converged(designs)
    found = Evaluator(map_for("VT8020"), PRESENT)(designs)
    energy = found.energy_j / exact.energy_j - 1.0
    assert np.abs(energy).max() < 0.002
    assert abs(np.median(energy)) < 5e-4
    assert np.abs(found.electrical_energy_j / exact.electrical_energy_j - 1.0).max() < 0.0015
    assert np.abs(found.height_m - exact.height_m).max() < 0.7e-3
    as_it_is = Evaluator(map_for("VT8020"), present(positions_read="state"))(designs)
    assert np.median(as_it_is.energy_j / exact.energy_j - 1.0) < -0.007


def by_own_integrator(design):
    """Height and energy by the classical Runge-Kutta method on MuJoCo's accelerations, with a step of 50 us.

    Commands come from the exported numbers by the functions of the export's replay; nothing else of the package runs.
    """
    spec = importlib.util.spec_from_file_location("replay", resources.files("pareto_monoped") / "data" / "replay.py")
    replay = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(replay)
    arrays = robot_arrays(design.as_array(), map_for("VT8020"), PRESENT.mass)
    numbers = json.loads(jump_record(arrays, design, PRESENT))
    model = mujoco.MjModel.from_xml_string(mjcf(arrays, PRESENT))
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    q, v, h = data.qpos.copy(), np.zeros(model.nv), 5e-5
    energy, height, latched, motor = 0.0, 0.0, False, np.zeros(2)

    def acceleration(q, v):
        data.qpos[:], data.qvel[:] = q, v
        mujoco.mj_forward(model, data)
        return data.qacc.copy()

    for step in range(60000):
        if latched and v[1] <= 0.0:
            break
        if step % 20 == 0:
            wanted, below = replay.virtual_leg(numbers, q[2], q[3], v[2:])
            u = np.clip((q[1] + below - numbers["foot_radius_m"]) / numbers["fade_length_m"], 0.0, 1.0)
            latched = latched or u >= 1.0
            share = 0.0 if latched else 1.0 - u * u * (3.0 - 2.0 * u)
            motor = share * replay.limited(numbers, wanted, v[2:])
        data.ctrl[:] = replay.delivered(numbers, motor, v[2:])
        a1 = acceleration(q, v)
        a2 = acceleration(q + 0.5 * h * v, v2 := v + 0.5 * h * a1)
        a3 = acceleration(q + 0.5 * h * v2, v3 := v + 0.5 * h * a2)
        a4 = acceleration(q + h * v3, v4 := v + h * a3)
        q, before, v = q + h * (v + 2 * v2 + 2 * v3 + v4) / 6, v, v + h * (a1 + 2 * a2 + 2 * a3 + a4) / 6
        energy += np.maximum(motor * 0.5 * (before + v)[2:], 0.0).sum() * h
        height = max(height, q[1])
    return height, energy


@pytest.mark.parametrize("case", [pytest.param("nominal", marks=pytest.mark.long), "C"])
def test_an_own_integrator_agrees(case):
    design = PAPER_CASES[case].design
    height, energy = by_own_integrator(design)
    found = Evaluator(map_for("VT8020"), PRESENT)(design.as_array()[None])
    assert found.height_m[0] == pytest.approx(height, abs=0.6e-3)
    assert found.energy_j[0] == pytest.approx(energy, rel=0.0015)


def test_a_finer_step_hardly_changes_a_jump():
    """Half the step moves the paper's designs by less than 0.3 mm and 0.1 percent: the control period stays."""
    coarse, fine = jump(PRESENT), jump(present(timestep_s=5e-4))
    assert np.abs(fine.height_m - coarse.height_m).max() < 0.3e-3
    assert np.abs(fine.energy_j / coarse.energy_j - 1.0).max() < 1e-3


def test_the_controller_reads_positions_at_the_time_of_the_speeds():
    """In free fall: z of half a step ago is that of the parabola at the time of the speed, to rounding."""
    step, jump_record_ = 1e-3, np.zeros(1, dtype=RECORD)[0]
    jump_record_["read_back_s"] = 0.5 * step
    speed, position = 1.0, 0.0
    before = speed + 9.81 * step
    jump_record_["velocity"][1] = before
    # q(t + h/2) of the parabola through z = 0 at the time t of the speed.
    position = speed * 0.5 * step - 0.5 * 9.81 * (0.5 * step) ** 2
    q, v = np.array([0.0, position, 0.0, 0.0]), np.array([0.0, speed, 0.0, 0.0])
    assert controller._read_back(q, v, jump_record_)[0] == pytest.approx(0.0, abs=1e-15)
