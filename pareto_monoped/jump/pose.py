"""Inverse kinematics of the start pose: base at its start height, foot directly below it (paper, section IV-B)."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.design import GRAVITY_M_PER_S2
from pareto_monoped.jump.calibration import Calibration, SpringContact
from pareto_monoped.jump.end_stops import end_stops
from pareto_monoped.robot.frames import JOINTS
from pareto_monoped.robot.population import RobotArrays

LEAST_IMPEDANCE = 0.0001
"""MuJoCo's smallest impedance (mjMINIMP), which a hardening spring has at first touch."""


@dataclass(frozen=True, slots=True, kw_only=True)
class StartPose:
    """Joint angles of n robots at rest.

    Attributes:
        hip_rad, knee_rad: shape (n,); NaN where the robot cannot stand.
        reason: why the robot cannot stand, n strings; empty where it can.
    """

    hip_rad: NDArray[np.float64]
    knee_rad: NDArray[np.float64]
    reason: tuple[str, ...]


_NEWTON_STEPS = 14
"""Enough from the full width down to a thousandth of its force: converges linearly (factor 2/3) at first, as the force
is nearly cubic, then quadratically."""


def start_pose(robots: RobotArrays, calibration: Calibration) -> StartPose:
    """Joint angles that place the foot directly below the base.

    With a spring contact the foot starts compressed by the robot's weight, so that nothing moves before the motors do.
    With a contact given by MuJoCo's parameters it starts just touching.

    Args:
        robots: n robots.
        calibration: the contact, and the end stops that the pose must respect.
    """
    radius = robots.foot_radius_m
    sunk = np.zeros(len(robots))
    if isinstance(calibration.contact, SpringContact):
        sunk = compression_m(calibration.contact, robots.body_mass_kg.sum(axis=1) * GRAVITY_M_PER_S2)
    length = robots.start_height_m - radius + sunk
    thigh, shank = robots.thigh_length_m, robots.shank_length_m
    with np.errstate(invalid="ignore", divide="ignore"):
        # Law of cosines. Of both solutions, take the one with the knee in front: positive flexion, from 0 to pi.
        knee = np.arccos((length**2 - thigh**2 - shank**2) / (2.0 * thigh * shank))
        hip = -np.arctan2(shank * np.sin(knee), thigh + shank * np.cos(knee))
    reason = [""] * len(robots)
    for i in np.flatnonzero(~np.isfinite(knee)):
        need = f"{length[i]:.3f} m from hip to foot"
        if thigh[i] + shank[i] < length[i]:
            reason[i] = f"the stretched leg of {thigh[i] + shank[i]:.3f} m is shorter than the {need}"
        else:
            reason[i] = f"links of {thigh[i]:.3f} m and {shank[i]:.3f} m cannot fold to the {need}"
    for name, angle, stop in zip(JOINTS, (hip, knee), end_stops(robots, calibration.joints), strict=True):
        if stop is None:
            continue
        with np.errstate(invalid="ignore"):
            outside = (angle < stop.lower_rad) | (angle > stop.upper_rad)
        for i in np.flatnonzero(outside):
            if not reason[i]:
                reason[i] = (
                    f"the {name} would stand at {np.degrees(angle[i]):.1f} deg, outside its stops "
                    f"{np.degrees(stop.lower_rad):.1f} to {np.degrees(stop.upper_rad):.1f} deg"
                )
    stands = np.array([not text for text in reason], dtype=bool)
    return StartPose(
        hip_rad=np.where(stands, hip, np.nan), knee_rad=np.where(stands, knee, np.nan), reason=tuple(reason)
    )


def compression_m(contact: SpringContact, force_n: NDArray[np.float64]) -> NDArray[np.float64]:
    """Compression of the foot's rubber under a steady force, shape (n,), by Newton's method.

    Without velocity and acceleration, the force of MuJoCo's constraint (see ``model.spring_fields``) is
    k (1 - D) d^2 / (D^2 (1 - d)) r up to the full width, and k r beyond. It is convex up to the full width, so that
    Newton's method converges from there monotonically.

    Args:
        contact: the spring.
        force_n: shape (n,).
    """
    full, least, width = contact.impedance, LEAST_IMPEDANCE, contact.width_m
    slope = (full - least) / width
    r = np.full(force_n.shape, width)
    for _ in range(_NEWTON_STEPS):
        d = least + slope * r
        force = contact.stiffness_n_per_m * (1.0 - full) * d**2 / (full**2 * (1.0 - d)) * r
        r = r - (force - force_n) / (force * (2.0 * slope / d + slope / (1.0 - d) + 1.0 / r))
    linear = force_n / contact.stiffness_n_per_m
    return np.where(linear < width, r, linear)
