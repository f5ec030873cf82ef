"""URDF: the simulated robot for other simulators, in SI units."""

import xml.etree.ElementTree as ET
from collections.abc import Sequence

import numpy as np

from pareto_monoped.cad.write.meshes import Collider, Visual, numbers
from pareto_monoped.jump.calibration import Joints
from pareto_monoped.jump.model import joint_damping, joint_friction_n_m
from pareto_monoped.robot.population import RobotArrays
from pareto_monoped.robot.units import BODIES, JOINTS

_NO_TURN = "0 0 0"


def urdf(arrays: RobotArrays, joints: Joints, shown: Sequence[Visual], solid: Sequence[Collider]) -> str:
    """Return the URDF of the first robot: links base, thigh and shank, joints hip and knee, frame foot.

    URDF has no element for the inertia of rotors, nor for its coupling with the thigh's rotation, so each joint has a
    comment with them. Each mesh of ``shown`` is in a file ``meshes/NAME.stl`` beside the document, in metres; the
    foot's sphere joins ``solid``.
    """
    root = ET.Element("robot", name="monoped")
    # Only MuJoCo reads this: keep the visual meshes and their folder.
    extension = ET.SubElement(root, "mujoco")
    ET.SubElement(extension, "compiler", strippath="false", discardvisual="false")
    for body, name in enumerate(BODIES):
        link = ET.SubElement(root, "link", name=name)
        _add_inertial(link, arrays, body)
        for visual in shown:
            if visual.body == name:
                _add_visual(link, visual)
        for collider in solid:
            if collider.body == name:
                _add_collision(link, collider)
        if name == "shank":
            foot = ET.SubElement(link, "collision", name="foot")  # the sphere that touches the ground
            ET.SubElement(foot, "origin", xyz=numbers(0.0, 0.0, -arrays.shank_length_m[0]), rpy=_NO_TURN)
            ET.SubElement(ET.SubElement(foot, "geometry"), "sphere", radius=numbers(arrays.foot_radius_m[0]))
    places_m = {"hip": 0.0, "knee": -float(arrays.thigh_length_m[0])}
    for joint, name in enumerate(JOINTS):
        _add_joint(root, arrays, joints, joint, z_m=places_m[name])
    _add_foot_frame(root, arrays)
    ET.indent(root)
    return '<?xml version="1.0"?>\n' + ET.tostring(root, encoding="unicode") + "\n"


def _add_inertial(link: ET.Element, arrays: RobotArrays, body: int) -> None:
    """Add mass and inertia about the centre of mass, along the axes of the body frame."""
    inertial = ET.SubElement(link, "inertial")
    ET.SubElement(inertial, "origin", xyz=numbers(*arrays.body_com_m[0, body]), rpy=_NO_TURN)
    ET.SubElement(inertial, "mass", value=numbers(arrays.body_mass_kg[0, body]))
    tensor = arrays.body_inertia_kg_m2[0, body]
    entries = {f"i{'xyz'[a]}{'xyz'[b]}": numbers(tensor[a, b]) for a in range(3) for b in range(a, 3)}
    ET.SubElement(inertial, "inertia", attrib=entries)


def _add_visual(link: ET.Element, visual: Visual) -> None:
    element = ET.SubElement(link, "visual", name=visual.name)
    geometry = ET.SubElement(element, "geometry")
    ET.SubElement(geometry, "mesh", filename=f"meshes/{visual.name}.stl")
    material = ET.SubElement(element, "material", name=visual.name)
    ET.SubElement(material, "color", rgba=numbers(*visual.colour, 1.0))


def _add_collision(link: ET.Element, collider: Collider) -> None:
    """Add a primitive; URDF's cylinders stand along z and have full lengths, boxes have full sizes."""
    element = ET.SubElement(link, "collision", name=collider.name)
    cylinder = collider.shape == "cylinder"
    turn = numbers(np.pi / 2, 0.0, 0.0) if cylinder else _NO_TURN
    ET.SubElement(element, "origin", xyz=numbers(*collider.position), rpy=turn)
    geometry = ET.SubElement(element, "geometry")
    if cylinder:
        radius, half_length = collider.size
        ET.SubElement(geometry, "cylinder", radius=numbers(radius), length=numbers(2.0 * half_length))
    else:
        ET.SubElement(geometry, "box", size=numbers(*(2.0 * half for half in collider.size)))


def _add_foot_frame(root: ET.Element, arrays: RobotArrays) -> None:
    """Add a frame without mass at the centre of the foot's sphere, for planners and controllers."""
    ET.SubElement(root, "link", name="foot")
    element = ET.SubElement(root, "joint", name="foot", type="fixed")
    ET.SubElement(element, "origin", xyz=numbers(0.0, 0.0, -arrays.shank_length_m[0]), rpy=_NO_TURN)
    ET.SubElement(element, "parent", link="shank")
    ET.SubElement(element, "child", link="foot")


def _rotor_comment(arrays: RobotArrays, joints: Joints, joint: int) -> str:
    """Return what a simulator must add for the parts that turn with the joint's motor."""
    name, inertia_kg_m2 = JOINTS[joint], float(arrays.armature_kg_m2[0, joint])
    if name == "hip" or joints.rotors == "armature":
        return f" {name}: reflected rotor inertia {inertia_kg_m2!r} kg m2 "
    reflected, coupling = float(arrays.knee_reflected_kg_m2[0]), float(arrays.knee_coupling_kg_m2[0])
    return (
        f" {name}: reflected rotor inertia {reflected!r} kg m2, coupled with the thigh's rotation by {coupling!r} kg "
        "m2; URDF can hold neither, the MJCF has both "
    )


def _add_joint(root: ET.Element, arrays: RobotArrays, joints: Joints, joint: int, *, z_m: float) -> None:
    """Add the joint between a body and the next one, with its axis along +y of the body frame."""
    name = JOINTS[joint]
    stop = (arrays.stops.hip, arrays.stops.knee)[joint]
    root.append(ET.Comment(_rotor_comment(arrays, joints, joint)))
    element = ET.SubElement(root, "joint", name=name, type="revolute")
    ET.SubElement(element, "origin", xyz=numbers(0.0, 0.0, z_m), rpy=_NO_TURN)
    ET.SubElement(element, "parent", link=BODIES[joint])
    ET.SubElement(element, "child", link=BODIES[joint + 1])
    ET.SubElement(element, "axis", xyz="0 1 0")
    effort, speed = arrays.peak_torque_n_m[0, joint], arrays.no_load_speed_rad_per_s[0, joint]
    reach = {"lower": numbers(stop.lower_rad), "upper": numbers(stop.upper_rad)}
    ET.SubElement(element, "limit", reach, effort=numbers(effort), velocity=numbers(speed))
    losses = {"damping": joint_damping(arrays, joints), "friction": joint_friction_n_m(arrays, joints)}
    ET.SubElement(element, "dynamics", {name: numbers(values[0, joint]) for name, values in losses.items()})
