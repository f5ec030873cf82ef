"""Robot -> MuJoCo: the start pose, the MJCF document of one robot, and the same numbers as model fields for a batch.

World frame: x forward, z up, floor at z = 0. The joints turn about +y. At zero both links hang straight down; a
negative hip angle swings the thigh forward, and a positive knee angle is flexion. The base slides and does not pitch.
On a stand it slides on vertical rails only, and its mass includes what holds it there.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.design import GRAVITY_M_PER_S2, Floats
from pareto_monoped.jump.calibration import Calibration, Drive, Joints, SpringContact
from pareto_monoped.jump.end_stops import EndStops, end_stops
from pareto_monoped.leg.stand import CARRIAGES
from pareto_monoped.robot.population import RobotArrays
from pareto_monoped.robot.units import JOINTS

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


# Body numbers in the model; the world is 0.
BASE, THIGH, SHANK = 1, 2, 3
FOOT_GEOM = 1
# Midpoint and power of MuJoCo's impedance curve: a straight line, and its default sigmoid.
_LINEAR, _SIGMOID = (0.5, 1.0), (0.5, 2.0)


def mjcf(robots: RobotArrays, calibration: Calibration, index: int = 0, *, comment: str = "") -> str:
    """Return the MJCF document of robot ``index``, which is exactly what a batch simulates for that robot."""
    import mujoco

    fields = {name: values[index] for name, values in model_fields(robots, calibration).items()}
    pose = start_pose(robots, calibration)
    start = start_qpos(calibration, robots.start_height_m, pose)[index]
    # Springs in N/m need inverse masses that only MuJoCo's compiler computes, so compile a draft without them first.
    stops = end_stops(robots, calibration.joints)
    draft = mujoco.MjModel.from_xml_string(_document(fields, start, calibration, stops, None, comment))
    springs = spring_fields(calibration, stops, draft.body_invweight0[None, :, :], draft.dof_invweight0[None, :])
    values = {name: values[0] for name, values in springs.items()}
    return _document(fields, start, calibration, stops, values, comment)


def template_mjcf(calibration: Calibration, stops: EndStops, user_data: int) -> str:
    """Return the MJCF document of a robot with round numbers; a batch overwrites the fields of each robot."""
    fields = {
        "body_mass": np.ones(4),
        "body_ipos": np.zeros((4, 3)),
        "body_inertia": np.ones((4, 3)),
        "body_pos": np.array([[0.0, 0.0, 0.0]] * 3 + [[0.0, 0.0, -0.4]]),
        "site_pos": np.array([[0.0, 0.0, -0.4]]),
        "geom_size": np.array([[0.0, 0.0, 1.0], [0.03, 0.0, 0.0]]),
        "dof_armature": np.ones(4),
        "dof_damping": np.ones(4),
        "actuator_ctrlrange": np.array([[-1.0, 1.0], [-1.0, 1.0]]),
        "tendon_armature": np.ones(1),
        "wrap_prm": np.ones(2),
    }
    start = np.zeros(4 if calibration.simulation.base_slides else 3)
    size = f'<size nuserdata="{user_data}"/>'
    return _document(fields, start, calibration, stops, None, "").replace("<worldbody>", f"{size}\n  <worldbody>", 1)


def model_fields(robots: RobotArrays, calibration: Calibration) -> dict[str, Floats]:
    """Return the model fields that differ between robots: MuJoCo's name -> values of shape (n, ...)."""
    n, slides = len(robots), calibration.simulation.base_slides
    mass, com, inertia = (np.zeros((n, 4, *tail)) for tail in ((), (3,), (3,)))
    mass[:, 1:] = robots.body_mass_kg
    mass[:, BASE] += stand_mass_kg(robots, calibration)
    com[:, 1:] = robots.body_com_m
    # All rotation is about y, so only the yy moment acts; products of inertia would load guides that are not modelled.
    inertia[:, 1:] = np.diagonal(robots.body_inertia_kg_m2, axis1=-2, axis2=-1)
    position = np.zeros((n, 4, 3))
    position[:, SHANK, 2] = -robots.thigh_length_m
    foot = np.zeros((n, 1, 3))
    foot[:, 0, 2] = -robots.shank_length_m
    armature = np.zeros((n, 4 if slides else 3))
    armature[:, -2:] = robots.armature_kg_m2
    rotor = {}
    if calibration.joints.rotors == "absolute":
        # One tendon of the coordinate hip + c knee with the armature J adds J [1, c; c, c^2] to the mass matrix
        # (MuJoCo's documentation, "tendon-fixed"). J c and J c^2 are the sums B and C; J itself leaves the thigh.
        coupling, reflected = robots.knee_coupling_kg_m2, robots.knee_reflected_kg_m2
        tendon = np.divide(coupling**2, reflected, out=np.zeros(n), where=reflected > 0.0)
        lever = np.divide(reflected, coupling, out=np.zeros(n), where=coupling > 0.0)
        armature[:, -1] = 0.0
        inertia[:, THIGH, 1] += robots.rotor_excess_kg_m2 - tendon
        rotor = {"tendon_armature": tendon[:, None], "wrap_prm": np.stack([np.ones(n), lever], axis=1)}
    joints = calibration.joints
    damping = np.zeros_like(armature)
    damping[:, -2:] = joint_damping(robots, joints)
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
        "actuator_ctrlrange": np.stack([-limit, limit], axis=-1),
        **rotor,
    }


def stand_mass_kg(robots: RobotArrays, calibration: Calibration) -> Floats:
    """Return what the base lifts besides the robot, shape (n,); 0 without a stand."""
    return np.zeros(len(robots)) if calibration.stand is None else robots.stand_mass_kg


def rail_friction_n(calibration: Calibration) -> float:
    """Return the Coulomb friction of all carriages on their rails; 0 without a stand."""
    return 0.0 if calibration.stand is None else CARRIAGES * calibration.stand.rail_friction_n


def joint_damping(robots: RobotArrays, joints: Joints) -> Floats:
    """Return viscous friction of hip and knee with their motors', N m s/rad, shape (n, 2)."""
    return joints.damping_n_m_s_per_rad + joints.motor_damping_n_m_s_per_rad * np.square(robots.ratio)


def gear_efficiency(robots: RobotArrays, drive: Drive) -> Floats:
    """Return the efficiency of both gearboxes under load, shape (n, 2), as the calibration reads it."""
    if not drive.mesh_losses:
        return np.ones_like(robots.efficiency)
    return (robots.efficiency_total if drive.efficiency == "total" else robots.efficiency).copy()


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


def start_qpos(calibration: Calibration, height_m: Floats, pose: StartPose) -> Floats:
    """Joint positions at rest: x (unless the base is on a vertical guide), z, hip, knee; shape (n, 4) or (n, 3)."""
    columns = [height_m, pose.hip_rad, pose.knee_rad]
    if calibration.simulation.base_slides:
        columns.insert(0, np.zeros(len(height_m)))
    return np.stack(columns, axis=1)


def _document(
    fields: dict[str, Any],
    start: Floats,
    calibration: Calibration,
    stops: EndStops,
    springs: dict[str, Any] | None,
    comment: str,
) -> str:
    """Return the XML text of one robot; reading its numbers gives the same bits."""
    simulation, joints = calibration.simulation, calibration.joints
    friction_loss = f' frictionloss="{_n(joints.friction_n_m)}"' if joints.friction_n_m else ""
    contact = calibration.contact
    if isinstance(contact, SpringContact):
        foot_solref = springs["geom_solref"] if springs else (-1.0, -1.0)
        solimp = (LEAST_IMPEDANCE, contact.impedance, contact.width_m, *_LINEAR)
        slip_ratio, cone = contact.slip_ratio, "elliptic"
    else:
        foot_solref = (contact.time_constant_s, contact.damping_ratio)
        solimp = (contact.impedance_min, contact.impedance_max, contact.impedance_width_m, *_SIGMOID)
        slip_ratio, cone = 1.0, "pyramidal"

    def hinge(k: int, name: str) -> str:
        limit, stop = "", stops[k]
        if stop is not None:
            solref = springs["jnt_solref"][k] if springs else (-1.0, -1.0)
            solimp = (LEAST_IMPEDANCE, stop.impedance, stop.width_rad, *_LINEAR)
            limit = (
                f' limited="true" range="{_n(stop.lower_rad, stop.upper_rad)}" solreflimit="{_n(*solref)}"'
                f' solimplimit="{_n(*solimp)}"'
            )
        armature, damping = fields["dof_armature"][-2 + k], fields["dof_damping"][-2 + k]
        return (
            f'<joint name="{name}" type="hinge" axis="0 1 0" armature="{_n(armature)}" damping="{_n(damping)}"'
            f"{friction_loss}{limit}/>"
        )

    def inertial(body: int) -> str:
        return (
            f'<inertial pos="{_n(*fields["body_ipos"][body])}" mass="{_n(fields["body_mass"][body])}"'
            f' diaginertia="{_n(*fields["body_inertia"][body])}"/>'
        )

    rails = f' frictionloss="{_n(friction_n)}"' if (friction_n := rail_friction_n(calibration)) else ""
    slide_x = '\n      <joint name="slide_x" type="slide" axis="1 0 0"/>' if simulation.base_slides else ""
    foot = _n(*fields["site_pos"][0])
    tendon = ""
    if joints.rotors == "absolute":
        tendon = f"""
  <tendon>
    <fixed name="knee_rotor" armature="{_n(*fields["tendon_armature"])}">
      <joint joint="hip" coef="{_n(fields["wrap_prm"][0])}"/>
      <joint joint="knee" coef="{_n(fields["wrap_prm"][1])}"/>
    </fixed>
  </tendon>"""
    head = f"<!-- {comment.replace('--', '- -')} -->\n" if comment else ""
    return f"""{head}<mujoco model="pareto_monoped {calibration.label}">
  <compiler angle="radian" autolimits="false"/>
  <option timestep="{_n(simulation.timestep_s)}" integrator="{simulation.integrator}" cone="{cone}" \
impratio="{_n(slip_ratio)}" gravity="0 0 {_n(-GRAVITY_M_PER_S2)}" solver="Newton" tolerance="1e-12">
    <flag island="disable" midphase="disable" autoreset="disable"/>
  </option>
  <worldbody>
    <light pos="0 -2 3" dir="0 0.5 -1"/>
    <geom name="floor" type="plane" size="0 0 1"/>
    <body name="base">{slide_x}
      <joint name="slide_z" type="slide" axis="0 0 1"{rails}/>
      {inertial(BASE)}
      <body name="thigh">
        {hinge(0, "hip")}
        {inertial(THIGH)}
        <body name="shank" pos="{_n(*fields["body_pos"][SHANK])}">
          {hinge(1, "knee")}
          {inertial(SHANK)}
          <geom name="foot" type="sphere" size="{_n(fields["geom_size"][FOOT_GEOM][0])}" pos="{foot}" priority="1" \
friction="{_n(contact.friction)} 0.005 0.0001" solref="{_n(*foot_solref)}" solimp="{_n(*solimp)}"/>
          <site name="foot" pos="{foot}"/>
        </body>
      </body>
    </body>
  </worldbody>{tendon}
  <actuator>
    <motor name="hip" joint="hip" gear="1" ctrllimited="true" ctrlrange="{_n(*fields["actuator_ctrlrange"][0])}"/>
    <motor name="knee" joint="knee" gear="1" ctrllimited="true" ctrlrange="{_n(*fields["actuator_ctrlrange"][1])}"/>
  </actuator>
  <keyframe>
    <key name="start" qpos="{_n(*start)}"/>
  </keyframe>
</mujoco>
"""


def _n(*values: float) -> str:
    """Return numbers, each as the shortest text that reads back to the same bits."""
    return " ".join(repr(float(value)) for value in values)
