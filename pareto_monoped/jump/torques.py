"""What the motors are told: the laws of ``laws``, a push that is replayed, the pose held in flight; what they deliver.

Compiled by numba.
"""

import math
from typing import Any

import numpy as np

from pareto_monoped.compute.compiled import call_address, compiled, inner
from pareto_monoped.design import MOST_KNOTS, Floats
from pareto_monoped.jump.controller_record import HIP, KNEE, OVER_LENGTH, OVER_TIME, OWN, PUSH, TRACKING

EASE_S = 0.003
"""How long a landing takes from its posture in flight to its push; our own choice: three usual control periods. Without
it, a foot that touches the floor just after a control period has begun, instead of just before, would change the peak
torque of the hip's gears by up to 7 percent."""


@inner
def torques(
    angle: tuple[float, float],
    foot: tuple[float, float],
    shank: tuple[float, float],
    speed: tuple[float, float],
    jump: Any,
) -> tuple[float, float]:
    """Return the torques of hip and knee that the law of this jump wants, before any limit.

    ``foot`` and ``shank`` are the vectors (x, z) from hip to foot and from knee to foot.
    """
    time_s = (jump.steps - 1.0) * jump.timestep_s
    if jump.law == OVER_TIME:
        return _on_profile(time_s, jump)
    if jump.law == OVER_LENGTH:
        return _on_profile(math.sqrt(foot[0] * foot[0] + foot[1] * foot[1]), jump)
    if jump.law == TRACKING:
        return _tracking(foot, shank, speed, jump)
    if jump.law == PUSH:
        return push(angle, foot, shank, speed, jump)
    if jump.law == OWN:
        return _own(time_s, angle, foot, speed, jump)
    return virtual_leg(foot, shank, speed, jump)


@inner
def _on_profile(place: float, jump: Any) -> tuple[float, float]:
    """Return the torques at a time or leg length; before the first knot and after the last one those of that knot."""
    share = (place - jump.first_knot) * jump.per_profile
    knots, smooth = int(jump.knots), jump.cubic > 0.0
    limit = jump.torque_limit_n_m
    hip = limit[HIP] * between(share, jump.profile[1:], knots, smooth)
    return hip, limit[KNEE] * between(share, jump.profile[1 + MOST_KNOTS :], knots, smooth)


@inner
def _tracking(
    foot: tuple[float, float], shank: tuple[float, float], speed: tuple[float, float], jump: Any
) -> tuple[float, float]:
    """Return the torques at a leg length, less those of a damper between hip and foot, which leave the hip alone."""
    (rx, rz), (shank_x, shank_z) = foot, shank
    leg2 = rx * rx + rz * rz
    hip, knee = _on_profile(math.sqrt(leg2), jump)
    drx = rz * speed[HIP] + shank_z * speed[KNEE]
    drz = -rx * speed[HIP] - shank_x * speed[KNEE]
    pull = jump.damping_n_s_per_m * (rx * drx + rz * drz) / leg2
    return hip, knee - pull * (shank_z * rx - shank_x * rz)


@compiled
def between(share: float, values: Floats, knots: int, smooth: bool) -> float:
    """Return the value at a share of the way, 0 to 1, from the first to the last of some equidistant knots.

    It is a straight line from knot to knot or, if ``smooth``, a cubic whose slope at a knot is that between its
    neighbours (Catmull and Rom, 1974); the outermost slopes are those of the outermost lines.
    """
    along = min(max(share, 0.0), 1.0) * (knots - 1)
    k = min(int(along), knots - 2)
    u = along - k
    start, end = values[k], values[k + 1]
    if not smooth:
        return float(start + u * (end - start))
    before = values[k - 1] if k > 0 else 2.0 * start - end
    after = values[k + 2] if k + 2 < knots else 2.0 * end - start
    out, in_ = 0.5 * (end - before), 0.5 * (after - start)
    rise = end - start
    return float(start + u * (out + u * (3.0 * rise - 2.0 * out - in_ + u * (out + in_ - 2.0 * rise))))


@compiled
def basis(shares: Floats, knots: int, smooth: bool) -> Floats:
    """Return what each knot alone, 1 where the others are 0, is at n shares of the way: shape (n, knots)."""
    found, unit = np.empty((len(shares), knots)), np.eye(knots)
    for row in range(len(shares)):
        for knot in range(knots):
            found[row, knot] = between(shares[row], unit[knot], knots, smooth)
    return found


@inner
def _own(
    time_s: float, angle: tuple[float, float], foot: tuple[float, float], speed: tuple[float, float], jump: Any
) -> tuple[float, float]:
    """Return the torques of a law of the user's own, which is compiled apart and called by its address."""
    state = np.empty(7)
    state[0], state[1], state[2], state[3] = time_s, angle[HIP], angle[KNEE], speed[HIP]
    state[4], state[5], state[6] = speed[KNEE], foot[0], foot[1]
    torque = np.zeros(2)
    call_address(np.int64(jump.own_address), state.ctypes, jump.profile.ctypes, torque.ctypes)
    return torque[HIP], torque[KNEE]


@inner
def virtual_leg(
    foot: tuple[float, float], shank: tuple[float, float], speed: tuple[float, float], jump: Any
) -> tuple[float, float]:
    """Return the torques of virtual spring, damper and torsional spring (paper, section II-B), before any limit.

    ``foot`` and ``shank`` are the vectors (x, z) from hip to foot and from knee to foot.
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


@inner
def push(
    angle: tuple[float, float],
    foot: tuple[float, float],
    shank: tuple[float, float],
    speed: tuple[float, float],
    jump: Any,
) -> tuple[float, float]:
    """Return the torques of a push: J^T F within its limit, a constant, and springs and dampers of both joints.

    F is that of the foot on the floor: a force, a spring to a place of the foot and a damper, forward and down. J is
    that of the pose, or of the pose that the springs of the joints pull to.
    """
    (rx, rz), (shank_x, shank_z) = foot, shank
    drx = rz * speed[HIP] + shank_z * speed[KNEE]
    drz = -rx * speed[HIP] - shank_x * speed[KNEE]
    fx = jump.force_n[0] + jump.force_n_per_m[0] * (jump.foot_m[0] - rx)
    fx += jump.force_n_s_per_m[0] * (jump.foot_m_per_s[0] - drx)
    fz = -jump.force_n[1] - jump.force_n_per_m[1] * (jump.foot_m[1] + rz)
    fz -= jump.force_n_s_per_m[1] * (jump.foot_m_per_s[1] + drz)
    if jump.at_target > 0.0:
        thigh, below = jump.target_rad[HIP], jump.target_rad[HIP] + jump.target_rad[KNEE]
        shank_x, shank_z = -jump.shank_length_m * math.sin(below), -jump.shank_length_m * math.cos(below)
        rx, rz = shank_x - jump.thigh_length_m * math.sin(thigh), shank_z - jump.thigh_length_m * math.cos(thigh)
    limit = jump.force_limit_n_m
    hip = min(max(rz * fx - rx * fz, -limit[HIP]), limit[HIP]) + jump.added_n_m[HIP]
    knee = min(max(shank_z * fx - shank_x * fz, -limit[KNEE]), limit[KNEE]) + jump.added_n_m[KNEE]
    stiffness, damping = jump.joint_n_m_per_rad, jump.joint_n_m_s_per_rad
    hip += stiffness * (jump.target_rad[HIP] - angle[HIP]) + damping * (jump.target_rad_per_s[HIP] - speed[HIP])
    knee += stiffness * (jump.target_rad[KNEE] - angle[KNEE]) + damping * (jump.target_rad_per_s[KNEE] - speed[KNEE])
    return hip, knee


@inner
def held_pose(angle: tuple[float, float], speed: tuple[float, float], jump: Any) -> tuple[float, float]:
    """Return torques of hip and knee that pull the leg back to its start pose in flight."""
    stiffness, damping = jump.flight_stiffness_n_m_per_rad, jump.flight_damping_n_m_s_per_rad
    return (
        stiffness * (jump.start_rad[HIP] - angle[HIP]) - damping * speed[HIP],
        stiffness * (jump.start_rad[KNEE] - angle[KNEE]) - damping * speed[KNEE],
    )


@inner
def release(knee: float, jump: Any) -> float:
    """Return the share of the knee's torque before its lower stop: a ramp over ``knee_release_rad`` down to zero."""
    if jump.knee_release_rad == 0.0:
        return 1.0
    share: float = min(max((knee - jump.lower_stop_rad[KNEE]) / jump.knee_release_rad, 0.0), 1.0)
    return share


@inner
def since_touch_s(jump: Any) -> float:
    """Return the time since the foot of a landing first touched the floor."""
    since: float = (jump.steps - 1.0) * jump.timestep_s - jump.touched_s
    return since


@inner
def eased(posture: tuple[float, float], push: tuple[float, float], jump: Any) -> tuple[float, float]:
    """Return the torques of a landing after touchdown, which go from those in flight to the push within ``EASE_S``."""
    share = min(since_touch_s(jump) / EASE_S, 1.0)
    hip = posture[HIP] + share * (push[HIP] - posture[HIP])
    return hip, posture[KNEE] + share * (push[KNEE] - posture[KNEE])


@inner
def lower(jump: Any) -> None:
    """Move the place that a landing's spring pulls the foot to: the catch, then smoothly down to the crouch."""
    u = min(max((since_touch_s(jump) - jump.catch_s) / jump.lower_s, 0.0), 1.0)
    jump.foot_m[1] = jump.catch_m + (jump.crouch_m - jump.catch_m) * u * u * (3.0 - 2.0 * u)


@inner
def limited(torque: float, speed: float, jump: Any, joint: int) -> float:
    """Return ``torque`` within the motor's peak torque and, while the motor drives, within its voltage-speed line."""
    limit: float = jump.torque_limit_n_m[joint]
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


@inner
def delivered(torque: float, speed: float, jump: Any, joint: int) -> float:
    """Return the torque that reaches the joint: the load-dependent friction of gears and chain opposes the motion."""
    loss: float = jump.loss[joint]
    limit: float = jump.torque_limit_n_m[joint]
    if loss == 0.0 or torque == 0.0:
        return torque
    after = torque - loss * abs(torque) * math.tanh(speed / jump.loss_speed_rad_per_s)
    return min(max(after, -limit), limit)


@inner
def _deceleration(
    r: float, v: float, width: float, full: float, stiffness: float, damping: float, inertia: float
) -> float:
    u = min(max(r / width, 0.0), 1.0)
    share = u * (1.0 - full) / (1.0 - full * u)
    torque = share * (stiffness * u * r + damping * v)
    return max(0.0, torque) * (1.0 - full * u) / inertia  # the virtual inertia adds d / (1 - d)


@compiled
def rebound(speed: float, width: float, full: float, stiffness: float, damping: float, inertia: float) -> float:
    """Return the speed at which a free inertia leaves a stop that it met at ``speed``, by Runge and Kutta's method.

    All quantities are in SI units; ``full`` is the impedance at the full ``width``.
    """
    r, v = 0.0, speed
    h = 0.005 * width / speed
    while r >= 0.0:
        a1 = _deceleration(r, v, width, full, stiffness, damping, inertia)
        v2 = v - 0.5 * h * a1
        a2 = _deceleration(r + 0.5 * h * v, v2, width, full, stiffness, damping, inertia)
        v3 = v - 0.5 * h * a2
        a3 = _deceleration(r + 0.5 * h * v2, v3, width, full, stiffness, damping, inertia)
        v4 = v - h * a3
        a4 = _deceleration(r + h * v3, v4, width, full, stiffness, damping, inertia)
        r += h * (v + 2.0 * v2 + 2.0 * v3 + v4) / 6.0
        v -= h * (a1 + 2.0 * a2 + 2.0 * a3 + a4) / 6.0
    return -v
