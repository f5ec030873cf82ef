"""Flat shapes as closed curves of lines, arcs and splines, and polygons along them. Millimetres, radians.

Involute spur gears follow ISO 21771 (involute function, tooth thickness at any radius). The root is an arc tangent to
the root circle and to the flank, of 0.38 module by default, the root radius of the basic rack of ISO 53. A curve
parallel to an involute is the same involute turned by (distance / base radius), which places the fillet's centre.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.geometry.gears import FILLET, ExternalGear, InternalGear
from pareto_monoped.geometry.shapes import Arc, Circle, Line, Path, Pattern, Shape, Spread

Points = NDArray[np.float64]
_COARSEST_STEP = 2.0 * np.pi / 48  # keeps the volume of thin bolts within 0.3 percent
_FLANK_POINTS = 8


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


@dataclass(frozen=True, slots=True, kw_only=True)
class Teeth:
    """What an outline needs of a gear, external or internal (``inner``: teeth point to the axis).

    For an internal gear the outline bounds the opening, whose tooth spaces have the form of an external gear's teeth.
    """

    count: int  #: number of teeth
    module_mm: float  #: pitch diameter over teeth
    tip_radius_mm: float
    root_radius_mm: float
    backlash_mm: float = 0.0  #: by how much each tooth is thinner than half the pitch, along the pitch circle
    fillet_mm: float  #: radius of the root
    pressure_angle_rad: float = np.radians(20.0)  #: on the pitch circle
    phase_rad: float = 0.0  #: angle of the middle of a tooth (external) or of a space (internal)
    inner: bool = False  #: an internal gear
    shift: float = 0.0  #: profile shift over module, positive outwards

    @property
    def pitch_radius_mm(self) -> float:
        """Radius on which both wheels roll."""
        return 0.5 * self.count * self.module_mm

    @property
    def base_radius_mm(self) -> float:
        """Radius of the circle that the involute unwinds from."""
        return self.pitch_radius_mm * float(np.cos(self.pressure_angle_rad))

    def half_angle(self, radius_mm: float) -> float:
        """Half the angle that a tooth (external) or a space (internal) spans at a radius, at least the base radius."""
        play = self.backlash_mm if self.inner else -self.backlash_mm
        shifted = 2.0 * self.shift * self.module_mm * np.tan(self.pressure_angle_rad)
        at_pitch = (0.5 * np.pi * self.module_mm + play + shifted) / (2.0 * self.pitch_radius_mm)
        return float(at_pitch + _inv(self.pressure_angle_rad) - _inv(_angle(self.base_radius_mm, radius_mm)))


def outline(teeth: Teeth) -> Contour:
    """Return the closed outline of a gear, anticlockwise; ``ValueError`` if its fillet does not fit."""
    half = _half_space(teeth) if teeth.inner else _half_tooth(teeth)
    pieces: list[Piece] = []
    turn = 2.0 * np.pi / teeth.count
    radii = teeth.tip_radius_mm, teeth.root_radius_mm
    far, near = radii[::-1] if teeth.inner else radii
    for k in range(teeth.count):
        middle = teeth.phase_rad + k * turn
        pieces += [_placed(piece, middle, mirror=True) for piece in half.outward]
        pieces.append(Arc(0.0, 0.0, far, middle - half.far_angle, middle + half.far_angle))
        pieces += [_placed(piece, middle, mirror=False) for piece in reversed(half.outward)]
        pieces.append(Arc(0.0, 0.0, near, middle + half.near_angle, middle + turn - half.near_angle))
    return Contour(pieces=tuple(pieces))


@dataclass(frozen=True, slots=True, kw_only=True)
class _Half:
    """The lower side of a tooth or space around the x axis, mirrored to the upper side: pieces from near to far.

    ``far_angle`` and ``near_angle`` are where they meet the circles of largest and least radius.
    """

    outward: tuple[Piece, ...]
    far_angle: float
    near_angle: float


def _half_tooth(t: Teeth) -> _Half:
    """Return fillet and flank (with a radial line below the base circle), from the root outward; at positive angles."""
    base, rho = t.base_radius_mm, t.fillet_mm
    centre_radius = t.root_radius_mm + rho
    roll = np.sqrt(max(centre_radius**2 - base**2, 0.0)) - rho
    foot: tuple[Line, ...] = ()
    if centre_radius > base and roll >= 0.0:
        start = float(np.hypot(base, roll))
        centre_angle = t.half_angle(centre_radius) + rho / base
        touch = _polar(start, t.half_angle(start))
    else:
        start = base
        side = t.half_angle(base)
        centre_angle = side + float(np.arcsin(rho / centre_radius))
        touch_radius = float(np.sqrt(centre_radius**2 - rho**2))
        if touch_radius > base:
            raise ValueError(f"a fillet of {rho} mm reaches above the base circle of {t.count} teeth")
        touch = _polar(touch_radius, side)
        foot = (Line(*touch, *_polar(base, side)),)
    if centre_angle > np.pi / t.count:
        raise ValueError(f"a fillet of {rho} mm does not fit between {t.count} teeth of module {t.module_mm}")
    fillet = _arc(_polar(centre_radius, centre_angle), _polar(t.root_radius_mm, centre_angle), touch)
    outward: tuple[Piece, ...] = (fillet, *foot, _flank(t, start, t.tip_radius_mm))
    return _Half(outward=outward, far_angle=t.half_angle(t.tip_radius_mm), near_angle=centre_angle)


def _half_space(t: Teeth) -> _Half:
    """Return flank and fillet of an internal gear's space, from the teeth's tips outward; at positive angles."""
    base, rho = t.base_radius_mm, t.fillet_mm
    centre_radius = t.root_radius_mm - rho
    touch_radius = float(np.hypot(base, np.sqrt(centre_radius**2 - base**2) + rho))
    centre_angle = t.half_angle(centre_radius) - rho / base
    if centre_angle < 0.0:
        raise ValueError(f"a fillet of {rho} mm does not fit into the spaces of {t.count} internal teeth")
    touch = _polar(touch_radius, t.half_angle(touch_radius))
    fillet = _arc(_polar(centre_radius, centre_angle), touch, _polar(t.root_radius_mm, centre_angle))
    outward = (_flank(t, t.tip_radius_mm, touch_radius), fillet)
    return _Half(outward=outward, far_angle=centre_angle, near_angle=t.half_angle(t.tip_radius_mm))


def _flank(t: Teeth, start_mm: float, end_mm: float) -> Spline:
    """Return points of the involute, evenly spaced in roll angle, along which it is smoothest."""
    base = t.base_radius_mm
    rolls = np.linspace(np.sqrt(max(start_mm**2 - base**2, 0.0)), np.sqrt(end_mm**2 - base**2), _FLANK_POINTS)
    return Spline(np.array([_polar(r, t.half_angle(r)) for r in np.hypot(base, rolls)]))


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


def _polar(radius: float, angle: float) -> Points:
    return np.array([radius * np.cos(angle), radius * np.sin(angle)])


def _inv(angle: float) -> float:
    return float(np.tan(angle) - angle)


def _angle(base_mm: float, radius_mm: float) -> float:
    return float(np.arccos(min(base_mm / radius_mm, 1.0)))


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
