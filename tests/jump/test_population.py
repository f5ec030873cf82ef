"""The batch against the independent loop of ``oracle``, and against itself."""

from dataclasses import replace

import numpy as np
import pytest

from pareto_monoped.jump.calibration import load_calibration
from pareto_monoped.jump.evaluate import evaluate_robots
from pareto_monoped.jump.model import mjcf
from pareto_monoped.jump.rows import take
from tests.jump import oracle
from tests.jump.robots import plausible_robots, random_designs


def test_plain_mj_step_on_the_exported_model_agrees():
    """To 1e-9 on all of 100 random designs: the reference amplifies rounding by less than a thousand."""
    calibration, designs = load_calibration(), random_designs(100, seed=7)
    robots = plausible_robots(designs)
    found = evaluate_robots(robots, designs[:, 4:], calibration)
    for i, design in enumerate(designs):
        jump = oracle.jump(
            mjcf(robots, calibration, i),
            *design[4:],
            oracle.motors_of(robots, i, calibration),
            fade=calibration.gate.length_m,
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
        )
        agreed += bool(
            found.height_m[i] == pytest.approx(jump.height, rel=1e-6)
            and found.energy_j[i] == pytest.approx(jump.energy, rel=1e-6)
        )
    assert agreed >= 12


@pytest.fixture(scope="module")
def many():
    designs = random_designs(60, seed=3)
    return (
        designs,
        plausible_robots(designs),
        evaluate_robots(plausible_robots(designs), designs[:, 4:], load_calibration()),
    )


def same_rows(part, whole, rows):
    for name, values in part.as_columns().items():
        np.testing.assert_array_equal(values, whole.as_columns()[name][rows], err_msg=name)


@pytest.mark.parametrize("size", [1, 2, 7, 33])
def test_bits_do_not_depend_on_the_batch(many, size):
    designs, robots, whole = many
    rows = np.random.default_rng(size).permutation(len(designs))[:size]
    same_rows(evaluate_robots(take(robots, rows), designs[rows, 4:], load_calibration()), whole, rows)


@pytest.mark.parametrize("workers", [2, 3])
def test_bits_do_not_depend_on_workers(many, workers):
    designs, robots, whole = many
    same_rows(evaluate_robots(robots, designs[:, 4:], load_calibration(), workers), whole, np.arange(len(designs)))


def test_inputs_are_not_changed(many):
    designs, robots, _ = many
    before, fresh = designs.copy(), plausible_robots(designs)
    evaluate_robots(robots, designs[:, 4:], load_calibration())
    np.testing.assert_array_equal(designs, before)
    np.testing.assert_array_equal(robots.body_mass_kg, fresh.body_mass_kg)
    np.testing.assert_array_equal(robots.efficiency, fresh.efficiency)


@pytest.mark.parametrize("integrator", ["Euler", "implicitfast", "RK4"])
def test_torque_is_held_during_a_step_whatever_the_integrator(integrator):
    """A Runge-Kutta step asks the callback four times; the oracle sets the torque once."""
    calibration, designs = load_calibration(), random_designs(8, seed=12)
    calibration = replace(calibration, simulation=replace(calibration.simulation, integrator=integrator))
    robots = plausible_robots(designs)
    found = evaluate_robots(robots, designs[:, 4:], calibration)
    for i, design in enumerate(designs):
        motors = oracle.motors_of(robots, i, calibration)
        jump = oracle.jump(mjcf(robots, calibration, i), *design[4:], motors, fade=calibration.gate.length_m)
        assert found.height_m[i] == pytest.approx(jump.height, rel=1e-9)
        assert found.energy_j[i] == pytest.approx(jump.energy, rel=1e-9)
