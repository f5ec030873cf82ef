"""The view of a part with layers from above, and its section: edges, numbered nodes, lettered holes."""

from collections.abc import Sequence

import numpy as np
import shapely
from shapely.geometry import box
from shapely.geometry.base import BaseGeometry

from pareto_monoped.cad.drawing.bores import Bore, number
from pareto_monoped.cad.drawing.dimension import Mark, ladder
from pareto_monoped.cad.drawing.end_view import draw_bore
from pareto_monoped.cad.drawing.paper import DASHED, LETTER_MM, NARROW_MM, WIDE_MM, Paper
from pareto_monoped.cad.drawing.placing import Tag
from pareto_monoped.cad.drawing.plan import Plan, cut_along, is_square, nodes
from pareto_monoped.cad.drawing.profile import polygons
from pareto_monoped.cad.drawing.section import hatch
from pareto_monoped.cad.shape.curves import Contour, polygon

_NODE_MM = 1.8
"""Height of the numbers of nodes (ISO 3098-1, the smallest size)."""
_LADDER_MM = 6.0
_DEPTH_MM = 18.0
"""How far a ladder of lengths may reach below where it begins: ten digits."""
_LETTER = "A"
_AXIS_MM = 9.0
"""Length of the arrows of the origin's axes."""
_SAME_MM = 1e-6


def plan_view(plan: Plan, scale: float) -> Paper:
    """The view from above without names; the plan's origin stands at (0, 0).

    Args:
        plan: to draw.
        scale: paper over part.
    """
    paper = Paper()
    above: BaseGeometry = shapely.Polygon()
    for layer in plan.layers:
        area = layer.area()
        for contour in (layer.outline, *layer.holes):
            _edge(paper, contour, above, scale)
        above = above.union(area)
    for bore in plan.bores:
        draw_bore(paper, bore, scale, visible=_seen(plan, bore), from_above=True)
    x0, y0 = (scale * v for v in plan.bounds[:2])
    if _has_ladders(plan):
        xs, ys = _square_values(plan)
        ladder(paper, _marks(xs, y0, scale), "below", y0 - _LADDER_MM, origin=0.0)
        ladder(paper, _marks(ys, x0, scale), "left", x0 - _LADDER_MM, origin=0.0)
    for way in ((_AXIS_MM, 0.0), (0.0, _AXIS_MM)):
        paper.line([(0.0, 0.0), way], width_mm=0.35)
        paper.arrow(*way, way)
    return paper


def axis_tags(scale: float) -> list[Tag]:
    """The names of the axes of the tables' coordinates, at the tips of their arrows."""
    tip = _AXIS_MM / scale
    return [
        Tag(text=name, x=x, y=y, radius=0.0, height_mm=LETTER_MM) for name, x, y in (("X", tip, 0.0), ("Y", 0.0, tip))
    ]


def section_place(plan: Plan) -> float:
    """Where the section is taken: through the axis of the largest round hole, or the middle."""
    x0, _, x1, _ = plan.bounds
    wide = max((bore for bore in plan.bores), key=lambda bore: bore.radius, default=None)
    return wide.centres[0][0] if wide is not None else 0.5 * (x0 + x1)


def section_marks(paper: Paper, plan: Plan, scale: float) -> None:
    """Where the section is taken, on the view from above: the ends of its plane with arrows, and its letter."""
    x, (_, low, _, high) = section_place(plan) * scale, plan.bounds
    floor = low * scale - (_LADDER_MM + _DEPTH_MM if _has_ladders(plan) else 2.0)
    for y, outwards in ((high * scale + 2.0, 1.0), (floor, -1.0)):
        paper.line([(x, y), (x, y + outwards * 6.0)], width_mm=WIDE_MM)
        paper.line([(x - 7.0, y + outwards * 5.0), (x, y + outwards * 5.0)])
        paper.arrow(x, y + outwards * 5.0, (1.0, 0.0))
        paper.text(_LETTER, x - 8.0, y + outwards * 5.0 - 1.75, height_mm=3.5, align="right")


def section_at(plan: Plan, scale: float) -> Paper:
    """The section across the sheet, seen from the left."""
    x = section_place(plan)
    paper = Paper()
    area = shapely.transform(cut_along(plan, x), lambda points: points * scale)
    behind = []
    for layer in plan.layers:
        far = layer.area().intersection(box(x, -1e4, 1e4, 1e4))
        for piece in shapely.get_parts(far):
            if piece.is_empty:
                continue
            _, low, _, high = piece.bounds
            behind.append(
                (float(piece.bounds[0]), box(layer.low * scale, low * scale, layer.high * scale, high * scale))
            )
    covered = area
    for _, silhouette in sorted(behind, key=lambda entry: entry[0]):
        _lines(paper, silhouette.boundary.difference(covered.buffer(-1e-6)), WIDE_MM)
        _lines(paper, silhouette.boundary.intersection(covered.buffer(-1e-6)), NARROW_MM, DASHED)
        covered = covered.union(silhouette)
    for region in polygons(area):
        for ring in (region.exterior, *region.interiors):
            paper.line(list(ring.coords)[:-1], width_mm=WIDE_MM, closed=True)
    hatch(paper, area)
    low_y = scale * plan.bounds[1]
    spans = [*((layer.low, layer.high) for layer in plan.layers), *((bore.low, bore.high) for bore in plan.bores)]
    heights = sorted({round(z, 3) for span in spans for z in span})
    marks = [Mark(at=z * scale, start=low_y, text=number(z - plan.low)) for z in heights]
    ladder(paper, marks, "below", low_y - _LADDER_MM, origin=plan.low * scale)
    middle, top = 0.5 * (plan.low + plan.high) * scale, scale * plan.bounds[3]
    paper.text(f"{_LETTER}-{_LETTER}", middle, top + 5.0, height_mm=3.5, align="centre")
    return paper


def _has_ladders(plan: Plan) -> bool:
    return any(is_square(layer.outline) for layer in plan.layers)


def _square_values(plan: Plan) -> tuple[list[float], list[float]]:
    """Distinct x and y of the nodes of outlines whose edges lie along the sheet."""
    points = np.array([point for layer in plan.layers if is_square(layer.outline) for point, _ in nodes(layer.outline)])
    x, y = (sorted({round(float(v), 3) for v in points[:, k]}) for k in (0, 1))
    return x, y


def _marks(values: Sequence[float], start: float, scale: float) -> list[Mark]:
    marks = [Mark(at=v * scale, start=start, text=number(v)) for v in values]
    if not any(abs(v) < _SAME_MM for v in values):
        marks.append(Mark(at=0.0, start=start, text="0"))
    return marks


def _edge(paper: Paper, contour: Contour, above: BaseGeometry, scale: float) -> None:
    """A contour: wide where it is seen, dashed below other layers."""
    ring = shapely.LinearRing(polygon(contour, 0.01 / scale))
    if above.is_empty:
        paper.line(np.asarray(ring.coords)[:-1] * scale, width_mm=WIDE_MM, closed=True)
        return
    inside = above.buffer(-1e-4)
    for part, width, dashes in (
        (ring.difference(inside), WIDE_MM, ()),
        (ring.intersection(inside), NARROW_MM, DASHED),
    ):
        _lines(paper, shapely.transform(part, lambda points: points * scale), width, dashes)


def _lines(paper: Paper, shape: BaseGeometry, width: float, dashes: tuple[float, ...] = ()) -> None:
    merged = shapely.line_merge(shape) if shape.geom_type == "MultiLineString" else shape
    for piece in shapely.get_parts(merged):
        if piece.geom_type in ("LineString", "LinearRing") and piece.length > 0.02:
            paper.line(list(piece.coords), width_mm=width, dashes=dashes)


def _seen(plan: Plan, bore: Bore) -> bool:
    """Whether no material stands above the mouth of a hole, or the hole is seen through a wider one."""
    x, y = bore.centres[0]
    covering = [
        layer for layer in plan.layers if layer.low > bore.high - _SAME_MM and shapely.contains_xy(layer.area(), x, y)
    ]
    wider = any(
        other.centres == bore.centres and other.radius > bore.radius and other.low > bore.high - _SAME_MM
        for other in plan.bores
    )
    return not covering or wider


def node_tag(text: str, point: np.ndarray) -> Tag:
    """The number of a node."""
    return Tag(text=text, x=float(point[0]), y=float(point[1]), radius=0.0, height_mm=_NODE_MM)


def hole_tag(text: str, bore: Bore, index: int) -> Tag:
    """The name of a hole."""
    x, y = bore.centres[index]
    return Tag(text=text, x=x, y=y, radius=bore.radius, height_mm=LETTER_MM)


def shape_tag(text: str, x: float, y: float, radius: float = 0.0) -> Tag:
    """The name of a window, or of a boss of some radius."""
    return Tag(text=text, x=x, y=y, radius=radius, height_mm=LETTER_MM)
