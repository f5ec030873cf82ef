"""The cut view of a round part: full section along the axis with diameters, lengths and chamfers."""

from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from shapely import affinity
from shapely.geometry import Polygon, box
from shapely.geometry.base import BaseGeometry

from pareto_monoped.cad.drawing.bores import Bore, chamfer_text, number
from pareto_monoped.cad.drawing.dimension import (
    FIRST_MM,
    PITCH_MM,
    Mark,
    across,
    datum_below,
    datum_letters,
    fits_between,
    ladder,
)
from pareto_monoped.cad.drawing.paper import CHAIN, WIDE_MM, Paper
from pareto_monoped.cad.drawing.profile import (
    Cylinder,
    Face,
    Taper,
    Teeth,
    cylinders,
    edges,
    faces,
    free,
    polygons,
    tapers,
)
from pareto_monoped.geometry.gears import ExternalGear
from pareto_monoped.geometry.making import Fit

_HATCH_MM = 2.0
_LADDER_MM = 5.0  # from the outline to where a ladder's lines may bend
_SAME_MM = 1e-6

_Along = Callable[[float], float]  # from a height along the axis to x on paper


@dataclass(frozen=True, slots=True, kw_only=True)
class RoundPart:
    """What the views of a round part are drawn from."""

    body: BaseGeometry  #: its half section without holes beside the axis
    teeth: tuple[Teeth, ...]  #: its gears
    bores: tuple[Bore, ...]  #: its holes beside the axis
    fits: tuple[Fit, ...]  #: tolerances of its round faces
    from_above: bool  #: whether the end view looks at its upper end

    @property
    def is_solid(self) -> bool:
        """Whether it has no holes at all: such shafts are not cut along their axis (ISO 128-3)."""
        return not self.bores and all(cylinder.shaft for cylinder in cylinders(self.body))

    @property
    def datum(self) -> float:
        """Height of the face that lengths are measured from: the end nearer to the unit's own face, z = 0."""
        low, _, high, _ = self.body.bounds
        return float(low if abs(low) < abs(high) else high)


def diameter_text(radius: float, fits: Sequence[Fit]) -> str:
    """Return a diameter with its fit."""
    zone = next((f" {fit.zone}" for fit in fits if fit.holds(2.0 * radius)), "")
    return f"Ø{number(2.0 * radius)}{zone}"


def section_view(part: RoundPart, scale: float) -> Paper:
    """Return the section with its dimensions; the axis lies on y = 0."""
    paper = Paper()
    sign = -1.0 if part.from_above else 1.0

    def x_of(z: float) -> float:
        return sign * z * scale

    low, _, high, top = part.body.bounds
    left, right = sorted((x_of(low), x_of(high)))
    halves = tuple(zip(_holed(part), (1.0, -1.0), strict=True))
    _outline(paper, shapely.union_all([_on_paper(half, x_of, scale, side) for half, side in halves]))
    if part.is_solid:
        _steps(paper, part.body, x_of, scale)
    else:
        hatch(paper, shapely.union_all([_hatched(part, half, x_of, scale, side) for half, side in halves]))
        _behind(paper, part.body, x_of, scale)
    for teeth in part.teeth:
        _teeth(paper, teeth, x_of, scale)
    _bore_lines(paper, part, x_of, scale)
    paper.line([(left - 4.0, 0.0), (right + 4.0, 0.0)], dashes=CHAIN)
    leaders = _diameters(paper, part, x_of, scale, (left, right))
    inner, outer = _lengths(part, x_of, scale)
    if inner:
        reach = max(r for height, r, _, _ in edges(part.body) if abs(height - part.datum) < _SAME_MM)
        inner.append(Mark(at=x_of(part.datum), start=reach * scale, text=""))
    leaders += _chamfers(part, x_of, scale)
    level = top * scale + _LADDER_MM
    ladder(paper, outer, "below", -level, origin=x_of(part.datum))
    ladder(paper, [*inner, *leaders], "above", level, origin=x_of(part.datum) if inner else None)
    return paper


def common_chamfer(body: BaseGeometry) -> tuple[float, float] | None:
    """Return depth and width of the chamfer that a part has most often; a note gives it instead of dimensions."""
    sizes = Counter((round(t.along, 3), round(t.across, 3)) for t in tapers(body) if abs(t.along - t.across) < 1e-3)
    return sizes.most_common(1)[0][0] if sizes else None


def _halves(part: RoundPart) -> list[list[tuple[Bore, BaseGeometry]]]:
    """Return the holes turned into the section's plane, by the half that they are drawn in: upper, lower.

    Holes that would meet go into the lower half, and are left out where that is full, too.
    """
    halves: list[list[tuple[Bore, BaseGeometry]]] = [[], []]
    for bore in part.bores:
        profile = _bore_profile(bore)
        half = next((h for h in halves if not any(_meet(bore, profile, *other) for other in h)), None)
        if half is not None:
            half.append((bore, profile))
    return halves


def _holed(part: RoundPart) -> Iterator[BaseGeometry]:
    """Yield both halves of the section with their holes, the upper one first."""
    for half in _halves(part):
        holes = [profile for _, profile in half]
        yield part.body.difference(shapely.union_all(holes)) if holes else part.body


def _meet(bore: Bore, profile: BaseGeometry, other: Bore, other_profile: BaseGeometry) -> bool:
    """Return whether two holes would be drawn over each other; steps of one hole belong together."""
    return bore.centres != other.centres and bool(profile.buffer(0.3).intersects(other_profile))


def _pitch(bore: Bore) -> float:
    x, y = bore.centres[0]
    return float(np.hypot(x, y))


def _bore_profile(bore: Bore) -> BaseGeometry:
    at, r = _pitch(bore), bore.radius
    pieces: list[BaseGeometry] = [box(bore.low, at - r, bore.high, at + r)]
    for mouth, face, inwards in zip(bore.mouths, (bore.low, bore.high), (1.0, -1.0), strict=True):
        if mouth is not None:
            wide, end = float(mouth.radius_mm), face + inwards * float(mouth.depth_mm)
            pieces.append(Polygon([(face, at - wide), (face, at + wide), (end, at + r), (end, at - r)]))
    return shapely.union_all(pieces)


def _on_paper(shape: BaseGeometry, x_of: _Along, scale: float, side: float) -> BaseGeometry:
    return affinity.affine_transform(shape, [x_of(1.0) - x_of(0.0), 0.0, 0.0, side * scale, x_of(0.0), 0.0])


def _hatched(part: RoundPart, half: BaseGeometry, x_of: _Along, scale: float, side: float) -> BaseGeometry:
    """Return the cut area without teeth, which are never hatched (ISO 2203)."""
    for teeth in part.teeth:
        one, other = sorted((float(teeth.gear.tip_radius_mm), float(teeth.gear.root_radius_mm)))
        half = half.difference(box(teeth.low, one, teeth.high, other))
    return _on_paper(half, x_of, scale, side)


def _outline(paper: Paper, area: BaseGeometry) -> None:
    for polygon in polygons(area.simplify(_SAME_MM)):
        for ring in (polygon.exterior, *polygon.interiors):
            paper.line(list(ring.coords)[:-1], width_mm=WIDE_MM, closed=True)


def _steps(paper: Paper, body: BaseGeometry, x_of: _Along, scale: float) -> None:
    """Draw the edges of a solid shaft, seen from outside: upright lines where its outline turns."""
    reach: dict[float, float] = {}
    for z, r, _, _ in edges(body):
        reach[round(z, 6)] = max(reach.get(round(z, 6), 0.0), r)
    for z, r in reach.items():
        paper.line([(x_of(z), -r * scale), (x_of(z), r * scale)], width_mm=WIDE_MM)


def hatch(paper: Paper, area: BaseGeometry, *, falling: bool = False) -> None:
    """Hatch an area at 45 degrees (ISO 128-3)."""
    if area.is_empty:
        return
    x0, y0, x1, y1 = area.bounds
    slope = -1.0 if falling else 1.0
    step = _HATCH_MM * np.sqrt(2.0)
    ends = (y0 - slope * x0, y0 - slope * x1, y1 - slope * x0, y1 - slope * x1)
    first = np.ceil(min(ends) / step) * step
    starts = np.arange(first, max(ends), step)
    lines = shapely.linestrings([[(x0, slope * x0 + c), (x1, slope * x1 + c)] for c in starts]) if len(starts) else []
    clipped = shapely.intersection(lines, area) if len(starts) else []
    for piece in shapely.get_parts(clipped):
        if piece.geom_type == "LineString" and piece.length > 0.05:
            paper.line(list(piece.coords))


def _behind(paper: Paper, body: BaseGeometry, x_of: _Along, scale: float) -> None:
    """Draw the edges of the bore behind the cut: upright lines where it changes."""
    least: dict[float, float] = {}
    for z, r, _, _ in edges(body):
        least[round(z, 6)] = min(least.get(round(z, 6), np.inf), r)
    for z, r in least.items():
        if r > _SAME_MM and not body.intersects(box(z - 1e-3, 0.0, z + 1e-3, r - 1e-3)):
            paper.line([(x_of(z), -r * scale), (x_of(z), r * scale)], width_mm=WIDE_MM)


def _teeth(paper: Paper, teeth: Teeth, x_of: _Along, scale: float) -> None:
    """Draw root lines and pitch lines of a gear in section."""
    low, high = x_of(teeth.low), x_of(teeth.high)
    reach = 2.0 if isinstance(teeth.gear, ExternalGear) else -2.0
    for side in (1.0, -1.0):
        root = side * float(teeth.gear.root_radius_mm) * scale
        paper.line([(low, root), (high, root)], width_mm=WIDE_MM)
        pitch = side * float(teeth.gear.pitch_radius_mm) * scale
        over = abs(reach) if high > low else -abs(reach)
        paper.line([(low - over, pitch), (high + over, pitch)], dashes=CHAIN)


def _bore_lines(paper: Paper, part: RoundPart, x_of: _Along, scale: float) -> None:
    """Draw the axes of the holes that are cut, and the threads' outer lines."""
    side_of = {id(bore): side for half, side in zip(_halves(part), (1.0, -1.0), strict=True) for bore, _ in half}
    for bore in part.bores:
        side = side_of.get(id(bore))
        if side is None:
            continue
        y = side * _pitch(bore) * scale
        ends = sorted((x_of(bore.low), x_of(bore.high)))
        paper.line([(ends[0] - 1.5, y), (ends[1] + 1.5, y)], dashes=CHAIN)
        thread = bore.feature.thread if bore.feature is not None else None
        if thread is not None:
            for r in (-0.5 * thread.diameter_mm, 0.5 * thread.diameter_mm):
                paper.line([(ends[0], y + r * scale), (ends[1], y + r * scale)])


def _diameters(paper: Paper, part: RoundPart, x_of: _Along, scale: float, ends: tuple[float, float]) -> list[Mark]:
    """Draw diameters beside the section, small ones nearest; return those that must have a leader instead."""
    sides: dict[bool, list[tuple[float, float]]] = {False: [], True: []}  # right of the section?
    leaders = []
    low, _, high, _ = part.body.bounds
    for radius in sorted({round(c.radius, 6) for c in cylinders(part.body)}):
        same = [c for c in cylinders(part.body) if abs(c.radius - radius) < 1e-5]
        text = diameter_text(radius, part.fits)
        fits = fits_between(text, 2.0 * radius * scale)
        found = _open_side(part.body, same, x_of, (low, high), sides) if fits else None
        if found is None:
            longest = max(same, key=lambda c: c.high - c.low)
            middle = x_of(0.5 * (longest.low + longest.high))
            leaders.append(Mark(at=middle, start=radius * scale, text=text, leader=True))
        else:
            to_right, edge = found
            sides[to_right].append((radius, edge))
    alone = [any(fit.holds(2.0 * c.radius) for c in cylinders(part.body)) for fit in part.fits]
    letters = zip(part.fits, datum_letters(part.fits, alone), strict=True)
    datums = {round(0.5 * float(fit.diameter_mm), 6): letter for fit, letter in letters}
    for to_right, members in sides.items():
        for k, (radius, edge) in enumerate(members):
            outwards = FIRST_MM + k * PITCH_MM
            x = ends[1] + outwards if to_right else ends[0] - outwards
            across(paper, x, radius * scale, diameter_text(radius, part.fits), edge=edge)
            if letter := datums.get(round(radius, 6)):
                datum_below(paper, letter, x, -radius * scale, [-r * scale for r, _ in members if r > radius])
    return leaders


def _open_side(
    body: BaseGeometry,
    same: Sequence[Cylinder],
    x_of: _Along,
    span: tuple[float, float],
    sides: dict[bool, list[tuple[float, float]]],
) -> tuple[bool, float] | None:
    """Return on which side extension lines reach the open, and where they begin: the nearer one, then the emptier."""
    options = []
    for c in same:
        for start, end in ((c.low, span[0]), (c.high, span[1])):
            if free(body, start, end, c.radius):
                to_right = x_of(end) > x_of(0.5 * (span[0] + span[1]))
                options.append((abs(end - start), len(sides[to_right]), to_right, x_of(start)))
    if not options:
        return None
    _, _, to_right, edge = min(options)
    return to_right, edge


def _lengths(part: RoundPart, x_of: _Along, scale: float) -> tuple[list[Mark], list[Mark]]:
    """Return running lengths of the faces, from the datum: of those in bores, and of those outside."""
    inner, outer = [], []
    by_height: dict[float, list[Face]] = {}
    for face in faces(part.body):
        by_height.setdefault(round(face.z, 6), []).append(face)
    top = part.body.bounds[3]
    for z, members in by_height.items():
        text = number(abs(z - part.datum))
        outside = [f for f in members if _open_outwards(part.body, f, top)]
        if outside:
            start = max(f.outer for f in outside)
            outer.append(Mark(at=x_of(z), start=-start * scale, text=text))
        else:
            inner.append(Mark(at=x_of(z), start=max(f.outer for f in members) * scale - 1.0, text=text))
    return inner, outer


def _open_outwards(body: BaseGeometry, face: Face, top: float) -> bool:
    """Return whether nothing stands outside a face on its empty side."""
    z = face.z + (2e-3 if face.up else -2e-3)
    return not body.intersects(box(z - 5e-4, face.outer - 1e-3, z + 5e-4, top + 1.0))


def _chamfers(part: RoundPart, x_of: _Along, scale: float) -> list[Mark]:
    """Return leaders of the conical faces that differ from the most common chamfer; one per size."""
    common = common_chamfer(part.body)
    found: dict[tuple[float, float], Taper] = {}
    for taper in tapers(part.body):
        size = (round(taper.along, 3), round(taper.across, 3))
        if size != common:
            found.setdefault(size, taper)
    leaders = []
    for size, taper in found.items():
        at, start = x_of(0.5 * (taper.z0 + taper.z1)), 0.5 * (taper.r0 + taper.r1) * scale
        leaders.append(Mark(at=at, start=start, text=chamfer_text(*size), leader=True))
    return leaders
