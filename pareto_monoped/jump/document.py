"""The MJCF document of one robot, and that of the template whose fields a batch overwrites."""

from typing import Any

import numpy as np

from pareto_monoped.design import GRAVITY_M_PER_S2, Floats
from pareto_monoped.jump.calibration import Calibration, SpringContact
from pareto_monoped.jump.end_stops import EndStops, constraints
from pareto_monoped.jump.model import (
    BASE,
    FOOT_GEOM,
    HIP_MOTOR,
    KNEE,
    KNEE_MOTOR,
    LEAST_IMPEDANCE,
    SHANK,
    THIGH,
    coordinates,
    model_fields,
    motor_places,
    spring_fields,
    start_pose,
    start_qpos,
)
from pareto_monoped.robot.population import RobotArrays
from pareto_monoped.robot.units import JOINTS

# Midpoint and power of MuJoCo's impedance curve: a straight line, and its default sigmoid.
_LINEAR, _SIGMOID = (0.5, 1.0), (0.5, 2.0)


def mjcf(robots: RobotArrays, calibration: Calibration, index: int = 0, *, comment: str = "") -> str:
    """Return the MJCF document of robot ``index``, which is exactly what a batch simulates for that robot."""
    import mujoco

    fields = {name: values[index] for name, values in model_fields(robots, calibration).items()}
    pose = start_pose(robots, calibration)
    start = start_qpos(robots, calibration, pose)[index]
    # Springs in N/m need inverse masses that only MuJoCo's compiler computes, so compile a draft without them first.
    stops = constraints(robots, calibration.joints)
    draft = mujoco.MjModel.from_xml_string(_document(fields, start, calibration, stops, None, comment))
    springs = spring_fields(calibration, stops, draft.body_invweight0[None, :, :], draft.dof_invweight0[None, :])
    values = {name: values[0] for name, values in springs.items()}
    return _document(fields, start, calibration, stops, values, comment)


def template_mjcf(calibration: Calibration, stops: EndStops, user_data: int) -> str:
    """Return the MJCF document of a robot with round numbers; a batch overwrites the fields of each robot."""
    fields = {
        "body_mass": np.ones(6),
        "body_ipos": np.zeros((6, 3)),
        "body_inertia": np.ones((6, 3)),
        "body_pos": np.array([[0.0, 0.0, 0.0]] * 3 + [[0.0, 0.0, -0.4]]),
        "site_pos": np.array([[0.0, 0.0, -0.4]]),
        "geom_size": np.array([[0.0, 0.0, 1.0], [0.03, 0.0, 0.0]]),
        "dof_armature": np.ones(6),
        "dof_damping": np.ones(6),
        "dof_frictionloss": np.ones(6),
        "actuator_ctrlrange": np.array([[-1.0, 1.0], [-1.0, 1.0]]),
        "tendon_armature": np.ones(3),
        "tendon_stiffness": np.ones(3),
        "tendon_damping": np.ones(3),
        "wrap_prm": np.ones(6),
    }
    start = np.zeros(len(coordinates(calibration)))
    size = f'<size nuserdata="{user_data}"/>'
    return _document(fields, start, calibration, stops, None, "").replace("<worldbody>", f"{size}\n  <worldbody>", 1)


def _document(
    fields: dict[str, Any],
    start: Floats,
    calibration: Calibration,
    stops: EndStops,
    springs: dict[str, Any] | None,
    comment: str,
) -> str:
    """Return the XML text of one robot; reading its numbers gives the same bits."""
    simulation, names = calibration.simulation, coordinates(calibration)
    contact = calibration.contact
    if isinstance(contact, SpringContact):
        foot_solref = springs["geom_solref"] if springs else (-1.0, -1.0)
        solimp = (LEAST_IMPEDANCE, contact.impedance, contact.width_m, *_LINEAR)
        slip_ratio, cone = contact.slip_ratio, "elliptic"
    else:
        foot_solref = (contact.time_constant_s, contact.damping_ratio)
        solimp = (contact.impedance_min, contact.impedance_max, contact.impedance_width_m, *_SIGMOID)
        slip_ratio, cone = 1.0, "pyramidal"

    def losses(name: str) -> str:
        friction = fields["dof_frictionloss"][names.index(name)]
        return f' frictionloss="{_n(friction)}"' if friction else ""

    def hinge(name: str, k: int | None = None) -> str:
        limit, stop = "", None if k is None else stops[k]
        if stop is not None:
            solref = springs["jnt_solref"][k] if springs else (-1.0, -1.0)
            solimp = (LEAST_IMPEDANCE, stop.impedance, stop.width_rad, *_LINEAR)
            limit = (
                f' limited="true" range="{_n(stop.lower_rad, stop.upper_rad)}" solreflimit="{_n(*solref)}"'
                f' solimplimit="{_n(*solimp)}"'
            )
        armature, damping = (fields[field][names.index(name)] for field in ("dof_armature", "dof_damping"))
        return (
            f'<joint name="{name}" type="hinge" axis="0 1 0" armature="{_n(armature)}" damping="{_n(damping)}"'
            f"{losses(name)}{limit}/>"
        )

    def inertial(body: int) -> str:
        return (
            f'<inertial pos="{_n(*fields["body_ipos"][body])}" mass="{_n(fields["body_mass"][body])}"'
            f' diaginertia="{_n(*fields["body_inertia"][body])}"/>'
        )

    def turning(joint: str, body: int, indent: str) -> str:
        """Return what turns with a motor, on the body that carries it; all its motion is in its joint."""
        if not calibration.drive.elastic:
            return ""
        inner = f"\n{indent}  {hinge(f'{joint}_motor')}\n{indent}  {inertial(body)}\n"
        return f'\n{indent}<body name="{joint}_motor">{inner}{indent}</body>'

    slide_x = '\n      <joint name="slide_x" type="slide" axis="1 0 0"/>' if "slide_x" in names else ""
    foot = _n(*fields["site_pos"][0])
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
      <joint name="slide_z" type="slide" axis="0 0 1"{losses("slide_z")}/>
      {inertial(BASE)}
      <body name="thigh">
        {hinge("hip", 0)}
        {inertial(THIGH)}
        <body name="shank" pos="{_n(*fields["body_pos"][SHANK])}">
          {hinge("knee", 1)}
          {inertial(SHANK)}
          <geom name="foot" type="sphere" size="{_n(fields["geom_size"][FOOT_GEOM][0])}" pos="{foot}" priority="1" \
friction="{_n(contact.friction)} 0.005 0.0001" solref="{_n(*foot_solref)}" solimp="{_n(*solimp)}"/>
          <site name="foot" pos="{foot}"/>
        </body>{turning("knee", KNEE_MOTOR, 8 * " ")}
      </body>{turning("hip", HIP_MOTOR, 6 * " ")}
    </body>
  </worldbody>{_tendons(fields, calibration)}
  <actuator>
{_actuators(fields, calibration)}
  </actuator>
  <keyframe>
    <key name="start" qpos="{_n(*start)}"/>
  </keyframe>
</mujoco>
"""


def _tendons(fields: dict[str, Any], calibration: Calibration) -> str:
    """Return what couples two coordinates: the rotor of the knee with the thigh, or the springs of elastic drives."""
    pairs = [(f"{joint}_drive", f"{joint}_motor", joint) for joint in JOINTS] if calibration.drive.elastic else []
    if calibration.joints.rotors == "absolute":
        pairs.append(("knee_rotor", "hip", coordinates(calibration)[motor_places(calibration)[KNEE]]))
    play = 0.5 * calibration.drive.backlash_rad
    lines = []
    for k, (name, *joints) in enumerate(pairs):
        what = f'armature="{_n(fields["tendon_armature"][k])}"'
        if name != "knee_rotor":
            stiffness, damping = fields["tendon_stiffness"][k], fields["tendon_damping"][k]
            what = f'stiffness="{_n(stiffness)}" damping="{_n(damping)}" springlength="{_n(-play, play)}"'
        lines.append(f'    <fixed name="{name}" {what}>')
        factors = fields["wrap_prm"][2 * k : 2 * k + 2]
        lines += [f'      <joint joint="{joint}" coef="{_n(c)}"/>' for joint, c in zip(joints, factors, strict=True)]
        lines.append("    </fixed>")
    return "\n".join(["\n  <tendon>", *lines, "  </tendon>"]) if lines else ""


def _actuators(fields: dict[str, Any], calibration: Calibration) -> str:
    """Return the motors and, under a law of our own, the end stops, whose torque the controller sets."""
    motors = [f"{joint}_motor" if calibration.drive.elastic else joint for joint in JOINTS]
    lines = [
        f'    <motor name="{joint}" joint="{motor}" gear="1" ctrllimited="true" ctrlrange="{_n(*limits)}"/>'
        for joint, motor, limits in zip(JOINTS, motors, fields["actuator_ctrlrange"][:2], strict=True)
    ]
    if calibration.joints.stop_law == "hunt_crossley":
        lines += [f'    <motor name="{joint}_stop" joint="{joint}" gear="1"/>' for joint in JOINTS]
    return "\n".join(lines)


def _n(*values: float) -> str:
    """Return numbers, each as the shortest text that reads back to the same bits."""
    return " ".join(repr(float(value)) for value in values)
