"""Flat shapes as closed curves: what solids, meshes and drawings are made from. Millimetres."""

from collections.abc import Sequence
from functools import lru_cache

import numpy as np

from pareto_monoped.cad.shape.curves import Contour, Points, polygon
from pareto_monoped.cad.shape.involute import Teeth, outline
from pareto_monoped.geometry.gears import FILLET, ExternalGear, InternalGear
from pareto_monoped.geometry.shapes import Circle, Path, Pattern, Shape, Spread


def contours(shape: Shape) -> tuple[Contour, ...]:
    """The closed curves that bound a shape, one per separate region.

    Raises:
        TypeError: a kind of shape that has no outline here.
    """
    if isinstance(shape, Circle):
        return (Contour(circle=shape),)
    if isinstance(shape, Pattern):
        radius = float(shape.radius_mm)
        return tuple(Contour(circle=Circle(radius_mm=radius, x_mm=x, y_mm=y)) for x, y in shape.centres_mm())
    if isinstance(shape, Path):
        return (Contour(pieces=shape.pieces),)
    if isinstance(shape, Spread):
        return tuple(Contour(pieces=path.pieces) for path in shape.paths())
    if isinstance(shape, ExternalGear | InternalGear):
        return (_gear(shape),)
    raise TypeError(f"no outline for a shape of kind {type(shape).__name__}")


def regions(outline: Shape, holes: Sequence[Shape]) -> list[tuple[Contour, list[Contour]]]:
    """The separate regions of an outline, each with the holes that lie in it."""
    outer = contours(outline)
    inner = [contour for hole in holes for contour in contours(hole)]
    if len(outer) == 1:
        return [(outer[0], inner)]
    corners = [polygon(contour) for contour in outer]
    middles = [polygon(contour).mean(axis=0) for contour in inner]
    return [
        (contour, [hole for hole, middle in zip(inner, middles, strict=True) if _contains(points, middle)])
        for contour, points in zip(outer, corners, strict=True)
    ]


def _contains(points: Points, point: Points) -> bool:
    """Whether a polygon contains a point: a ray along x from there leaves it an odd number of times."""
    x, y = (points - point).T
    x_next, y_next = np.roll(x, -1), np.roll(y, -1)
    crosses = (y > 0.0) != (y_next > 0.0)
    with np.errstate(divide="ignore", invalid="ignore"):
        at = x - y * (x_next - x) / (y_next - y)
    return bool(np.sum(crosses & (at > 0.0)) % 2)


def all_polygons(shapes: Sequence[Shape], tolerance_mm: float = 0.01) -> list[Points]:
    """One polygon per contour of the shapes."""
    return [polygon(contour, tolerance_mm) for shape in shapes for contour in contours(shape)]


@lru_cache(maxsize=64)
def _gear(gear: ExternalGear | InternalGear) -> Contour:
    module = float(gear.module_mm)
    return outline(
        Teeth(
            count=int(gear.teeth),
            module_mm=module,
            tip_radius_mm=float(gear.tip_radius_mm),
            root_radius_mm=float(gear.root_radius_mm),
            backlash_mm=float(gear.backlash_mm),
            fillet_mm=FILLET * module,
            pressure_angle_rad=gear.pressure_angle_rad,
            phase_rad=float(gear.phase_rad),
            inner=isinstance(gear, InternalGear),
            shift=float(gear.shift),
        )
    )
