"""What the motors are told: the virtual leg of the paper, a push that is replayed, and the pose held in flight.

Compiled by numba.
"""

import math
from typing import Any

from pareto_monoped.compute.compiled import compiled
from pareto_monoped.jump.controller_record import HIP, KNEE


@compiled
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


@compiled
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


@compiled
def held_pose(angle: tuple[float, float], speed: tuple[float, float], jump: Any) -> tuple[float, float]:
    """Return torques of hip and knee that pull the leg back to its start pose in flight."""
    stiffness, damping = jump.flight_stiffness_n_m_per_rad, jump.flight_damping_n_m_s_per_rad
    return (
        stiffness * (jump.start_rad[HIP] - angle[HIP]) - damping * speed[HIP],
        stiffness * (jump.start_rad[KNEE] - angle[KNEE]) - damping * speed[KNEE],
    )


@compiled
def release(knee: float, jump: Any) -> float:
    """Return the share of the knee's torque before its lower stop: a ramp over ``knee_release_rad`` down to zero."""
    if jump.knee_release_rad == 0.0:
        return 1.0
    share: float = min(max((knee - jump.lower_stop_rad[KNEE]) / jump.knee_release_rad, 0.0), 1.0)
    return share
