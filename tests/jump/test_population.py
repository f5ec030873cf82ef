"""The batch against the independent loop of ``oracle``, and against itself."""

from dataclasses import replace

import mujoco
import numpy as np
import pytest

from pareto_monoped.jump.calibration import load_calibration
from pareto_monoped.jump.document import mjcf
from pareto_monoped.jump.evaluate import evaluate_robots
from pareto_monoped.jump.population import first_records
from pareto_monoped.jump.variations import take
from tests.jump import oracle
from tests.jump.robots import plausible_robots, random_designs


@pytest.mark.parametrize("count", [12, pytest.param(100, marks=pytest.mark.long)])
def test_plain_mj_step_on_the_exported_model_agrees(count):
    """To 1e-9 on all random designs, as `reference-3` hardly amplifies rounding."""
    calibration, designs = load_calibration("reference-3"), random_designs(count, seed=7)
    robots = plausible_robots(designs)
    found = evaluate_robots(robots, designs[:, 4:], calibration)
    for i, design in enumerate(designs):
        jump = oracle.jump(
            mjcf(robots, calibration, i),
            *design[4:],
            oracle.motors_of(robots, i, calibration),
            fade=calibration.gate.length_m,
            read_back=True,
        )
        assert jump.ended
        assert found.height_m[i] == pytest.approx(jump.height, rel=1e-9)
        assert found.energy_j[i] == pytest.approx(jump.energy, rel=1e-9)
        assert found.energy_hip_j[i] == pytest.approx(jump.hip_energy, rel=1e-9, abs=1e-9)
        assert found.foot_clearance_m[i] == pytest.approx(jump.clearance, rel=1e-9)
        assert found.apex_s[i] == pytest.approx(jump.apex)
        assert found.lift_off_s[i] == pytest.approx(jump.lift_off)


def test_literal_jump_agrees_where_rounding_does_not_decide():
    calibration, designs = load_calibration("paper"), random_designs(20, seed=8)
    robots = plausible_robots(designs)
    found = evaluate_robots(robots, designs[:, 4:], calibration)
    agreed = 0
    for i, design in enumerate(designs):
        jump = oracle.jump(
            mjcf(robots, calibration, i),
            *design[4:],
            oracle.motors_of(robots, i, calibration),
            lags=calibration.gate.lags,
            mean_speed=False,
            gravity=calibration.controller.gravity_feed_forward,
            weight_of=calibration.controller.weight,
            flight=(
                calibration.controller.flight.stiffness_n_m_per_rad,
                calibration.controller.flight.damping_n_m_s_per_rad,
            ),
        )
        agreed += bool(
            found.height_m[i] == pytest.approx(jump.height, rel=1e-6)
            and found.energy_j[i] == pytest.approx(jump.energy, rel=1e-6)
        )
    assert agreed >= 12


def test_weight_limits_and_pose_of_the_later_readings():
    """The base's weight alone, a knee that is geared down once more, and the pose that the motors hold in flight."""
    paper, designs = load_calibration("paper"), random_designs(3, seed=2)
    robots = plausible_robots(designs)
    records = first_records(robots, designs[:, 4:], paper)
    np.testing.assert_allclose(records["weight_n"], 9.81 * robots.body_mass_kg[:, 0], rtol=1e-12)
    scale = paper.drive.knee_torque_scale
    np.testing.assert_allclose(records["torque_limit_n_m"], robots.peak_torque_n_m * [1.0, scale], rtol=1e-12)
    model = mujoco.MjModel.from_xml_string(mjcf(robots, paper, 1))
    np.testing.assert_allclose(records["start_rad"][1], model.key_qpos[0][-2:], rtol=1e-12)
    np.testing.assert_allclose(records["torque_limit_n_m"][1], model.actuator_ctrlrange[:, 1], rtol=1e-12)


def test_first_records_hold_what_robot_and_calibration_say():
    start, designs = load_calibration("reference-3"), random_designs(2, seed=1)
    calibration = replace(
        start,
        drive=replace(start.drive, chain_efficiency=0.9, peak_torque_scale=1.25, loss_speed_rad_per_s=0.7),
        controller=replace(start.controller, rest_length_m=9.0, gravity_feed_forward=0.5),
        simulation=replace(start.simulation, time_limit_s=2.0, work_speed="start"),
    )
    by_stages = replace(start, simulation=replace(start.simulation, integrator="RK4", positions_read="state"))
    robots = plausible_robots(designs)
    records = first_records(robots, designs[:, 4:], calibration)
    hip, knee = robots.ratio[0]
    assert hip != knee
    expected = {
        "rest_length_m": 9.0,
        "timestep_s": 0.001,
        "period_steps": 1,
        "step_limit": 2000,
        "stages": 1,
        "read_back_s": 0.0005,
        "fade_length_m": 0.01,
        "latch": 1,
        "loss_speed_rad_per_s": 0.7,
        "voltage_limit": 1,
        "mean_speed": 0,
        "thigh_length_m": designs[0, 0],
        "shank_length_m": designs[0, 1],
        "foot_radius_m": 0.025,
        "stiffness_n_per_m": designs[0, 4],
        "damping_n_s_per_m": designs[0, 5],
        "torsional_stiffness_n_m_per_rad": designs[0, 6],
        "weight_n": 0.5 * 9.81 * robots.body_mass_kg[0].sum(),
        "torque_limit_n_m": [1.25 * 5.5 * hip, 1.25 * 5.5 * knee],
        "no_load_speed_rad_per_s": [502.65 / hip, 502.65 / knee],
        # R i / k_t at the motor's shaft, with 1.25 times the peak current of 5.5 N m / k_t; divided by the ratio
        "corner_speed_rad_per_s": [(502.65 - 0.06 * 1.25 * 5.5 / 0.0955**2) / ratio for ratio in (hip, knee)],
        "loss": [1.0 - 0.94, 1.0 - 0.94 * 0.9],
        "heat_w_per_n2_m2": [0.06 / (0.0955 * ratio) ** 2 for ratio in (hip, knee)],
        "height_m": 0.5,
        "body_mass_kg": robots.body_mass_kg[0],
        "thigh_com_m": robots.body_com_m[0, 1, [0, 2]],
        "shank_com_m": robots.body_com_m[0, 2, [0, 2]],
        "link_inertia_kg_m2": robots.body_inertia_kg_m2[0, 1:, 1, 1],
        "armature_kg_m2": [robots.armature_kg_m2[0, 0], robots.knee_reflected_kg_m2[0]],
        "coupling_kg_m2": robots.knee_coupling_kg_m2[0],
        "rotor_kg_m2": [1e-4 * hip, 1e-4 * knee],
        "ratio": [hip, knee],
        "joint_damping_n_m_s_per_rad": start.joints.damping_n_m_s_per_rad,
        "lower_stop_rad": [robots.stops.hip.lower_rad, robots.stops.knee.lower_rad],
        "upper_stop_rad": [robots.stops.hip.upper_rad, robots.stops.knee.upper_rad],
        "sprocket_radius_m": 0.026,
    }
    for name, value in expected.items():
        np.testing.assert_allclose(records[0][name], value, rtol=1e-12, err_msg=name)
    zero = set(records.dtype.names) - set(expected)
    assert all(np.all(records[name] == 0.0) for name in zero)
    runge_kutta = first_records(robots, designs[:, 4:], by_stages)
    assert (runge_kutta["stages"][0], runge_kutta["read_back_s"][0]) == (4, 0)
    ideal = first_records(robots, designs[:, 4:], load_calibration("ideal"))
    assert np.all(ideal["loss"] == 0.0)
    paper = first_records(robots, designs[:, 4:], load_calibration("paper"))
    assert (paper["lags"][0], paper["fade_length_m"][0], paper["latch"][0], paper["voltage_limit"][0]) == (1, 0, 0, 0)


@pytest.fixture(scope="module", params=["reference", "reference-3"])
def many(request):
    """By either engine."""
    designs, calibration = random_designs(60, seed=3), load_calibration(request.param)
    robots = plausible_robots(designs)
    return designs, robots, calibration, evaluate_robots(robots, designs[:, 4:], calibration)


def same_rows(part, whole, rows):
    for name, values in part.as_columns().items():
        np.testing.assert_array_equal(values, whole.as_columns()[name][rows], err_msg=name)


@pytest.mark.parametrize("size", [1, 2, 7, 33])
def test_bits_do_not_depend_on_the_batch(many, size):
    designs, robots, calibration, whole = many
    rows = np.random.default_rng(size).permutation(len(designs))[:size]
    same_rows(evaluate_robots(take(robots, rows), designs[rows, 4:], calibration), whole, rows)


@pytest.mark.parametrize("workers", [2, 3])
def test_bits_do_not_depend_on_workers(many, workers):
    designs, robots, calibration, whole = many
    same_rows(evaluate_robots(robots, designs[:, 4:], calibration, workers), whole, np.arange(len(designs)))


def test_inputs_are_not_changed(many):
    designs, robots, calibration, _ = many
    before, fresh = designs.copy(), plausible_robots(designs)
    evaluate_robots(robots, designs[:, 4:], calibration)
    np.testing.assert_array_equal(designs, before)
    np.testing.assert_array_equal(robots.body_mass_kg, fresh.body_mass_kg)
    np.testing.assert_array_equal(robots.efficiency, fresh.efficiency)


@pytest.mark.parametrize("integrator", ["Euler", "implicitfast", "RK4"])
def test_torque_is_held_during_a_step_whatever_the_integrator(integrator):
    """A Runge-Kutta step calls the callback four times; the oracle sets the torque once."""
    calibration, designs = load_calibration("reference-3"), random_designs(4, seed=12)
    reads = "state" if integrator == "RK4" else "half_step_back"
    simulation = replace(calibration.simulation, integrator=integrator, positions_read=reads)
    calibration = replace(calibration, simulation=simulation)
    robots = plausible_robots(designs)
    found = evaluate_robots(robots, designs[:, 4:], calibration)
    for i, design in enumerate(designs):
        motors = oracle.motors_of(robots, i, calibration)
        jump = oracle.jump(
            mjcf(robots, calibration, i),
            *design[4:],
            motors,
            fade=calibration.gate.length_m,
            read_back=integrator != "RK4",
        )
        assert found.height_m[i] == pytest.approx(jump.height, rel=1e-9)
        assert found.energy_j[i] == pytest.approx(jump.energy, rel=1e-9)
