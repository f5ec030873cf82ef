"""Robot -> MuJoCo: the start pose, and the numbers of MuJoCo's model; ``document`` writes them as MJCF.

World frame: x forward, z up, floor at z = 0. The joints turn about +y. At zero both links hang straight down; a
negative hip angle swings the thigh forward, and a positive knee angle is flexion. The base slides and does not pitch.
On a stand it slides on vertical rails only, and its mass includes what holds it there.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.design import GRAVITY_M_PER_S2, Floats
from pareto_monoped.jump.calibration import Calibration, Drive, Joints, SpringContact
from pareto_monoped.jump.end_stops import EndStops, end_stops
from pareto_monoped.leg.stand import CARRIAGES
from pareto_monoped.robot.population import RobotArrays
from pareto_monoped.robot.units import JOINTS

KNEE = JOINTS.index("knee")
_STABLE = 1.4
"""Of the 2 up to which a semi-implicit step is stable, because the joint gives way as well and a motor swings faster.

By simulation: of 120 random designs of each of four motors, none goes wrong below 1.46.
"""
_COPPER_PER_K = 0.00393  #: Relative rise of copper's resistance per kelvin from 20 degC (IEC 60028).
LEAST_IMPEDANCE = 0.0001  #: MuJoCo's smallest impedance (mjMINIMP), which a hardening spring has at first touch.


@dataclass(frozen=True, slots=True, kw_only=True)
class StartPose:
    """Joint angles of n robots at rest."""

    #: hip_rad, knee_rad: shape (n,); NaN where the robot cannot stand
    hip_rad: NDArray[np.float64]
    knee_rad: NDArray[np.float64]
    reason: tuple[str, ...]  #: why the robot cannot stand, n strings; empty where it can


_NEWTON_STEPS = 14
"""Enough from the full width down to a thousandth of its force: converges linearly (factor 2/3) at first, as the force
is nearly cubic, then quadratically."""


def start_pose(robots: RobotArrays, calibration: Calibration) -> StartPose:
    """Return the joint angles with the base at its start height and the foot directly below it (paper, section IV-B).

    With a spring contact the foot starts compressed by the robot's weight, so that nothing moves before the motors do.
    With a contact given by MuJoCo's parameters it starts just touching. The pose must lie within the end stops.
    """
    radius = robots.foot_radius_m
    sunk = np.zeros(len(robots))
    if isinstance(calibration.contact, SpringContact):
        moved_kg = robots.body_mass_kg.sum(axis=1) + stand_mass_kg(robots, calibration)
        sunk = compression_m(calibration.contact, moved_kg * GRAVITY_M_PER_S2)
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
    """Return the compression of the foot's rubber under a steady force, shape (n,), by Newton's method.

    The force is convex up to the full width, so that Newton's method converges from there monotonically.
    """
    full, least, width = contact.impedance, LEAST_IMPEDANCE, contact.width_m
    slope = (full - least) / width
    r = np.full(force_n.shape, width)
    for _ in range(_NEWTON_STEPS):
        d = least + slope * r
        force = slow_force_n(contact, r)
        r = r - (force - force_n) / (force * (2.0 * slope / d + slope / (1.0 - d) + 1.0 / r))
    linear = force_n / contact.stiffness_n_per_m
    return np.where(linear < width, r, linear)


def slow_force_n(contact: SpringContact, compression_m: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the force of the foot's rubber at rest.

    Without velocity and acceleration, the force of MuJoCo's constraint (see ``spring_fields``) is k (1 - D) d^2 / (D^2
    (1 - d)) r up to the full width, and k r beyond.
    """
    full, width = contact.impedance, contact.width_m
    d = LEAST_IMPEDANCE + (full - LEAST_IMPEDANCE) / width * np.minimum(compression_m, width)
    scale = contact.stiffness_n_per_m * (1.0 - full) * d**2 / (full**2 * (1.0 - d))
    return np.asarray(scale * compression_m)


# Body numbers in the model; the world is 0. The last two turn with the motors of an elastic drive.
BASE, THIGH, SHANK, KNEE_MOTOR, HIP_MOTOR = 1, 2, 3, 4, 5
_NEARLY_NOTHING = 1e-13
"""Mass in kg, and inertia in kg m2, of a body that only carries a coordinate; MuJoCo allows no 0."""


def coordinates(calibration: Calibration) -> tuple[str, ...]:
    """Return names of the model's joints in the order of positions and speeds; see ``controller``."""
    slides = ("slide_x", "slide_z") if calibration.simulation.base_slides else ("slide_z",)
    return (*slides, "hip", "knee", *(("knee_motor", "hip_motor") if calibration.drive.elastic else ()))


def motor_places(calibration: Calibration) -> list[int]:
    """Return where the coordinates of both motors stand, hip first; without an elastic drive those of the joints."""
    names = coordinates(calibration)
    return [names.index(f"{joint}_motor" if calibration.drive.elastic else joint) for joint in JOINTS]


def joint_places(calibration: Calibration) -> list[int]:
    """Return where hip and knee stand among the coordinates."""
    return [coordinates(calibration).index(joint) for joint in JOINTS]


FOOT_GEOM = 1


def model_fields(robots: RobotArrays, calibration: Calibration) -> dict[str, Floats]:
    """Return the model fields that differ between robots: MuJoCo's name -> values of shape (n, ...)."""
    n, names, elastic = len(robots), coordinates(calibration), calibration.drive.elastic
    motors, joints = motor_places(calibration), calibration.joints
    bodies = 6 if elastic else 4
    mass, com, inertia = (np.zeros((n, bodies, *tail)) for tail in ((), (3,), (3,)))
    mass[:, 1:4] = robots.body_mass_kg
    mass[:, BASE] += stand_mass_kg(robots, calibration)
    com[:, 1:4] = robots.body_com_m
    # All rotation is about y, so only the yy moment acts; products of inertia would load guides that are not modelled.
    inertia[:, 1:4] = np.diagonal(robots.body_inertia_kg_m2, axis1=-2, axis2=-1)
    position = np.zeros((n, bodies, 3))
    position[:, SHANK, 2] = -robots.thigh_length_m
    foot = np.zeros((n, 1, 3))
    foot[:, 0, 2] = -robots.shank_length_m
    armature, damping, friction = np.zeros((3, n, len(names)))
    armature[:, motors] = robots.armature_kg_m2
    damping[:, motors] = joint_damping(robots, joints)
    friction[:, motors] = joint_friction_n_m(robots, calibration.joints)
    friction[:, names.index("slide_z")] = rail_friction_n(calibration)
    tendons = []  # armature, stiffness, damping, then both coefficients; in the order of ``_tendons``
    if elastic:
        mass[:, KNEE_MOTOR:] = inertia[:, KNEE_MOTOR:] = _NEARLY_NOTHING
        damper = drive_damping_n_m_s_per_rad(robots, calibration)
        stiffness, none = robots.drive_stiffness_n_m_per_rad, np.zeros(n)
        tendons = [(none, stiffness[:, k], damper[:, k], none + 1.0, none - 1.0) for k in range(len(JOINTS))]
    if joints.rotors == "absolute":
        # One tendon of the coordinate hip + c knee with the armature J adds J [1, c; c, c^2] to the mass matrix
        # (MuJoCo's documentation, "tendon-fixed"). J c and J c^2 are the sums B and C; J itself leaves the thigh. With
        # an elastic drive the knee's motor takes the place of the knee.
        coupling, reflected = robots.knee_coupling_kg_m2, robots.knee_reflected_kg_m2
        tendon = np.divide(coupling**2, reflected, out=np.zeros(n), where=reflected > 0.0)
        lever = np.divide(reflected, coupling, out=np.zeros(n), where=coupling > 0.0)
        armature[:, motors[KNEE]] = 0.0
        inertia[:, THIGH, 1] += robots.rotor_excess_kg_m2 - tendon
        tendons.append((tendon, np.zeros(n), np.zeros(n), np.ones(n), lever))
    coupled = {}
    if tendons:
        numbers = np.array(tendons)  # shape (tendons, 5, n)
        names_of = ("tendon_armature", "tendon_stiffness", "tendon_damping")
        coupled = {name: numbers[:, k].T for k, name in enumerate(names_of)}
        coupled["wrap_prm"] = np.moveaxis(numbers[:, 3:], -1, 0).reshape(n, -1)
    limit = torque_limit(robots, calibration.drive)
    return {
        "body_mass": mass,
        "body_ipos": com,
        "body_inertia": inertia,
        "body_pos": position,
        "site_pos": foot,
        "geom_pos": np.concatenate([np.zeros((n, 1, 3)), foot], axis=1),
        "geom_size": np.stack(
            [np.tile([0.0, 0.0, 1.0], (n, 1)), robots.foot_radius_m[:, None] * [1.0, 0.0, 0.0]], axis=1
        ),
        "dof_armature": armature,
        "dof_damping": damping,
        "dof_frictionloss": friction,
        "actuator_ctrlrange": _control_range(limit, joints),
        **coupled,
    }


def _control_range(limit_n_m: Floats, joints: Joints) -> Floats:
    """Return the range of every actuator: the motors', then those of the end stops, which have none."""
    limits = limit_n_m if joints.stop_law == "constraint" else np.concatenate([limit_n_m, 0.0 * limit_n_m], axis=1)
    return np.stack([-limits, limits], axis=-1)


def stand_mass_kg(robots: RobotArrays, calibration: Calibration) -> Floats:
    """Return what the base lifts besides the robot, shape (n,); 0 without a stand."""
    return np.zeros(len(robots)) if calibration.stand is None else robots.stand_mass_kg


def rail_friction_n(calibration: Calibration) -> float:
    """Return the Coulomb friction of all carriages on their rails; 0 without a stand."""
    return 0.0 if calibration.stand is None else CARRIAGES * calibration.stand.rail_friction_n


def joint_damping(robots: RobotArrays, joints: Joints) -> Floats:
    """Return viscous friction of hip and knee with their motors', N m s/rad, shape (n, 2)."""
    damping = joints.damping_n_m_s_per_rad + joints.motor_damping_n_m_s_per_rad * np.square(robots.ratio)
    if joints.motor_damping_share_s_per_rad:
        damping = damping + joints.motor_damping_share_s_per_rad * robots.rated_torque_n_m * robots.ratio
    return damping


def joint_friction_n_m(robots: RobotArrays, joints: Joints) -> Floats:
    """Return Coulomb friction of hip and knee, shape (n, 2)."""
    return joints.friction_n_m + joints.friction_share * robots.rated_torque_n_m


def drive_damping_n_m_s_per_rad(robots: RobotArrays, calibration: Calibration) -> Floats:
    """Return the damping of both elastic drives: 2 zeta sqrt(k C), shape (n, 2)."""
    turning = _driven_kg_m2(robots, calibration)
    ratio = calibration.drive.drive_damping_ratio
    return np.asarray(2.0 * ratio * np.sqrt(robots.drive_stiffness_n_m_per_rad * turning))


def longest_step_s(robots: RobotArrays, calibration: Calibration) -> Floats:
    """Return the longest step that the springs of elastic drives allow, shape (n,); infinite for rigid ones.

    It is a share of 1 / omega, with omega of a motor on its spring and the joint held.
    """
    if not calibration.drive.elastic:
        return np.full(len(robots), np.inf)
    turning = _driven_kg_m2(robots, calibration)
    return np.asarray(_STABLE * np.sqrt(turning / robots.drive_stiffness_n_m_per_rad).min(axis=1))


def _driven_kg_m2(robots: RobotArrays, calibration: Calibration) -> Floats:
    """Return C of what turns with each motor, at its joint, shape (n, 2)."""
    turning = robots.armature_kg_m2.copy()
    if calibration.joints.rotors == "absolute":
        turning[:, KNEE] = robots.knee_reflected_kg_m2
    return turning


def winding_resistance_ohm(robots: RobotArrays, drive: Drive) -> Floats:
    """Return the resistance of the warm windings, shape (n, 2)."""
    return robots.winding_resistance_ohm * (1.0 + _COPPER_PER_K * drive.winding_rise_k)


def gear_efficiency(robots: RobotArrays, drive: Drive) -> Floats:
    """Return the efficiency of both gearboxes under load, shape (n, 2), as the calibration reads it."""
    if not drive.mesh_losses:
        return np.ones_like(robots.efficiency)
    known = (robots.efficiency_total if drive.efficiency == "total" else robots.efficiency).copy()
    return known if drive.gear_loss == 1.0 else np.maximum(1.0 - drive.gear_loss * (1.0 - known), 0.0)


def torque_limit(robots: RobotArrays, drive: Drive) -> Floats:
    """Return the peak torque of hip and knee, N m at the joint, shape (n, 2)."""
    return drive.peak_torque_scale * robots.peak_torque_n_m * [1.0, drive.knee_torque_scale]


def spring_fields(
    calibration: Calibration, stops: EndStops, body_invweight0: Floats, dof_invweight0: Floats
) -> dict[str, Floats]:
    """Return MuJoCo's parameters for springs and dampers given in SI units.

    MuJoCo computes a constraint's force as d / (1 - d) / A (b' v + k' r - a), with impedance d (D at full compression),
    a fixed inverse mass A, k' = -solref[0] d / D^2 and b' = -solref[1] / D (its documentation, "Computation: constraint
    model" and "Solver parameters"). A stiffness k in N/m at full compression therefore needs solref[0] = -k A (1 - D),
    and a damping c in N s/m needs solref[1] = -c A (1 - D). MuJoCo's inverse masses of bodies have shape (n, 4, 2),
    those of joints (n, nv).

    Returns:
        ``geom_solref`` of the foot, shape (n, 2), and ``jnt_solref`` of hip and knee, shape (n, 2, 2), if the
        calibration has such springs.
    """
    result = {}
    contact = calibration.contact
    if isinstance(contact, SpringContact):
        scale = body_invweight0[:, SHANK, 0] * (1.0 - contact.impedance)
        result["geom_solref"] = -scale[:, None] * [contact.stiffness_n_per_m, contact.damping_n_s_per_m]
    if any(stops):
        joint = np.tile([0.02, 1.0], (len(dof_invweight0), 2, 1))
        for k, stop in enumerate(stops):
            if stop is None:
                continue
            scale = dof_invweight0[:, -2 + k] * (1.0 - stop.impedance)
            joint[:, k] = -scale[:, None] * [stop.stiffness_n_m_per_rad, stop.damping_n_m_s_per_rad]
        result["jnt_solref"] = joint
    return result


def start_qpos(robots: RobotArrays, calibration: Calibration, pose: StartPose) -> Floats:
    """Return joint positions at rest, in the order of ``coordinates``, shape (n, nv).

    The springs of elastic drives are wound up by ``standing_torque_n_m``, so that a jump does not begin with a fall.
    """
    joint_rad = np.stack([pose.hip_rad, pose.knee_rad], axis=1)
    known = {"slide_x": np.zeros(len(robots)), "slide_z": robots.start_height_m}
    known |= dict(zip(JOINTS, joint_rad.T, strict=True))
    if calibration.drive.elastic:
        torque = standing_torque_n_m(robots, calibration, pose)
        motor_rad = joint_rad + torque / robots.drive_stiffness_n_m_per_rad
        motor_rad += np.copysign(0.5 * calibration.drive.backlash_rad, torque)
        known |= {f"{joint}_motor": motor_rad[:, k] for k, joint in enumerate(JOINTS)}
    return np.stack([known[name] for name in coordinates(calibration)], axis=1)


def standing_torque_n_m(robots: RobotArrays, calibration: Calibration, pose: StartPose) -> Floats:
    """Return torques that hold robots in their start pose, shape (n, 2).

    Each joint carries the moments about it of the floor's force, which points straight up, and of the links below it.
    """
    thigh_rad, shank_rad = pose.hip_rad, pose.hip_rad + pose.knee_rad
    knee_m, foot_m = -robots.thigh_length_m * np.sin(thigh_rad), -robots.shank_length_m * np.sin(shank_rad)
    links_n = GRAVITY_M_PER_S2 * robots.body_mass_kg[:, [THIGH - 1, SHANK - 1]]
    centres_m = [
        com[:, 0] * np.cos(angle) + com[:, 2] * np.sin(angle)
        for com, angle in ((robots.body_com_m[:, THIGH - 1], thigh_rad), (robots.body_com_m[:, SHANK - 1], shank_rad))
    ]
    lifted_kg = robots.body_mass_kg.sum(axis=1) + stand_mass_kg(robots, calibration)
    knee = GRAVITY_M_PER_S2 * lifted_kg * foot_m - links_n[:, 1] * centres_m[1]
    hip = (GRAVITY_M_PER_S2 * lifted_kg - links_n[:, 1]) * knee_m + knee - links_n[:, 0] * centres_m[0]
    return np.stack([hip, knee], axis=1)


def wound_j(robots: RobotArrays, calibration: Calibration, pose: StartPose) -> Floats:
    """Return the energy in the springs of elastic drives at the start, shape (n,)."""
    if not calibration.drive.elastic:
        return np.zeros(len(robots))
    torque = standing_torque_n_m(robots, calibration, pose)
    return np.asarray(0.5 * np.sum(np.square(torque) / robots.drive_stiffness_n_m_per_rad, axis=1))
