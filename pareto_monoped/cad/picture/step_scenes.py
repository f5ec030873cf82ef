"""Exploded views of the steps of assembly: what is together is grey, what comes to it is coloured and pulled away."""

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.cad.assembling.bodies import Blocking
from pareto_monoped.cad.assembling.steps import Step
from pareto_monoped.cad.assembly import Instance
from pareto_monoped.cad.picture.colours import colour
from pareto_monoped.cad.picture.drawing import Body, View
from pareto_monoped.cad.picture.labels import Row
from pareto_monoped.cad.picture.scenes import Scene
from pareto_monoped.cad.shape.meshes import mesh_of
from pareto_monoped.geometry.roles import Visibility

Floats = NDArray[np.float64]

_TOLERANCE_MM = 0.2
_GREY = (0.80, 0.81, 0.83)
_APART_MM = 12.0
_WIDTH, _HEIGHT = 640, 480
_AXES = "xyz"


def step_scene(step: Step, blocking: Blocking, placed: Sequence[Instance]) -> Scene:
    """The picture of a step, seen from the side from which most comes.

    Args:
        step: the step.
        blocking: its bodies, and the sides from which fasteners are driven.
        placed: the instances of the bodies.
    """
    boxes = _boxes(blocking, placed)
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
    bodies = []
    for k in sorted(there):
        if k not in number and blocking.bodies[k].instance.part.visibility is Visibility.INSIDE:
            continue  # covered by others
        for index in blocking.bodies[k].instances:
            mesh = mesh_of(placed[index].part, _TOLERANCE_MM)
            world = placed[index].world
            points = mesh.points_mm @ world[:3, :3].T + world[:3, 3] + moves.get(k, np.zeros(3))
            hue = colour(number[k] - 1) if k in number else _GREY
            bodies.append(Body(points_mm=points, triangles=mesh.triangles, colour=hue, number=number.get(k, 0)))
    side = sum(1.0 if out == "+y" else -1.0 for _, out in groups if out[1] == "y")
    view = View(towards=(-0.75, -0.55 if side > 0.0 else 0.55, -0.35))
    return Scene(bodies=tuple(bodies), view=view, width=_WIDTH, height=_HEIGHT, legend=rows)


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


def _boxes(blocking: Blocking, placed: Sequence[Instance]) -> list[Floats]:
    """Low and high corner of each body, shape (2, 3)."""
    found = []
    for body in blocking.bodies:
        points = []
        for index in body.instances:
            mesh, world = mesh_of(placed[index].part, _TOLERANCE_MM), placed[index].world
            points.append(mesh.points_mm @ world[:3, :3].T + world[:3, 3])
        everything = np.concatenate(points)
        found.append(np.stack([everything.min(axis=0), everything.max(axis=0)]))
    return found


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
