"""What MJCF and URDF show of a robot, and what collides: meshes per body and material, and primitives."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.actuator.actuator import Actuator
from pareto_monoped.cad.assembly import unit_frame
from pareto_monoped.cad.product import Product
from pareto_monoped.cad.shape.meshes import Mesh, joined, mesh_of, placed
from pareto_monoped.geometry.roles import Role, Visibility

Floats = NDArray[np.float64]

VISUAL_TOLERANCE_MM = 0.1
METRES = 1e-3
"""From the meshes' millimetres to the models' unit."""
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
    """A primitive in a body frame, in metres.

    Attributes:
        name: unique in the robot.
        body: the body that it moves with.
        shape: a box, or a cylinder along y.
        size: half sizes of the box along x, y and z; radius and half length of the cylinder.
        position: of its centre.
    """

    name: str
    body: str
    shape: Literal["box", "cylinder"]
    size: tuple[float, ...]
    position: tuple[float, float, float]


def visuals(product: Product) -> tuple[Visual, ...]:
    """Coarse meshes of what can be seen, one for each body and material, at zero joint angles."""
    shown: dict[tuple[str, str], list[tuple[Mesh, Floats]]] = {}
    colours: dict[tuple[str, str], tuple[float, float, float]] = {}
    for instance, unique in product.placed():
        if instance.part.visibility is not Visibility.OUTSIDE:
            continue
        key = (instance.body, unique.part.material.name.replace(" ", "_"))
        shown.setdefault(key, []).append((mesh_of(unique.part, VISUAL_TOLERANCE_MM), instance.in_body))
        colours.setdefault(key, unique.part.material.colour)
    return tuple(
        Visual(
            name=f"{body}_{material}",
            body=body,
            mesh=joined(members, METRES),
            colour=colours[body, material],
        )
        for (body, material), members in shown.items()
    )


def colliders(product: Product) -> tuple[Collider, ...]:
    """Boxes and cylinders around frame, actuators and links; the foot's sphere is the simulation's own."""
    robot = product.robot
    # Rods, with the screws that stand out of the cheeks, bound the frame; cores bound the links.
    return (
        _around_actuator(product, "hip_actuator", robot.hip),
        _around_actuator(product, "knee_actuator", robot.knee),
        _around_parts(product, "frame", unit="base_frame", roles=(Role.ROD, Role.SCREW)),
        _around_parts(product, "thigh", unit="thigh", roles=(Role.CORE,)),
        _around_parts(product, "shank", unit="shank", roles=(Role.CORE,)),
    )


def _around_actuator(product: Product, name: str, actuator: Actuator) -> Collider:
    """A cylinder as long and wide as an actuator's housing."""
    unit = next(unit for unit in product.robot.units if unit.name == name)
    middle = unit_frame(unit) @ np.array([0.0, 0.0, -0.5 * actuator.length_mm, 1.0])
    return Collider(
        name=name,
        body=unit.body,
        shape="cylinder",
        size=(1e-3 * actuator.mount.housing_radius_mm, 0.5e-3 * actuator.length_mm),
        position=(0.0, float(1e-3 * middle[1]), 0.0),
    )


def _around_parts(product: Product, name: str, *, unit: str, roles: tuple[Role, ...]) -> Collider:
    """A box with a margin around those parts of a unit that can be seen and have one of the roles."""
    bodies = set()
    low, high = np.full(3, np.inf), np.full(3, -np.inf)
    for instance, unique in product.placed():
        part = instance.part
        if instance.unit == unit and part.role in roles and part.visibility is Visibility.OUTSIDE:
            bodies.add(instance.body)
            box = np.asarray(placed(unique.mesh.body, instance.in_body).bounding_box())
            low, high = np.minimum(low, box[:3]), np.maximum(high, box[3:])
    (body,) = bodies
    half, centre = 0.5e-3 * (high - low) + _MARGIN_M, 0.5e-3 * (high + low)
    return Collider(
        name=name,
        body=body,
        shape="box",
        size=tuple(float(v) for v in half),
        position=(float(centre[0]), float(centre[1]), float(centre[2])),
    )


def numbers(*values: float) -> str:
    """Values as an XML attribute, each with all its digits."""
    return " ".join(repr(float(value)) for value in values)
