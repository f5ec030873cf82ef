"""A robot on the rails of the test stand: what it lifts, what the rails take, and what stays that of the robot."""

from dataclasses import replace

import mujoco
import numpy as np
import pytest

from pareto_monoped.actuator.search import map_for
from pareto_monoped.design import CONTROL, LOWER, PAPER_CASES, UPPER, columns, complete
from pareto_monoped.jump.balance import balanced, energy_balance
from pareto_monoped.jump.calibration import load_calibration
from pareto_monoped.jump.document import mjcf
from pareto_monoped.jump.evaluate import Evaluator
from pareto_monoped.jump.single import trace_of
from pareto_monoped.jump.variations import take
from pareto_monoped.robot.population import robot_arrays
from tests.jump.test_loads import SMOOTH, loads_by_mujoco
from tests.jump.test_variations import neutral

MAP = map_for("VT8020")
REFERENCE, STAND = load_calibration("reference-3"), load_calibration("stand-1")
CASES = complete(np.array([case.design.as_array() for case in PAPER_CASES.values()]))
RANDOM = complete(np.random.default_rng(5).uniform(LOWER, UPPER, (20, len(LOWER))))
ALL = np.vstack((CASES, RANDOM))
RAILS_N = 4 * 1.0
"""Four carriages of 1 N."""


@pytest.fixture(scope="module")
def jumps():
    return {known.name: Evaluator(MAP, known)(ALL) for known in (REFERENCE, STAND)}


def test_the_robot_is_the_same_and_only_the_base_is_heavier():
    robots = robot_arrays(CASES[0], MAP)
    loose, held = (mujoco.MjModel.from_xml_string(mjcf(robots, known)) for known in (REFERENCE, STAND))
    # Arms of 93 g (tests/leg/test_stand.py), carriages of 54 g and 16 screws M3 x 8 of 1 g.
    assert held.body("base").mass[0] - loose.body("base").mass[0] == pytest.approx(0.418, abs=0.001)
    for body in ("thigh", "shank"):
        assert held.body(body).mass[0] == loose.body(body).mass[0]
    assert (held.njnt, loose.njnt) == (3, 4)
    assert held.joint("slide_z").frictionloss[0] == RAILS_N


def test_measures_of_the_robot_leave_the_stand_out(jumps):
    for name in ("mass_kg", "cost_eur", "made_parts", "bought_parts"):
        np.testing.assert_array_equal(jumps["stand"].of(name), jumps["reference"].of(name))
    assert np.all(jumps["stand"].drift_m[jumps["stand"].ok] == 0.0)


def test_efficiency_counts_the_lift_of_the_robot_alone(jumps):
    found, start_m = jumps["stand"], 0.5
    lifted_j = 9.81 * found.mass_kg * (found.height_m - start_m)
    np.testing.assert_allclose(found.efficiency[found.ok], (lifted_j / found.energy_j)[found.ok], rtol=1e-12)


@pytest.mark.parametrize("speed_m_per_s", [1.5, -1.5])
def test_free_fall_along_the_rails_is_slowed_by_their_friction(speed_m_per_s):
    """The centre of mass of all that moves has the acceleration -g less friction over mass, against the motion."""
    robots = robot_arrays(CASES[3], MAP)
    model = mujoco.MjModel.from_xml_string(mjcf(robots, STAND))
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    data.joint("slide_z").qpos[0] = 3.0
    data.joint("slide_z").qvel[0] = speed_m_per_s
    moved_kg = robots.body_mass_kg.sum() + 0.186 + 4 * 0.054 + 16 * 0.001
    mujoco.mj_forward(model, data)
    speeds = []
    for _ in range(2):
        mujoco.mj_subtreeVel(model, data)
        speeds.append(data.subtree_linvel[0, 2])
        mujoco.mj_step(model, data, 50)
        mujoco.mj_forward(model, data)
    expected = -9.81 - np.sign(speed_m_per_s) * RAILS_N / moved_kg
    assert (speeds[1] - speeds[0]) / 0.05 == pytest.approx(expected, rel=1e-4)


def test_the_balance_closes_and_the_rails_take_their_friction_along_the_way():
    for design in ALL[2:6]:
        robots, control = robot_arrays(design, MAP), columns(design[None], CONTROL)
        balance = energy_balance(robots, control, STAND)
        assert abs(balance.residual_j) < 0.001 * balance.joint_work_j
        assert balance.error < 0.001
        trace = trace_of(robots, control, STAND)
        assert balance.rails_j == pytest.approx(RAILS_N * np.abs(np.diff(trace["base_z_m"])).sum(), rel=0.01)
        assert balance.potential_j == pytest.approx(trace["potential_j"][-1] - trace["potential_j"][0], rel=1e-3)


def test_many_balances_close_at_once():
    robots, control = robot_arrays(ALL, MAP), columns(ALL, CONTROL)
    assert np.all(balanced(robots, control, STAND).error < 0.002)


def test_a_batch_and_a_single_jump_are_the_same_to_the_bit(jumps):
    for i in (0, 3, 7):
        trace = trace_of(robot_arrays(ALL[i], MAP), columns(ALL[i : i + 1], CONTROL), STAND)
        assert trace["base_z_m"].max() == jumps["stand"].height_m[i]


@pytest.mark.parametrize("every", [10, pytest.param(1, marks=pytest.mark.long)])
def test_loads_are_those_of_the_constraints(every):
    """The rails take the side force of the floor, which follows from the joint that is off its stops."""
    stand = replace(STAND, joints=SMOOTH.joints)
    found = Evaluator(MAP, stand)(ALL)
    for i, design in list(enumerate(ALL))[::every]:
        if found.ok[i]:
            expected = loads_by_mujoco(robot_arrays(design, MAP), columns(design[None], CONTROL), stand)
            for name, value in expected.items():
                assert found.of(name)[i] == pytest.approx(value, rel=1e-3, abs=1e-6), (name, i)


def test_mass_and_friction_of_the_stand_vary(jumps):
    """A factor of 1 changes nothing; rails of twice the friction are those of a calibration of twice the friction."""
    alike = neutral(len(ALL))
    found = Evaluator(MAP, STAND)(ALL, variations=alike)
    np.testing.assert_array_equal(found.height_m, jumps["stand"].height_m)
    twice = replace(alike, rail_friction=np.full(len(ALL), 2.0))
    rough = Evaluator(MAP, replace(STAND, stand=replace(STAND.stand, rail_friction_n=2.0)))(ALL)
    found = Evaluator(MAP, STAND)(ALL, variations=twice)
    np.testing.assert_array_equal(found.height_m, rough.height_m)
    np.testing.assert_array_equal(found.peak_foot_force_n, rough.peak_foot_force_n)
    more = replace(alike, stand_mass=np.full(len(ALL), 1.5))
    heavy = Evaluator(MAP, STAND)(ALL, variations=more)
    assert np.all((heavy.height_m < jumps["stand"].height_m)[heavy.ok])
    np.testing.assert_array_equal(heavy.mass_kg, jumps["stand"].mass_kg)
    alone = Evaluator(MAP, STAND)(ALL[3:4], variations=take(more, np.array([3])))
    assert alone.height_m[0] == heavy.height_m[3]
