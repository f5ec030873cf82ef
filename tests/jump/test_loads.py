"""The loads of a jump are those of MuJoCo's constraint forces, which the controller never sees."""

from dataclasses import replace

import mujoco
import numpy as np
import pytest

from pareto_monoped.actuator.search import map_for
from pareto_monoped.design import CONTROL, LOWER, PAPER_CASES, UPPER, columns, complete
from pareto_monoped.jump.calibration import load_calibration
from pareto_monoped.jump.evaluate import Evaluator
from pareto_monoped.jump.single import constraint_forces, moments
from pareto_monoped.robot.population import robot_arrays

REFERENCE = load_calibration("reference-3")
"""With rigid drives and MuJoCo's stops; loads of elastic ones are those of ``planar.py`` and ``test_elastic``."""
SMOOTH = replace(REFERENCE, joints=replace(REFERENCE.joints, friction_n_m=0.0))
STEP = REFERENCE.simulation.timestep_s


EVERY = pytest.mark.parametrize("every", [7, pytest.param(1, marks=pytest.mark.long)])
"""Which share of the designs jumps in the plain loop."""


@pytest.fixture(scope="module")
def designs():
    paper = [case.design.as_array() for case in PAPER_CASES.values()]
    return np.vstack([paper, complete(np.random.default_rng(5).uniform(LOWER, UPPER, (6, len(LOWER))))])


def shank_jacobian(moment, qpos):
    """Of the velocity of the shank's centre of mass."""
    data, jacobian = moment.scratch, np.zeros((3, moment.model.nv))
    data.qpos[:] = qpos
    mujoco.mj_kinematics(moment.model, data)
    mujoco.mj_comPos(moment.model, data)
    mujoco.mj_jacBodyCom(moment.model, data, jacobian, None, moment.model.body("shank").id)
    return jacobian


def knee_force(moment, floor):
    """What accelerates the shank besides its weight and the floor, as MuJoCo steps: with the speeds at the start."""
    qpos, qvel, tick = moment.qpos, moment.qvel, 1e-6
    bend = (shank_jacobian(moment, qpos + tick * qvel) - shank_jacobian(moment, qpos - tick * qvel)) / (2.0 * tick)
    change = (moment.after.qvel - qvel) / STEP
    acceleration = shank_jacobian(moment, qpos) @ change + bend @ qvel + [0.0, 0.0, 9.81]
    return acceleration[[0, 2]] * moment.model.body("shank").mass[0] - np.asarray(floor)[:2]


def floor_force(moment):
    """Of the floor on the foot, x and z, from MuJoCo's contacts: a base on rails has no coordinate for x."""
    total, force = np.zeros(3), np.zeros(6)
    for k, contact in enumerate(moment.data.contact):
        mujoco.mj_contactForce(moment.model, moment.data, k, force)
        total += contact.frame.reshape(3, 3).T @ force[:3]
    return total[[0, 2]]


def loads_by_mujoco(robots, control, calibration):
    """Stop torque, stop energy, foot force, gear torques and chain pull of one jump, from a plain loop."""
    foot = energy = pull = knee = 0.0
    stop, gear, beyond = np.zeros(2), np.zeros(2), np.zeros(2)
    ends = [(stop.lower_rad, stop.upper_rad) for stop in (robots.stops.hip, robots.stops.knee)]
    rotor, ratio = robots.rotor_inertia_kg_m2[0], robots.ratio[0]
    absolute = calibration.joints.rotors == "absolute"
    for moment in moments(robots, control, calibration):
        if moment.last:
            break
        limits, force = constraint_forces(moment.data)[1], floor_force(moment)
        knee = max(knee, np.linalg.norm(knee_force(moment, force)))
        limits = limits[-2:]
        change = (moment.after.qvel - moment.qvel)[-2:] / STEP
        stop, foot = np.maximum(stop, np.abs(limits)), max(foot, np.hypot(force[0], force[1]))
        for k, (lower, upper) in enumerate(ends):
            beyond[k] = max(beyond[k], lower - moment.qpos[-2 + k], moment.qpos[-2 + k] - upper)
        energy -= float(limits @ (0.5 * (moment.qvel[-2:] + moment.after.qvel[-2:]))) * STEP
        motor = change * ratio + [0.0, change[0] if absolute else 0.0]
        torque = moment.record["motor_torque_n_m"]
        gear = np.maximum(gear, np.abs(torque - rotor * ratio * motor))
        if absolute:
            before = robots.knee_reflected_kg_m2[0] * change[1] + robots.knee_coupling_kg_m2[0] * change[0]
        else:
            before = robots.armature_kg_m2[0, 1] * change[1]
        pull = max(pull, abs(moment.data.ctrl[1] - before) / robots.sprocket_radius_m[0])
    return {
        "peak_stop_torque_n_m": stop.max(),
        "peak_stop_torque_hip_n_m": stop[0],
        "peak_stop_torque_knee_n_m": stop[1],
        # A bumper has given all it can when it is squeezed to half of its diameter.
        "stop_compression_hip": beyond[0] * robots.stops.hip.lever_mm / (0.5 * robots.stops.hip.bumper.diameter_mm),
        "stop_compression_knee": beyond[1] * robots.stops.knee.lever_mm / (0.5 * robots.stops.knee.bumper.diameter_mm),
        "stop_energy_j": energy,
        "peak_foot_force_n": foot,
        "peak_knee_force_n": knee,
        "peak_gear_torque_hip_n_m": gear[0],
        "peak_gear_torque_knee_n_m": gear[1],
        "peak_chain_tension_n": pull,
        "drift_m": abs(moment.qpos[0]) if len(moment.qpos) == 4 else 0.0,
    }


@EVERY
@pytest.mark.parametrize("rotors", [pytest.param("armature", marks=pytest.mark.long), "absolute"])
def test_loads_are_those_of_the_constraints(designs, rotors, every):
    actuator_map = map_for("VT8020")
    calibration = replace(SMOOTH, joints=replace(SMOOTH.joints, rotors=rotors))
    evaluations = Evaluator(actuator_map, calibration)(designs)
    assert evaluations.ok.all()
    for i, design in list(enumerate(designs))[::every]:
        robots = robot_arrays(design, actuator_map)
        # MuJoCo's contact point lies in the middle of the foot's 2 mm of compression, ours at its sole.
        for name, value in loads_by_mujoco(robots, columns(design[None], CONTROL), calibration).items():
            assert getattr(evaluations, name)[i] == pytest.approx(value, rel=1e-3, abs=1e-6), (name, i)


@EVERY
def test_coulomb_friction_is_counted_with_the_stop(designs, every):
    actuator_map = map_for("VT8020")
    evaluations = Evaluator(actuator_map, REFERENCE)(designs)
    for i, design in list(enumerate(designs))[::every]:
        expected = loads_by_mujoco(robot_arrays(design, actuator_map), columns(design[None], CONTROL), REFERENCE)
        off = abs(evaluations.peak_stop_torque_n_m[i] - expected["peak_stop_torque_n_m"])
        assert off < REFERENCE.joints.friction_n_m + 0.05


def test_without_stops_nothing_ends_in_them(designs):
    free = replace(REFERENCE, joints=replace(REFERENCE.joints, stops="given"))
    evaluations = Evaluator(map_for("VT8020"), free)(designs)
    assert np.all(evaluations.peak_stop_torque_n_m[evaluations.ok] == 0.0)
    assert np.all(evaluations.stop_energy_j[evaluations.ok] == 0.0)


def test_a_guided_base_does_not_drift(designs):
    guided = replace(REFERENCE, simulation=replace(REFERENCE.simulation, base_slides=False))
    evaluations = Evaluator(map_for("VT8020"), guided)(designs)
    assert np.all(evaluations.drift_m[evaluations.ok] == 0.0)
