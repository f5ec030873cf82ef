"""The virtual controller and the bookkeeping of one jump, compiled by numba.

``control`` is called at the start of every step. It books the step just made, ends a jump that is over, and sets the
torques of the next step. Everything it knows about a jump besides positions and speeds is in one ``RECORD``, which
``callback`` keeps in the user data of the simulation.

Importing this module imports numba, so import it where a simulation starts. The record and all constants stay in this
file because numba recompiles a function only if its own file changes.
"""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.jump.compiled import compiled

Floats = NDArray[np.float64]

HIP, KNEE = 0, 1

_ONE, _BOTH = np.float64, (np.float64, (2,))
RECORD = np.dtype(
    [
        ("status", _ONE),  # one of RUNNING ... TIMEOUT
        # Settings, the same for all jumps under one calibration. Flags are 0 or 1.
        ("rest_length_m", _ONE),
        ("timestep_s", _ONE),
        ("step_limit", _ONE),
        ("stages", _ONE),  # calls per step: 4 for a Runge-Kutta integrator
        ("fade_length_m", _ONE),  # 0: torque only while the foot touches the floor
        ("latch", _ONE),
        ("loss_speed_rad_per_s", _ONE),
        ("voltage_limit", _ONE),
        ("lags", _ONE),
        ("mean_speed", _ONE),
        # The robot.
        ("thigh_length_m", _ONE),
        ("shank_length_m", _ONE),
        ("foot_radius_m", _ONE),
        ("stiffness_n_per_m", _ONE),
        ("damping_n_s_per_m", _ONE),
        ("torsional_stiffness_n_m_per_rad", _ONE),
        ("weight_n", _ONE),  # the term m g of F_z
        ("torque_limit_n_m", _BOTH),
        ("no_load_speed_rad_per_s", _BOTH),
        ("corner_speed_rad_per_s", _BOTH),
        ("loss", _BOTH),  # share of the torque lost in gears and chain
        ("heat_w_per_n2_m2", _BOTH),  # Joule heat per squared joint torque
        # What the controller remembers from step to step.
        ("stage", _ONE),
        ("steps", _ONE),
        ("height_m", _ONE),  # highest so far
        ("clearance_m", _ONE),
        ("lift_off_step", _ONE),  # last step with contact
        ("stood", _ONE),  # the foot has touched the floor
        ("off_floor", _ONE),  # the foot has left the floor after it has stood
        ("touched", _ONE),  # contact one step ago
        ("energy_j", _BOTH),
        ("absorbed_j", _BOTH),
        ("drive_loss_j", _BOTH),
        ("joule_heat_j", _ONE),
        ("peak_torque_n_m", _BOTH),
        ("peak_speed_rad_per_s", _BOTH),
        ("peak_power_w", _BOTH),
        ("active_steps", _ONE),
        ("saturated_steps", _BOTH),
        ("speed_rad_per_s", _BOTH),  # at the start of the current step
        ("motor_torque_n_m", _BOTH),  # during the current step, at the joint before losses
        ("joint_torque_n_m", _BOTH),  # the same after losses
    ],
    align=True,
)
"""Everything the controller knows about one jump; pairs are hip, knee. MuJoCo's user data must be float64."""
RECORD_NUMBERS = RECORD.itemsize // 8
"""Length of a record in MuJoCo's user data."""

RUNNING, FLYING, APEX, NO_LIFT_OFF, SANK, DIVERGED, TIMEOUT = range(7)
"""Values of ``status``; the jump goes on up to and including ``FLYING``."""

TOUCH_M = 1e-9
"""Clearance that still counts as touching, because of rounding in the start pose."""
SANK_M = 0.1
"""A base this low has fallen: half its actuators' diameter is 0.05 m."""
SPEED_LIMIT = 1e4
"""Speed of a joint or slide (rad/s, m/s) beyond which the simulation has failed."""


@compiled
def control(q: Floats, v: Floats, ctrl: Floats, jump: Any) -> None:
    """Book the last step of a jump, end the jump if it is over, and set the torques of its next step.

    Args:
        q: joint positions at the start of the step, shape (nv,): slides (x if the base slides, z), hip, knee.
        v: joint speeds, shape (nv,).
        ctrl: torques of hip and knee, shape (2,); written.
        jump: a ``RECORD``; written.
    """
    if jump.stages > 1.0:
        # A Runge-Kutta integrator calls once per stage; the torque of the first stage is held.
        stage = jump.stage
        jump.stage = stage + 1.0 if stage + 1.0 < jump.stages else 0.0
        if stage > 0.0:
            return
    if jump.status == RUNNING:
        _run(q, v, ctrl, jump)
    elif jump.status == FLYING:
        _fly(q, v, jump)
    if jump.status != RUNNING:
        ctrl[HIP] = ctrl[KNEE] = 0.0


@compiled
def _fine(q: Floats, v: Floats) -> bool:
    """Whether a state is finite and slower than ``SPEED_LIMIT``."""
    fine = True
    for k in range(v.shape[0]):
        fine = fine and math.isfinite(q[k]) and abs(v[k]) < SPEED_LIMIT
    return fine


@compiled
def _end(q: Floats, v: Floats, jump: Any) -> None:
    """End a jump at the apex (the foot is off the floor and the base no longer rises) or in failure."""
    nv = v.shape[0]
    if jump.off_floor > 0.0 and v[nv - 3] <= 0.0:
        jump.status = APEX
    elif q[nv - 3] < SANK_M:
        jump.status = SANK
    elif jump.steps > jump.step_limit:
        jump.status = TIMEOUT if jump.off_floor > 0.0 else NO_LIFT_OFF


@compiled
def _fly(q: Floats, v: Floats, jump: Any) -> None:
    """A step after the torque has been switched off for good."""
    if not _fine(q, v):
        jump.status = DIVERGED
        return
    nv = v.shape[0]
    jump.steps += 1.0
    jump.height_m = max(jump.height_m, q[nv - 3])
    jump.peak_speed_rad_per_s[HIP] = max(jump.peak_speed_rad_per_s[HIP], abs(v[nv - 2]))
    jump.peak_speed_rad_per_s[KNEE] = max(jump.peak_speed_rad_per_s[KNEE], abs(v[nv - 1]))
    _end(q, v, jump)
    if jump.status != FLYING:
        rz = -jump.thigh_length_m * math.cos(q[nv - 2]) - jump.shank_length_m * math.cos(q[nv - 2] + q[nv - 1])
        jump.clearance_m = q[nv - 3] + rz - jump.foot_radius_m


@compiled
def _run(q: Floats, v: Floats, ctrl: Floats, jump: Any) -> None:
    """A step under the controller."""
    if not _fine(q, v):
        jump.status = DIVERGED
        return
    nv = v.shape[0]
    z, hip, knee = q[nv - 3], q[nv - 2], q[nv - 1]
    speed = (v[nv - 2], v[nv - 1])

    # Vectors from hip to foot (r) and from knee to foot (shank).
    shank_angle = hip + knee
    shank_x = -jump.shank_length_m * math.sin(shank_angle)
    shank_z = -jump.shank_length_m * math.cos(shank_angle)
    rx = -jump.thigh_length_m * math.sin(hip) + shank_x
    rz = -jump.thigh_length_m * math.cos(hip) + shank_z
    clearance = z + rz - jump.foot_radius_m

    if jump.steps > 0:
        _book(jump, speed)
    jump.steps += 1
    jump.height_m = max(jump.height_m, z)
    jump.clearance_m = clearance
    gate = _gate(clearance, jump)
    _end(q, v, jump)
    if jump.status != RUNNING:
        return
    if jump.off_floor > 0.0 and jump.latch > 0.0:
        jump.status = FLYING
        for joint in range(2):
            jump.motor_torque_n_m[joint] = jump.joint_torque_n_m[joint] = 0.0
        return

    torque = (0.0, 0.0)
    if gate > 0.0:
        wanted = _virtual_leg((rx, rz), (shank_x, shank_z), speed, jump)
        jump.active_steps += 1
        torque = (
            gate * _limited(wanted[HIP], speed[HIP], jump, HIP),
            gate * _limited(wanted[KNEE], speed[KNEE], jump, KNEE),
        )
    for joint in range(2):
        jump.motor_torque_n_m[joint] = torque[joint]
        jump.speed_rad_per_s[joint] = speed[joint]
        delivered = _delivered(torque[joint], speed[joint], jump, joint)
        ctrl[joint] = jump.joint_torque_n_m[joint] = delivered


@compiled
def _gate(clearance: float, jump: Any) -> float:
    """The share of the torque that passes at a foot clearance; notes contact and lift-off."""
    touching = clearance <= TOUCH_M
    if touching:
        jump.stood = 1.0
        jump.lift_off_step = jump.steps
    length = jump.fade_length_m
    if length > 0.0:
        u = min(max(clearance / length, 0.0), 1.0)
        gate = 1.0 - u * u * (3.0 - 2.0 * u)
        in_air = clearance >= length
    else:
        # After a step MuJoCo's contact list still describes the state before it; a literal program reads that list.
        listed = touching if jump.lags == 0.0 or jump.steps == 1 else jump.touched > 0.0
        jump.touched = 1.0 if touching else 0.0
        gate = 1.0 if listed else 0.0
        in_air = not listed
    jump.off_floor = 1.0 if in_air and jump.stood > 0.0 else 0.0
    return gate


@compiled
def _virtual_leg(
    foot: tuple[float, float], shank: tuple[float, float], speed: tuple[float, float], jump: Any
) -> tuple[float, float]:
    """Torques of virtual spring, damper and torsional spring (paper, section II-B), before any limit.

    Args:
        foot: vector (x, z) from hip to foot.
        shank: vector (x, z) from knee to foot.
        speed: of hip and knee.
        jump: the record.

    Returns:
        Torques of hip and knee.
    """
    # F_l, tau_t, F_x, F_z and tau = J^T F of the paper; alpha is positive with the foot behind the base.
    # J: d rx / d hip = rz, d rz / d hip = -rx; d rx / d knee = shank_z, d rz / d knee = -shank_x.
    (rx, rz), (shank_x, shank_z) = foot, shank
    leg = math.sqrt(rx * rx + rz * rz)
    sin, cos = -rx / leg, -rz / leg
    alpha = math.atan2(-rx, -rz)
    drx = rz * speed[HIP] + shank_z * speed[KNEE]
    drz = -rx * speed[HIP] - shank_x * speed[KNEE]
    dleg = (rx * drx + rz * drz) / leg
    axial = jump.stiffness_n_per_m * (jump.rest_length_m - leg) - jump.damping_n_s_per_m * dleg
    across = jump.torsional_stiffness_n_m_per_rad * (0.0 - alpha) / leg
    fz = -axial * cos + across * sin - jump.weight_n
    fx = -axial * sin - across * cos
    return rz * fx - rx * fz, shank_z * fx - shank_x * fz


@compiled
def _limited(torque: float, speed: float, jump: Any, joint: int) -> float:
    """``torque`` within the motor's peak torque and, while the motor drives, within its voltage-speed line."""
    limit = jump.torque_limit_n_m[joint]
    upper, lower = limit, -limit
    if jump.voltage_limit > 0.0:
        no_load, corner = jump.no_load_speed_rad_per_s[joint], jump.corner_speed_rad_per_s[joint]
        upper = limit * min(max((no_load - speed) / (no_load - corner), 0.0), 1.0)
        lower = -limit * min(max((no_load + speed) / (no_load - corner), 0.0), 1.0)
    if torque >= upper:
        jump.saturated_steps[joint] += 1
        return upper
    if torque <= lower:
        jump.saturated_steps[joint] += 1
        return lower
    return torque


@compiled
def _delivered(torque: float, speed: float, jump: Any, joint: int) -> float:
    """The torque that reaches the joint: the load-dependent friction of gears and chain opposes the motion."""
    loss, limit = jump.loss[joint], jump.torque_limit_n_m[joint]
    if loss == 0.0 or torque == 0.0:
        return torque
    after = torque - loss * abs(torque) * math.tanh(speed / jump.loss_speed_rad_per_s)
    return min(max(after, -limit), limit)


@compiled
def _book(jump: Any, speed: tuple[float, float]) -> None:
    """Add up the step just made.

    Work is torque times the mean of the speeds at both ends of the step, or times the speed at its start.
    """
    timestep = jump.timestep_s
    for joint in range(2):
        torque, start = jump.motor_torque_n_m[joint], jump.speed_rad_per_s[joint]
        during = 0.5 * (start + speed[joint]) if jump.mean_speed > 0.0 else start
        power = torque * during
        if power > 0.0:
            jump.energy_j[joint] += power * timestep
        else:
            jump.absorbed_j[joint] -= power * timestep
        jump.drive_loss_j[joint] += (torque - jump.joint_torque_n_m[joint]) * during * timestep
        jump.joule_heat_j += jump.heat_w_per_n2_m2[joint] * torque * torque * timestep
        jump.peak_torque_n_m[joint] = max(jump.peak_torque_n_m[joint], abs(torque))
        jump.peak_speed_rad_per_s[joint] = max(jump.peak_speed_rad_per_s[joint], abs(speed[joint]))
        jump.peak_power_w[joint] = max(jump.peak_power_w[joint], abs(power))
