"""Elastic drives, bumpers after Hunt and Crossley, friction, warmth: against closed forms and MuJoCo's own forces."""

from dataclasses import replace

import mujoco
import numpy as np
import pytest

from pareto_monoped.actuator.search import map_for
from pareto_monoped.design import CONTROL, LOWER, PAPER_CASES, UPPER, columns, complete
from pareto_monoped.jump.audit import audit
from pareto_monoped.jump.balance import balanced, energy_balance
from pareto_monoped.jump.calibration import load_calibration
from pareto_monoped.jump.document import mjcf
from pareto_monoped.jump.end_stops import damping_s_per_m
from pareto_monoped.jump.evaluate import Evaluator, evaluate_robots
from pareto_monoped.jump.model import joint_damping, joint_friction_n_m, longest_step_s
from pareto_monoped.jump.single import moments, trace_of
from pareto_monoped.leg.chain import strand_compliance_m_per_n
from pareto_monoped.leg.dimensions import leg_dimensions
from pareto_monoped.robot.population import robot_arrays

MAP = map_for("VT8020")
ELASTIC = load_calibration("reference").by("mujoco")
CASES = complete(np.array([case.design.as_array() for case in PAPER_CASES.values()]))
RANDOM = complete(np.random.default_rng(3).uniform(LOWER, UPPER, (40, len(LOWER))))


def test_a_strand_of_the_chain_is_the_springs_of_its_pieces_in_series():
    """By hand for an 084 and axes 400 mm apart, in mm and N.

    Renold's 14.51e-5 / 12.7^2 for 2 x 50.8 mm of chain; two studs M5 of 11 mm between fork and thread, of which the
    drawn square has 15.76 mm2 of steel; a bar of 264.4 mm, its ends of 2 x 16 mm with 64 - 15.76 mm2 of aluminium and
    3 x 8 mm2 between.
    """
    chain = 14.51e-5 / 12.7**2 * 101.6
    studs = 2 * 11.0 / (206e3 * 15.76)
    bar = 32.0 / (70e3 * 48.24) + 232.4 / (70e3 * 24.0)
    assert strand_compliance_m_per_n(400.0, leg_dimensions(MAP)) == pytest.approx(
        1e-3 * (chain + studs + bar), rel=1e-3
    )
    longer = strand_compliance_m_per_n(np.array([400.0, 500.0]), leg_dimensions(MAP))
    assert np.diff(longer)[0] == pytest.approx(1e-3 * 100.0 / (70e3 * 24.0), rel=1e-12)


def test_a_drive_is_as_stiff_as_gearbox_and_chain_in_series():
    robots, radius_m = robot_arrays(CASES, MAP), 12.7e-3 / (2.0 * np.sin(np.pi / 14))
    strand = strand_compliance_m_per_n(1e3 * CASES[:, 0], leg_dimensions(MAP))
    for i, case in enumerate(PAPER_CASES.values()):
        hip, knee = MAP.lookup(case.design.hip_ratio), MAP.lookup(case.design.knee_ratio)
        stiff = robots.drive_stiffness_n_m_per_rad[i]
        if hip is knee:
            assert 1.0 / stiff[1] == pytest.approx(1.0 / stiff[0] + strand[i] / radius_m**2, rel=1e-12)
        assert stiff[0] > 20e3 > 5e3 > stiff[1] > 1e3


def test_a_motor_swings_on_its_drive_as_stiffness_and_inertia_say():
    """Undamped, with the joints held, against 2 pi sqrt(C / k); the leg stands far above the floor."""
    bare = replace(
        ELASTIC,
        joints=replace(ELASTIC.joints, friction_share=0.0, motor_damping_share_s_per_rad=0.0),
        drive=replace(ELASTIC.drive, drive_damping_ratio=0.0),
    )
    robots = robot_arrays(CASES[1], MAP)
    model = mujoco.MjModel.from_xml_string(mjcf(robots, bare))
    model.opt.timestep, model.opt.gravity[:] = 1e-6, 0.0
    model.dof_armature[:4] = 1e6  # which holds base and joints
    data = mujoco.MjData(model)
    turning = {"hip": robots.armature_kg_m2[0, 0], "knee": robots.knee_reflected_kg_m2[0]}
    for k, joint in enumerate(("hip", "knee")):
        mujoco.mj_resetDataKeyframe(model, data, 0)
        data.qpos[1] += 1.0
        motor = model.joint(f"{joint}_motor").qposadr[0]
        held = data.joint(joint).qpos[0]
        data.qpos[motor] = held + 1e-3
        signs = []
        for _ in range(40_000):
            mujoco.mj_step(model, data)
            signs.append(data.qpos[motor] > held)
        crossings = np.flatnonzero(np.diff(signs))
        period = 2.0 * np.mean(np.diff(crossings)) * 1e-6
        expected = 2.0 * np.pi * np.sqrt(turning[joint] / robots.drive_stiffness_n_m_per_rad[0, k])
        assert period == pytest.approx(expected, rel=2e-3)


def test_drives_a_thousand_times_as_stiff_make_the_rigid_jump():
    robots, control = robot_arrays(CASES[::3], MAP), columns(CASES[::3], CONTROL)
    stiff = replace(robots, drive_stiffness_n_m_per_rad=1e3 * robots.drive_stiffness_n_m_per_rad)
    fine = replace(ELASTIC, simulation=replace(ELASTIC.simulation, timestep_s=1e-5))
    rigid = replace(fine, drive=replace(fine.drive, elastic=False))
    found, expected = evaluate_robots(stiff, control, fine), evaluate_robots(robots, control, rigid)
    np.testing.assert_allclose(found.height_m, expected.height_m, atol=3e-4)
    np.testing.assert_allclose(found.energy_j, expected.energy_j, rtol=3e-3)
    soft = evaluate_robots(robots, control, replace(ELASTIC, simulation=replace(ELASTIC.simulation, timestep_s=1e-4)))
    assert (soft.peak_chain_tension_n > 1.1 * expected.peak_chain_tension_n).all()


@pytest.mark.parametrize("designs", [CASES[3:], pytest.param(CASES[:3], marks=pytest.mark.long)], ids=["C", "others"])
def test_loads_are_those_of_mujocos_tendons_and_contacts(designs):
    """Chain and foot, from what MuJoCo computes in every step and the controller never sees."""
    robots = robot_arrays(designs, MAP)
    jumps = evaluate_robots(robots, columns(designs, CONTROL), ELASTIC)
    for i, design in enumerate(designs):
        pull = foot = 0.0
        alone = robot_arrays(design, MAP)
        for moment in moments(alone, columns(design[None], CONTROL), ELASTIC):
            if moment.last:
                break
            data, model = moment.data, moment.model
            drive = model.tendon("knee_drive").id
            rate = data.qvel if moment.after is not data else moment.qvel
            force = model.tendon_stiffness[drive] * (moment.qpos[4] - moment.qpos[3])
            force += model.tendon_damping[drive] * (rate[4] - rate[3])
            pull = max(pull, abs(force) / alone.sprocket_radius_m[0])
            total, one = np.zeros(3), np.zeros(6)
            for k, contact in enumerate(data.contact):
                mujoco.mj_contactForce(model, data, k, one)
                total += contact.frame.reshape(3, 3).T @ one[:3]
            foot = max(foot, np.linalg.norm(total))
        assert jumps.peak_chain_tension_n[i] == pytest.approx(pull, rel=1e-9)
        assert jumps.peak_foot_force_n[i] == pytest.approx(foot, rel=1e-3)


@pytest.mark.parametrize(
    ("play_rad", "some", "count"),
    [
        (0.0, slice(3, 4), 15),
        (0.004, slice(0, 1), 15),
        *(pytest.param(play_rad, slice(4), 40, marks=pytest.mark.long) for play_rad in (0.0, 0.004)),
    ],
)
def test_the_energy_balance_closes(play_rad, some, count):
    """With half of what is asked: a thousandth of the work is allowed."""
    calibration = replace(ELASTIC, drive=replace(ELASTIC.drive, backlash_rad=play_rad))
    for design in CASES[some]:
        balance = energy_balance(robot_arrays(design, MAP), columns(design[None], CONTROL), calibration)
        assert balance.error < 5e-4
        assert abs(balance.residual_j) < 1e-4 * balance.joint_work_j
        assert 0.1 < balance.drives_absorbed_j < 1.0
        assert 5.0 < balance.stops_absorbed_j < 25.0
    designs = RANDOM[:count]
    errors = balanced(robot_arrays(designs, MAP), columns(designs, CONTROL), calibration).error
    assert errors.max() < 5e-4


@pytest.mark.parametrize("count", [5, pytest.param(12, marks=pytest.mark.long)])
def test_it_is_as_well_conditioned_as_the_rigid_drive(count):
    found = audit(RANDOM[:count], MAP, load_calibration("reference"), workers=2)
    assert found.well_conditioned.all()
    assert np.percentile(found.half_step_height_m, 90) < 2e-4
    assert np.percentile(found.half_step_energy, 90) < 5e-4
    assert found.spread_height_m.max() < 2e-6


@pytest.mark.parametrize("mass_kg", [0.2, 3.0])
@pytest.mark.parametrize("joint", ["hip", "knee"])
def test_a_bumper_gives_back_the_share_of_the_elastomer_whatever_meets_it(joint, mass_kg):
    """A mass that meets the bumper with the 1.4 m/s of ISO 4662, by small steps on the part's own slow force."""
    part = getattr(robot_arrays(CASES[0], MAP).stops, joint)
    (chi,) = damping_s_per_m(np.array([part.bumper.elastomer.rebound_resilience]))
    speed, step, x, v = 1.4, 2e-7, 0.0, 1.4
    while x >= 0.0:
        force = float(part.bumper.force_n(1e3 * x)) * max(0.0, 1.0 + chi * v)
        v -= step * force / mass_kg
        x += step * v
    assert (v / speed) ** 2 == pytest.approx(0.08, rel=2e-3)


def test_more_rebound_is_less_damping():
    chi = damping_s_per_m(np.array([0.05, 0.08, 0.25, 0.81]))
    assert (np.diff(chi) < 0.0).all()
    # Nearly elastic: 1 - e is about 2/3 chi v (Hunt and Crossley, eq. 20).
    (gentle,) = damping_s_per_m(np.array([0.98]))
    assert 1.0 - np.sqrt(0.98) == pytest.approx(2.0 / 3.0 * gentle * 1.4, rel=0.02)


def test_friction_and_damping_grow_with_motor_and_ratio():
    robots = robot_arrays(CASES, MAP)
    for i, design in enumerate(CASES):
        model = mujoco.MjModel.from_xml_string(mjcf(robot_arrays(design, MAP), ELASTIC))
        for k, joint in enumerate(("hip", "knee")):
            place = model.joint(f"{joint}_motor").dofadr[0]
            ratio = robots.ratio[i, k]
            assert model.dof_frictionloss[place] == pytest.approx(0.0111 * 5.5 * ratio, rel=1e-12)
            assert model.dof_damping[place] == pytest.approx(4.6e-5 * 5.5 * ratio**2, rel=1e-12)
        assert not model.dof_frictionloss[:4].any()


def test_a_weak_motor_rubs_as_much_as_a_strong_one_of_its_kind():
    """A torque constant below the data sheet's changes the peak torque, and neither bearings nor seals."""
    robots = robot_arrays(CASES, MAP)
    weak = replace(robots, peak_torque_n_m=0.5 * robots.peak_torque_n_m)
    for of_friction in (
        lambda some: joint_damping(some, ELASTIC.joints),
        lambda some: joint_friction_n_m(some, ELASTIC.joints),
    ):
        np.testing.assert_array_equal(of_friction(weak), of_friction(robots))


def test_a_step_that_the_drives_cannot_follow_is_refused_and_makes_no_height():
    """With 1 ms, springs blow up to jumps of many metres, or to wrong ones."""
    for engine in ("compiled", "mujoco"):
        slow = replace(ELASTIC.by(engine), simulation=replace(ELASTIC.by(engine).simulation, timestep_s=1e-3))
        found = Evaluator(MAP, slow)(CASES)
        assert set(found.status) == {"diverged"}
        assert np.isnan(found.height_m).all()
        assert "a step of 1000 us is too long for its elastic drives" in found.reason[0]
    robots = robot_arrays(CASES, MAP)
    frequency = np.sqrt(robots.drive_stiffness_n_m_per_rad[:, 0] / robots.armature_kg_m2[:, 0])
    np.testing.assert_allclose(longest_step_s(robots, ELASTIC), 1.4 / frequency, rtol=1e-12)
    longest = replace(ELASTIC, simulation=replace(ELASTIC.simulation, timestep_s=5e-4))
    assert (Evaluator(MAP, longest)(CASES).height_m < 1.1).all()


def test_the_bus_sums_both_motors_before_it_cuts_off():
    """From the trace of a jump with rigid drives, whose speeds are the motors', and with warm copper (IEC 60028)."""
    rigid = load_calibration("reference-3")
    calibration = replace(rigid, drive=replace(rigid.drive, battery="bus", winding_rise_k=40.0))
    warm_ohm = MAP.motor.terminal_resistance_ohm * (1.0 + 0.00393 * 40.0)
    for design in CASES:
        robots = robot_arrays(design, MAP)
        trace = trace_of(robots, columns(design[None], CONTROL), calibration)
        power = 0.0
        for k, joint in enumerate(("hip", "knee")):
            torque, speed = trace[f"{joint}_motor_torque_n_m"][:-1], trace[f"{joint}_rad_per_s"]
            current = torque / (robots.ratio[0, k] * MAP.motor.torque_constant_n_m_per_a)
            power = power + torque * 0.5 * (speed[1:] + speed[:-1]) + warm_ohm * current**2
        found = Evaluator(MAP, calibration)(design).electrical_energy_j[0]
        assert found == pytest.approx(1e-3 * np.maximum(power, 0.0).sum(), rel=1e-9)
        apart = replace(calibration, drive=replace(calibration.drive, battery="each_motor"))
        assert Evaluator(MAP, apart)(design).electrical_energy_j[0] > 1.005 * found


def test_the_documents_springs_are_at_rest_over_the_whole_play_and_no_more():
    drive = replace(ELASTIC.drive, backlash_rad=0.004)
    model = mujoco.MjModel.from_xml_string(mjcf(robot_arrays(CASES[:1], MAP), replace(ELASTIC, drive=drive)))
    springs = [model.tendon(f"{joint}_drive").id for joint in ("hip", "knee")]
    assert model.tendon_lengthspring[springs].tolist() == [[-0.002, 0.002]] * 2
