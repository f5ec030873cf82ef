"""What the motors are told: the virtual leg of the paper and the pose held in flight, compiled by numba."""

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
