"""The pictures of an export: the robot, sections with numbers and legend, exploded views, and the steps of assembly.

In the steps, what is together is grey; what comes to it is coloured and pulled away.
"""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import manifold3d as m3
import numpy as np
from numpy.typing import NDArray

from pareto_monoped.cad.assembly import ACTUATOR_UNITS, Instance, body_frames, pulled_apart, unit_frame
from pareto_monoped.cad.bodies import Blocking
from pareto_monoped.cad.picture.drawing import Body, Faces, Shown, View, draw, draw_faces, faces_of
from pareto_monoped.cad.picture.labels import Row, colour, labelled, numbered
from pareto_monoped.cad.product import Product
from pareto_monoped.cad.shape.meshes import Mesh, mesh_from, placed, shell_of
from pareto_monoped.cad.steps import Step
from pareto_monoped.geometry.roles import Visibility

Image = NDArray[np.uint8]
Floats = NDArray[np.float64]

_FROM_THE_RIGHT = View(towards=(-0.55, 1.0, -0.32))  # from the side of the knee actuator, from in front and above
_ALONG_X = View(towards=(-0.35, 1.0, -0.22), up=(0.0, 0.0, 1.0))
_KNEE_AROUND_MM = 62.0
"""Half of the box around the knee joint that its section shows: the bearings with a part of either link."""
_TOLERANCE_MM = 0.2
_GREY = (0.80, 0.81, 0.83)
_APART_MM = 12.0
_WIDTH, _HEIGHT = 640, 480
_AXES = "xyz"
_VIEWS = {True: View(towards=(-0.75, -0.55, -0.35)), False: View(towards=(-0.75, 0.55, -0.35))}
"""From the left of the robot, and from its right."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Scene:
    """All that a picture is drawn from; it refers to nothing of the product, so another thread can draw it."""

    bodies: tuple[Body, ...]
    view: View
    width: int  #: in pixels, without the legend
    height: int  #: in pixels, without the strips for numbers
    legend: tuple[Row, ...] = ()  #: one row per part

    def picture(self) -> Image:
        """Draw it."""
        return labelled(draw(self.bodies, self.view, width=self.width, height=self.height), self.legend)


def assembly_scene(product: Product, *, width: int = 900, height: int = 1080) -> Scene:
    """Return the robot in its pose."""
    bodies = tuple(
        _body(unique.mesh, instance.world, unique.part.material.colour)
        for instance, unique in product.placed()
        if instance.part.visibility is not Visibility.INSIDE
    )
    return Scene(bodies=bodies, view=_FROM_THE_RIGHT, width=width, height=height)


def section_scene(product: Product, unit_name: str, *, width: int = 1000, height: int = 820) -> Scene:
    """Return an actuator with a quarter cut away, its output to the left, each part in its own colour."""
    unit = next(unit for unit in product.robot.units if unit.name == unit_name)
    # The axis along -x of the scene, output to the left; the first planet on top.
    turned = np.zeros((4, 4))
    turned[0, 2], turned[1, 1], turned[2, 0], turned[3, 3] = -1.0, 1.0, 1.0, 1.0
    upright = turned @ np.linalg.inv(unit_frame(unit))
    members = [
        (instance, placed(unique.mesh.body, upright @ instance.in_body))
        for instance, unique in product.placed()
        if instance.unit == unit_name
    ]
    return _section(members, width=width, height=height)


def knee_scene(product: Product, *, width: int = 1000, height: int = 820) -> Scene:
    """Return the knee joint with a quarter cut away: thigh, shank and what is between them, around the joint's axis."""
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
        box = near.bounding_box()
        if max(box[:3]) < half and min(box[3:]) > -half:
            members.append((instance, near ^ around))
    return _section([(i, body) for i, body in members if not body.is_empty()], width=width, height=height)


def exploded_scene(product: Product, *, width: int = 1500, height: int = 1080) -> Scene:
    """Return all parts of the robot pulled apart along the joints' axis, the units in their own colours."""
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
    view, rows = View(towards=(-1.0, 0.62, -0.42)), tuple(numbered(names, colours))
    return Scene(bodies=tuple(bodies), view=view, width=width, height=height, legend=rows)


def _section(members: Sequence[tuple[Instance, m3.Manifold]], *, width: int, height: int) -> Scene:
    """Return placed instances with a quarter cut away, one colour and number per kind of part."""
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


def _without_quarter(body: m3.Manifold) -> m3.Manifold:
    """Return the body without the quarter that lies towards the viewer and above the axis."""
    far = body.trim_by_plane((0.0, 1.0, 0.0), 0.0)
    near_low = body.trim_by_plane((0.0, -1.0, 0.0), 0.0).trim_by_plane((0.0, 0.0, -1.0), 0.0)
    return m3.Manifold.compose([far, near_low])


@dataclass(frozen=True, slots=True, kw_only=True)
class Stage:
    """All bodies of an assembly in their places, from which the pictures of its steps are made."""

    blocking: Blocking
    corners_mm: tuple[Floats, ...]  #: per instance the points of its triangles, shape (n, 3)
    triangles: tuple[NDArray[np.int64], ...]  #: per instance the indices of its points, shape (m, 3)
    boxes: tuple[Floats, ...]  #: low and high corner of each body, shape (2, 3)
    _seen: dict[tuple[int, bool], Faces] = field(default_factory=dict)

    def faces(self, instance: int, from_left: bool) -> Faces:
        """Return what one of the two viewers sees of an instance; most steps show it again."""
        if (instance, from_left) not in self._seen:
            seen = faces_of(self.corners_mm[instance], self.triangles[instance], _VIEWS[from_left].axes())
            self._seen[instance, from_left] = seen
        return self._seen[instance, from_left]


def stage_of(blocking: Blocking, placed: Sequence[Instance]) -> Stage:
    """Return the stage of an assembly from its instances in their places."""
    parts = {id(instance.part): instance.part for instance in placed}
    shells = {key: shell_of(part, _TOLERANCE_MM) for key, part in parts.items()}
    corners, triangles = [], []
    for instance in placed:
        points, faces = shells[id(instance.part)]
        corners.append(points @ instance.world[:3, :3].T + instance.world[:3, 3])
        triangles.append(faces)
    boxes = []
    for body in blocking.bodies:
        everything = np.concatenate([corners[index] for index in body.instances])
        boxes.append(np.stack([everything.min(axis=0), everything.max(axis=0)]))
    return Stage(blocking=blocking, corners_mm=tuple(corners), triangles=tuple(triangles), boxes=tuple(boxes))


def step_picture(step: Step, stage: Stage) -> Image:
    """Return the picture of a step, seen from the side from which most comes."""
    blocking, boxes = stage.blocking, stage.boxes
    moves: dict[int, Floats] = {}
    groups = [(addition.members, addition.out) for addition in step.additions]
    groups += [(frozenset({k}), blocking.driven_from(k)) for k in step.fasteners]
    there = set(step.base)
    for members, out in groups:
        way = _way(members, there, out, boxes, moves)
        moves |= dict.fromkeys(members, way)
        there |= members
    fresh = [k for members, _ in groups for k in sorted(members)]
    if step.base_number is None:
        fresh = [*sorted(step.base), *fresh]
    number, rows = _legend(fresh, blocking)
    from_left = sum(1.0 if out == "+y" else -1.0 for _, out in groups if out[1] == "y") > 0.0
    axes = _VIEWS[from_left].axes()
    shown = []
    for k in sorted(there):
        if k not in number and blocking.bodies[k].instance.part.visibility is Visibility.INSIDE:
            continue  # covered by others
        hue = colour(number[k] - 1) if k in number else _GREY
        move = axes @ moves.get(k, np.zeros(3))
        for index in blocking.bodies[k].instances:
            faces = stage.faces(index, from_left)
            shown.append(Shown(faces=faces, colour=hue, number=number.get(k, 0), move_mm=move))
    return labelled(draw_faces(shown, width=_WIDTH, height=_HEIGHT), rows)


def _legend(fresh: Sequence[int], blocking: Blocking) -> tuple[dict[int, int], tuple[Row, ...]]:
    """Return the number of each new body, and a row per kind of part of a unit."""
    numbers: dict[tuple[str, str], int] = {}
    counts: list[int] = []
    number = {}
    for k in fresh:
        body = blocking.bodies[k]
        row = numbers.setdefault((body.unit, body.instance.part.name), len(numbers) + 1)
        counts += [0] * (row - len(counts))
        number[k] = row
        counts[row - 1] += len(body.instances)
    rows = []
    for (_, name), row in numbers.items():
        count = f" ({counts[row - 1]})" if counts[row - 1] > 1 else ""
        rows.append(Row(number=row, text=name.replace("_", " ") + count, colour=colour(row - 1)))
    return number, tuple(rows)


def _way(
    members: frozenset[int], there: set[int], out: str, boxes: Sequence[Floats], moves: Mapping[int, Floats]
) -> Floats:
    """Return how far a set moves out until it has passed all that lies before it, shape (3,)."""
    axis, sign = _AXES.index(out[1]), 1.0 if out[0] == "+" else -1.0
    others = [k for k in range(3) if k != axis]
    distance = 0.0
    for k in members:
        low, high = boxes[k]
        for other in there:
            box = boxes[other] + moves.get(other, np.zeros(3))
            if np.all(low[others] < box[1][others]) and np.all(high[others] > box[0][others]):
                gap = box[1][axis] - low[axis] if sign > 0.0 else high[axis] - box[0][axis]
                distance = max(distance, float(gap) + _APART_MM)
    way = np.zeros(3)
    way[axis] = sign * max(distance, _APART_MM)
    return way
