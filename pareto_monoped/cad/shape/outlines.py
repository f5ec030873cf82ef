"""Flat shapes as closed curves of lines, arcs and splines, and polygons along them. Millimetres, radians.

And other prisms for the same part, chosen so that uniting them is cheap.

The outlines of gears follow their records in ``geometry.gears``.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.geometry.features import Bevel
from pareto_monoped.geometry.gears import ExternalGear, InternalGear, half_angle
from pareto_monoped.geometry.parts import Prism
from pareto_monoped.geometry.shapes import Arc, Circle, Line, Numbers, Path, Pattern, Shape, Spread

Points = NDArray[np.float64]
_COARSEST_STEP = 2.0 * np.pi / 48  # keeps the volume of thin bolts within 0.3 percent
_FLANK_POINTS, _ROOT_POINTS = 8, 8


@dataclass(frozen=True, slots=True)
class Spline:
    """A smooth curve through points, shape (n, 2)."""

    points_mm: Points


Piece = Line | Arc | Spline


@dataclass(frozen=True, slots=True)
class Contour:
    """A closed curve: pieces that join end to end, anticlockwise; or a full circle."""

    pieces: tuple[Piece, ...] = ()
    circle: Circle | None = None


def centres_mm(shape: Circle | Pattern) -> list[tuple[float, float]]:
    """Return where the discs of a shape have their centres."""
    return shape.centres_mm() if isinstance(shape, Pattern) else [(float(shape.x_mm), float(shape.y_mm))]


def ends(piece: Piece) -> tuple[Points, Points]:
    """Return the first and the last point of a piece."""
    if isinstance(piece, Line):
        return np.array([piece.x0_mm, piece.y0_mm]), np.array([piece.x1_mm, piece.y1_mm])
    if isinstance(piece, Spline):
        return piece.points_mm[0], piece.points_mm[-1]
    return on_arc(piece, float(piece.start_rad)), on_arc(piece, float(piece.end_rad))


def on_arc(arc: Arc, angle_rad: float) -> Points:
    """Return the point of an arc at an angle."""
    x, y = arc.x_mm + arc.radius_mm * np.cos(angle_rad), arc.y_mm + arc.radius_mm * np.sin(angle_rad)
    return np.array([x, y], dtype=np.float64)


def polygon(contour: Contour, tolerance_mm: float = 0.01) -> Points:
    """Return points along a contour, shape (n, 2), that stay within ``tolerance_mm`` of its arcs."""
    if contour.circle is not None:
        return _arc_points(_full(contour.circle), tolerance_mm)
    rows = []
    for piece in contour.pieces:
        if isinstance(piece, Line):
            rows.append(np.array([[piece.x0_mm, piece.y0_mm]], dtype=np.float64))
        elif isinstance(piece, Spline):
            rows.append(piece.points_mm[:-1])
        else:
            rows.append(_arc_points(piece, tolerance_mm))
    return np.concatenate(rows)


def corners(contour: Contour) -> Points:
    """Return points of a contour among which are all its extremes along x and y, to rounding, shape (n, 2)."""
    circle = contour.circle
    arcs = [piece for piece in contour.pieces if isinstance(piece, Arc)] if circle is None else [_full(circle)]
    tops = [on_arc(arc, angle) for arc in arcs for angle in _quarters(float(arc.start_rad), float(arc.end_rad))]
    return np.array([*polygon(contour), *tops])


def _full(circle: Circle) -> Arc:
    return Arc(circle.x_mm, circle.y_mm, circle.radius_mm, 0.0, 2.0 * np.pi)


def _quarters(start_rad: float, end_rad: float) -> Points:
    """Return the multiples of a right angle between two angles: there an arc is farthest along x or y."""
    low, high = sorted((start_rad, end_rad))
    return 0.5 * np.pi * np.arange(np.ceil(low / (0.5 * np.pi)), np.floor(high / (0.5 * np.pi)) + 1.0)


def _arc_points(arc: Arc, tolerance_mm: float) -> Points:
    """Return points on an arc without its last one, which is the next piece's first."""
    sweep = float(arc.end_rad) - float(arc.start_rad)
    radius = float(arc.radius_mm)
    step = min(2.0 * np.arccos(max(1.0 - tolerance_mm / radius, 0.5)), _COARSEST_STEP)
    count = max(int(np.ceil(abs(sweep) / step)), 2)
    angle = float(arc.start_rad) + sweep * np.arange(count) / count
    centre = np.array([arc.x_mm, arc.y_mm], dtype=np.float64)
    return centre + radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)


@lru_cache(maxsize=64)
def _gear(gear: ExternalGear | InternalGear) -> Contour:
    """Return the closed outline of a gear, anticlockwise; ``ValueError`` if a ring's fillets do not fit."""
    half = _half_space(gear) if isinstance(gear, InternalGear) else _half_tooth(gear)
    pieces: list[Piece] = []
    count = int(gear.teeth)
    turn = 2.0 * np.pi / count
    near, far = sorted((float(gear.tip_radius_mm), float(gear.root_radius_mm)))
    for k in range(count):
        middle = float(gear.phase_rad) + k * turn
        pieces += [_placed(piece, middle, mirror=True) for piece in half.outward]
        pieces.append(Arc(0.0, 0.0, far, middle - half.far_angle, middle + half.far_angle))
        pieces += [_placed(piece, middle, mirror=False) for piece in reversed(half.outward)]
        pieces.append(Arc(0.0, 0.0, near, middle + half.near_angle, middle + turn - half.near_angle))
    return Contour(pieces=tuple(pieces))


@dataclass(frozen=True, slots=True, kw_only=True)
class _Half:
    """The upper side of a tooth or space around the x axis: pieces from near to far.

    ``far_angle`` and ``near_angle`` are where they meet the circles of largest and least radius.
    """

    outward: tuple[Piece, ...]
    far_angle: float
    near_angle: float


def _half_tooth(gear: ExternalGear) -> _Half:
    """Return root and flank of a tooth; the root's record has the middle of the space for its x axis."""
    root = _turned(gear.root_curve_mm(_ROOT_POINTS) * [1.0, -1.0], np.pi / float(gear.teeth))
    flank = _flank(gear, float(gear.form_radius_mm), float(gear.tip_radius_mm))
    return _Half(
        outward=(Spline(root), flank),
        far_angle=float(half_angle(gear, gear.tip_radius_mm)),
        near_angle=float(np.arctan2(root[0, 1], root[0, 0])),
    )


def _half_space(gear: InternalGear) -> _Half:
    """Return flank and fillet of a ring's space."""
    rho, root = float(gear.fillet_mm), float(gear.root_radius_mm)
    centre_angle, form = float(gear.fillet_angle_rad), float(gear.form_radius_mm)
    if centre_angle < 0.0:
        raise ValueError(f"a fillet of {rho} mm does not fit into the spaces of {gear.teeth} internal teeth")
    touch = _polar(form, float(half_angle(gear, form)))
    fillet = _arc(_polar(root - rho, centre_angle), touch, _polar(root, centre_angle))
    tip = float(gear.tip_radius_mm)
    return _Half(
        outward=(_flank(gear, tip, form), fillet), far_angle=centre_angle, near_angle=float(half_angle(gear, tip))
    )


def _flank(gear: ExternalGear | InternalGear, start_mm: float, end_mm: float) -> Spline:
    """Return points of the involute, evenly spaced in roll angle, along which it is smoothest."""
    base = float(gear.base_radius_mm)
    rolls = np.linspace(np.sqrt(max(start_mm**2 - base**2, 0.0)), np.sqrt(end_mm**2 - base**2), _FLANK_POINTS)
    radii = np.hypot(base, rolls)
    return Spline(_polar(radii, half_angle(gear, radii)).T)


def _placed(piece: Piece, angle: float, *, mirror: bool) -> Piece:
    """Return a piece of the upper half turned by ``angle``: backwards, or mirrored to the lower half and forwards."""
    if isinstance(piece, Arc):
        centre = np.array([piece.x_mm, piece.y_mm], dtype=np.float64)
        x, y = _turned(centre * [1.0, -1.0] if mirror else centre, angle)
        if mirror:
            return Arc(float(x), float(y), piece.radius_mm, angle - piece.start_rad, angle - piece.end_rad)
        return Arc(float(x), float(y), piece.radius_mm, angle + piece.end_rad, angle + piece.start_rad)
    if isinstance(piece, Line):
        points = np.array([[piece.x0_mm, piece.y0_mm], [piece.x1_mm, piece.y1_mm]], dtype=np.float64)
    else:
        points = piece.points_mm
    points = points * [1.0, -1.0] if mirror else points[::-1]
    points = _turned(points, angle)
    if isinstance(piece, Line):
        return Line(*(float(v) for v in points.ravel()))
    return Spline(points)


def _turned(points: Points, angle: float) -> Points:
    cos, sin = np.cos(angle), np.sin(angle)
    return np.asarray(points @ np.array([[cos, sin], [-sin, cos]]))


def _arc(centre: Points, first: Points, last: Points) -> Arc:
    a = float(np.arctan2(first[1] - centre[1], first[0] - centre[0]))
    b = float(np.arctan2(last[1] - centre[1], last[0] - centre[0]))
    sweep = (b - a + np.pi) % (2.0 * np.pi) - np.pi
    return Arc(float(centre[0]), float(centre[1]), float(np.hypot(*(first - centre))), a, a + sweep)


def _polar(radius: Numbers, angle: Numbers) -> Points:
    return np.array([radius * np.cos(angle), radius * np.sin(angle)])


def contours(shape: Shape) -> tuple[Contour, ...]:
    """Return the closed curves that bound a shape, one per separate region; ``TypeError`` for an unknown kind."""
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
    """Return the separate regions of an outline, each with the holes that lie in it."""
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
    """Return whether a polygon contains a point: a ray along x from there leaves it an odd number of times."""
    x, y = (points - point).T
    x_next, y_next = np.roll(x, -1), np.roll(y, -1)
    crosses = (y > 0.0) != (y_next > 0.0)
    with np.errstate(divide="ignore", invalid="ignore"):
        at = x - y * (x_next - x) / (y_next - y)
    return bool(np.sum(crosses & (at > 0.0)) % 2)


def all_polygons(shapes: Sequence[Shape], tolerance_mm: float = 0.01) -> list[Points]:
    """Return one polygon per contour of the shapes."""
    return [polygon(contour, tolerance_mm) for shape in shapes for contour in contours(shape)]


_TOUCH_MM = 1e-9
_LEAST_WALL_MM = 1.0
"""Of a ring that fills a hole. Our own choice: three times the chamfers of 0.3 mm on the edges of bores."""


def regrouped(prisms: Sequence[Prism]) -> list[Prism]:
    """Return the same body from other prisms: slices of one outline that stand on each other become one tall prism.

    Slices of a gear would have to be united along all their flanks. Where each slice has one central hole, the tall
    prism gets the widest of these holes, and rings fill it where the hole is narrower. Slices whose holes are nearly
    equal stay as they are: a chamfer does not fit on a ring that is thinner than itself.
    """
    result = []
    for stack in _stacks(prisms):
        bores = [prism.holes[0] for prism in stack if len(prism.holes) == 1 and isinstance(prism.holes[0], Circle)]
        if len(stack) == 1 or len(bores) < len(stack):
            result += stack
            continue
        widest = max(bores, key=lambda bore: float(bore.radius_mm))
        walls = [float(widest.radius_mm) - float(bore.radius_mm) for bore in bores]
        if any(0.0 < wall < _LEAST_WALL_MM for wall in walls):
            result += stack
            continue
        result.append(Prism(outline=stack[0].outline, z0_mm=stack[0].z0_mm, z1_mm=stack[-1].z1_mm, holes=(widest,)))
        result += [
            Prism(outline=widest, z0_mm=prism.z0_mm, z1_mm=prism.z1_mm, holes=(bore,))
            for prism, bore in zip(stack, bores, strict=True)
            if float(bore.radius_mm) < float(widest.radius_mm)
        ]
    return result


def stands_on(bevel: Bevel, prism: Prism) -> bool:
    """Return whether the edge of a bevel that takes away is one of this prism's, which is high enough for it."""
    takes = bevel.hole or float(bevel.edge_mm) <= float(bevel.at.radius_mm)
    return takes and is_on(bevel, prism)


def is_on(bevel: Bevel, prism: Prism) -> bool:
    """Return the same of any bevel: that of a countersunk head adds to its shank."""
    face, end = float(bevel.face_mm), float(bevel.end_mm)
    low, high = float(prism.z0_mm), float(prism.z1_mm)
    shapes = prism.holes if bevel.hole else (prism.outline,)
    at_face = abs(face - (low if end > face else high)) < _TOUCH_MM
    return bevel.at in shapes and at_face and abs(end - face) < high - low - _TOUCH_MM


def without_teeth(prism: Prism, bevels: Sequence[Bevel]) -> tuple[Prism, ...]:
    """Return a prism with teeth and bevels as two, one around the other, of which one has the teeth and no bevel.

    The kernel needs seconds for a cone on a face that has hundreds of edges. Other prisms come back as they are.
    """
    own = [bevel for bevel in bevels if stands_on(bevel, prism)]
    teeth = [shape for shape in (prism.outline, *prism.holes) if isinstance(shape, ExternalGear | InternalGear)]
    if not own or len(teeth) != 1:
        return (prism,)
    others: list[Shape] = [hole for hole in prism.holes if hole is not teeth[0]]
    around: list[Shape] = [
        Circle(radius_mm=bevel.edge_mm, x_mm=x, y_mm=y) for bevel in own if bevel.hole for x, y in bevel.centres_mm()
    ]
    reaches = [_reach(shape) for shape in (*others, *around)]
    if teeth[0] is prism.outline:
        low, high = max(far for _, far in reaches), _reach(teeth[0])[0]
    else:
        low, high = _reach(teeth[0])[1], min(near for near, _ in reaches) if reaches else 0.0
    if low >= high:
        return (prism,)
    split = Circle(radius_mm=0.5 * (low + high))
    if teeth[0] is prism.outline:
        return replace(prism, holes=(split,)), replace(prism, outline=split, holes=tuple(others))
    return replace(prism, holes=(split, *others)), replace(prism, outline=split, holes=(teeth[0],))


def _reach(shape: Shape) -> tuple[float, float]:
    """Return the least and the greatest distance of a boundary from the origin; 0 and infinity for unknown kinds."""
    if isinstance(shape, ExternalGear | InternalGear):
        radii = float(shape.root_radius_mm), float(shape.tip_radius_mm)
        return min(radii), max(radii)
    if isinstance(shape, Circle | Pattern):
        ring = float(shape.pitch_radius_mm) if isinstance(shape, Pattern) else 0.0
        away = float(np.hypot(shape.x_mm, shape.y_mm))
        radius = float(shape.radius_mm)
        return abs(abs(ring - away) - radius) if ring + away > radius else 0.0, ring + away + radius
    return 0.0, np.inf


def _stacks(prisms: Sequence[Prism]) -> list[list[Prism]]:
    """Return prisms of one outline that stand on each other without a gap, from below; all others alone."""
    stacks: list[list[Prism]] = []
    for prism in sorted(prisms, key=lambda p: float(p.z0_mm)):
        for stack in stacks:
            if stack[-1].outline == prism.outline and abs(float(stack[-1].z1_mm) - float(prism.z0_mm)) < _TOUCH_MM:
                stack.append(prism)
                break
        else:
            stacks.append([prism])
    return stacks
