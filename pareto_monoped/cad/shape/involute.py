"""Outlines of involute spur gears with root fillets and backlash. Millimetres, radians.

Geometry after ISO 21771 (involute function, tooth thickness at any radius). The root is an arc tangent to the root
circle and to the flank, of 0.38 module by default, the root radius of the basic rack of ISO 53. A curve
parallel to an involute is the same involute turned by (distance / base radius), which places the fillet's centre.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.cad.shape.curves import Contour, Spline
from pareto_monoped.geometry.shapes import Arc, Line

Point = NDArray[np.float64]
Pieces = tuple[Line | Arc | Spline, ...]
_FLANK_POINTS = 8


@dataclass(frozen=True, slots=True, kw_only=True)
class Teeth:
    """What an outline needs of a gear, external or internal (``inner`` teeth pointing to the axis).

    For an internal gear the outline bounds the opening, whose tooth spaces have the form of an external gear's teeth.

    Attributes:
        count: number of teeth.
        module_mm: pitch diameter over teeth.
        tip_radius_mm, root_radius_mm: of the teeth.
        backlash_mm: by how much each tooth is thinner than half the pitch, along the pitch circle.
        fillet_mm: radius of the root.
        pressure_angle_rad: on the pitch circle.
        phase_rad: angle of the middle of a tooth (external) or of a space (internal).
        inner: an internal gear.
        shift: profile shift over module, positive outwards.
    """

    count: int
    module_mm: float
    tip_radius_mm: float
    root_radius_mm: float
    backlash_mm: float = 0.0
    fillet_mm: float
    pressure_angle_rad: float = np.radians(20.0)
    phase_rad: float = 0.0
    inner: bool = False
    shift: float = 0.0

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
    """The closed outline of a gear, anticlockwise.

    Raises:
        ValueError: the fillet does not fit between the flanks.
    """
    half = _half_space(teeth) if teeth.inner else _half_tooth(teeth)
    pieces: list[Line | Arc | Spline] = []
    turn = 2.0 * np.pi / teeth.count
    far, near = (
        (teeth.root_radius_mm, teeth.tip_radius_mm) if teeth.inner else (teeth.tip_radius_mm, teeth.root_radius_mm)
    )
    far_angle, near_angle = half.far_angle, half.near_angle
    for k in range(teeth.count):
        middle = teeth.phase_rad + k * turn
        pieces += [_placed(piece, middle, mirror=True) for piece in half.outward]
        pieces.append(Arc(0.0, 0.0, far, middle - far_angle, middle + far_angle))
        pieces += [_placed(piece, middle, mirror=False) for piece in reversed(half.outward)]
        pieces.append(Arc(0.0, 0.0, near, middle + near_angle, middle + turn - near_angle))
    return Contour(pieces=tuple(pieces))


@dataclass(frozen=True, slots=True, kw_only=True)
class _Half:
    """The lower side of a tooth or space around the x axis, mirrored to the upper side: pieces from near to far.

    ``far_angle`` and ``near_angle`` are where they meet the circles of largest and least radius.
    """

    outward: Pieces
    far_angle: float
    near_angle: float


def _half_tooth(t: Teeth) -> _Half:
    """Fillet, flank (with a radial line below the base circle), from the root outward; at positive angles."""
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
    return _Half(
        outward=(fillet, *foot, _flank(t, start, t.tip_radius_mm)),
        far_angle=t.half_angle(t.tip_radius_mm),
        near_angle=centre_angle,
    )


def _half_space(t: Teeth) -> _Half:
    """Flank and fillet of an internal gear's space, from the tips of its teeth outward; at positive angles."""
    base, rho = t.base_radius_mm, t.fillet_mm
    centre_radius = t.root_radius_mm - rho
    touch_radius = float(np.hypot(base, np.sqrt(centre_radius**2 - base**2) + rho))
    centre_angle = t.half_angle(centre_radius) - rho / base
    if centre_angle < 0.0:
        raise ValueError(f"a fillet of {rho} mm does not fit into the spaces of {t.count} internal teeth")
    touch = _polar(touch_radius, t.half_angle(touch_radius))
    fillet = _arc(_polar(centre_radius, centre_angle), touch, _polar(t.root_radius_mm, centre_angle))
    return _Half(
        outward=(_flank(t, t.tip_radius_mm, touch_radius), fillet),
        far_angle=centre_angle,
        near_angle=t.half_angle(t.tip_radius_mm),
    )


def _flank(t: Teeth, start_mm: float, end_mm: float) -> Spline:
    """Points of the involute, evenly spaced in roll angle, along which it is smoothest."""
    base = t.base_radius_mm
    rolls = np.linspace(np.sqrt(max(start_mm**2 - base**2, 0.0)), np.sqrt(end_mm**2 - base**2), _FLANK_POINTS)
    return Spline(np.array([_polar(r, t.half_angle(r)) for r in np.hypot(base, rolls)]))


def _placed(piece: Line | Arc | Spline, angle: float, *, mirror: bool) -> Line | Arc | Spline:
    """A piece of the upper half turned by ``angle``: run backwards, or mirrored to the lower half and run forwards."""
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


def _turned(points: Point, angle: float) -> Point:
    cos, sin = np.cos(angle), np.sin(angle)
    result: Point = points @ np.array([[cos, sin], [-sin, cos]])
    return result


def _arc(centre: Point, first: Point, last: Point) -> Arc:
    """The short arc from one point to another."""
    a = float(np.arctan2(first[1] - centre[1], first[0] - centre[0]))
    b = float(np.arctan2(last[1] - centre[1], last[0] - centre[0]))
    sweep = (b - a + np.pi) % (2.0 * np.pi) - np.pi
    return Arc(float(centre[0]), float(centre[1]), float(np.hypot(*(first - centre))), a, a + sweep)


def _polar(radius: float, angle: float) -> Point:
    return np.array([radius * np.cos(angle), radius * np.sin(angle)])


def _inv(angle: float) -> float:
    return float(np.tan(angle) - angle)


def _angle(base_mm: float, radius_mm: float) -> float:
    return float(np.arccos(min(base_mm / radius_mm, 1.0)))
