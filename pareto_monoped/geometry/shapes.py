"""Flat shapes and their exact area moments.

A shape lies in the local x-y plane, in millimetres. Every number may be a float or an array of shape (n,), so that the
same code weighs one part or a whole population; results then have shape (n,).

The six integrals of a region, area, x, y, xx, yy, xy over dA, add up over disjoint regions and subtract for holes. By
Green's theorem each is an integral along the boundary, in closed form for straight lines and arcs.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field, fields
from functools import lru_cache, reduce
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Numbers = float | Floats
"""A float, or an array of shape (n,) with one value per design."""


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
        """Return all integrals times ``factor``."""
        return Moments(
            self.area * factor, self.x * factor, self.y * factor, self.xx * factor, self.yy * factor, self.xy * factor
        )

    def moved(self, x_mm: Numbers, y_mm: Numbers) -> "Moments":
        """Return the integrals of the region moved by (x_mm, y_mm), by the parallel axis theorem."""
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
        """Return the region's integrals about the local origin."""
        ...

    def area_mm2(self) -> Numbers:
        """Return the first of ``moments``, to the last bit, for searches that weigh thousands of parts."""
        ...


@dataclass(frozen=True, slots=True, kw_only=True)
class Circle:
    """A disc."""

    radius_mm: Numbers
    x_mm: Numbers = 0.0
    y_mm: Numbers = 0.0

    def area_mm2(self) -> Numbers:
        """Return the first of ``moments``."""
        return np.pi * np.square(self.radius_mm)

    def moments(self) -> Moments:
        """Return the integrals in closed form."""
        area = self.area_mm2()
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
    phase_rad: Numbers = 0.0
    x_mm: Numbers = 0.0
    y_mm: Numbers = 0.0

    def area_mm2(self) -> Numbers:
        """Return the first of ``moments``."""
        return self.count * np.pi * np.square(self.radius_mm)

    def moments(self) -> Moments:
        """Return the integrals in closed form."""
        area = self.area_mm2()
        second = area * (0.25 * np.square(self.radius_mm) + 0.5 * np.square(self.pitch_radius_mm))
        return Moments(area, 0.0, 0.0, second, second, 0.0).moved(self.x_mm, self.y_mm)

    def centres_mm(self) -> list[tuple[float, float]]:
        """Return the centres of the discs, for a pattern of plain numbers."""
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
    """A circular piece of a boundary, from one angle to another (increasing: anticlockwise)."""

    x_mm: Numbers
    y_mm: Numbers
    radius_mm: Numbers
    start_rad: Numbers
    end_rad: Numbers


@dataclass(frozen=True, slots=True)
class Path:
    """A region bounded by lines and arcs that run anticlockwise and close."""

    pieces: tuple[Line | Arc, ...]
    _known: Moments | None = field(default=None, init=False, repr=False, compare=False)

    def area_mm2(self) -> Numbers:
        """Return the first of ``moments``."""
        many = any(isinstance(value, np.ndarray) for piece in self.pieces for value in _numbers(piece))
        return _enclosed_mm2(self.pieces) if many and self._known is None else self.moments().area

    def moments(self) -> Moments:
        """Add up the sectors that the pieces span with the origin, by Green's theorem."""
        if self._known is None:
            try:
                known = _remembered(self.pieces)
            except TypeError:  # arrays have no hash
                known = _boundary(self.pieces)
            object.__setattr__(self, "_known", known)
            return known
        return self._known


@dataclass(frozen=True, slots=True, kw_only=True)
class Spread:
    """The same path repeated evenly around the origin, turned each time: webs, spokes. Moments as of ``Pattern``."""

    path: Path  #: one of them, drawn around the +x axis
    count: Numbers  #: how many; those of an array may be 0
    phase_rad: Numbers = 0.0  #: by which the first is turned

    def area_mm2(self) -> Numbers:
        """Return the first of ``moments``."""
        return self.count * self.path.area_mm2()

    def moments(self) -> Moments:
        """Return those of one path, averaged over all angles."""
        one = self.path.moments()
        second = 0.5 * self.count * (one.xx + one.yy)
        return Moments(self.count * one.area, 0.0, 0.0, second, second, 0.0)

    def paths(self) -> list[Path]:
        """Return each path where it lies, for plain numbers."""
        step = 2.0 * np.pi / int(self.count)
        return [turned(self.path, float(self.phase_rad) + k * step) for k in range(int(self.count))]


def turned(path: Path, angle_rad: float) -> Path:
    """Return a path of plain numbers turned about the origin."""
    cos, sin = float(np.cos(angle_rad)), float(np.sin(angle_rad))

    def at(x: Numbers, y: Numbers) -> tuple[float, float]:
        return float(cos * x - sin * y), float(sin * x + cos * y)

    return Path(
        tuple(
            Line(*at(p.x0_mm, p.y0_mm), *at(p.x1_mm, p.y1_mm))
            if isinstance(p, Line)
            else Arc(*at(p.x_mm, p.y_mm), p.radius_mm, p.start_rad + angle_rad, p.end_rad + angle_rad)
            for p in path.pieces
        )
    )


def polygon(points: Sequence[tuple[Numbers, Numbers]]) -> Path:
    """Return the polygon through points (x, y), anticlockwise."""
    return Path(tuple(Line(*one, *other) for one, other in zip(points, (*points[1:], points[0]), strict=True)))


def _numbers(piece: Line | Arc) -> tuple[Numbers, ...]:
    if isinstance(piece, Line):
        return piece.x0_mm, piece.y0_mm, piece.x1_mm, piece.y1_mm
    return piece.x_mm, piece.y_mm, piece.radius_mm, piece.start_rad, piece.end_rad


def _boundary(pieces: tuple[Line | Arc, ...]) -> Moments:
    lines = [_numbers(piece) for piece in pieces if isinstance(piece, Line)]
    arcs = [_numbers(piece) for piece in pieces if isinstance(piece, Arc)]
    total = Moments(0.0)
    if lines:
        total = total + _added(_triangles(*_columns(lines)))
    if arcs:
        total = total + _arc_sectors(*_columns(arcs))
    return total


_remembered = lru_cache(maxsize=256)(_boundary)


def _enclosed_mm2(pieces: tuple[Line | Arc, ...]) -> Numbers:
    """Return the area of ``_boundary`` alone: the same terms in the same order, a fifth of the work."""
    lines = [_numbers(piece) for piece in pieces if isinstance(piece, Line)]
    arcs = [_numbers(piece) for piece in pieces if isinstance(piece, Arc)]
    total: Numbers = 0.0
    if lines:
        total = total + reduce(np.add, _twice_mm2(*_columns(lines)) / 2.0)
    if arcs:
        x, y, r, start, end = _columns(arcs)
        sectors = r * r * (end - start) / 2.0
        towards = _twice_mm2(x + r * np.cos(start), y + r * np.sin(start), x, y) / 2.0
        away = _twice_mm2(x, y, x + r * np.cos(end), y + r * np.sin(end)) / 2.0
        total = total + (reduce(np.add, sectors) + reduce(np.add, towards) + reduce(np.add, away))
    return total


def _columns(rows: Sequence[tuple[Numbers, ...]]) -> Floats:
    """Return the columns of a table of numbers, each of shape (pieces, ...)."""
    shape = next((value.shape for row in rows for value in row if isinstance(value, np.ndarray) and value.ndim), ())
    table = np.empty((len(rows[0]), len(rows), *shape))
    for piece, row in enumerate(rows):
        for column, value in enumerate(row):
            table[column, piece] = value
    return table


def _added(moments: Moments) -> Moments:
    """Sum over the pieces, term by term, because the order of NumPy's own sum depends on the shape."""
    return Moments(*(reduce(np.add, getattr(moments, each.name))[()] for each in fields(moments)))


def _twice_mm2(x0: Floats, y0: Floats, x1: Floats, y1: Floats) -> Floats:
    """Return twice the areas of triangles between the origin and straight lines."""
    return x0 * y1 - x1 * y0


def _triangles(x0: Floats, y0: Floats, x1: Floats, y1: Floats) -> Moments:
    """Return the triangles between the origin and straight lines, one row per line."""
    twice = _twice_mm2(x0, y0, x1, y1)
    return Moments(
        twice / 2.0,
        (x0 + x1) * twice / 6.0,
        (y0 + y1) * twice / 6.0,
        (x0 * x0 + x0 * x1 + x1 * x1) * twice / 12.0,
        (y0 * y0 + y0 * y1 + y1 * y1) * twice / 12.0,
        (x0 * (2.0 * y0 + y1) + x1 * (y0 + 2.0 * y1)) * twice / 24.0,
    )


def _arc_sectors(x: Floats, y: Floats, r: Floats, start: Floats, end: Floats) -> Moments:
    """Return what arcs span with the origin: sectors around their centres, and two triangles from each to it."""
    cos0, sin0, cos1, sin1 = np.cos(start), np.sin(start), np.cos(end), np.sin(end)
    turn, wave = end - start, sin1 * cos1 - sin0 * cos0
    r2, r3, r4 = r * r, r**3, r**4
    sector = Moments(
        r2 * turn / 2.0,
        r3 * (sin1 - sin0) / 3.0,
        r3 * (cos0 - cos1) / 3.0,
        r4 * (turn + wave) / 8.0,
        r4 * (turn - wave) / 8.0,
        r4 * (sin1 * sin1 - sin0 * sin0) / 8.0,
    ).moved(x, y)
    towards = _triangles(x + r * cos0, y + r * sin0, x, y)
    away = _triangles(x, y, x + r * cos1, y + r * sin1)
    return _added(sector) + _added(towards) + _added(away)


def rectangle(*, width_mm: Numbers, height_mm: Numbers, x_mm: Numbers = 0.0, y_mm: Numbers = 0.0) -> Path:
    """Return a rectangle centred at (x_mm, y_mm)."""
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
    """Return the convex hull of two discs: the outline of a link or a slot.

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
