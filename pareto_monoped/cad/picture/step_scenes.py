"""Exploded views of the steps of assembly: what is together is grey, what comes to it is coloured and pulled away."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.cad.assembling.bodies import Blocking
from pareto_monoped.cad.assembling.steps import Step
from pareto_monoped.cad.assembly import Instance
from pareto_monoped.cad.picture.colours import colour
from pareto_monoped.cad.picture.drawing import Faces, Shown, View, draw_faces, faces_of
from pareto_monoped.cad.picture.labels import Row, labelled
from pareto_monoped.cad.shape.meshes import shell_of
from pareto_monoped.geometry.roles import Visibility

Floats = NDArray[np.float64]

_TOLERANCE_MM = 0.2
_GREY = (0.80, 0.81, 0.83)
_APART_MM = 12.0
_WIDTH, _HEIGHT = 640, 480
_AXES = "xyz"
_VIEWS = {True: View(towards=(-0.75, -0.55, -0.35)), False: View(towards=(-0.75, 0.55, -0.35))}
"""From the left of the robot, and from its right."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Stage:
    """All bodies of an assembly in their places, from which the pictures of its steps are made.

    Attributes:
        blocking: the bodies, and the sides from which fasteners are driven.
        corners_mm: per instance the points of its triangles, shape (n, 3).
        triangles: per instance the indices of its points, shape (m, 3).
        boxes: low and high corner of each body, shape (2, 3).
    """

    blocking: Blocking
    corners_mm: tuple[Floats, ...]
    triangles: tuple[NDArray[np.int64], ...]
    boxes: tuple[Floats, ...]
    _seen: dict[tuple[int, bool], Faces] = field(default_factory=dict)

    def faces(self, instance: int, from_left: bool) -> Faces:
        """What one of the two viewers sees of an instance; most steps show it again."""
        if (instance, from_left) not in self._seen:
            seen = faces_of(self.corners_mm[instance], self.triangles[instance], _VIEWS[from_left].axes())
            self._seen[instance, from_left] = seen
        return self._seen[instance, from_left]


def stage_of(blocking: Blocking, placed: Sequence[Instance]) -> Stage:
    """The stage of an assembly from its instances in their places."""
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


def step_picture(step: Step, stage: Stage) -> NDArray[np.uint8]:
    """The picture of a step, seen from the side from which most comes."""
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
    """The number of each new body, and a row per kind of part."""
    names: dict[tuple[str, str], int] = {}
    counts: list[int] = []
    number = {}
    for k in fresh:
        body = blocking.bodies[k]
        key = (body.unit, body.instance.part.name)
        if key not in names:
            names[key] = len(names) + 1
            counts.append(0)
        number[k] = names[key]
        counts[names[key] - 1] += len(body.instances)
    rows = []
    for (_, name), row in names.items():
        count = f" ({counts[row - 1]})" if counts[row - 1] > 1 else ""
        rows.append(Row(number=row, text=name.replace("_", " ") + count, colour=colour(row - 1)))
    return number, tuple(rows)


def _way(
    members: frozenset[int], there: set[int], out: str, boxes: Sequence[Floats], moves: Mapping[int, Floats]
) -> Floats:
    """How far a set moves out until it has passed all that lies before it, shape (3,)."""
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
