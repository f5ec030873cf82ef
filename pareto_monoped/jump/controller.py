"""The controller and the bookkeeping of one jump, compiled by numba.

Importing this module imports numba, so it is imported where a simulation starts. ``control`` is called at the start of
every step: it books the step just made, ends a jump that is over, and sets the torques of the next step. All that it
knows of a jump besides positions and speeds stands in one row of numbers, which ``callback`` keeps in the simulation's
own user data.
"""

import math

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.jump.compiled import compiled

Floats = NDArray[np.float64]

# Columns of a jump's row. What follows ``_HIP`` is the knee's.
_COLUMNS = iter(range(1000))
# One of the values below.
STATUS = next(_COLUMNS)
# The same for all jumps of a calibration.
(
    REST_LENGTH, TIMESTEP, STEP_LIMIT, STAGES, FADE_LENGTH, LATCH, LOSS_SPEED, VOLTAGE_LIMIT, LAGS, MEAN_SPEED,
) = SETTINGS = [next(_COLUMNS) for _ in range(10)]  # fmt: skip
# The robot's.
(
    THIGH, SHANK, FOOT_RADIUS, STIFFNESS, DAMPING, TORSION, WEIGHT,
    PEAK_HIP, PEAK_KNEE, NO_LOAD_HIP, NO_LOAD_KNEE, CORNER_HIP, CORNER_KNEE,
    LOSS_HIP, LOSS_KNEE, HEAT_HIP, HEAT_KNEE,
) = CONSTANTS = [next(_COLUMNS) for _ in range(17)]  # fmt: skip
# What the controller remembers.
(
    STAGE, STEPS, HEIGHT, CLEARANCE, LIFT_OFF_STEP, STOOD, OFF, TOUCHED,
    ENERGY_HIP, ENERGY_KNEE, ABSORBED_HIP, ABSORBED_KNEE, LOST_HIP, LOST_KNEE, HEAT_J,
    PEAK_TORQUE_HIP, PEAK_TORQUE_KNEE, PEAK_SPEED_HIP, PEAK_SPEED_KNEE, PEAK_POWER_HIP, PEAK_POWER_KNEE,
    ACTIVE_STEPS, SATURATED_HIP, SATURATED_KNEE,
    SPEED_HIP, SPEED_KNEE, TORQUE_HIP, TORQUE_KNEE, JOINT_TORQUE_HIP, JOINT_TORQUE_KNEE,
) = MEMORY = [next(_COLUMNS) for _ in range(30)]  # fmt: skip
N_ROW = next(_COLUMNS)

# Values of ``STATUS``.
RUNNING, FLYING, APEX, NO_LIFT_OFF, SANK, DIVERGED, TIMEOUT = range(7)

TOUCH_M = 1e-9
"""Clearance that still counts as touching: rounding of the start pose."""
SANK_M = 0.1
"""A base this low has fallen: half its actuators' diameter is 0.05 m."""
SPEED_LIMIT = 1e4
"""A joint or slide faster than this (m/s, rad/s) is a failed simulation."""


@compiled
def control(q: Floats, v: Floats, ctrl: Floats, m: Floats) -> None:
    """Book the last step of a jump, end it if it is over, set the torques of its next step.

    Args:
        q: joint positions at the start of the step, slides first, shape (nv,).
        v: joint speeds, shape (nv,).
        ctrl: torques of hip and knee, written.
        m: the jump's row, shape (N_ROW,), written.
    """
    if m[STAGES] > 1.0:
        # A Runge-Kutta step asks once a stage; the torque of its start is held.
        stage = m[STAGE]
        m[STAGE] = stage + 1.0 if stage + 1.0 < m[STAGES] else 0.0
        if stage > 0.0:
            return
    if m[STATUS] == RUNNING:
        _run(q, v, ctrl, m)
    elif m[STATUS] == FLYING:
        _fly(q, v, m)
    if m[STATUS] != RUNNING:
        ctrl[0] = ctrl[1] = 0.0


@compiled
def _fine(q: Floats, v: Floats) -> bool:
    """Whether a state is finite and not absurdly fast."""
    fine = True
    for k in range(v.shape[0]):
        fine = fine and math.isfinite(q[k]) and abs(v[k]) < SPEED_LIMIT
    return fine


@compiled
def _end(q: Floats, v: Floats, m: Floats) -> None:
    """End a jump at the apex (the foot has stood and is off the ground, the base no longer rises), or in failure."""
    nv = v.shape[0]
    if m[OFF] > 0.0 and v[nv - 3] <= 0.0:
        m[STATUS] = APEX
    elif q[nv - 3] < SANK_M:
        m[STATUS] = SANK
    elif m[STEPS] > m[STEP_LIMIT]:
        m[STATUS] = TIMEOUT if m[OFF] > 0.0 else NO_LIFT_OFF


@compiled
def _fly(q: Floats, v: Floats, m: Floats) -> None:
    """A step after the torque has been switched off for good."""
    if not _fine(q, v):
        m[STATUS] = DIVERGED
        return
    nv = v.shape[0]
    m[STEPS] += 1.0
    m[HEIGHT] = max(m[HEIGHT], q[nv - 3])
    m[PEAK_SPEED_HIP] = max(m[PEAK_SPEED_HIP], abs(v[nv - 2]))
    m[PEAK_SPEED_KNEE] = max(m[PEAK_SPEED_KNEE], abs(v[nv - 1]))
    _end(q, v, m)
    if m[STATUS] != FLYING:
        rz = -m[THIGH] * math.cos(q[nv - 2]) - m[SHANK] * math.cos(q[nv - 2] + q[nv - 1])
        m[CLEARANCE] = q[nv - 3] + rz - m[FOOT_RADIUS]


@compiled
def _run(q: Floats, v: Floats, ctrl: Floats, m: Floats) -> None:
    """A step under the controller."""
    if not _fine(q, v):
        m[STATUS] = DIVERGED
        return
    nv = v.shape[0]
    z, hip, knee = q[nv - 3], q[nv - 2], q[nv - 1]

    # Foot relative to the base, and its Jacobian: d rx / d hip = rz, d rz / d hip = -rx.
    shank_angle = hip + knee
    shank_x, shank_z = -m[SHANK] * math.sin(shank_angle), -m[SHANK] * math.cos(shank_angle)
    rx = -m[THIGH] * math.sin(hip) + shank_x
    rz = -m[THIGH] * math.cos(hip) + shank_z
    clearance = z + rz - m[FOOT_RADIUS]
    speed = (v[nv - 2], v[nv - 1])

    if m[STEPS] > 0:
        _book(m, speed)
    m[STEPS] += 1
    m[HEIGHT] = max(m[HEIGHT], z)
    m[CLEARANCE] = clearance
    touching = clearance <= TOUCH_M
    if touching:
        m[STOOD] = 1.0
        m[LIFT_OFF_STEP] = m[STEPS]

    # Share of the torque that the gate lets through, and whether the foot counts as off the ground.
    length = m[FADE_LENGTH]
    if length > 0.0:
        u = min(max(clearance / length, 0.0), 1.0)
        gate = 1.0 - u * u * (3.0 - 2.0 * u)
        in_air = clearance >= length
    else:
        # After a step MuJoCo's contact list still describes the state before it; a literal program reads that list.
        listed = touching if m[LAGS] == 0.0 or m[STEPS] == 1 else m[TOUCHED] > 0.0
        m[TOUCHED] = 1.0 if touching else 0.0
        gate = 1.0 if listed else 0.0
        in_air = not listed
    m[OFF] = 1.0 if in_air and m[STOOD] > 0.0 else 0.0
    _end(q, v, m)
    if m[STATUS] != RUNNING:
        return
    if m[OFF] > 0.0 and m[LATCH] > 0.0:
        m[STATUS] = FLYING
        m[TORQUE_HIP] = m[TORQUE_KNEE] = m[JOINT_TORQUE_HIP] = m[JOINT_TORQUE_KNEE] = 0.0
        return

    torque_hip, torque_knee = 0.0, 0.0
    if gate > 0.0:
        # Paper, section II-B: F_l, tau_t, F_x, F_z and tau = J^T F; alpha is positive with the foot behind the base.
        leg = math.sqrt(rx * rx + rz * rz)
        sin, cos = -rx / leg, -rz / leg
        alpha = math.atan2(-rx, -rz)
        drx = rz * speed[0] + shank_z * speed[1]
        drz = -rx * speed[0] - shank_x * speed[1]
        dleg = (rx * drx + rz * drz) / leg
        axial = m[STIFFNESS] * (m[REST_LENGTH] - leg) - m[DAMPING] * dleg
        across = m[TORSION] * (0.0 - alpha) / leg
        fz = -axial * cos + across * sin - m[WEIGHT]
        fx = -axial * sin - across * cos
        torque_hip = rz * fx - rx * fz
        torque_knee = shank_z * fx - shank_x * fz
        m[ACTIVE_STEPS] += 1
        torque_hip = gate * _limited(torque_hip, speed[0], m, 0)
        torque_knee = gate * _limited(torque_knee, speed[1], m, 1)
    m[TORQUE_HIP], m[TORQUE_KNEE] = torque_hip, torque_knee
    m[SPEED_HIP], m[SPEED_KNEE] = speed
    m[JOINT_TORQUE_HIP] = _delivered(torque_hip, speed[0], m[LOSS_HIP], m[PEAK_HIP], m[LOSS_SPEED])
    m[JOINT_TORQUE_KNEE] = _delivered(torque_knee, speed[1], m[LOSS_KNEE], m[PEAK_KNEE], m[LOSS_SPEED])
    ctrl[0], ctrl[1] = m[JOINT_TORQUE_HIP], m[JOINT_TORQUE_KNEE]


@compiled
def _limited(torque: float, speed: float, m: Floats, joint: int) -> float:
    """``torque`` within the motor's peak and, where it drives, within its voltage-speed line."""
    peak = m[PEAK_HIP + joint]
    upper, lower = peak, -peak
    if m[VOLTAGE_LIMIT] > 0.0:
        no_load, corner = m[NO_LOAD_HIP + joint], m[CORNER_HIP + joint]
        upper = peak * min(max((no_load - speed) / (no_load - corner), 0.0), 1.0)
        lower = -peak * min(max((no_load + speed) / (no_load - corner), 0.0), 1.0)
    if torque >= upper:
        m[SATURATED_HIP + joint] += 1
        return upper
    if torque <= lower:
        m[SATURATED_HIP + joint] += 1
        return lower
    return torque


@compiled
def _delivered(torque: float, speed: float, loss: float, peak: float, loss_speed: float) -> float:
    """What reaches the joint: load-dependent friction of gears and chain opposes the motion."""
    if loss == 0.0 or torque == 0.0:
        return torque
    after = torque - loss * abs(torque) * math.tanh(speed / loss_speed)
    return min(max(after, -peak), peak)


@compiled
def _book(m: Floats, speed: tuple[float, float]) -> None:
    """Add the step just made: torque times the speed at its start, or times the mean of the speeds at its ends."""
    timestep = m[TIMESTEP]
    for joint in range(2):
        torque = m[TORQUE_HIP + joint]
        during = 0.5 * (m[SPEED_HIP + joint] + speed[joint]) if m[MEAN_SPEED] > 0.0 else m[SPEED_HIP + joint]
        power = torque * during
        if power > 0.0:
            m[ENERGY_HIP + joint] += power * timestep
        else:
            m[ABSORBED_HIP + joint] -= power * timestep
        m[LOST_HIP + joint] += (torque - m[JOINT_TORQUE_HIP + joint]) * during * timestep
        m[HEAT_J] += m[HEAT_HIP + joint] * torque * torque * timestep
        m[PEAK_TORQUE_HIP + joint] = max(m[PEAK_TORQUE_HIP + joint], abs(torque))
        m[PEAK_SPEED_HIP + joint] = max(m[PEAK_SPEED_HIP + joint], abs(speed[joint]))
        m[PEAK_POWER_HIP + joint] = max(m[PEAK_POWER_HIP + joint], abs(power))
