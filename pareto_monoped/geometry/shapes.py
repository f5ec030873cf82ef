"""Flat shapes and their exact area moments.

A shape lies in the local x-y plane, in millimetres. Every number may be a float or an array of shape (n,), so that the
same code weighs one part or a whole population; results then have shape (n,).

The six integrals of a region, area, x, y, xx, yy, xy over dA, add up over disjoint regions and subtract for holes. By
Green's theorem each is an integral along the boundary; straight lines and arcs are integrated by Gauss-Legendre
quadrature, which is exact for lines and to rounding for arcs of up to a half turn.
"""

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

Numbers = float | NDArray[np.float64]
"""A float, or an array of shape (n,) with a value a design."""

# 16 nodes integrate polynomials up to degree 31 exactly; sines over a half turn to about 1e-16.
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(16)
_NODES = 0.5 * (_NODES + 1.0)
_WEIGHTS = 0.5 * _WEIGHTS


@dataclass(frozen=True, slots=True)
class Moments:
    """Integrals of a flat region about the local origin: area in mm2, first moments in mm3, second moments in mm4."""

    area: Numbers
    x: Numbers = 0.0
    y: Numbers = 0.0
    xx: Numbers = 0.0
    yy: Numbers = 0.0
    xy: Numbers = 0.0

    def __add__(self, other: "Moments") -> "Moments":
        return Moments(
            self.area + other.area,
            self.x + other.x,
            self.y + other.y,
            self.xx + other.xx,
            self.yy + other.yy,
            self.xy + other.xy,
        )

    def __sub__(self, other: "Moments") -> "Moments":
        return self + other.scaled(-1.0)

    def scaled(self, factor: Numbers) -> "Moments":
        """All integrals times ``factor``."""
        return Moments(
            self.area * factor, self.x * factor, self.y * factor, self.xx * factor, self.yy * factor, self.xy * factor
        )

    def moved(self, x_mm: Numbers, y_mm: Numbers) -> "Moments":
        """The integrals of the region moved by (x_mm, y_mm), by the parallel axis theorem."""
        return Moments(
            self.area,
            self.x + self.area * x_mm,
            self.y + self.area * y_mm,
            self.xx + 2.0 * self.x * x_mm + self.area * x_mm * x_mm,
            self.yy + 2.0 * self.y * y_mm + self.area * y_mm * y_mm,
            self.xy + self.x * y_mm + self.y * x_mm + self.area * x_mm * y_mm,
        )


class Shape(Protocol):
    """A flat region that knows its moments; the CAD knows how to draw each kind."""

    def moments(self) -> Moments:
        """The region's integrals about the local origin."""
        ...


@dataclass(frozen=True, slots=True, kw_only=True)
class Circle:
    """A disc."""

    radius_mm: Numbers
    x_mm: Numbers = 0.0
    y_mm: Numbers = 0.0

    def moments(self) -> Moments:
        """Closed form."""
        area = np.pi * np.square(self.radius_mm)
        second = 0.25 * area * np.square(self.radius_mm)
        return Moments(area, 0.0, 0.0, second, second, 0.0).moved(self.x_mm, self.y_mm)


@dataclass(frozen=True, slots=True, kw_only=True)
class Pattern:
    """The same disc repeated evenly around a circle: bolt holes, pins.

    The two second moments are taken as equal, which is exact for three and more (rotational symmetry); for two the
    polar moment is exact and its split is not, which only affects rotation about an in-plane axis.
    """

    radius_mm: Numbers
    pitch_radius_mm: Numbers
    count: Numbers
    phase_rad: float = 0.0
    x_mm: Numbers = 0.0
    y_mm: Numbers = 0.0

    def moments(self) -> Moments:
        """Closed form."""
        area = self.count * np.pi * np.square(self.radius_mm)
        second = area * (0.25 * np.square(self.radius_mm) + 0.5 * np.square(self.pitch_radius_mm))
        return Moments(area, 0.0, 0.0, second, second, 0.0).moved(self.x_mm, self.y_mm)

    def centres_mm(self) -> list[tuple[float, float]]:
        """The centres of the discs, for a pattern of plain numbers."""
        angles = self.phase_rad + 2.0 * np.pi * np.arange(int(self.count)) / int(self.count)
        return [
            (float(self.x_mm + self.pitch_radius_mm * np.cos(a)), float(self.y_mm + self.pitch_radius_mm * np.sin(a)))
            for a in angles
        ]


@dataclass(frozen=True, slots=True)
class Line:
    """A straight piece of a boundary, from one point to another."""

    x0_mm: Numbers
    y0_mm: Numbers
    x1_mm: Numbers
    y1_mm: Numbers


@dataclass(frozen=True, slots=True)
class Arc:
    """A circular piece of a boundary, from one angle to another (increasing: anticlockwise), at most a half turn."""

    x_mm: Numbers
    y_mm: Numbers
    radius_mm: Numbers
    start_rad: Numbers
    end_rad: Numbers


@dataclass(frozen=True, slots=True)
class Path:
    """A region bounded by lines and arcs that run anticlockwise and close."""

    pieces: tuple[Line | Arc, ...]

    def moments(self) -> Moments:
        """Green's theorem along each piece."""
        total = Moments(0.0)
        for piece in self.pieces:
            x, y, dx, dy = _samples(piece)

            def along(values: NDArray[np.float64]) -> Numbers:
                return np.asarray(np.sum(values * _WEIGHTS, axis=-1))[()]

            total = total + Moments(
                along(0.5 * (x * dy - y * dx)),
                along(0.5 * x * x * dy),
                along(-0.5 * y * y * dx),
                along(x**3 * dy / 3.0),
                along(-(y**3) * dx / 3.0),
                along(0.5 * x * x * y * dy),
            )
        return total


def _samples(piece: Line | Arc) -> tuple[NDArray[np.float64], ...]:
    """Points and derivatives with respect to the curve parameter at the nodes, each of shape (..., 16)."""
    if isinstance(piece, Line):
        x0, y0, x1, y1 = (
            np.asarray(v, dtype=np.float64)[..., None] for v in (piece.x0_mm, piece.y0_mm, piece.x1_mm, piece.y1_mm)
        )
        dx, dy = x1 - x0, y1 - y0
        x, y = x0 + dx * _NODES, y0 + dy * _NODES
        return x, y, dx + 0.0 * x, dy + 0.0 * y
    cx, cy, r, a0, a1 = (
        np.asarray(v, dtype=np.float64)[..., None]
        for v in (piece.x_mm, piece.y_mm, piece.radius_mm, piece.start_rad, piece.end_rad)
    )
    angle = a0 + (a1 - a0) * _NODES
    cos, sin = np.cos(angle), np.sin(angle)
    return cx + r * cos, cy + r * sin, -r * sin * (a1 - a0), r * cos * (a1 - a0)


def rectangle(*, width_mm: Numbers, height_mm: Numbers, x_mm: Numbers = 0.0, y_mm: Numbers = 0.0) -> Path:
    """A rectangle centred at (x_mm, y_mm)."""
    left, right = x_mm - 0.5 * width_mm, x_mm + 0.5 * width_mm
    low, high = y_mm - 0.5 * height_mm, y_mm + 0.5 * height_mm
    return Path(
        (
            Line(left, low, right, low),
            Line(right, low, right, high),
            Line(right, high, left, high),
            Line(left, high, left, low),
        )
    )


def hull(*, top_radius_mm: Numbers, bottom_radius_mm: Numbers, length_mm: Numbers, y_mm: Numbers = 0.0) -> Path:
    """The convex hull of two discs: the outline of a link or a slot.

    The top disc is centred at (0, y_mm), the bottom one ``length_mm`` below it; ``length_mm`` must exceed the
    difference of the radii. Lines are the outer tangents.
    """
    lean = np.arcsin((bottom_radius_mm - top_radius_mm) / length_mm)  # of the tangents' normal above the horizontal
    low = y_mm - length_mm
    cos, sin = np.cos(lean), np.sin(lean)
    right_low = (bottom_radius_mm * cos, low + bottom_radius_mm * sin)
    right_high = (top_radius_mm * cos, y_mm + top_radius_mm * sin)
    return Path(
        (
            Line(*right_low, *right_high),
            Arc(0.0, y_mm, top_radius_mm, lean, np.pi - lean),
            Line(-right_high[0], right_high[1], -right_low[0], right_low[1]),
            Arc(0.0, low, bottom_radius_mm, np.pi - lean, 2.0 * np.pi + lean),
        )
    )
