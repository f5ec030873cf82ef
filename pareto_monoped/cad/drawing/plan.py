"""A part with outlines that are not round, turned so that its edges lie along the sheet, with its origin set."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import Polygon, box
from shapely.geometry.base import BaseGeometry

from pareto_monoped.cad.drawing.bores import Bore, bores
from pareto_monoped.cad.shape.outlines import Contour, contours, corners, ends, polygon
from pareto_monoped.geometry.parts import Part
from pareto_monoped.geometry.shapes import Arc, Circle, Line, Pattern

Points = NDArray[np.float64]
_SAME_MM = 1e-6
_FLAT_RAD = 1e-6


@dataclass(frozen=True, slots=True, kw_only=True)
class Layer:
    """An outline with its holes that are not round, from one height to another."""

    outline: Contour
    holes: tuple[Contour, ...]
    low: float
    high: float

    def area(self) -> Polygon:
        """Its region, with circles as polygons."""
        return Polygon(polygon(self.outline), [polygon(hole) for hole in self.holes])


@dataclass(frozen=True, slots=True, kw_only=True)
class Plan:
    """What the views of a part with layers are drawn from, in the sheet's directions."""

    layers: tuple[Layer, ...]  #: from above
    bores: tuple[Bore, ...]  #: round holes, on the axis too
    low: float  #: end along z
    high: float

    @property
    def bounds(self) -> tuple[float, float, float, float]:
        """Least x and y, greatest x and y."""
        points = np.concatenate([corners(layer.outline) for layer in self.layers])
        (x0, y0), (x1, y1) = points.min(axis=0), points.max(axis=0)
        return float(x0), float(y0), float(x1), float(y1)

    @property
    def is_flat(self) -> bool:
        """Whether it is one layer of one thickness."""
        return len(self.layers) == 1

    def passed_by(self, bore: Bore) -> bool:
        """Return whether holes go from one end of the part to the other."""
        return abs(bore.low - self.low) < 1e-6 and abs(bore.high - self.high) < 1e-6


def plan_of(part: Part) -> Plan:
    """Return the part turned and moved: long side along the sheet, origin at its own axis if it has a hole there."""
    shapes = _shapes(part)
    outlines = [contour for contour, _, _, _ in shapes]
    found = bores(part, on_axis=True)
    turn = _turn(outlines)
    if any(round(float(bore.shape.x_mm), 6) == round(float(bore.shape.y_mm), 6) == 0.0 for bore in found):
        shift = np.zeros(2)
    else:
        turned = [_moved(outline, turn, np.zeros(2)) for outline in outlines]
        shift = -np.concatenate([corners(outline) for outline in turned]).min(axis=0)
    layers = []
    for outline, holes, low, high in shapes:
        inner = tuple(_moved(hole, turn, shift) for hole in holes)
        layers.append(Layer(outline=_moved(outline, turn, shift), holes=inner, low=low, high=high))
    moved = tuple(replace(bore, shape=_moved_shape(bore.shape, turn, shift)) for bore in found)
    joined = tuple(_joined(layers))
    low, high = min(layer.low for layer in joined), max(layer.high for layer in joined)
    return Plan(layers=joined, bores=moved, low=low, high=high)


def nodes(contour: Contour) -> list[tuple[Points, Line | Arc]]:
    """Return the points where a contour's pieces begin, with the piece that follows."""
    found = []
    for piece in contour.pieces:
        assert isinstance(piece, Line | Arc)
        found.append((ends(piece)[0], piece))
    return found


def is_square(contour: Contour) -> bool:
    """Return whether a contour consists of lines along the sheet's edges only."""
    return bool(contour.pieces) and all(isinstance(p, Line) and _along(p) for p in contour.pieces)


def rounded_rectangle(contour: Contour) -> tuple[float, float, float, float, float] | None:
    """Return width, height, corner radius and centre of a rectangle along the sheet's edges; None for others."""
    lines = [piece for piece in contour.pieces if isinstance(piece, Line)]
    arcs = [piece for piece in contour.pieces if isinstance(piece, Arc)]
    if len(lines) != 4 or len(arcs) not in (0, 4) or not all(_along(line) for line in lines):
        return None
    radii = {round(float(arc.radius_mm), 6) for arc in arcs}
    if len(radii) > 1 or any(abs(abs(float(a.end_rad) - float(a.start_rad)) - 0.5 * np.pi) > 1e-6 for a in arcs):
        return None
    points = polygon(contour)
    (x0, y0), (x1, y1) = points.min(axis=0), points.max(axis=0)
    radius = radii.pop() if radii else 0.0
    return float(x1 - x0), float(y1 - y0), radius, float(0.5 * (x0 + x1)), float(0.5 * (y0 + y1))


def repeats(contour: Contour) -> int:
    """Return how often a contour repeats itself around the origin, as a sprocket does; 1 for most."""
    points = np.array([point for point, _ in nodes(contour)])
    radii, angles = np.hypot(*points.T), np.unwrap(np.arctan2(points[:, 1], points[:, 0]))
    for count in range(len(points) // 2, 2, -1):
        if len(points) % count:
            continue
        step = len(points) // count
        turned = np.allclose(np.roll(radii, -step), radii, atol=1e-6)
        steps = (np.roll(angles, -step) - angles + np.pi) % (2.0 * np.pi) - np.pi
        if turned and np.allclose(steps, 2.0 * np.pi / count, atol=1e-6):
            return count
    return 1


def _shapes(part: Part) -> list[tuple[Contour, tuple[Contour, ...], float, float]]:
    """Return outlines with their holes that are not round, and their ends along z; of a ball that of its middle."""
    found = []
    for prism in part.prisms:
        others = [hole for hole in prism.holes if not isinstance(hole, Circle | Pattern)]
        inner = tuple(contour for hole in others for contour in contours(hole))
        ends = float(prism.z0_mm), float(prism.z1_mm)
        found += [(outline, inner, *ends) for outline in contours(prism.outline)]
    for ball in part.balls:
        radius, y, top = float(ball.radius_mm), float(ball.y_mm), float(ball.top_mm)
        half = float(np.sqrt(max(radius**2 - top**2, 0.0)))
        lean = float(np.arcsin(top / radius))
        arc = Arc(0.0, y, radius, np.pi - lean, 2.0 * np.pi + lean)
        cut = Contour(pieces=(arc, Line(half, y + top, -half, y + top)))
        pocket = contours(ball.pocket.outline) if ball.pocket is not None else ()
        found.append((cut, pocket, -radius, radius))
    return found


def _joined(layers: Sequence[Layer]) -> list[Layer]:
    """Return layers of one outline and one set of holes that stand on each other as one; from above."""
    result: list[Layer] = []
    for layer in sorted(layers, key=lambda one: one.low):
        for k, other in enumerate(result):
            same = _equal(other.outline, layer.outline) and len(other.holes) == len(layer.holes)
            if same and abs(other.high - layer.low) < _SAME_MM and all(map(_equal, other.holes, layer.holes)):
                result[k] = replace(other, high=layer.high)
                break
        else:
            result.append(layer)
    return sorted(result, key=lambda one: (-one.high, -one.low))


def _equal(one: Contour, other: Contour) -> bool:
    a, b = polygon(one), polygon(other)
    return a.shape == b.shape and np.allclose(a, b)


def _turn(outlines: Sequence[Contour]) -> float:
    """Return the angle by which to turn a part: most of its edges along the sheet, and the longer side across it."""
    lengths: dict[float, float] = {}
    for contour in outlines:
        for piece in contour.pieces:
            if isinstance(piece, Line):
                (x0, y0), (x1, y1) = ends(piece)
                angle = round(float(np.arctan2(y1 - y0, x1 - x0)) % (0.5 * np.pi), 6) % round(0.5 * np.pi, 6)
                lengths[angle] = lengths.get(angle, 0.0) + float(np.hypot(x1 - x0, y1 - y0))
    straight = max(lengths, key=lambda a: (round(lengths[a], 3), -a), default=0.0)
    # A part without one clear direction keeps its own axes.
    if lengths.get(straight, 0.0) < 0.6 * sum(lengths.values()):
        straight = 0.0
    size = np.ptp(_rotated(np.concatenate([polygon(contour) for contour in outlines]), -straight), axis=0)
    return -straight + (0.5 * np.pi if size[1] > size[0] + 1e-6 else 0.0)


def _rotated(points: Points, angle: float) -> Points:
    cos, sin = np.cos(angle), np.sin(angle)
    return np.asarray(points @ np.array([[cos, sin], [-sin, cos]]))


def _moved(contour: Contour, turn: float, shift: Points) -> Contour:
    if contour.circle is not None:
        circle = _moved_shape(contour.circle, turn, shift)
        assert isinstance(circle, Circle)
        return Contour(circle=circle)
    pieces = []
    for piece in contour.pieces:
        if not isinstance(piece, Line | Arc):
            raise TypeError(f"no plan of a contour with a {type(piece).__name__}")
        pieces.append(_moved_piece(piece, turn, shift))
    return Contour(pieces=tuple(pieces))


def _moved_piece(piece: Line | Arc, turn: float, shift: Points) -> Line | Arc:
    if isinstance(piece, Line):
        first, last = (_rotated(end, turn) + shift for end in ends(piece))
        return Line(float(first[0]), float(first[1]), float(last[0]), float(last[1]))
    centre = _rotated(np.array([piece.x_mm, piece.y_mm], dtype=np.float64), turn) + shift
    return Arc(float(centre[0]), float(centre[1]), piece.radius_mm, piece.start_rad + turn, piece.end_rad + turn)


def _moved_shape(shape: Circle | Pattern, turn: float, shift: Points) -> Circle | Pattern:
    x, y = _rotated(np.array([shape.x_mm, shape.y_mm], dtype=np.float64), turn) + shift
    if isinstance(shape, Pattern):
        return replace(shape, x_mm=float(x), y_mm=float(y), phase_rad=float(shape.phase_rad) + turn)
    return replace(shape, x_mm=float(x), y_mm=float(y))


def _along(line: Line) -> bool:
    (x0, y0), (x1, y1) = ends(line)
    return bool(min(abs(x1 - x0), abs(y1 - y0)) < _FLAT_RAD * max(abs(x1 - x0), abs(y1 - y0)) + 1e-9)


def cut_along(plan: Plan, x: float) -> BaseGeometry:
    """Return the material on the plane across the sheet at ``x``, in coordinates z and y."""
    line = shapely.linestrings([(x, plan.bounds[1] - 1.0), (x, plan.bounds[3] + 1.0)])
    solid = [
        box(layer.low, piece.bounds[1], layer.high, piece.bounds[3])
        for layer in plan.layers
        for piece in shapely.get_parts(layer.area().intersection(line))
        if piece.length > _SAME_MM
    ]
    body = shapely.union_all(solid)
    empty = [cut for bore in plan.bores for cx, cy in bore.centres for cut in _cut_bore(bore, cy, abs(cx - x))]
    return body.difference(shapely.union_all(empty)) if empty else body


def _cut_bore(bore: Bore, y: float, off: float) -> Iterator[BaseGeometry]:
    """Yield where a hole, whose axis lies ``off`` the plane, opens it: the cylinder, and cones through their axis."""
    if off < bore.radius - _SAME_MM:
        half = float(np.sqrt(bore.radius**2 - off**2))
        yield box(bore.low, y - half, bore.high, y + half)
    for mouth, face, inwards in zip(bore.mouths, (bore.low, bore.high), (1.0, -1.0), strict=True):
        if mouth is not None and off < _SAME_MM:
            wide, end = float(mouth.radius_mm), face + inwards * float(mouth.depth_mm)
            yield Polygon([(face, y - wide), (face, y + wide), (end, y + bore.radius), (end, y - bore.radius)])
