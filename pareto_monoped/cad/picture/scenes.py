"""The pictures of an export: the robot, sections of actuators and knee with numbers and legend, an exploded view."""

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import manifold3d as m3
import numpy as np
from numpy.typing import NDArray

from pareto_monoped.cad.assembly import ACTUATOR_UNITS, Instance, body_frames, unit_frame
from pareto_monoped.cad.picture.colours import colour
from pareto_monoped.cad.picture.drawing import Body, View, draw
from pareto_monoped.cad.picture.labels import Row, labelled, numbered
from pareto_monoped.cad.product import Product
from pareto_monoped.cad.shape.meshes import Mesh, mesh_from, placed
from pareto_monoped.cad.shape.pulled_apart import pulled_apart
from pareto_monoped.geometry.roles import Visibility

Image = NDArray[np.uint8]
Floats = NDArray[np.float64]

_FROM_THE_RIGHT = View(towards=(-0.55, 1.0, -0.32))
"""From the side of the knee actuator, from in front and above."""
_ALONG_X = View(towards=(-0.35, 1.0, -0.22), up=(0.0, 0.0, 1.0))
_KNEE_AROUND_MM = 62.0
"""Half of the box around the knee joint that its section shows: the bearings with a part of either link."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Scene:
    """All that a picture is drawn from; it refers to nothing of the product, so another thread can draw it.

    Attributes:
        bodies: what to draw.
        view: the direction of view.
        width, height: of the picture, in pixels, without the legend and the strips for its numbers.
        legend: one row per part.
    """

    bodies: tuple[Body, ...]
    view: View
    width: int
    height: int
    legend: tuple[Row, ...] = ()

    def picture(self) -> Image:
        """Draw it."""
        drawn = draw(self.bodies, self.view, width=self.width, height=self.height)
        return labelled(drawn, self.legend)


def assembly_scene(product: Product, *, width: int = 900, height: int = 1080) -> Scene:
    """The robot in its pose."""
    bodies = []
    for instance, unique in product.placed():
        if instance.part.visibility is Visibility.INSIDE:
            continue
        bodies.append(_body(unique.mesh, instance.world, unique.part.material.colour))
    return Scene(bodies=tuple(bodies), view=_FROM_THE_RIGHT, width=width, height=height)


def section_scene(product: Product, unit_name: str, *, width: int = 1000, height: int = 820) -> Scene:
    """An actuator with a quarter cut away, its output to the left, each part in its own colour."""
    unit = next(unit for unit in product.robot.units if unit.name == unit_name)
    upright = _axis_to_the_left() @ np.linalg.inv(unit_frame(unit))
    members = [
        (instance, placed(unique.mesh.body, upright @ instance.in_body))
        for instance, unique in product.placed()
        if instance.unit == unit_name
    ]
    return _section(members, width=width, height=height)


def knee_scene(product: Product, *, width: int = 1000, height: int = 820) -> Scene:
    """The knee joint with a quarter cut away: thigh, shank and what is between them, around the joint's axis."""
    in_joint = np.linalg.inv(body_frames(product.robot, product.pose)["shank"])
    # Joint axis, which is y, to the left; what points up stays up.
    turned = np.zeros((4, 4))
    turned[0, 1], turned[1, 0], turned[2, 2], turned[3, 3] = -1.0, 1.0, 1.0, 1.0
    half = _KNEE_AROUND_MM
    around = m3.Manifold.cube((2.0 * half, 2.0 * half, 2.0 * half), center=True)
    members = []
    for instance, unique in product.placed():
        if instance.unit in ACTUATOR_UNITS:
            continue
        near = placed(unique.mesh.body, turned @ in_joint @ instance.world)
        if _boxes_meet(near.bounding_box(), half):
            members.append((instance, near ^ around))
    return _section([(i, body) for i, body in members if not body.is_empty()], width=width, height=height)


def exploded_scene(product: Product, *, width: int = 1500, height: int = 1080) -> Scene:
    """All parts of the robot pulled apart along the joints' axis, the units in their own colours."""
    order = [unit.name for unit in product.robot.units]
    names = {name: sum(instance.unit == name for instance in product.instances) for name in order}
    colours = {name: colour(k) for k, name in enumerate(order)}
    number = {name: k for k, name in enumerate(order, 1)}
    boxes = np.array([placed(u.mesh.body, i.world).bounding_box() for i, u in product.placed()])
    moves = pulled_apart(boxes, axis=1)
    bodies = []
    for (instance, unique), move in zip(product.placed(), moves, strict=True):
        at = instance.world.copy()
        at[1, 3] += move
        bodies.append(_body(unique.mesh, at, colours[instance.unit], number[instance.unit]))
    view = View(towards=(-1.0, 0.62, -0.42))
    rows = tuple(numbered(names, colours))
    return Scene(bodies=tuple(bodies), view=view, width=width, height=height, legend=rows)


def _section(members: Sequence[tuple[Instance, m3.Manifold]], *, width: int, height: int) -> Scene:
    """Placed instances with a quarter cut away, one colour and number per kind of part."""
    names = Counter(instance.part.name for instance, _ in members)
    colours = {name: colour(k) for k, name in enumerate(names)}
    number = {name: k for k, name in enumerate(names, 1)}
    bodies = []
    for instance, body in members:
        kept = _without_quarter(body)
        if not kept.is_empty():
            bodies.append(_body(mesh_from(kept), np.eye(4), colours[instance.part.name], number[instance.part.name]))
    rows = tuple(numbered(names, colours))
    return Scene(bodies=tuple(bodies), view=_ALONG_X, width=width, height=height, legend=rows)


def _body(mesh: Mesh, at: Floats, hue: tuple[float, float, float], number: int = 0) -> Body:
    points = mesh.points_mm @ at[:3, :3].T + at[:3, 3]
    return Body(points_mm=points, triangles=mesh.triangles, colour=hue, number=number)


def _axis_to_the_left() -> Floats:
    """The actuator's axis along -x of the picture's scene, output to the left; the first planet on top."""
    matrix = np.zeros((4, 4))
    matrix[0, 2], matrix[1, 1], matrix[2, 0], matrix[3, 3] = -1.0, 1.0, 1.0, 1.0
    return matrix


def _boxes_meet(box: Iterable[float], half: float) -> bool:
    x0, y0, z0, x1, y1, z1 = box
    return max(x0, y0, z0) < half and min(x1, y1, z1) > -half


def _without_quarter(body: m3.Manifold) -> m3.Manifold:
    """The body without the quarter that lies towards the viewer and above the axis."""
    far = body.trim_by_plane((0.0, 1.0, 0.0), 0.0)
    near_low = body.trim_by_plane((0.0, -1.0, 0.0), 0.0).trim_by_plane((0.0, 0.0, -1.0), 0.0)
    return m3.Manifold.compose([far, near_low])
