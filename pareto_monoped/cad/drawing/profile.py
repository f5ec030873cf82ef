"""The half section of a round part, and the faces that its dimensions are taken from.

Coordinates of a profile are z along the axis and the radius r, in millimetres.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

import shapely
from shapely.geometry import MultiPolygon, Polygon, box
from shapely.geometry.base import BaseGeometry

from pareto_monoped.geometry.features import Bevel
from pareto_monoped.geometry.gears import ExternalGear, InternalGear
from pareto_monoped.geometry.parts import Part, Prism
from pareto_monoped.geometry.shapes import Circle, Pattern, Shape

_SAME_MM = 1e-6
_ASIDE_MM = 1e-3  # how far beside a point the material is looked for


@dataclass(frozen=True, slots=True, kw_only=True)
class Cylinder:
    """A cylindrical face: radius, ends, and whether the material lies inside it (a shaft) or outside (a bore)."""

    radius: float
    low: float
    high: float
    shaft: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class Face:
    """A flat face across the axis, from one radius to another; ``up`` if it looks towards greater z."""

    z: float
    inner: float
    outer: float
    up: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class Taper:
    """A conical face between two points: chamfers and lead-ins."""

    z0: float
    r0: float
    z1: float
    r1: float

    @property
    def along(self) -> float:
        """Its length along the axis."""
        return abs(self.z1 - self.z0)

    @property
    def across(self) -> float:
        """Its width across the axis."""
        return abs(self.r1 - self.r0)


@dataclass(frozen=True, slots=True, kw_only=True)
class Teeth:
    """Where a gear's teeth stand, and whether they bound a hole: that of a ring, or for a splined shaft."""

    gear: ExternalGear | InternalGear
    low: float
    high: float
    hole: bool


def is_round(part: Part) -> bool:
    """Return whether a part is turned about its z axis, apart from teeth and round holes."""
    if part.balls or not part.prisms:
        return False
    shapes = [shape for prism in part.prisms for shape in (prism.outline, *prism.holes)]
    known = all(isinstance(shape, Circle | Pattern | ExternalGear | InternalGear) for shape in shapes)
    return all(_on_axis(prism.outline) for prism in part.prisms) and known


def half_section(part: Part) -> BaseGeometry:
    """Return the material of a round part in the half plane, without holes off the axis; teeth reach to their tips."""
    body = shapely.union_all([ring for prism in part.prisms for ring in _rings(prism)])
    cones = [bevel for bevel in part.bevels if _on_axis(bevel.at)]
    cut = [_triangle(bevel) for bevel in cones if _takes(bevel)]
    added = [_triangle(bevel) for bevel in cones if not _takes(bevel)]
    if cut:
        body = body.difference(shapely.union_all(cut))
    if added:
        body = body.union(shapely.union_all(added))
    return body.simplify(_SAME_MM)


def teeth_of(part: Part) -> tuple[Teeth, ...]:
    """Return the gears of a part, each from end to end."""
    found: dict[tuple[ExternalGear | InternalGear, bool], list[Prism]] = {}
    for prism in part.prisms:
        for shape, hole in ((prism.outline, False), *((inner, True) for inner in prism.holes)):
            if isinstance(shape, ExternalGear | InternalGear):
                found.setdefault((shape, hole), []).append(prism)
    return tuple(
        Teeth(gear=gear, low=min(float(p.z0_mm) for p in prisms), high=max(float(p.z1_mm) for p in prisms), hole=hole)
        for (gear, hole), prisms in found.items()
    )


def cylinders(body: BaseGeometry) -> tuple[Cylinder, ...]:
    """Return the cylindrical faces, from below; faces of one radius that a gap divides stay apart."""
    found = [
        Cylinder(radius=r0, low=min(z0, z1), high=max(z0, z1), shaft=_inside(body, 0.5 * (z0 + z1), r0 - _ASIDE_MM))
        for z0, r0, z1, r1 in edges(body)
        if abs(r0 - r1) < _SAME_MM and r0 > _SAME_MM
    ]
    return tuple(sorted(found, key=lambda c: (c.low, c.radius)))


def faces(body: BaseGeometry) -> tuple[Face, ...]:
    """Return the flat faces, from below."""
    found = [
        Face(z=z0, inner=min(r0, r1), outer=max(r0, r1), up=_inside(body, z0 - _ASIDE_MM, 0.5 * (r0 + r1)))
        for z0, r0, z1, r1 in edges(body)
        if abs(z0 - z1) < _SAME_MM
    ]
    return tuple(sorted(found, key=lambda f: (f.z, f.inner)))


def tapers(body: BaseGeometry) -> tuple[Taper, ...]:
    """Return the conical faces."""
    return tuple(
        Taper(z0=z0, r0=r0, z1=z1, r1=r1)
        for z0, r0, z1, r1 in edges(body)
        if abs(z0 - z1) >= _SAME_MM and abs(r0 - r1) >= _SAME_MM
    )


def edges(body: BaseGeometry) -> Iterator[tuple[float, float, float, float]]:
    """Yield the straight edges of a profile: z and r of both ends."""
    for polygon in polygons(body):
        for ring in (polygon.exterior, *polygon.interiors):
            for (z0, r0), (z1, r1) in pairwise(ring.coords):
                yield z0, r0, z1, r1


def polygons(body: BaseGeometry) -> tuple[Polygon, ...]:
    """Return the regions of a profile."""
    if isinstance(body, MultiPolygon):
        return tuple(body.geoms)
    return (body,) if isinstance(body, Polygon) and not body.is_empty else ()


def free(body: BaseGeometry, z0: float, z1: float, r: float) -> bool:
    """Return whether a line along the axis from ``z0`` to ``z1`` at radius ``r`` meets material at most at its skin."""
    low, high = min(z0, z1) + _ASIDE_MM, max(z0, z1) - _ASIDE_MM
    if high <= low:
        return True
    thin = box(low, r - 0.5 * _ASIDE_MM, high, r + 0.5 * _ASIDE_MM)
    # A surface at this very radius fills half of the thin box.
    return bool(thin.intersection(body).area <= 0.6 * thin.area)


def seen(body: BaseGeometry, r: float, *, from_above: bool) -> float | None:
    """Return height of the first material that a viewer along the axis meets at a radius; None for an opening."""
    low, _, high, _ = body.bounds
    hit = shapely.intersection(body, shapely.linestrings([(low - 1.0, r), (high + 1.0, r)]))
    return None if hit.is_empty else float(hit.bounds[2 if from_above else 0])


def visible_circles(body: BaseGeometry, *, from_above: bool) -> tuple[float, ...]:
    """Return radii of the edges that a viewer along the axis sees."""
    found = []
    for r in sorted({round(r, 6) for _, r, _, _ in edges(body) if r > _SAME_MM}):
        inner = [seen(body, r - k * _ASIDE_MM, from_above=from_above) for k in (1, 2)]
        outer = [seen(body, r + k * _ASIDE_MM, from_above=from_above) for k in (1, 2)]
        if not _continues(inner, outer):
            found.append(r)
    return tuple(found)


def _continues(inner: list[float | None], outer: list[float | None]) -> bool:
    """Return whether a surface goes on without an edge, from heights at one and two steps on either side."""
    if any(z is None for z in (*inner, *outer)):
        return all(z is None for z in (*inner, *outer))
    near, far, other_near, other_far = (float(z) for z in (*inner, *outer) if z is not None)
    slope, other_slope = near - far, other_far - other_near
    return abs(other_near - near - 2.0 * slope) < 0.1 * _ASIDE_MM and abs(slope - other_slope) < 0.1 * _ASIDE_MM


def _on_axis(shape: Shape) -> bool:
    if isinstance(shape, ExternalGear | InternalGear):
        return True
    return isinstance(shape, Circle) and abs(float(shape.x_mm)) < _SAME_MM and abs(float(shape.y_mm)) < _SAME_MM


def _rings(prism: Prism) -> Iterator[Polygon]:
    """Yield the prism's material in the half plane: between its central hole and its outline."""
    bores = [_reach(hole) for hole in prism.holes if _on_axis(hole)]
    yield box(float(prism.z0_mm), max(bores, default=0.0), float(prism.z1_mm), _reach(prism.outline))


def _reach(shape: Shape) -> float:
    if isinstance(shape, ExternalGear | InternalGear):
        return float(shape.tip_radius_mm)
    assert isinstance(shape, Circle)
    return float(shape.radius_mm)


def _triangle(bevel: Bevel) -> Polygon:
    radius, edge = float(bevel.at.radius_mm), float(bevel.edge_mm)
    face, end = float(bevel.face_mm), float(bevel.end_mm)
    return Polygon([(face, radius), (face, edge), (end, radius)])


def _takes(bevel: Bevel) -> bool:
    return bevel.hole or float(bevel.edge_mm) < float(bevel.at.radius_mm)


def _inside(body: BaseGeometry, z: float, r: float) -> bool:
    return bool(shapely.contains_xy(body, z, r))
