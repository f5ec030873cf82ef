"""The controller at single states, against the paper's equations worked out by hand."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pareto_monoped.jump import controller, single
from pareto_monoped.jump.controller_record import RECORD, origin

CONTROL = single._controller(origin())
"""The controller as single jumps use it, which is found compiled on disk."""

THIGH, SHANK, RADIUS, WEIGHT = 0.4, 0.4, 0.03, 30.0
STIFFNESS, DAMPING, TORSION = 20.0, 3.0, 15.0
NO_LOAD, CORNER = 80.0, 60.0


def torques(hip, knee, *, clearance=0.0, speeds=(0.0, 0.0), peak=1e6, fade=0.02, loss=0.0, record=None, **more):
    """Torques (hip motor, knee motor, hip joint, knee joint), the status, and the record after one call."""
    if record is None:
        record = np.zeros(1, dtype=RECORD)[0]
    values = {
        "rest_length_m": 10.0,
        "timestep_s": 0.001,
        "period_steps": 1,
        "ratio": 6.0,
        "sprocket_radius_m": 0.026,
        "lower_stop_rad": -np.inf,
        "upper_stop_rad": np.inf,
        "step_limit": 3000,
        "stages": 1,
        "fade_length_m": fade,
        "latch": True,
        "loss_speed_rad_per_s": 0.5,
        "voltage_limit": True,
        "thigh_length_m": THIGH,
        "shank_length_m": SHANK,
        "foot_radius_m": RADIUS,
        "stiffness_n_per_m": STIFFNESS,
        "damping_n_s_per_m": DAMPING,
        "torsional_stiffness_n_m_per_rad": TORSION,
        "weight_n": WEIGHT,
        "torque_limit_n_m": peak,
        "no_load_speed_rad_per_s": NO_LOAD,
        "corner_speed_rad_per_s": CORNER,
        "loss": loss,
    }
    for name, value in (values | more).items():
        record[name] = value
    foot = -THIGH * np.cos(hip) - SHANK * np.cos(hip + knee)
    qpos, qvel = np.array([0.0, clearance + RADIUS - foot, hip, knee]), np.array([0.0, 0.1, *speeds])
    ctrl = np.zeros(2)
    CONTROL(qpos, qvel, ctrl, record)
    return np.array([*record["motor_torque_n_m"], *ctrl]), record["status"], record


def foot(hip, knee):
    angle = hip + knee
    return np.array([-THIGH * np.sin(hip) - SHANK * np.sin(angle), -THIGH * np.cos(hip) - SHANK * np.cos(angle)])


def force_on_ground(hip, knee):
    """(F_x, F_z) that the joint torques exert through the foot: tau = J^T F, J by finite differences."""
    torque, _, _ = torques(hip, knee)
    small = 1e-6
    columns = [
        (foot(hip + small, knee) - foot(hip - small, knee)) / (2 * small),
        (foot(hip, knee + small) - foot(hip, knee - small)) / (2 * small),
    ]
    return np.linalg.solve(np.array(columns), torque[:2])


@pytest.mark.parametrize(("hip", "side"), [(-0.4, "behind"), (-0.9, "in front")])
def test_the_base_is_pushed_back_over_the_foot(hip, side):
    knee = 1.3
    x, z = foot(hip, knee)
    assert (x < 0.0) == (side == "behind")
    length, alpha = np.hypot(x, z), np.arctan2(-x, -z)
    # Equations of section II-B, with F the force of the foot on the ground
    axial, twist = STIFFNESS * (10.0 - length), -TORSION * alpha
    fz = -axial * np.cos(alpha) + twist / length * np.sin(alpha) - WEIGHT
    fx = -axial * np.sin(alpha) - twist / length * np.cos(alpha)
    np.testing.assert_allclose(force_on_ground(hip, knee), [fx, fz], rtol=1e-6)
    # The part of the torsional spring alone: the ground pushes the base towards the foot's side.
    across = np.array([-np.cos(alpha), np.sin(alpha)]) * twist / length
    assert np.sign(-across[0]) == np.sign(x)


def test_symmetric_leg_needs_no_hip_torque_but_for_nothing():
    # Foot straight below: alpha = 0, the force is vertical and passes through the hip.
    knee = 1.2
    torque, _, _ = torques(-knee / 2, knee)
    length = 2 * THIGH * np.cos(knee / 2)
    force = STIFFNESS * (10.0 - length) + WEIGHT
    assert torque[0] == pytest.approx(0.0, abs=1e-12)
    # Lever arm of the vertical force about the knee: thigh sin(hip angle); it straightens the leg (negative).
    assert torque[1] == pytest.approx(-force * THIGH * np.sin(knee / 2))


def test_damper_opposes_the_stretching_leg():
    still, _, _ = torques(-0.6, 1.2)
    stretching, _, _ = torques(-0.6, 1.2, speeds=(0.5, -1.0))
    rate = 2 * THIGH * np.sin(0.6) * 0.5  # d(2 l cos(knee / 2)) / dt
    assert stretching[1] - still[1] == pytest.approx(DAMPING * rate * THIGH * np.sin(0.6))


@given(st.floats(-1.0, 0.0), st.floats(0.4, 2.0), st.floats(-90.0, 90.0), st.floats(-90.0, 90.0))
def test_torque_stays_within_peak_and_voltage_line(hip, knee, hip_speed, knee_speed):
    torque, _, _ = torques(hip, knee, speeds=(hip_speed, knee_speed), peak=5.0, loss=0.1)
    assert np.all(np.abs(torque) <= 5.0)
    for motor, speed in zip(torque[:2], (hip_speed, knee_speed), strict=True):
        if motor * speed > 0.0:
            line = 5.0 * max(NO_LOAD - abs(speed), 0.0) / (NO_LOAD - CORNER)
            assert abs(motor) <= line + 1e-12


def test_no_torque_drives_beyond_the_no_load_speed():
    torque, _, _ = torques(-0.6, 1.2, speeds=(0.0, -NO_LOAD - 5.0), peak=5.0)
    assert torque[1] == 0.0


@pytest.mark.parametrize(("share", "left"), [(-0.5, 1.0), (0.0, 1.0), (0.25, 0.84375), (0.5, 0.5), (1.0, 0.0)])
def test_torque_fades_smoothly_with_clearance(share, left):
    full, _, _ = torques(-0.6, 1.2)
    faded, _, _ = torques(-0.6, 1.2, clearance=share * 0.02)
    assert faded[1] == pytest.approx(left * full[1], abs=1e-9)


def test_a_foot_that_has_stood_and_risen_ends_control_for_good():
    _, status, record = torques(-0.6, 1.2)
    assert status == controller.RUNNING
    _, status, _ = torques(-0.6, 1.2, clearance=0.021, record=record)
    assert status == controller.FLYING


def test_a_foot_that_has_not_stood_yet_is_no_lift_off():
    _, status, _ = torques(-0.6, 1.2, clearance=0.021)
    assert status == controller.RUNNING


def test_literal_gate_is_all_or_nothing():
    touching, _, _ = torques(-0.6, 1.2, clearance=-1e-6, fade=0.0)
    clear, _, _ = torques(-0.6, 1.2, clearance=1e-6, fade=0.0)
    assert touching[1] != 0.0
    assert clear[1] == 0.0


def test_in_flight_springs_and_dampers_pull_the_leg_to_its_start_pose():
    pose = {"flight_stiffness_n_m_per_rad": 100.0, "flight_damping_n_m_s_per_rad": 10.0, "start_rad": (-0.7, 1.5)}
    speeds = (0.5, -2.0)
    clear, status, _ = torques(
        -0.6, 1.2, clearance=1e-6, fade=0.0, speeds=speeds, latch=False, voltage_limit=False, **pose
    )
    assert clear[:2] == pytest.approx([100.0 * -0.1 - 10.0 * 0.5, 100.0 * 0.3 + 10.0 * 2.0])
    assert status == controller.RUNNING
    weak, _, _ = torques(-0.6, 1.2, clearance=1e-6, fade=0.0, speeds=speeds, peak=7.0, voltage_limit=False, **pose)
    assert weak[:2] == pytest.approx([-7.0, 7.0])
    # On the floor the virtual leg acts alone.
    held, _, _ = torques(-0.6, 1.2, clearance=-1e-6, fade=0.0, speeds=speeds, **pose)
    free, _, _ = torques(-0.6, 1.2, clearance=-1e-6, fade=0.0, speeds=speeds)
    assert held == pytest.approx(free)


def test_losses_take_from_driving_and_add_to_braking():
    driving, _, _ = torques(-0.6, 1.2, speeds=(0.0, -20.0), loss=0.1)
    braking, _, _ = torques(-0.6, 1.2, speeds=(0.0, 20.0), loss=0.1)
    assert driving[3] == pytest.approx(0.9 * driving[1])
    assert braking[3] == pytest.approx(1.1 * braking[1])


def test_a_state_that_is_not_finite_has_diverged():
    _, status, _ = torques(np.nan, 1.2)
    assert status == controller.DIVERGED
    _, status, _ = torques(-0.6, 1.2, speeds=(0.0, 2e4))
    assert status == controller.DIVERGED


def test_the_gate_takes_its_share_of_the_limited_torque():
    """A saturated motor fades too: the limit comes first."""
    torque, _, _ = torques(-0.9, 1.3, clearance=0.01, peak=1.0)
    np.testing.assert_allclose(np.abs(torque[:2]), [0.5, 0.5])


def test_without_a_voltage_limit_only_the_peak_counts():
    torque, _, _ = torques(-0.6, 1.2, speeds=(0.0, -NO_LOAD), peak=5.0, voltage_limit=False)
    assert torque[1] == -5.0


def test_a_gate_without_latch_gives_torque_again_when_the_foot_comes_down():
    _, _, record = torques(-0.6, 1.2, latch=False)
    torque, status, record = torques(-0.6, 1.2, clearance=0.03, record=record, latch=False)
    assert (torque[1], status) == (0.0, controller.RUNNING)
    torque, _, _ = torques(-0.6, 1.2, record=record, latch=False)
    assert torque[1] != 0.0


def test_a_lagging_contact_is_that_of_the_step_before():
    torque, _, record = torques(-0.6, 1.2, fade=0.0, lags=True)
    assert torque[1] != 0.0
    torque, _, record = torques(-0.6, 1.2, fade=0.0, lags=True, clearance=0.01, record=record)
    assert torque[1] != 0.0
    torque, _, _ = torques(-0.6, 1.2, fade=0.0, lags=True, clearance=0.0, record=record)
    assert torque[1] == 0.0


@pytest.mark.parametrize(("clearance", "expected"), [(-0.05, controller.RUNNING), (-0.08, controller.SANK)])
def test_a_base_below_a_tenth_of_a_metre_has_sunk(clearance, expected):
    _, status, _ = torques(-1.4, 2.8, clearance=clearance)  # the folded leg is 0.136 m high, the foot's radius 0.03 m
    assert status == expected


@pytest.mark.parametrize(("clearance", "expected"), [(0.0, controller.NO_LIFT_OFF), (0.03, controller.TIMEOUT)])
def test_a_jump_may_take_as_many_steps_as_its_limit_and_no_more(clearance, expected):
    _, _, record = torques(-0.6, 1.2, latch=False)
    record["steps"] = 2999
    _, status, record = torques(-0.6, 1.2, clearance=clearance, latch=False, record=record)
    assert (status, record["steps"]) == (controller.RUNNING, 3000)
    _, status, _ = torques(-0.6, 1.2, clearance=clearance, latch=False, record=record)
    assert status == expected


@pytest.mark.parametrize("mean_speed", [True, False])
def test_a_braking_motor_absorbs_work_and_spends_none(mean_speed):
    """Torque of the first call times the mean of both speeds, or times the first."""
    _, _, record = torques(-0.6, 1.2, speeds=(0.0, 2.0), loss=0.1, mean_speed=mean_speed)
    torque, delivered = record["motor_torque_n_m"][1], record["joint_torque_n_m"][1]
    assert torque < 0.0
    _, _, record = torques(-0.6, 1.2, speeds=(0.0, 4.0), loss=0.1, mean_speed=mean_speed, record=record)
    speed = 3.0 if mean_speed else 2.0
    assert record["energy_j"][1] == 0.0
    assert record["absorbed_j"][1] == pytest.approx(-torque * speed * 0.001)
    assert record["drive_loss_j"][1] == pytest.approx((torque - delivered) * speed * 0.001)
    assert record["drive_loss_j"][1] > 0.0
    assert record["peak_power_w"][1] == pytest.approx(-torque * speed)
    assert record["peak_torque_n_m"][1] == -torque
    assert record["peak_speed_rad_per_s"][1] == 4.0


def test_peak_speeds_and_clearance_are_those_of_the_flight_too():
    _, _, record = torques(-0.6, 1.2)
    _, status, record = torques(-0.6, 1.2, clearance=0.021, record=record)
    _, status, record = torques(-0.6, 1.2, clearance=0.05, speeds=(7.0, -9.0), record=record)
    assert status == controller.FLYING
    assert record["peak_speed_rad_per_s"].tolist() == [7.0, 9.0]
    qpos, qvel = np.array([0.0, 1.0, -0.6, 1.2]), np.array([0.0, -0.1, 0.0, 0.0])
    CONTROL(qpos, qvel, np.zeros(2), record)
    assert record["status"] == controller.APEX
    assert record["clearance_m"] == pytest.approx(1.0 + foot(-0.6, 1.2)[1] - RADIUS)


@pytest.mark.parametrize(("height_m", "hip", "sinks"), [(0.3, 0.9, False), (0.3, 0.6, True), (0.09, 1.5, True)])
def test_a_landing_sinks_where_base_or_knee_meets_the_floor(height_m, hip, sinks):
    """The knee hangs a thigh's length below the base, and is as low as the foot's radius there."""
    record = np.zeros(1, dtype=RECORD)[0]
    record["thigh_length_m"], record["foot_radius_m"], record["step_limit"] = THIGH, RADIUS, 3000
    knee_low = height_m - THIGH * np.cos(hip) < RADIUS
    assert sinks == (knee_low or height_m < 0.1)
    controller._end_landing(np.array([0.0, height_m, hip, -1.2]), np.array([0.0, -1.0, 0.0, 0.0]), record)
    assert record["status"] == (controller.SANK if sinks else controller.RUNNING)
