"""Closed curves of lines, arcs and splines, and polygons along them. Millimetres."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.geometry.shapes import Arc, Circle, Line

Points = NDArray[np.float64]
_COARSEST_STEP = 2.0 * np.pi / 48  # keeps the volume of thin bolts within 0.3 percent


@dataclass(frozen=True, slots=True)
class Spline:
    """A smooth curve through points, shape (n, 2)."""

    points_mm: Points


@dataclass(frozen=True, slots=True)
class Contour:
    """A closed curve: pieces that join end to end, anticlockwise; or a full circle."""

    pieces: tuple[Line | Arc | Spline, ...] = ()
    circle: Circle | None = None


def ends(piece: Line | Arc | Spline) -> tuple[Points, Points]:
    """First and last point of a piece."""
    if isinstance(piece, Line):
        return np.array([piece.x0_mm, piece.y0_mm]), np.array([piece.x1_mm, piece.y1_mm])
    if isinstance(piece, Spline):
        return piece.points_mm[0], piece.points_mm[-1]
    return on_arc(piece, float(piece.start_rad)), on_arc(piece, float(piece.end_rad))


def on_arc(arc: Arc, angle_rad: float) -> Points:
    """The point of an arc at an angle."""
    return np.array(
        [arc.x_mm + arc.radius_mm * np.cos(angle_rad), arc.y_mm + arc.radius_mm * np.sin(angle_rad)], dtype=np.float64
    )


def polygon(contour: Contour, tolerance_mm: float = 0.01) -> Points:
    """Points along a contour, shape (n, 2), that stay within ``tolerance_mm`` of its arcs."""
    if contour.circle is not None:
        circle = contour.circle
        full = Arc(circle.x_mm, circle.y_mm, circle.radius_mm, 0.0, 2.0 * np.pi)
        return _arc_points(full, tolerance_mm)
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
    """Points of a contour among which are all its extremes along x and y, to rounding, shape (n, 2)."""
    circle = contour.circle
    if circle is not None:
        arcs = [Arc(circle.x_mm, circle.y_mm, circle.radius_mm, 0.0, 2.0 * np.pi)]
    else:
        arcs = [piece for piece in contour.pieces if isinstance(piece, Arc)]
    tops = [on_arc(arc, angle) for arc in arcs for angle in _quarters(float(arc.start_rad), float(arc.end_rad))]
    return np.array([*polygon(contour), *tops])


def _quarters(start_rad: float, end_rad: float) -> Points:
    """The multiples of a right angle between two angles: there an arc is farthest along x or y."""
    low, high = sorted((start_rad, end_rad))
    return 0.5 * np.pi * np.arange(np.ceil(low / (0.5 * np.pi)), np.floor(high / (0.5 * np.pi)) + 1.0)


def _arc_points(arc: Arc, tolerance_mm: float) -> Points:
    """Points on an arc without its last one, which is the next piece's first."""
    sweep = float(arc.end_rad) - float(arc.start_rad)
    radius = float(arc.radius_mm)
    step = min(2.0 * np.arccos(max(1.0 - tolerance_mm / radius, 0.5)), _COARSEST_STEP)
    count = max(int(np.ceil(abs(sweep) / step)), 2)
    angle = float(arc.start_rad) + sweep * np.arange(count) / count
    centre = np.array([arc.x_mm, arc.y_mm], dtype=np.float64)
    return centre + radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)
