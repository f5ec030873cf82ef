"""How large shapes and parts are, for blanks and cut lengths: box, reach from the axis, perimeter.

Millimetres; as in ``shapes``, every number may be an array of shape (n,).
"""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import lru_cache, reduce

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.geometry.gears import ExternalGear, InternalGear
from pareto_monoped.geometry.parts import Part
from pareto_monoped.geometry.shapes import Arc, Circle, Line, Numbers, Path, Pattern, Shape, Spread


@dataclass(frozen=True, slots=True, kw_only=True)
class Extent:
    """How far one instance of a part reaches, in its own frame."""

    x_mm: Numbers  #: length of its box along x
    y_mm: Numbers
    z_mm: Numbers
    radius_mm: Numbers  #: of the cylinder around the z axis that holds it


def extent(part: Part) -> Extent:
    """Return the extent of the prisms of a part."""
    outlines = [prism.outline for prism in part.prisms]
    right, up, left, down = (_most(_support(shape, k * 0.5 * np.pi) for shape in outlines) for k in range(4))
    return Extent(
        x_mm=right + left,
        y_mm=up + down,
        z_mm=_most(prism.z1_mm for prism in part.prisms) + _most(-prism.z0_mm for prism in part.prisms),
        radius_mm=_most(map(_reach, outlines)),
    )


def _most(values: Iterable[Numbers]) -> Numbers:
    return reduce(np.maximum, values)


def perimeter_mm(shape: Shape) -> Numbers:
    """Return the length of a shape's boundary; teeth count as their reference circle."""
    match shape:
        case Circle():
            return 2.0 * np.pi * shape.radius_mm
        case Pattern():
            return shape.count * 2.0 * np.pi * shape.radius_mm
        case Spread():
            return shape.count * perimeter_mm(shape.path)
        case Path():
            return reduce(np.add, map(_length, shape.pieces))
        case ExternalGear() | InternalGear():
            return 2.0 * np.pi * shape.pitch_radius_mm
    raise TypeError(f"{type(shape).__name__}: its perimeter is not known")


def _length(piece: Line | Arc) -> Numbers:
    if isinstance(piece, Arc):
        return piece.radius_mm * np.abs(piece.end_rad - piece.start_rad)
    return _hypot(piece.x1_mm - piece.x0_mm, piece.y1_mm - piece.y0_mm)


def _hypot(x_mm: Numbers, y_mm: Numbers) -> Numbers:
    length_mm: Numbers = np.hypot(x_mm, y_mm)
    return length_mm


def _support(shape: Shape, angle_rad: float) -> Numbers:
    """Return how far a shape reaches in a direction, from the origin."""
    if isinstance(shape, Path):
        return _known(_path_support, shape, angle_rad)
    if isinstance(shape, Circle | Pattern):
        ring = shape.pitch_radius_mm if isinstance(shape, Pattern) else 0.0
        centre: Numbers = shape.x_mm * np.cos(angle_rad) + shape.y_mm * np.sin(angle_rad)
        return centre + shape.radius_mm + ring
    return _reach(shape)


def _reach(shape: Shape) -> Numbers:
    """Return how far the farthest point of a shape is from the origin; a pattern counts as its ring."""
    match shape:
        case Circle() | Pattern():
            ring = shape.pitch_radius_mm if isinstance(shape, Pattern) else 0.0
            return _hypot(shape.x_mm, shape.y_mm) + shape.radius_mm + ring
        case Spread():
            return _reach(shape.path)
        case Path():
            return _known(_path_reach, shape, 0.0)
        case ExternalGear():
            return shape.tip_radius_mm
        case InternalGear():
            return shape.root_radius_mm
    raise TypeError(f"{type(shape).__name__}: its extent is not known")


def _known(function: Callable[[Path, float], Numbers], path: Path, angle_rad: float) -> Numbers:
    """Return the value of a function of a path, remembered where the path is of plain numbers."""
    try:
        return _remembered(function, path, angle_rad)
    except TypeError:  # arrays have no hash
        return function(path, angle_rad)


@lru_cache(maxsize=1024)
def _remembered(function: Callable[[Path, float], Numbers], path: Path, angle_rad: float) -> Numbers:
    return function(path, angle_rad)


def _path_support(path: Path, angle_rad: float) -> Numbers:
    x, y = np.cos(angle_rad), np.sin(angle_rad)

    def of(piece: Line | Arc) -> Numbers:
        if isinstance(piece, Line):
            return _most((piece.x0_mm * x + piece.y0_mm * y, piece.x1_mm * x + piece.y1_mm * y))
        ends = np.maximum(np.cos(piece.start_rad - angle_rad), np.cos(piece.end_rad - angle_rad))
        centre: Numbers = piece.x_mm * x + piece.y_mm * y
        return centre + piece.radius_mm * np.where(_passes(piece, angle_rad), 1.0, ends)

    return _most(map(of, path.pieces))


def _path_reach(path: Path, _: float) -> Numbers:
    def of(piece: Line | Arc) -> Numbers:
        if isinstance(piece, Line):
            return _most((_hypot(piece.x0_mm, piece.y0_mm), _hypot(piece.x1_mm, piece.y1_mm)))
        r = piece.radius_mm
        ends = _most(
            _hypot(piece.x_mm + r * np.cos(angle), piece.y_mm + r * np.sin(angle))
            for angle in (piece.start_rad, piece.end_rad)
        )
        outwards = _passes(piece, np.arctan2(piece.y_mm, piece.x_mm))
        return np.where(outwards, _hypot(piece.x_mm, piece.y_mm) + r, ends)

    return _most(map(of, path.pieces))


def _passes(arc: Arc, angle_rad: Numbers) -> NDArray[np.bool_]:
    """Return whether an arc, which may run either way, has a point in a direction from its centre."""
    low, high = np.minimum(arc.start_rad, arc.end_rad), np.maximum(arc.start_rad, arc.end_rad)
    return np.asarray(low + np.mod(angle_rad - low, 2.0 * np.pi) <= high)
