"""The sheet of a part with layers: view from above, section, tables of holes and of contours.

The views have edges, numbered nodes and lettered holes.
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from string import ascii_uppercase

import numpy as np
import shapely
from shapely.geometry import box
from shapely.geometry.base import BaseGeometry

from pareto_monoped.cad.drawing.bores import Bore, chamfer_text, number
from pareto_monoped.cad.drawing.data_tables import fit_table
from pareto_monoped.cad.drawing.dimension import (
    DATUM,
    FRAME_MM,
    SECOND,
    Mark,
    Tag,
    datum,
    datum_fit,
    ladder,
    place_tags,
)
from pareto_monoped.cad.drawing.end_view import draw_bore
from pareto_monoped.cad.drawing.paper import DASHED, LETTER_MM, NARROW_MM, TIMES, WIDE_MM, Paper
from pareto_monoped.cad.drawing.plan import Layer, Plan, cut_along, is_square, nodes, repeats, rounded_rectangle
from pareto_monoped.cad.drawing.profile import polygons
from pareto_monoped.cad.drawing.section import hatch
from pareto_monoped.cad.drawing.sheet import SCALES, scale_text, table
from pareto_monoped.cad.shape.outlines import Contour, polygon
from pareto_monoped.geometry.features import ShaftEnd
from pareto_monoped.geometry.making import Fit
from pareto_monoped.geometry.parts import Part
from pareto_monoped.geometry.shapes import Arc, Pattern

_NODE_MM = 1.8  # height of the numbers of nodes (ISO 3098-1, the smallest size)
_LADDER_MM = 6.0
_DEPTH_MM = 18.0  # how far a ladder of lengths may reach below where it begins: ten digits
_LETTER = "S"  # of the section, and of no datum
_AXIS_MM = 9.0  # length of the arrows of the origin's axes
_SAME_MM = 1e-6
_DETAIL = "Z"
_UNREADABLE = "IORSW"  # letters like figures, and those of bosses, section and windows
_NEAR_MM, _MANY = 4.0, 8
"""Holes with less than twice this distance on paper stand close together; so many of them make a detail view."""
_WIDE_MM = 120.0  # width of a detail
_APART_MM = 8.0  # from a view to its detail
_ROWS = 34  # rows of a table before it goes on beside itself

Circle = tuple[float, float, float]  #: x and y of its centre, and its radius


def plan_view(plan: Plan, scale: float) -> Paper:
    """Return the view from above without names; the plan's origin stands at (0, 0)."""
    paper = Paper()
    above: BaseGeometry = shapely.Polygon()
    for layer in plan.layers:
        for contour in (layer.outline, *layer.holes):
            _edge(paper, contour, above, scale)
        above = above.union(layer.area())
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
    """Return the names of the axes of the tables' coordinates, at the tips of their arrows."""
    tip = _AXIS_MM / scale
    return [_tag(name, x, y) for name, x, y in (("X", tip, 0.0), ("Y", 0.0, tip))]


def section_place(plan: Plan) -> float:
    """Return where the section is taken: through the axis of the largest round hole or else boss, or the middle."""
    x0, _, x1, _ = plan.bounds
    if plan.bores:
        return max(plan.bores, key=lambda bore: bore.radius).centres[0][0]
    bosses = [layer.outline.circle for layer in plan.layers if layer.outline.circle is not None]
    return max(((c.radius_mm, float(c.x_mm)) for c in bosses), default=(0.0, 0.5 * (x0 + x1)))[1]


def section_marks(paper: Paper, plan: Plan, scale: float) -> None:
    """Mark where the section is taken, on the view from above: the ends of its plane with arrows, and its letter."""
    x, (_, low, _, high) = section_place(plan) * scale, plan.bounds
    floor = low * scale - (_LADDER_MM + _DEPTH_MM if _has_ladders(plan) else 2.0)
    for y, outwards in ((high * scale + 2.0, 1.0), (floor, -1.0)):
        paper.line([(x, y), (x, y + outwards * 6.0)], width_mm=WIDE_MM)
        paper.line([(x - 7.0, y + outwards * 5.0), (x, y + outwards * 5.0)])
        paper.arrow(x, y + outwards * 5.0, (1.0, 0.0))
        paper.text(_LETTER, x - 8.0, y + outwards * 5.0 - 1.75, height_mm=3.5, align="right")


def section_at(plan: Plan, scale: float) -> Paper:
    """Return the section across the sheet, seen from the left."""
    x = section_place(plan)
    paper = Paper()
    area = shapely.transform(cut_along(plan, x), lambda points: points * scale)
    behind = []
    for layer in plan.layers:
        far = layer.area().intersection(box(x, -1e4, 1e4, 1e4))
        for piece in shapely.get_parts(far):
            if piece.is_empty:
                continue
            x0, low, _, high = piece.bounds
            behind.append((float(x0), box(layer.low * scale, low * scale, layer.high * scale, high * scale)))
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
    """Return distinct x and y of the nodes of outlines whose edges lie along the sheet."""
    points = np.array([point for layer in plan.layers if is_square(layer.outline) for point, _ in nodes(layer.outline)])
    x, y = (sorted({round(float(v), 3) for v in points[:, k]}) for k in (0, 1))
    return x, y


def _marks(values: Sequence[float], start: float, scale: float) -> list[Mark]:
    marks = [Mark(at=v * scale, start=start, text=number(v)) for v in values]
    if not any(abs(v) < _SAME_MM for v in values):
        marks.append(Mark(at=0.0, start=start, text="0"))
    return marks


def _edge(paper: Paper, contour: Contour, above: BaseGeometry, scale: float) -> None:
    """Draw a contour: wide where it is seen, dashed below other layers."""
    ring = shapely.LinearRing(polygon(contour, 0.01 / scale))
    if above.is_empty:
        paper.line(np.asarray(ring.coords)[:-1] * scale, width_mm=WIDE_MM, closed=True)
        return
    inside = above.buffer(-1e-4)
    styles = ((ring.difference(inside), WIDE_MM, ()), (ring.intersection(inside), NARROW_MM, DASHED))
    for part, width, dashes in styles:
        _lines(paper, shapely.transform(part, lambda points: points * scale), width, dashes)


def _lines(paper: Paper, shape: BaseGeometry, width: float, dashes: tuple[float, ...] = ()) -> None:
    merged = shapely.line_merge(shape) if shape.geom_type == "MultiLineString" else shape
    for piece in shapely.get_parts(merged):
        if piece.geom_type in ("LineString", "LinearRing") and piece.length > 0.02:
            paper.line(list(piece.coords), width_mm=width, dashes=dashes)


def _seen(plan: Plan, bore: Bore) -> bool:
    """Return whether no material stands above the mouth of a hole, or the hole is seen through a wider one."""
    x, y = bore.centres[0]
    mouth = bore.high - _SAME_MM
    covering = any(layer.low > mouth and shapely.contains_xy(layer.area(), x, y) for layer in plan.layers)
    others = [other for other in plan.bores if other.centres == bore.centres and other.low > mouth]
    return not covering or any(other.radius > bore.radius for other in others)


def _tag(text: str, x: float, y: float, radius: float = 0.0) -> Tag:
    return Tag(text=text, x=x, y=y, radius=radius, height_mm=LETTER_MM)


def plan_views(plan: Plan, scale: float, tags: Sequence[Tag]) -> list[Paper]:
    """Return the view from above, and a section where the part has more than one thickness."""
    above = plan_view(plan, scale)
    cut = _has_section(plan)
    if cut:
        section_marks(above, plan, scale)
    crowd = _crowd(plan, scale)
    near = [tag for tag in tags if crowd is not None and tag.height_mm == LETTER_MM and _inside(tag, crowd)]
    if crowd is not None:
        x, y, radius = (scale * value for value in crowd)
        above.circle(x, y, radius)
        tags = [*(tag for tag in tags if tag not in near), _tag(_DETAIL, crowd[0], crowd[1], crowd[2])]
    _place_names(above, [*axis_tags(scale), *tags], scale)
    if crowd is not None:
        above = _with_detail(above, _detail(plan, crowd, _larger(scale, crowd[2]), near))
    return [above, section_at(plan, scale)] if cut else [above]


def _larger(scale: float, radius_mm: float) -> float:
    """Return the largest scale at which a detail is not too wide, or else the next one above the view's."""
    found = [other for other in SCALES if other > scale and 2.0 * radius_mm * other <= _WIDE_MM]
    return max(found, default=min(other for other in SCALES if other > scale))


def _crowd(plan: Plan, scale: float) -> Circle | None:
    """Return centre and radius around the holes that stand too close together on paper for their names, if any do.

    A sheet at full size or above shows all of them well enough.
    """
    if scale >= 1.0:
        return None
    discs = [shapely.Point(x, y).buffer(bore.radius + _NEAR_MM / scale) for bore in plan.bores for x, y in bore.centres]
    groups = [group for group in polygons(shapely.union_all(discs)) if sum(map(group.intersects, discs)) >= _MANY]
    if not groups:
        return None
    found = max(groups, key=lambda group: sum(map(group.intersects, discs)))
    circle = shapely.minimum_bounding_circle(found)
    return circle.centroid.x, circle.centroid.y, shapely.minimum_bounding_radius(found)


def _inside(tag: Tag, crowd: Circle) -> bool:
    return bool(np.hypot(tag.x - crowd[0], tag.y - crowd[1]) < crowd[2])


def _detail(plan: Plan, crowd: Circle, scale: float, tags: Sequence[Tag]) -> Paper:
    """Return what is within a circle of the view from above at a larger scale, with its names."""
    x, y, radius = (scale * value for value in crowd)
    disc = shapely.Point(x, y).buffer(radius, quad_segs=64)
    whole, paper = plan_view(plan, scale), Paper()
    for stroke in whole.strokes:
        line = shapely.LinearRing(stroke.points) if stroke.closed else shapely.LineString(stroke.points)
        _lines(paper, line.intersection(disc), stroke.width_mm, stroke.dashes)
    paper.fills += [fill for fill in whole.fills if disc.contains(shapely.Polygon(fill.points))]
    paper.circle(x, y, radius)
    _place_names(paper, tags, scale)
    top = paper.box()[3]
    paper.text(f"{_DETAIL}, {scale_text(scale)}", x, top + 3.0, height_mm=3.5, align="centre")
    return paper


def _with_detail(view: Paper, detail: Paper) -> Paper:
    """Return a view and its detail below or beside it, where they take less room; the middle stands at y = 0."""
    (left, low, right, high), (x0, y0, x1, y1) = view.box(), detail.box()
    both = Paper()
    if right - left > high - low:
        middle = 0.5 * (high + low - (y1 - y0) - _APART_MM)
        both.lay(view, 0.0, -middle)
        both.lay(detail, 0.5 * (left + right) - 0.5 * (x0 + x1), low - _APART_MM - y1 - middle)
    else:
        both.lay(view, 0.0, -0.5 * (low + high))
        both.lay(detail, right + _APART_MM - x0, -0.5 * (y0 + y1))
    return both


def _place_names(paper: Paper, tags: Sequence[Tag], scale: float) -> None:
    """Write names on a view; that of a datum stands in its frame, which is placed first as it takes more room."""
    datums = [tag for tag in tags if tag.text == DATUM]
    place_tags(paper, [replace(tag, height_mm=FRAME_MM) for tag in datums], scale)
    for _ in datums:
        x0, y0, x1, y1 = paper.labels.pop().box()
        datum(paper, DATUM, 0.5 * (x0 + x1 - FRAME_MM), 0.5 * (y0 + y1 - FRAME_MM))
    place_tags(paper, [tag for tag in tags if tag.text != DATUM], scale)


def _has_section(plan: Plan) -> bool:
    return not (plan.is_flat and all(map(plan.passed_by, plan.bores)))


def plan_tables(plan: Plan, part: Part) -> tuple[list[Paper], list[Tag]]:
    """Return tables of fits, holes, windows and contours, and the names that stand on the view."""
    around = [2.0 * radius for radius in _around(plan)]
    alone = [any(fit.holds(diameter) for diameter in around) for fit in part.toleranced]
    first = datum_fit(part.toleranced)
    axis = first is not None and alone[part.toleranced.index(first)]
    hole_rows, tags = _hole_rows(plan, first if axis else None)
    contour_rows, window_rows, node_tags = _contour_rows(plan, part)
    fits = fit_table(part.toleranced, alone)
    tables = [] if fits is None else [fits]
    if hole_rows or window_rows:
        rows = [*hole_rows, *window_rows]
        columns = ("Hole", "Size", "X", "Y", "Position")
        # Without tolerances of position there is no column of them.
        used = len(columns) if any(row[-1] for row in rows) else len(columns) - 1
        tables += _tables("Holes, from the origin X Y", columns[:used], [row[:used] for row in rows])
    if contour_rows:
        head = ("Node", "X", "Y", "To the next", "Centre X", "Centre Y")
        tables += _tables("Contours, from the origin X Y", head, contour_rows)
    return tables, [*tags, *node_tags]


def _around(plan: Plan) -> Iterator[float]:
    """Yield radii of the single round faces around an axis: bosses, and bores of which there are no others.

    Several alike beside each other have no common axis.
    """
    for layer in plan.layers:
        if layer.outline.circle is not None:
            yield float(layer.outline.circle.radius_mm)
    for bore in plan.bores:
        alike = [other for other in plan.bores if other.radius == bore.radius]
        if bore.count == 1 and all(other.centres == bore.centres for other in alike):
            yield bore.radius


def plan_notes(plan: Plan, part: Part) -> Iterator[str]:
    """Yield what no dimension says."""
    x0, y0, x1, y1 = plan.bounds
    for ball in part.balls:
        width = number(2.0 * float(ball.radius_mm))
        yield f"Ball SØ{width}, cut flat {number(float(ball.top_mm))} above its centre."
        if ball.pocket is not None:
            depth = float(ball.pocket.z1_mm) - float(ball.pocket.z0_mm)
            yield f"The pocket is {number(depth)} wide across the view."
    if not part.balls and not _has_section(plan):
        yield f"Thickness t = {number(plan.high - plan.low)}."
    yield f"Blank {number(x1 - x0)} {TIMES} {number(y1 - y0)} {TIMES} {number(plan.high - plan.low)}."
    if any(bore.feature is not None and bore.feature.thread is not None for bore in plan.bores):
        yield "Tapped holes are chamfered at 90° to the diameter of their thread."
    if part.process == "laser cut" and plan.is_flat:
        yield "Cut by the file of the same name in laser/, which has the contours above without kerf."


def _tables(title: str, head: Sequence[str], rows: Sequence[Sequence[str]]) -> list[Paper]:
    parts = [rows[k : k + _ROWS] for k in range(0, len(rows), _ROWS)]
    return [table(title if k == 0 else f"{title}, continued", head, part) for k, part in enumerate(parts)]


def _hole_rows(plan: Plan, axis: Fit | None) -> tuple[list[tuple[str, ...]], list[Tag]]:
    """Return a row per hole or pattern, and names: holes of one kind share a letter, which is none of a datum.

    Positions refer to the axis of the fit ``axis``. Without one, the first circle of fitted holes is the datum.
    """
    fitted = [bore for bore in plan.bores if bore.fit is not None and bore.count > 1 and bore.place_mm is not None]
    pattern = fitted[0] if axis is None and fitted else None
    kinds: dict[str, list[Bore]] = {}
    for bore in plan.bores:
        kinds.setdefault(_kind(bore, plan), []).append(bore)
    rows: list[tuple[str, ...]] = []
    tags: list[Tag] = []
    for bore in [pattern] if pattern is not None else plan.bores:
        if bore is pattern or (axis is not None and bore.count == 1 and axis.holds(2.0 * bore.radius)):
            tags.append(_tag(DATUM, *min(bore.centres, key=lambda centre: (centre[0], centre[1])), bore.radius))
            break
    circles = [layer.outline.circle for layer in plan.layers if layer.outline.circle is not None and not tags]
    for circle in [one for one in circles if axis is not None and axis.holds(2.0 * float(one.radius_mm))][:1]:
        tags.append(_tag(DATUM, float(circle.x_mm), float(circle.y_mm), float(circle.radius_mm)))
    letters = (letter for letter in ascii_uppercase if letter not in (DATUM, SECOND, _DETAIL, *_UNREADABLE))
    for letter, (kind, members) in zip(letters, kinds.items(), strict=False):
        for k, bore in enumerate(members, 1):
            name = f"{letter}{k}" if len(members) > 1 else letter
            x, y = float(bore.shape.x_mm), float(bore.shape.y_mm)
            zone = f"Ø{number(bore.place_mm)}" if bore.place_mm is not None else ""
            if zone and bore is pattern:
                zone = f"{zone}, datum {DATUM}"
            elif zone and (axis is not None or pattern is not None):
                zone = f"{zone} {DATUM}"
            rows.append((name, kind, number(x), number(y), zone))
            rightmost = int(np.argmax(np.round([x + 0.1 * y for x, y in bore.centres], 6)))
            tags.append(_tag(name, *bore.centres[rightmost], bore.radius))
    return rows, tags


def _kind(bore: Bore, plan: Plan) -> str:
    """Return what the holes of one letter have in common, and between which z those are that pass only part of it."""
    text = bore.size()
    if isinstance(bore.shape, Pattern):
        turn = 360.0 / bore.count
        first = round(float(np.degrees(bore.shape.phase_rad)) % turn, 3) % round(turn, 3)
        beginning = f", first at {number(first)}°" if first > 0.0 else ""
        text = f"{bore.count} {TIMES} {text} on Ø{number(2.0 * float(bore.shape.pitch_radius_mm))}{beginning}"
    span = [] if plan.passed_by(bore) else [f"z {number(bore.low - plan.low)} to {number(bore.high - plan.low)}"]
    return ", ".join([text, *bore.details(from_above=True), *span])


def _contour_rows(plan: Plan, part: Part) -> tuple[list[tuple[str, ...]], list[tuple[str, ...]], list[Tag]]:
    """Return rows of nodes, rows of windows and bosses, and the names of both."""
    rows: list[tuple[str, ...]] = []
    shapes: list[tuple[str, ...]] = []
    tags: list[Tag] = []
    several = len({(layer.low, layer.high) for layer in plan.layers}) > 1
    for layer in plan.layers:
        span = f"z {number(layer.low - plan.low)} to {number(layer.high - plan.low)}" if several else ""
        for contour in (layer.outline, *layer.holes):
            ends = ", ".join(filter(None, (span, *_end_chamfers(contour, layer, plan, part))))
            _add_contour(contour, layer, ends, part.toleranced, rows, shapes, tags)
    return rows, shapes, tags


def _end_chamfers(contour: Contour, layer: Layer, plan: Plan, part: Part) -> Iterator[str]:
    if contour.circle is None:
        return
    for end in part.features:
        if not isinstance(end, ShaftEnd) or abs(float(end.at.radius_mm) - float(contour.circle.radius_mm)) > _SAME_MM:
            continue
        face = float(end.face_mm)
        if layer.low - _SAME_MM < face < layer.high + _SAME_MM:
            size = chamfer_text(float(end.depth_mm), float(end.width_mm))
            yield f"chamfer {size} at z {number(face - plan.low)}"


def _add_contour(
    contour: Contour,
    layer: Layer,
    span: str,
    fits: Sequence[Fit],
    rows: list[tuple[str, ...]],
    shapes: list[tuple[str, ...]],
    tags: list[Tag],
) -> None:
    outline = contour is layer.outline
    rectangle = rounded_rectangle(contour) if not outline else None
    if contour.circle is not None:
        name = f"R{1 + sum(row[0].startswith('R') for row in shapes)}"
        x, y, radius = (float(v) for v in (contour.circle.x_mm, contour.circle.y_mm, contour.circle.radius_mm))
        zone = next((f" {fit.zone}" for fit in fits if fit.holds(2.0 * radius)), "")
        shapes.append((name, f"boss Ø{number(2.0 * radius)}{zone} {span}".strip(), number(x), number(y), ""))
        tags.append(_tag(name, x, y, radius))
    elif rectangle is not None:
        width, height, radius, x, y = rectangle
        name = f"W{1 + sum(row[0].startswith('W') for row in shapes)}"
        corner = f", corners R{number(radius)}" if radius else ""
        text = f"{number(width)} {TIMES} {number(height)}{corner} {span}".strip()
        shapes.append((name, text, number(x), number(y), ""))
        tags.append(_tag(name, x, y))
    elif not (outline and is_square(contour)):
        _add_nodes(contour, span, rows, tags)


def _add_nodes(contour: Contour, span: str, rows: list[tuple[str, ...]], tags: list[Tag]) -> None:
    """Add a row per node; those of one period where the contour repeats itself."""
    listed = nodes(contour)
    times = repeats(contour)
    first = sum(row[0].isdigit() for row in rows) + 1
    if span or times > 1:
        again = f"{times} times around the origin" if times > 1 else ""
        rows.append(("", "", "", ", ".join(filter(None, (span, again))), "", ""))
    for k, (point, piece) in enumerate(listed[: len(listed) // times], first):
        centre, onward = ("", ""), "line"
        if isinstance(piece, Arc):
            turn = "" if float(piece.end_rad) > float(piece.start_rad) else ", clockwise"
            onward = f"arc R{number(float(piece.radius_mm))}{turn}"
            centre = (number(float(piece.x_mm)), number(float(piece.y_mm)))
        x, y = float(point[0]), float(point[1])
        rows.append((f"{k}", number(x), number(y), onward, *centre))
        tags.append(Tag(text=f"{k}", x=x, y=y, radius=0.0, height_mm=_NODE_MM))
