from dataclasses import replace

import mujoco
import numpy as np
import pytest

from pareto_monoped.jump.calibration import load_calibration
from pareto_monoped.jump.controller_record import RECORD_NUMBERS
from pareto_monoped.jump.document import mjcf
from pareto_monoped.jump.end_stops import end_stops
from pareto_monoped.jump.model import start_pose
from pareto_monoped.jump.population import prepare
from tests.jump.robots import plausible_robots, random_designs


@pytest.fixture(scope="module")
def designs():
    return random_designs(6, seed=11)


def _compiled(designs, calibration, i=0):
    return mujoco.MjModel.from_xml_string(mjcf(plausible_robots(designs), calibration, i))


@pytest.mark.parametrize("name", ["reference", "reference-3", "paper", "ideal", "stand"])
def test_batch_simulates_exactly_the_exported_model(designs, name):
    calibration, robots = load_calibration(name), plausible_robots(designs)
    population = prepare(robots, designs[:, 4:], start_pose(robots, calibration), calibration.by("mujoco"))
    compared = 0
    for i in range(len(designs)):
        exported, simulated = _compiled(designs, calibration, i), population.batch.get_model(i)
        for field in dir(exported):
            value = getattr(exported, field)
            # The keyframe is not in the batch: its state is written directly, and compared below.
            if isinstance(value, np.ndarray) and field not in ("key_qpos", "_sizes"):
                np.testing.assert_array_equal(value, getattr(simulated, field), err_msg=field)
                compared += 1
        # In the batch, user data holds the controller's record.
        assert (exported.nuserdata, simulated.nuserdata) == (0, RECORD_NUMBERS)
        assert np.count_nonzero(exported._sizes != simulated._sizes) == 1
        np.testing.assert_array_equal(exported.key_qpos[0], population.batch.bind("qpos")[i])
        assert bytes(str(exported.opt), "utf-8") == bytes(str(simulated.opt), "utf-8")
    assert compared > 100 * len(designs)


@pytest.mark.parametrize(("calibration", "turned"), [("reference", "{}_motor"), ("reference-3", "{}")])
def test_names_others_rely_on(designs, calibration, turned):
    """A motor turns its joint, or its own end of an elastic drive."""
    model = _compiled(designs, load_calibration(calibration))
    for body in ("base", "thigh", "shank"):
        assert model.body(body).id > 0
    for joint in ("slide_x", "slide_z", "hip", "knee"):
        model.joint(joint)
    for geom in ("floor", "foot"):
        model.geom(geom)
    model.site("foot")
    robots = plausible_robots(designs)
    for j, name in enumerate(("hip", "knee")):
        motor = model.actuator(name)
        assert motor.trnid[0] == model.joint(turned.format(name)).id
        assert motor.gear[0] == 1.0
        peak = robots.peak_torque_n_m[0, j]
        np.testing.assert_array_equal(motor.ctrlrange, [-peak, peak])
        assert motor.ctrllimited[0]


def test_start_keyframe_has_the_base_at_half_a_metre_and_the_foot_below(designs):
    model = _compiled(designs, load_calibration())
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key("start").id)
    mujoco.mj_forward(model, data)
    np.testing.assert_allclose(data.body("base").xpos, [0.0, 0.0, 0.5], atol=1e-15)
    assert data.site("foot").xpos[0] == pytest.approx(0.0, abs=1e-12)
    assert data.ncon == 1


def test_vertical_guide_has_no_slide_in_x(designs):
    model = _compiled(designs, load_calibration("paper"))
    assert [model.joint(k).name for k in range(model.njnt)] == ["slide_z", "hip", "knee"]


def test_masses_and_armature_arrive(designs):
    robots = plausible_robots(designs)
    model = _compiled(designs, load_calibration("reference-3"))
    np.testing.assert_array_equal(model.body_mass[1:], robots.body_mass_kg[0])
    # The knee's turning parts are a tendon, whose own inertia leaves the thigh (tests/jump/test_rotors.py).
    np.testing.assert_array_equal(model.dof_armature[-2:], [robots.armature_kg_m2[0, 0], 0.0])
    inertia = robots.body_inertia_kg_m2[0, :, 1, 1] - [0.0, model.tendon_armature[0], 0.0]
    np.testing.assert_allclose(model.body_inertia[1:, 1], inertia, rtol=1e-12)
    joint_only = _compiled(designs, load_calibration("reference-1"))
    np.testing.assert_array_equal(joint_only.dof_armature[-2:], robots.armature_kg_m2[0])
    np.testing.assert_array_equal(joint_only.body_inertia[1:, 1], robots.body_inertia_kg_m2[0, :, 1, 1])


@pytest.mark.parametrize("share", [0.3, 0.8, 1.5])
def test_foot_pushes_like_the_documented_spring(designs, share):
    """MuJoCo's force without acceleration is (reference acceleration) / R."""
    calibration = load_calibration()
    contact, model = calibration.contact, _compiled(designs, calibration)
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    mujoco.mj_kinematics(model, data)
    depth = share * contact.width_m
    data.qpos[1] -= data.site("foot").xpos[2] - model.geom("foot").size[0] + depth
    mujoco.mj_forward(model, data)
    force = data.efc_aref / data.efc_R
    kind = data.efc_type == int(mujoco.mjtConstraint.mjCNSTR_CONTACT_ELLIPTIC)
    d, u = contact.impedance, min(share, 1.0)
    spring = contact.stiffness_n_per_m * depth * u**2 * (1.0 - d) / (1.0 - d * u)
    assert force[kind][0] == pytest.approx(spring, rel=0.01)


@pytest.mark.parametrize("name", ["reference-3", "reference-1"])
@pytest.mark.parametrize("joint", ["hip", "knee"])
def test_end_stops_push_like_the_documented_bumper(designs, joint, name):
    calibration = load_calibration(name)
    stops = end_stops(plausible_robots(designs), calibration.joints)
    stop, model = stops[("hip", "knee").index(joint)], _compiled(designs, calibration)
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    data.qpos[1] = 2.0  # in the air
    data.joint(joint).qpos[0] = stop.lower_rad - stop.width_rad
    data.joint(joint).qvel[0] = -2.0
    mujoco.mj_forward(model, data)
    kind = data.efc_type == int(mujoco.mjtConstraint.mjCNSTR_LIMIT_JOINT)
    torque = (data.efc_aref / data.efc_R)[kind]
    expected = stop.stiffness_n_m_per_rad * stop.width_rad + stop.damping_n_m_s_per_rad * 2.0
    assert torque == pytest.approx([expected])


def test_a_joint_feels_its_motors_damping_times_the_ratio_squared(designs):
    """A motor's shaft turns g times as fast as its joint and loses the power b w^2; the slides have no friction."""
    start = load_calibration("paper")
    calibration = replace(
        start, joints=replace(start.joints, damping_n_m_s_per_rad=0.3, motor_damping_n_m_s_per_rad=0.05)
    )
    robots = plausible_robots(designs)
    hip, knee = robots.ratio[0]
    assert hip != knee
    damping = _compiled(designs, calibration).dof_damping.reshape(3, -1)[:, 0]
    np.testing.assert_allclose(damping, [0.0, 0.3 + 0.05 * hip**2, 0.3 + 0.05 * knee**2], rtol=1e-12)


def test_numbers_of_the_calibration_arrive(designs):
    start = load_calibration("reference-3")
    calibration = replace(
        start,
        joints=replace(start.joints, friction_n_m=0.7),
        drive=replace(start.drive, peak_torque_scale=1.25),
        contact=replace(start.contact, friction=0.6, slip_ratio=4.0),
        simulation=replace(start.simulation, integrator="implicitfast", timestep_s=0.0005),
    )
    robots, model = plausible_robots(designs), _compiled(designs, calibration)
    assert model.dof_frictionloss.tolist() == [0.0, 0.0, 0.7, 0.7]
    np.testing.assert_allclose(model.actuator_ctrlrange[:, 1], 1.25 * robots.peak_torque_n_m[0], rtol=1e-12)
    assert model.geom("foot").friction[0] == 0.6
    assert model.opt.impratio == 4.0
    assert model.opt.timestep == 0.0005
    assert model.opt.integrator == mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    assert model.opt.gravity.tolist() == [0.0, 0.0, -9.81]
    for joint in ("hip", "knee"):
        stop = getattr(robots.stops, joint)
        assert model.joint(joint).range.tolist() == [stop.lower_rad, stop.upper_rad]


def test_a_comment_stands_at_the_head_and_cannot_end_itself(designs):
    text = mjcf(plausible_robots(designs), load_calibration(), comment="design: a --> b")
    assert text.startswith("<!-- design: a - -> b -->")
    mujoco.MjModel.from_xml_string(text)
