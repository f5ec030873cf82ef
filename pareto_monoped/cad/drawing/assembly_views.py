"""The assembly from its side, or cut along the leg with straight joints, from the parts' meshes; balloons of items.

Balloons stand in a column on either side of a view, each with a leader to its part (ISO 6433). On exploded views a
leader crosses no other part: where it begins on its part, and on which side its balloon stands, are chosen by exchanges
that lower the number of crossings until none does.
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import manifold3d as m3
import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry.base import BaseGeometry

from pareto_monoped.cad.assembly import Pose, body_frames
from pareto_monoped.cad.drawing.bores import number
from pareto_monoped.cad.drawing.dimension import GAP_MM, OVERSHOOT_MM, spread
from pareto_monoped.cad.drawing.paper import NARROW_MM, Paper
from pareto_monoped.cad.drawing.profile import polygons
from pareto_monoped.cad.drawing.section import hatch
from pareto_monoped.cad.drawing.sheet import scale_text
from pareto_monoped.cad.product import Product
from pareto_monoped.cad.shape.meshes import placed
from pareto_monoped.geometry.roles import SCREWS, Role, Visibility

Floats = NDArray[np.float64]

_LEAST_MM2 = 0.3  # smaller visible areas on paper are not drawn
_NOT_CUT = SCREWS | {Role.BOLT, Role.PIN, Role.SHAFT, Role.ROD}
"""Parts that are drawn uncut where the plane runs along them (ISO 128-3)."""
# Rows: right, up and towards the viewer of each view, in the assembly's frame.
_FROM_RIGHT = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]])
FROM_LEFT = np.array([[-1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0]])
FROM_FRONT = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]])
FROM_FRONT_LYING = np.array([[0.0, 0.0, -1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]])
"""The same turned by a right angle: the joints' axes are upright, the leg points to the right."""

_OVERALL_MM = 7.0  # from a view to its overall dimensions
_CAPTION_MM = 3.5  # height of the names of views
BALLOON_MM = 4.0  #: Radius of an item's balloon.
_PITCH_MM = 9.5
_TEXT_MM = 2.5
_COLUMN_MM = 14.0
_RIM_MM = 3.0  # how far within a part's edge a leader may end (our own choice)
_PLACES = 2
"""Along a part at which a leader may end: at its ends. Five take three times as long and leave as many crossings."""
_CROSSING_MM = 1000.0  # length of leader that one crossing less is worth (our own choice: more than any leader has)
_ROUNDS = 4

Point = tuple[float, float]
Box = tuple[float, float, float, float]


@dataclass(frozen=True, slots=True, kw_only=True)
class Seen:
    """A part's instance in a view: its visible region on the view's plane in millimetres, and its item."""

    item: int
    region: BaseGeometry
    cut: bool


def side_view(product: Product) -> list[Seen]:
    """Return the visible regions of the robot in its pose, seen from the right, the nearest first."""
    shown = []
    for (instance, unique), item in zip(product.placed(), product.kinds, strict=True):
        if instance.part.visibility is Visibility.INSIDE:
            continue
        body = placed(unique.mesh.body, to_view(_FROM_RIGHT) @ instance.world)
        shown.append((body.bounding_box()[5], item, body))
    found = []
    covered: BaseGeometry = shapely.Polygon()
    for _, item, body in sorted(shown, key=lambda entry: -entry[0]):
        region = outline_of(body.project())
        visible = region.difference(covered)
        if not visible.is_empty:
            found.append(Seen(item=item, region=visible, cut=False))
            covered = covered.union(region)
    return found


def leg_section(product: Product) -> list[Seen]:
    """Return regions of the robot with straight joints on the plane through all joint axes, seen from the front."""
    frames = body_frames(product.robot, Pose(hip_rad=0.0, knee_rad=0.0))
    found = []
    for (instance, unique), item in zip(product.placed(), product.kinds, strict=True):
        body = placed(unique.mesh.body, to_view(FROM_FRONT) @ frames[instance.body] @ instance.in_body)
        low, high = body.bounding_box()[2], body.bounding_box()[5]
        if low >= 0.0 or high <= 0.0:
            continue
        region = outline_of(body.slice(0.0))
        if not region.is_empty:
            found.append(Seen(item=item, region=region, cut=instance.part.role not in _NOT_CUT))
    return found


def drawn(seen: Sequence[Seen], scale: float) -> Paper:
    """Return the regions on paper, cut ones hatched, neighbouring parts in different directions."""
    paper = Paper()
    for one in seen:
        region = shapely.transform(one.region, lambda points: points * scale)
        for polygon in polygons(region):
            if polygon.area < _LEAST_MM2:
                continue
            for ring in (polygon.exterior, *polygon.interiors):
                width = NARROW_MM if polygon.area < 20.0 * _LEAST_MM2 else 0.35
                paper.line(list(ring.simplify(0.02).coords)[:-1], width_mm=width, closed=True)
        if one.cut:
            hatch(paper, region, falling=one.item % 2 == 1)
    return paper


def overall(paper: Paper, extent: Box, scale: float, *, high: bool) -> None:
    """Dimension how wide a view is, and how high if asked, beyond its balloons; ``extent`` is its box without them."""
    (left, low, right, top), (outer, floor, _, _) = extent, paper.box()
    y, x = floor - _OVERALL_MM, outer - _OVERALL_MM
    for at, way in ((left, -1.0), (right, 1.0)):
        paper.line([(at, floor - GAP_MM), (at, y - OVERSHOOT_MM)])
        paper.arrow(at, y, (way, 0.0))
    paper.line([(left, y), (right, y)])
    paper.text(number(round((right - left) / scale, 1)), 0.5 * (left + right), y + 1.0, align="centre")
    if not high:
        return
    for at, way in ((low, -1.0), (top, 1.0)):
        paper.line([(outer - GAP_MM, at), (x - OVERSHOOT_MM, at)])
        paper.arrow(x, at, (0.0, way))
    paper.line([(x, low), (x, top)])
    paper.text(number(round((top - low) / scale, 1)), x - 1.0, 0.5 * (low + top), align="centre", upward=True)


def within(seen: Sequence[Seen], low_mm: float, high_mm: float) -> list[Seen]:
    """Return the regions of a view between two heights."""
    band = shapely.box(-1e5, low_mm, 1e5, high_mm)
    clipped = [replace(one, region=one.region.intersection(band)) for one in seen]
    return [one for one in clipped if not one.region.is_empty]


def areas(seen: Sequence[Seen]) -> dict[int, float]:
    """Return the largest visible region of each item in mm2 of the robot."""
    found: dict[int, float] = {}
    for one in seen:
        found[one.item] = max(found.get(one.item, 0.0), max((p.area for p in polygons(one.region)), default=0.0))
    return found


def to_view(axes: Floats) -> Floats:
    """Return the matrix from the assembly's frame to a view's."""
    matrix = np.eye(4)
    matrix[:3, :3] = axes
    return matrix


def outline_of(section: m3.CrossSection) -> BaseGeometry:
    """Return a region of the plane as a Shapely geometry."""
    rings = [np.asarray(ring) for ring in section.to_polygons() if len(ring) > 2]
    # Manifold gives outer boundaries anticlockwise and holes clockwise; even-odd filling needs no order.
    region: BaseGeometry = shapely.Polygon()
    for ring in sorted((shapely.Polygon(ring).buffer(0.0) for ring in rings), key=lambda area: -area.area):
        region = region.symmetric_difference(ring)
    return region


def captioned(paper: Paper, name: str, scale: float) -> Paper:
    """Return a finished view with its name and scale over it, and its middle, without these, at y = 0."""
    left, low, right, high = paper.box()
    paper.text(f"{name}, {scale_text(scale)}", 0.5 * (left + right), high + 6.0, height_mm=_CAPTION_MM, align="centre")
    centred = Paper()
    centred.lay(paper, 0.0, -0.5 * (low + high))
    return centred


@dataclass(frozen=True, slots=True, kw_only=True)
class _End:
    """Where a leader ends on its part, and whether its balloon stands in the right column."""

    tip: Point
    to_right: bool


def balloons(paper: Paper, seen: Sequence[Seen], scale: float, items: Sequence[int]) -> None:
    """Draw balloons of a dense view: leaders into the largest visible region of their parts, none crosses another."""
    points = {}
    for item in items:
        region = max((p for one in seen if one.item == item for p in polygons(one.region)), key=lambda p: p.area)
        point = region.representative_point()
        points[item] = (point.x * scale, point.y * scale)
    ends = {}
    for rank, item in enumerate(sorted(points, key=lambda item: (points[item][0], item))):
        ends[item] = _End(tip=points[item], to_right=2 * rank >= len(points))
    _draw(paper, _placed(ends, _columns(paper)), ends)


def clear_balloons(paper: Paper, seen: Sequence[Seen], scale: float) -> None:
    """Draw balloons of an exploded view, one per region, with leaders that cross no other part if there is a way."""
    regions = {one.item: shapely.affinity.scale(one.region, scale, scale, origin=(0.0, 0.0)) for one in seen}
    choices = {item: list(_ends(region)) for item, region in regions.items()}
    columns = _columns(paper)
    middle = 0.5 * sum(columns)

    def away(end: _End) -> float:
        return abs(columns[end.to_right] - end.tip[0])

    ends = {item: min(found, key=away) for item, found in choices.items()}
    tree, order = shapely.STRtree(list(regions.values())), list(regions)
    cost = _cost(ends, columns, tree, order)
    for _ in range(_ROUNDS):
        before = cost
        crossing = set(_hits(ends, columns, tree, order)[0])
        for item in sorted(crossing, key=lambda item: abs(ends[item].tip[0] - middle)):
            for end in choices[item]:
                changed = ends | {item: end}
                lower = _cost(changed, columns, tree, order)
                if lower < cost - 1e-9:
                    ends, cost = changed, lower
        if cost == before:
            break
    _draw(paper, _placed(ends, columns), ends)


def _columns(paper: Paper) -> tuple[float, float]:
    left, _, right, _ = paper.box()
    return left - _COLUMN_MM, right + _COLUMN_MM


def _ends(region: BaseGeometry) -> Iterator[_End]:
    """Yield places within a part at its left and its right end, in the middle, above and below."""
    left, low, right, high = region.bounds
    rim = min(_RIM_MM, 0.5 * (right - left))
    for start in np.linspace(left, right - rim, _PLACES):
        band = region.intersection(shapely.box(start, low, start + rim, high))
        if band.area == 0.0:
            continue  # between two instances
        near = max(shapely.get_parts(band), key=shapely.area)
        x0, y0, x1, y1 = near.bounds
        third = (y1 - y0) / 3.0
        for part in (near, *(near.intersection(shapely.box(x0, y, x1, y + third)) for y in (y0, y1 - third))):
            if part.area > 0.0:
                point = part.representative_point()
                yield from (_End(tip=(point.x, point.y), to_right=to_right) for to_right in (False, True))


def _placed(ends: Mapping[int, _End], columns: tuple[float, float]) -> dict[int, Point]:
    """Return the middle of every balloon, near the height of its leader's end; no leaders cross."""
    found: dict[int, Point] = {}
    for to_right, x in zip((False, True), columns, strict=True):
        tips = {item: end.tip for item, end in ends.items() if end.to_right is to_right}
        order = sorted(tips, key=lambda item: (tips[item][1], item))
        heights = spread([tips[item][1] for item in order], _PITCH_MM)
        for item, y in zip(_uncrossed(order, heights, x, tips), heights, strict=True):
            found[item] = (x, y)
    return found


def _hits(
    ends: Mapping[int, _End], columns: tuple[float, float], tree: shapely.STRtree, order: Sequence[int]
) -> tuple[list[int], float]:
    """Return the items whose leaders cross other parts, once per crossing, and the length of all leaders."""
    placed = _placed(ends, columns)
    lines = shapely.linestrings([[placed[item], ends[item].tip] for item in order])
    own, other = tree.query(lines, predicate="intersects")
    return [order[k] for k in own[own != other].tolist()], float(shapely.length(lines).sum())


def _cost(ends: Mapping[int, _End], columns: tuple[float, float], tree: shapely.STRtree, order: Sequence[int]) -> float:
    crossings, length = _hits(ends, columns, tree, order)
    return _CROSSING_MM * len(crossings) + length


def _draw(paper: Paper, placed: Mapping[int, Point], ends: Mapping[int, _End]) -> None:
    for item, at in placed.items():
        _balloon(paper, item, at, ends[item].tip)


def _uncrossed(order: Sequence[int], heights: Sequence[float], x: float, points: Mapping[int, Point]) -> list[int]:
    """Return items in an order in which no two leaders cross: exchanges of two that shorten them, until none does."""
    items = list(order)

    def long(k: int, item: int) -> float:
        return math.hypot(points[item][0] - x, points[item][1] - heights[k])

    shorter = True
    while shorter:
        shorter = False
        for a in range(len(items)):
            for b in range(a + 1, len(items)):
                now = long(a, items[a]) + long(b, items[b])
                if long(a, items[b]) + long(b, items[a]) < now - 1e-9:
                    items[a], items[b] = items[b], items[a]
                    shorter = True
    return items


def _balloon(paper: Paper, item: int, at: Point, tip: Point) -> None:
    """Draw an item's number in a circle, with a leader that ends in a dot within the part."""
    way = np.array(tip) - np.array(at)
    start = np.array(at) + way / np.hypot(*way) * BALLOON_MM
    paper.circle(*at, BALLOON_MM, width_mm=0.35)
    paper.text(f"{item + 1}", at[0], at[1] - 0.5 * _TEXT_MM, height_mm=_TEXT_MM, align="centre")
    paper.line([tuple(start), tip])
    angles = np.linspace(0.0, 2.0 * np.pi, 9)[:-1]
    dot = np.stack([tip[0] + 0.5 * np.cos(angles), tip[1] + 0.5 * np.sin(angles)], axis=1)
    paper.fill(dot)
