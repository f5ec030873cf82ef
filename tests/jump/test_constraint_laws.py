"""The laws of contact, sliding, joint friction and end stops, as docs/model.md words them, against MuJoCo's forces.

Each law gives a force from position, speed and acceleration. MuJoCo's own acceleration goes in, so no solver is needed.
"""

import mujoco
import numpy as np
import pytest

from pareto_monoped.actuator.search import map_for
from pareto_monoped.design import LOWER, UPPER
from pareto_monoped.jump.calibration import load_calibration
from pareto_monoped.jump.document import mjcf
from pareto_monoped.jump.end_stops import end_stops
from pareto_monoped.jump.single import constraint_forces
from pareto_monoped.robot.population import robot_arrays

REFERENCE = load_calibration("reference-3")
CONTACT = REFERENCE.contact


@pytest.fixture(scope="module")
def states():
    """Models and data at random states: the foot touches and slips or sticks, the knee may be in a stop."""
    rng, found = np.random.default_rng(4), []
    designs = rng.uniform(LOWER, UPPER, (10, len(LOWER)))
    robots = robot_arrays(designs, map_for("VT8020"))
    for i in range(len(designs)):
        model = mujoco.MjModel.from_xml_string(mjcf(robots, REFERENCE, i))
        for _ in range(40):
            data = mujoco.MjData(model)
            data.qpos[2:] = rng.uniform(-1.0, 0.0), rng.uniform(0.1, 2.0)
            mujoco.mj_kinematics(model, data)
            depth = rng.uniform(0.0, 1.2 * CONTACT.width_m)
            data.qpos[1] -= data.site("foot").xpos[2] - model.geom("foot").size[0] + depth
            data.qvel[:] = rng.normal(0.0, 1.0, 4) * [0.3, 0.3, 3.0, 3.0] * rng.choice([0.02, 1.0])
            data.ctrl[:] = rng.uniform(-1.0, 1.0, 2) * model.actuator_ctrlrange[:, 1]
            mujoco.mj_forward(model, data)
            found.append((robots, model, data))
    return found


def at_the_contact(model, data):
    """Jacobian (x and z) of the point half-way between the floor and the lowest point of the foot, and the depth."""
    foot, radius = data.site("foot").xpos, model.geom("foot").size[0]
    depth = radius - foot[2]
    point = np.array([foot[0], 0.0, -0.5 * depth])
    jacobian = np.zeros((3, model.nv))
    mujoco.mj_jac(model, data, jacobian, None, point, model.body("shank").id)
    return jacobian[[0, 2]], depth


def documented_contact(model, data):
    """Force (x, z) of the floor by the laws of docs/model.md."""
    jacobian, depth = at_the_contact(model, data)
    if depth <= 0.0:
        return np.zeros(2), jacobian
    inverse, full, least = model.body("shank").invweight0[0], CONTACT.impedance, 1e-4
    d = least + (full - least) * min(depth / CONTACT.width_m, 1.0)
    mass = d / (1.0 - d) / inverse
    stiffness = CONTACT.stiffness_n_per_m * inverse * (1.0 - full) * d / full**2
    damping = CONTACT.damping_n_s_per_m * inverse * (1.0 - full) / full
    slip, rise = jacobian @ data.qvel
    along, up = jacobian @ data.qacc
    pull_n = stiffness * depth - damping * rise - up
    pull_t = -damping * slip - along
    ratio, mu = CONTACT.slip_ratio, CONTACT.friction
    if ratio * abs(pull_t) <= mu * pull_n:
        return mass * np.array([ratio * pull_t, pull_n]), jacobian
    normal = mass * max(0.0, pull_n + mu * abs(pull_t)) / (1.0 + mu**2 / ratio)
    return np.array([np.sign(pull_t) * mu * normal, normal]), jacobian


def test_the_floors_force_is_the_documented_one(states):
    sliding = sticking = 0
    for _, model, data in states:
        force, jacobian = documented_contact(model, data)
        found = constraint_forces(data)[2]
        np.testing.assert_allclose(jacobian.T @ force, found, rtol=1e-6, atol=1e-6 * (1.0 + np.abs(found).max()))
        slips = abs(abs(force[0]) - CONTACT.friction * force[1]) < 1e-9 * (1.0 + force[1])
        sliding += force[1] > 1.0 and slips
        sticking += force[1] > 1.0 and not slips
    assert sliding > 50
    assert sticking > 20


def test_the_joints_friction_is_the_documented_one(states):
    """9 / A (-a - v / 9.5 ms) within the Coulomb torque: MuJoCo's default regularisation."""
    saturated = creeping = 0
    for _, model, data in states:
        most = REFERENCE.joints.friction_n_m
        wanted = 9.0 / model.dof_invweight0[2:] * (-data.qacc[2:] - 2.0 / (0.95 * 0.02) * data.qvel[2:])
        np.testing.assert_allclose(constraint_forces(data)[0][2:], np.clip(wanted, -most, most), rtol=1e-6, atol=1e-9)
        saturated += int((np.abs(wanted) > most).sum())
        creeping += int((np.abs(wanted) < most).sum())
    assert saturated > 100
    assert creeping > 0


def test_the_end_stops_torque_is_the_documented_one(states):
    pushed = 0
    for robots, model, data in states:
        stop, angle = end_stops(robots, REFERENCE.joints)[1], data.qpos[3]
        found = constraint_forces(data)[1][3]
        beyond = stop.lower_rad - angle
        if beyond <= 0.0:
            assert found == 0.0
            continue
        d = 1e-4 + (stop.impedance - 1e-4) * min(beyond / stop.width_rad, 1.0)
        share = d / stop.impedance * (1.0 - stop.impedance) / (1.0 - d)
        spring = stop.stiffness_n_m_per_rad * share * d / stop.impedance * beyond
        virtual = d / (1.0 - d) / model.dof_invweight0[3]
        torque = spring - stop.damping_n_m_s_per_rad * share * data.qvel[3] - virtual * data.qacc[3]
        assert found == pytest.approx(max(0.0, torque), rel=1e-6, abs=1e-6)
        pushed += found > 1.0
    assert pushed > 10


def test_inverse_masses_are_those_of_the_zero_pose(states):
    """A of a joint: its diagonal entry of the inverse mass matrix; of the foot: a third of the trace of the shank's."""
    for _, model, _ in states[::40]:
        data = mujoco.MjData(model)
        mujoco.mj_forward(model, data)
        matrix, jacobian = np.zeros((model.nv, model.nv)), np.zeros((3, model.nv))
        mujoco.mj_fullM(model, data, matrix)
        inverse = np.linalg.inv(matrix)
        np.testing.assert_allclose(model.dof_invweight0, np.diag(inverse), rtol=1e-9)
        shank = model.body("shank").id
        mujoco.mj_jac(model, data, jacobian, None, data.xipos[shank], shank)
        expected = np.trace(jacobian @ inverse @ jacobian.T) / 3.0
        assert model.body("shank").invweight0[0] == pytest.approx(expected, rel=1e-9)
