"""The sheet of the cables: base and actuators from the front and from the left, with every corner of every cable."""

from collections.abc import Iterator, Sequence
from string import ascii_uppercase

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.cad.assembly import Pose, body_frames
from pareto_monoped.cad.cables import Cable, cables, rounded
from pareto_monoped.cad.drawing.assembly_views import FROM_FRONT, FROM_LEFT, Seen, captioned, drawn, outline_of, to_view
from pareto_monoped.cad.drawing.bores import number
from pareto_monoped.cad.drawing.paper import Paper
from pareto_monoped.cad.drawing.placing import Tag, place_tags
from pareto_monoped.cad.drawing.sheet import A1, A2, SCALES, Size, compose, table
from pareto_monoped.cad.product import Product
from pareto_monoped.cad.shape.meshes import placed
from pareto_monoped.geometry.roles import Role, Visibility

_WIDE_MM = 0.7
_NAME_MM = 2.5
_LARGEST = 1.0
_NOTES = (
    "Lengths in mm, from the hip's axis in the middle of the leg: x forward, y left, z up. The thigh hangs down.",
    "Path: along the middle line with rounded corners. Cut: with the tails at both ends, rounded up.",
)


def cable_sheet(product: Product) -> tuple[Paper, Size, float]:
    """The sheet.

    Raises:
        ValueError: the robot fits no sheet.
    """
    made = cables(product.robot)
    regions = {name: list(_seen(product, axes)) for name, axes in _VIEWS}
    tables = _tables(made)
    notes = (*_NOTES, *(f"{cable.warning[0].upper()}{cable.warning[1:]}." for cable in made if cable.warning))
    for scale in (scale for scale in SCALES if scale <= _LARGEST):
        views = [_view(name, regions[name], axes, made, scale) for name, axes in _VIEWS]
        for size in (A2, A1):
            paper = compose(size, views, tables, notes)
            if paper is not None:
                return paper, size, scale
    raise ValueError("drawing of the cables: the robot fits no sheet")


_VIEWS = (("From the front", FROM_FRONT), ("From the left", FROM_LEFT))


def _seen(product: Product, axes: NDArray[np.float64]) -> Iterator[Seen]:
    """Outlines of what stands on the base or belongs to an actuator, all of them, with the leg hanging down."""
    frames = body_frames(product.robot, Pose(hip_rad=0.0, knee_rad=0.0))
    units = {unit.name for unit in product.robot.units if unit.body == "base"}
    for (instance, unique), item in zip(product.placed(), product.kinds, strict=True):
        near = instance.unit in units or instance.part.role in (Role.HOUSING, Role.SHAFT, Role.ELECTRONICS)
        if instance.body == "shank" or not near or instance.part.visibility is not Visibility.OUTSIDE:
            continue
        body = placed(unique.mesh.body, to_view(axes) @ frames[instance.body] @ instance.in_body)
        yield Seen(item=item, region=outline_of(body.project()), cut=False)


def _view(name: str, seen: Sequence[Seen], axes: NDArray[np.float64], made: Sequence[Cable], scale: float) -> Paper:
    """The outlines with the cables over them, and a name at every corner."""
    paper = drawn(seen, scale)
    tags = []
    for letter, cable in zip(ascii_uppercase, made, strict=False):
        line = rounded(cable.points_mm, cable.bend_radius_mm) @ axes[:2].T * scale
        paper.line(line, width_mm=_WIDE_MM)
        for k, (x, y) in enumerate((cable.points_mm @ axes[:2].T).tolist(), 1):
            tags.append(Tag(text=f"{letter}{k}", x=x, y=y, radius=0.0, height_mm=_NAME_MM))
    place_tags(paper, tags, scale)
    return captioned(paper, name, scale)


def _tables(made: Sequence[Cable]) -> list[Paper]:
    """What is cut, and the corners."""
    cut = [
        (
            letter,
            f"{cable.start} to {cable.end}",
            f"{cable.wires} x {cable.designation}",
            f"{cable.length_mm:.0f}",
            f"{cable.cut_mm:g}",
            f"{cable.bend_radius_mm:.0f}",
        )
        for letter, cable in zip(ascii_uppercase, made, strict=False)
    ]
    corners = [
        (f"{letter}{k}", *(number(round(value, 1)) for value in point), what)
        for letter, cable in zip(ascii_uppercase, made, strict=False)
        for k, (point, what) in enumerate(zip(cable.points_mm.tolist(), cable.notes, strict=True), 1)
    ]
    return [
        table("Cables", ("Cable", "From, to", "Wires", "Path", "Cut", "Bend radius"), cut),
        table("Corners", ("Corner", "x", "y", "z", "What"), corners),
    ]
