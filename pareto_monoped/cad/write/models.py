"""MJCF and URDF of the robot: SI units, the simulation's inertials, visual meshes and primitive colliders."""

import xml.etree.ElementTree as ET
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.cad.assembly import unit_frame
from pareto_monoped.cad.product import Product
from pareto_monoped.cad.shape.meshes import Mesh, joined, mesh_of, placed
from pareto_monoped.geometry.roles import Role, Visibility
from pareto_monoped.leg.joint_ranges import HIP_RANGE_RAD, KNEE_RANGE_RAD
from pareto_monoped.robot.frames import BODIES
from pareto_monoped.robot.population import RobotArrays

Floats = NDArray[np.float64]

VISUAL_TOLERANCE_MM = 0.1
_MARGIN_M = 1e-3


@dataclass(frozen=True, slots=True, kw_only=True)
class Visual:
    """What a body shows of one material: a mesh in the body frame, in millimetres."""

    name: str
    body: str
    mesh: Mesh
    colour: tuple[float, float, float]


@dataclass(frozen=True, slots=True, kw_only=True)
class Collider:
    """A primitive in a body frame, in metres: a ``box`` (half sizes), a ``cylinder`` about y (radius, half length)."""

    name: str
    body: str
    kind: str
    size: tuple[float, ...]
    position: tuple[float, float, float]


def visuals(product: Product) -> tuple[Visual, ...]:
    """Coarse meshes of what can be seen, one for each body and material, at zero joint angles."""
    shown: dict[tuple[str, str], list[tuple[Mesh, Floats]]] = {}
    colours: dict[tuple[str, str], tuple[float, float, float]] = {}
    for instance, kind in product.placed():
        if instance.part.visibility is not Visibility.OUTSIDE:
            continue
        key = (instance.body, kind.part.material.name.replace(" ", "_"))
        shown.setdefault(key, []).append((mesh_of(kind.part, VISUAL_TOLERANCE_MM), instance.in_body))
        colours.setdefault(key, kind.part.material.colour)
    return tuple(
        Visual(
            name=f"{body}_{material}",
            body=body,
            mesh=joined(members),
            colour=colours[body, material],
        )
        for (body, material), members in shown.items()
    )


def colliders(product: Product) -> tuple[Collider, ...]:
    """Boxes and cylinders around frame, actuators and links; the foot's sphere is the simulation's own."""
    robot, found = product.robot, []
    for name, body, actuator in (("hip_actuator", "base", robot.hip), ("knee_actuator", "thigh", robot.knee)):
        unit = next(unit for unit in robot.units if unit.name == name)
        middle = unit_frame(unit) @ np.array([0.0, 0.0, -0.5 * actuator.length_mm, 1.0])
        found.append(
            Collider(
                name=name,
                body=body,
                kind="cylinder",
                size=(1e-3 * actuator.mount.housing_radius_mm, 0.5e-3 * actuator.length_mm),
                position=(0.0, float(1e-3 * middle[1]), 0.0),
            )
        )
    # Rods, with the screws that stand out of the cheeks, for the frame; cores for the links.
    for name, body, unit_name, roles in (
        ("frame", "base", "base_frame", (Role.ROD, Role.SCREW)),
        ("thigh", "thigh", "thigh", (Role.CORE,)),
        ("shank", "shank", "shank", (Role.CORE,)),
    ):
        low, high = np.full(3, np.inf), np.full(3, -np.inf)
        for instance, kind in product.placed():
            part = instance.part
            if instance.unit == unit_name and part.role in roles and part.visibility is Visibility.OUTSIDE:
                box = np.asarray(placed(kind.mesh.body, instance.in_body).bounding_box())
                low, high = np.minimum(low, box[:3]), np.maximum(high, box[3:])
        half, centre = 0.5e-3 * (high - low) + _MARGIN_M, 0.5e-3 * (high + low)
        found.append(
            Collider(
                name=name,
                body=body,
                kind="box",
                size=tuple(float(v) for v in half),
                position=(float(centre[0]), float(centre[1]), float(centre[2])),
            )
        )
    return tuple(found)


def mjcf_with_meshes(document: str, shown: Sequence[Visual], solid: Sequence[Collider]) -> str:
    """The simulation's MJCF with visual meshes (group 2) and colliders (group 3) added.

    The colliders meet each other but not the floor (contype and conaffinity 2), so that the document still makes the
    very jump that was simulated, in which only the foot touches the ground.
    """
    root = ET.fromstring(document, parser=ET.XMLParser(target=ET.TreeBuilder(insert_comments=True)))
    compiler = root.find("compiler")
    assert compiler is not None
    compiler.set("meshdir", "meshes")
    asset = ET.Element("asset")
    for visual in shown:
        ET.SubElement(asset, "mesh", name=visual.name, file=f"{visual.name}.stl")
    root.insert(list(root).index(compiler) + 1, asset)
    for body in root.iter("body"):
        for visual in shown:
            if visual.body == body.get("name"):
                ET.SubElement(
                    body,
                    "geom",
                    name=f"{visual.name}_visual",
                    type="mesh",
                    mesh=visual.name,
                    contype="0",
                    conaffinity="0",
                    group="2",
                    rgba=_numbers(*visual.colour, 1.0),
                )
        for item in solid:
            if item.body == body.get("name"):
                geom = ET.SubElement(
                    body,
                    "geom",
                    name=f"{item.name}_collider",
                    type=item.kind,
                    size=_numbers(*item.size),
                    pos=_numbers(*item.position),
                    contype="2",
                    conaffinity="2",
                    group="3",
                    rgba="0.2 0.5 0.9 0.2",
                )
                if item.kind == "cylinder":
                    geom.set("zaxis", "0 1 0")
    ET.indent(root)
    return ET.tostring(root, encoding="unicode") + "\n"


def urdf(arrays: RobotArrays, shown: Sequence[Visual], solid: Sequence[Collider]) -> str:
    """The URDF of the first robot: links ``base``, ``thigh``, ``shank``, joints ``hip`` and ``knee``.

    URDF has no word for the rotors' reflected inertia; it is written as a comment beside each joint.
    """
    root = ET.Element("robot", name="monoped")
    # Only MuJoCo reads this: keep the visual meshes and their folder.
    extension = ET.SubElement(root, "mujoco")
    ET.SubElement(extension, "compiler", strippath="false", discardvisual="false")
    for k, name in enumerate(BODIES):
        link = ET.SubElement(root, "link", name=name)
        inertial = ET.SubElement(link, "inertial")
        ET.SubElement(inertial, "origin", xyz=_numbers(*arrays.body_com_m[0, k]), rpy="0 0 0")
        ET.SubElement(inertial, "mass", value=_numbers(arrays.body_mass_kg[0, k]))
        tensor = arrays.body_inertia_kg_m2[0, k]
        entries = {f"i{'xyz'[a]}{'xyz'[b]}": _numbers(tensor[a, b]) for a in range(3) for b in range(a, 3)}
        ET.SubElement(inertial, "inertia", attrib=entries)
        for visual in shown:
            if visual.body == name:
                element = ET.SubElement(link, "visual", name=visual.name)
                geometry = ET.SubElement(element, "geometry")
                ET.SubElement(geometry, "mesh", filename=f"meshes/{visual.name}.stl")
                material = ET.SubElement(element, "material", name=visual.name)
                ET.SubElement(material, "color", rgba=_numbers(*visual.colour, 1.0))
        for item in solid:
            if item.body == name:
                _urdf_collision(link, item)
        if name == "shank":
            element = ET.SubElement(link, "collision", name="foot")
            ET.SubElement(element, "origin", xyz=_numbers(0.0, 0.0, -arrays.shank_length_m[0]), rpy="0 0 0")
            ET.SubElement(ET.SubElement(element, "geometry"), "sphere", radius=_numbers(arrays.foot_radius_m[0]))
    places = {"hip": 0.0, "knee": -float(arrays.thigh_length_m[0])}
    limits = {"hip": HIP_RANGE_RAD, "knee": KNEE_RANGE_RAD}
    for k, (name, parent, child) in enumerate((("hip", "base", "thigh"), ("knee", "thigh", "shank"))):
        inertia = arrays.armature_kg_m2[0, k]
        root.append(ET.Comment(f" {name}: reflected rotor inertia {float(inertia)!r} kg m2 "))
        joint = ET.SubElement(root, "joint", name=name, type="revolute")
        ET.SubElement(joint, "origin", xyz=_numbers(0.0, 0.0, places[name]), rpy="0 0 0")
        ET.SubElement(joint, "parent", link=parent)
        ET.SubElement(joint, "child", link=child)
        ET.SubElement(joint, "axis", xyz="0 1 0")
        ET.SubElement(
            joint,
            "limit",
            lower=_numbers(limits[name][0]),
            upper=_numbers(limits[name][1]),
            effort=_numbers(arrays.peak_torque_n_m[0, k]),
            velocity=_numbers(arrays.no_load_speed_rad_per_s[0, k]),
        )
    ET.indent(root)
    return '<?xml version="1.0"?>\n' + ET.tostring(root, encoding="unicode") + "\n"


def _urdf_collision(link: ET.Element, item: Collider) -> None:
    element = ET.SubElement(link, "collision", name=item.name)
    cylinder = item.kind == "cylinder"
    ET.SubElement(
        element, "origin", xyz=_numbers(*item.position), rpy=_numbers(np.pi / 2, 0.0, 0.0) if cylinder else "0 0 0"
    )
    geometry = ET.SubElement(element, "geometry")
    if cylinder:
        ET.SubElement(geometry, "cylinder", radius=_numbers(item.size[0]), length=_numbers(2.0 * item.size[1]))
    else:
        ET.SubElement(geometry, "box", size=_numbers(*(2.0 * v for v in item.size)))


def _numbers(*values: float) -> str:
    return " ".join(repr(float(value)) for value in values)
