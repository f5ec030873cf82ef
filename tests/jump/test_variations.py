"""Varied robots: neutral variations change no bit, and each variation is that of a robot or calibration made so."""

from dataclasses import replace

import numpy as np
import pytest

from pareto_monoped.actuator.search import map_for
from pareto_monoped.design import PAPER_CASES, PAPER_CONTROL, complete_control
from pareto_monoped.jump.calibration import load_calibration
from pareto_monoped.jump.evaluate import Evaluator, evaluate_robots
from pareto_monoped.jump.variations import unvaried
from pareto_monoped.measures import MEASURE_NAMES
from pareto_monoped.robot.population import robot_arrays

DESIGNS = np.array([PAPER_CASES[name].design.as_array() for name in ("C", "A")])


@pytest.fixture(scope="module", params=["reference", "reference-3"])
def evaluator(request):
    """With elastic drives and the compiled engine, and with rigid ones by MuJoCo."""
    return Evaluator(map_for("VT8020"), load_calibration(request.param))


def neutral(n=2, **changes):
    return replace(unvaried(n), **changes)


def same(one, other, names=("height_m", "energy_j", "peak_foot_force_n", "stop_energy_j", "peak_chain_tension_n")):
    for name in names:
        np.testing.assert_array_equal(getattr(one, name), getattr(other, name), err_msg=name)


def test_neutral_variations_change_no_bit(evaluator):
    same(evaluator(DESIGNS, variations=neutral()), evaluator(DESIGNS), MEASURE_NAMES)


def test_the_result_does_not_depend_on_batch_or_workers(evaluator):
    generator = np.random.default_rng(1)
    n = 12
    varied = neutral(n, masses=generator.uniform(0.95, 1.05, (n, 3)), delays_s=0.001 * generator.integers(0, 4, n))
    designs = np.repeat(DESIGNS[:1], n, axis=0)
    together = Evaluator(evaluator.actuator_map, evaluator.calibration, workers=2)(designs, variations=varied)
    alone = evaluator(designs[7:8], variations=neutral(1, masses=varied.masses[7:8], delays_s=varied.delays_s[7:8]))
    for name in MEASURE_NAMES:
        np.testing.assert_array_equal(getattr(together, name)[7:8], getattr(alone, name))


def as_calibrated(evaluator, **tables):
    """The jumps under a calibration with other numbers, some of them functions of those that it has."""
    calibration = evaluator.calibration
    changed = {}
    for table, numbers in tables.items():
        known = getattr(calibration, table)
        new = {name: value(getattr(known, name)) if callable(value) else value for name, value in numbers.items()}
        changed[table] = replace(known, **new)
    return Evaluator(evaluator.actuator_map, replace(calibration, **changed))(DESIGNS)


def times(factor):
    return lambda value: factor * value


@pytest.mark.parametrize(
    ("change", "tables", "rtol"),
    [
        (
            {"friction": np.full(2, 1.5)},
            {"joints": dict.fromkeys(("friction_n_m", "friction_share"), times(1.5))},
            1e-9,
        ),
        (
            {"damping": np.full(2, 0.5)},
            {"joints": dict.fromkeys(("damping_n_m_s_per_rad", "motor_damping_share_s_per_rad"), times(0.5))},
            1e-9,
        ),
        (
            {"foot_stiffness": np.full(2, 1.25)},
            {"contact": {"stiffness_n_per_m": times(1.25)}},
            # A varied robot starts in the pose of the nominal foot, which is compressed by some 0.05 mm more.
            1e-4,
        ),
        ({"delays_s": np.full(2, 0.003)}, {"simulation": {"delay_s": 0.003}}, 1e-9),
        ({"delays_s": np.full(2, 0.0014)}, {"simulation": {"delay_s": 0.001}}, 1e-9),
        (
            {"peak_torques": np.full((2, 2), 0.9)},
            # Friction stays: it is a share of the torque that motors of this kind are rated for.
            {"drive": {"peak_torque_scale": 0.9}},
            1e-9,
        ),
    ],
    ids=["friction", "damping", "foot", "delay", "part of a period", "torque"],
)
def test_what_a_calibration_can_say_is_as_if_it_said_so(evaluator, change, tables, rtol):
    varied, calibrated = evaluator(DESIGNS, variations=neutral(**change)), as_calibrated(evaluator, **tables)
    np.testing.assert_allclose(varied.height_m, calibrated.height_m, rtol=rtol)
    np.testing.assert_allclose(varied.energy_j, calibrated.energy_j, rtol=10.0 * rtol)
    assert (varied.height_m != evaluator(DESIGNS).height_m).any()


@pytest.mark.parametrize(
    ("change", "tables"),
    [
        ({"chain_loss": np.full(2, 2.5)}, {"drive": {"chain_efficiency": 1.0 - 2.5 * 0.02}}),
        (
            {"winding_resistance": np.full(2, 1.1)},
            # 1 + 0.00393 (T - 20) times 1.1, at the calibration's own temperature T
            {"drive": {"winding_rise_k": lambda rise: (1.1 * (1.0 + 0.00393 * rise) - 1.0) / 0.00393}},
        ),
        ({"gear_loss": np.zeros(2)}, {"drive": {"mesh_losses": False}}),
        ({"gear_loss": np.full(2, 2.3)}, {"drive": {"gear_loss": 2.3}}),
    ],
    ids=["chain", "winding", "gears without losses", "printed gears"],
)
def test_losses_and_warmth_are_as_if_the_calibration_said_so(evaluator, change, tables):
    varied, calibrated = evaluator(DESIGNS, variations=neutral(**change)), as_calibrated(evaluator, **tables)
    for name in ("height_m", "energy_j", "electrical_energy_j", "drive_loss_j"):
        np.testing.assert_allclose(getattr(varied, name), getattr(calibrated, name), rtol=1e-9)
    assert (varied.electrical_energy_j != evaluator(DESIGNS).electrical_energy_j).all()


def test_twice_the_loss_of_gears_is_twice_what_they_lose_of_the_torque(evaluator):
    varied, plain = evaluator(DESIGNS, variations=neutral(gear_loss=np.full(2, 2.0))), evaluator(DESIGNS)
    assert (varied.height_m < plain.height_m).all()
    share = varied.drive_loss_j / (varied.energy_j - varied.absorbed_j)
    before = plain.drive_loss_j / (plain.energy_j - plain.absorbed_j)
    robots = robot_arrays(DESIGNS, evaluator.actuator_map)
    knee = robots.efficiency_total[:, 1]
    np.testing.assert_allclose(share / before, (1.0 - 0.98 * (2.0 * knee - 1.0)) / (1.0 - 0.98 * knee), rtol=0.03)


def test_a_heavier_rotor_is_a_robot_with_that_rotor(evaluator):
    """All moments of what turns at the motors' speed, by hand: J g^2 at the joints, J g and J to the thigh."""
    robots, more = robot_arrays(DESIGNS, evaluator.actuator_map), 0.2
    rotor, ratio = robots.rotor_inertia_kg_m2, robots.ratio
    heavier = replace(
        robots,
        rotor_inertia_kg_m2=1.2 * rotor,
        armature_kg_m2=robots.armature_kg_m2 + more * rotor * ratio**2,
        knee_reflected_kg_m2=robots.knee_reflected_kg_m2 + more * (rotor * ratio**2)[:, 1],
        knee_coupling_kg_m2=robots.knee_coupling_kg_m2 + more * (rotor * ratio)[:, 1],
        rotor_excess_kg_m2=robots.rotor_excess_kg_m2 + more * rotor[:, 1],
    )
    varied = evaluator(DESIGNS, variations=neutral(rotor_inertia=np.full(2, 1.2)))
    expected = evaluate_robots(heavier, complete_control(DESIGNS[:, 4:7]), evaluator.calibration)
    np.testing.assert_allclose(varied.height_m, expected.height_m, rtol=1e-9)
    assert (varied.height_m < evaluator(DESIGNS).height_m).all()


def test_less_rebound_takes_more_of_the_energy_at_the_stop():
    elastic = Evaluator(map_for("VT8020"), load_calibration("reference"))
    dull, plain = elastic(DESIGNS, variations=neutral(rebound=np.full(2, 0.5))), elastic(DESIGNS)
    lively = elastic(DESIGNS, variations=neutral(rebound=np.full(2, 1.9)))
    assert (dull.stop_energy_j != plain.stop_energy_j).all()
    assert (dull.height_m > plain.height_m).all()
    assert (lively.height_m < plain.height_m).all()
    same(elastic(DESIGNS, variations=neutral()), plain)


def test_gains_and_lengths_are_those_of_another_design_with_the_same_masses(evaluator):
    robots = robot_arrays(DESIGNS, evaluator.actuator_map)
    longer = replace(robots, thigh_length_m=robots.thigh_length_m + 5e-4, shank_length_m=robots.shank_length_m - 3e-4)
    control = complete_control(DESIGNS[:, 4:7] * [1.05, 0.95, 1.02])
    assert len(PAPER_CONTROL) == 3
    varied = evaluator(
        DESIGNS,
        variations=neutral(gains=np.tile([1.05, 0.95, 1.02], (2, 1)), link_lengths_m=np.tile([5e-4, -3e-4], (2, 1))),
    )
    same(varied, evaluate_robots(longer, control, evaluator.calibration))


def test_a_lower_voltage_is_a_lower_no_load_speed(evaluator):
    robots = robot_arrays(DESIGNS, evaluator.actuator_map)
    slower = replace(robots, no_load_speed_rad_per_s=0.15 * robots.no_load_speed_rad_per_s)
    varied = evaluator(DESIGNS, variations=neutral(no_load_speeds=np.full(2, 0.15)))
    assert (varied.energy_j != evaluator(DESIGNS).energy_j).any()
    same(varied, evaluate_robots(slower, complete_control(DESIGNS[:, 4:7]), evaluator.calibration))


def test_the_controller_does_not_know_the_true_mass(evaluator):
    """The jump of a heavier robot whose controller knows its mass is another one."""
    robots = robot_arrays(DESIGNS, evaluator.actuator_map)
    heavier = replace(
        robots, body_mass_kg=1.05 * robots.body_mass_kg, body_inertia_kg_m2=1.05 * robots.body_inertia_kg_m2
    )
    knowing = evaluate_robots(heavier, complete_control(DESIGNS[:, 4:7]), evaluator.calibration)
    varied = evaluator(DESIGNS, variations=neutral(masses=np.full((2, 3), 1.05)))
    np.testing.assert_allclose(varied.mass_kg, knowing.mass_kg)
    # Its m g is too small, so that it pushes less. With a feed-forward of 1 / 1.05 the other one does the same.
    controller = replace(
        evaluator.calibration.controller,
        gravity_feed_forward=evaluator.calibration.controller.gravity_feed_forward / 1.05,
    )
    less = replace(evaluator.calibration, controller=controller)
    unknowing = evaluate_robots(heavier, complete_control(DESIGNS[:, 4:7]), less)
    np.testing.assert_allclose(varied.height_m, unknowing.height_m, rtol=1e-9)
    assert (np.abs(varied.height_m - knowing.height_m) > 1e-6).any()


def test_stiffer_stops_take_the_same_jump_up_to_the_stop(evaluator):
    varied, plain = evaluator(DESIGNS, variations=neutral(stop_stiffness=np.full(2, 1.3))), evaluator(DESIGNS)
    assert (varied.peak_stop_torque_n_m > plain.peak_stop_torque_n_m).any()
    assert (varied.stop_compression_knee < plain.stop_compression_knee).any()
    np.testing.assert_array_equal(varied.peak_torque_hip_n_m, plain.peak_torque_hip_n_m)
