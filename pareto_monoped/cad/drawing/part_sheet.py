"""The drawing of one part: which views and tables it needs, at which scale and on which sheet."""

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import replace

from pareto_monoped.cad.drawing.bores import Bore, bores, chamfer_text, number
from pareto_monoped.cad.drawing.data_tables import fit_table, gear_rows, length_rows
from pareto_monoped.cad.drawing.dimension import DATUM, datum_fit
from pareto_monoped.cad.drawing.end_view import end_view, sees_more_from_above
from pareto_monoped.cad.drawing.paper import Paper
from pareto_monoped.cad.drawing.plan import plan_of
from pareto_monoped.cad.drawing.plan_sheet import plan_notes, plan_tables, plan_views
from pareto_monoped.cad.drawing.profile import Teeth, cylinders, half_section, is_round, teeth_of
from pareto_monoped.cad.drawing.section import RoundPart, common_chamfer, section_view
from pareto_monoped.cad.drawing.sheet import SCALES, SIZES, Size, compose, inner_mm, table
from pareto_monoped.geometry.making import ToothMaking
from pareto_monoped.geometry.parts import Part

_READABLE_MM, _PLAN_MM = 60.0, 120.0
"""Least length of the longest side on paper, if a sheet allows it: of round parts, and of others, which have more holes
and nodes along it (our own choice)."""

Sheet = tuple[Paper, Size, float]  #: What stands on it, its size, its scale.


def round_part(part: Part) -> RoundPart:
    """Return what the views are drawn from."""
    body, teeth, holes = half_section(part), teeth_of(part), bores(part)
    found = RoundPart(body=body, teeth=teeth, bores=holes, fits=part.toleranced, from_above=True)
    return replace(found, from_above=sees_more_from_above(found))


def round_views(drawn: RoundPart, scale: float) -> list[Paper]:
    """Return the section, and the end view if there is something to see."""
    axis = datum_fit(drawn.fits)
    central = axis is not None and any(axis.holds(2.0 * c.radius) for c in cylinders(drawn.body))
    section = section_view(drawn, scale)
    # Diameters in the section say everything about a part without holes beside its axis.
    return [section, end_view(drawn, scale, DATUM if central else None)] if drawn.bores else [section]


def round_tables(part: Part, drawn: RoundPart) -> list[Paper]:
    """Return gear data and fits."""
    tables = []
    for teeth in sorted(drawn.teeth, key=lambda teeth: abs(teeth.low - drawn.datum)):
        rows = gear_rows(
            teeth.gear,
            accuracy_class=part.accuracy_class,
            hole=teeth.hole,
            making=_making(part, teeth),
            hardness=part.grade.hardness if part.grade is not None else "",
        )
        tables.append(table(_gear_title(teeth, drawn), ("", ""), rows))
    around = [2.0 * c.radius for c in cylinders(drawn.body)]
    fits = fit_table(drawn.fits, [any(fit.holds(diameter) for diameter in around) for fit in drawn.fits])
    return [*tables, *([fits] if fits is not None else []), *length_tables(part, drawn.datum)]


def length_tables(part: Part, datum_mm: float) -> list[Paper]:
    """Return the table of lengths with limits; none if all have general tolerances."""
    rows = length_rows(part.lengths, datum_mm)
    return [table("Lengths with limits", ("", ""), rows)] if rows else []


def _making(part: Part, teeth: Teeth) -> ToothMaking | None:
    gear = (int(teeth.gear.teeth), float(teeth.gear.module_mm))
    return next((one for one in part.teeth if (one.teeth, one.module_mm) == gear), None)


def _gear_title(teeth: Teeth, drawn: RoundPart) -> str:
    """Return a title that tells several gears of one part apart."""
    if len(drawn.teeth) == 1:
        return "Gear data"
    near, far = sorted(abs(z - drawn.datum) for z in (teeth.low, teeth.high))
    return f"Gear data, from {number(near)} to {number(far)}"


def round_notes(drawn: RoundPart) -> Iterator[str]:
    """Yield what no dimension says."""
    chamfer = common_chamfer(drawn.body)
    if chamfer is not None:
        yield f"Chamfers without dimension {chamfer_text(*chamfer)}."
    yield f"Lengths run from the face marked with a circle, z = {drawn.datum:g} mm in the model."


def axis_threads(part: Part, datum_mm: float) -> Iterator[str]:
    """Yield the threads on a round part's own axis, which the end view does not call out."""
    for bore in bores(part, on_axis=True):
        feature = bore.feature
        if feature is None or feature.thread is None or bore.count > 1 or any(map(bool, bore.centres[0])):
            continue
        ends = [
            number(abs(end - datum_mm)) for end, mouth in zip((bore.low, bore.high), bore.mouths, strict=True) if mouth
        ]
        where = f"face{'s' if len(ends) > 1 else ''} at {' and '.join(sorted(ends, key=float))}"
        yield f"Tapped on the axis from the {where}: {bore.size()}."


def _fit_notes(part: Part, holes: Iterable[Bore]) -> Iterator[str]:
    """Yield how holes are finished in place, and the tolerance of all other diameters."""
    for fit in dict.fromkeys(hole.fit for hole in holes if hole.fit is not None and hole.fit.together):
        yield f"Ø{fit.text} is reamed together with the parts that the dowels join, from holes 0.2 mm smaller."
    if part.process in ("machined", "laser cut"):
        yield "Diameters without tolerance: holes H12, shafts h12 (ISO 286-2)."


def part_sheet(part: Part) -> Sheet:
    """Return the sheet of a part without its title block; ``ValueError`` if no sheet is large enough."""
    said = [part.note, part.joint.text if part.joint else ""]
    notes = [*_fit_notes(part, bores(part)), *(f"{note[0].upper()}{note[1:]}." for note in said if note)]
    if is_round(part):
        drawn = round_part(part)
        low, _, high, top = drawn.body.bounds
        bare = (high - low + (2.0 * top if drawn.bores else 0.0), 2.0 * top)
        readable = _READABLE_MM / max(high - low, 2.0 * top)
        tables = round_tables(part, drawn)
        notes = [*round_notes(drawn), *axis_threads(part, drawn.datum), *notes]
        return placed(bare, readable, lambda scale: round_views(drawn, scale), tables, notes)
    plan = plan_of(part)
    x0, y0, x1, y1 = plan.bounds
    tables, tags = plan_tables(plan, part)
    tables = [*tables, *length_tables(part, plan.low)]
    readable = min(_PLAN_MM / max(x1 - x0, y1 - y0), 2.0)
    notes = [*plan_notes(plan, part), *notes]
    return placed((x1 - x0, y1 - y0), readable, lambda scale: plan_views(plan, scale, tags), tables, notes)


def placed(
    bare_mm: tuple[float, float],
    readable: float,
    views: Callable[[float], Sequence[Paper]],
    tables: Sequence[Paper],
    notes: Sequence[str],
) -> Sheet:
    """Return the smallest sheet with readable views, at the largest scale that fits, or raise ``ValueError``.

    ``bare_mm`` is the size of the views without dimensions at full size; the scale is ``readable`` if possible.
    """
    drawn: dict[float, Sequence[Paper]] = {}
    best: Sheet | None = None
    for size in SIZES:
        for scale in SCALES:
            room = all(bare * scale < side for bare, side in zip(bare_mm, inner_mm(size), strict=True))
            if not room or (best is not None and scale <= best[2]):
                continue
            # Before anything is drawn, which takes ten times as long: are the views alone too large beside the tables?
            if scale not in drawn and compose(size, [_blank(bare_mm, scale)], tables, notes) is None:
                continue
            if scale not in drawn:
                drawn[scale] = views(scale)
            paper = compose(size, drawn[scale], tables, notes)
            if paper is not None:
                best = (paper, size, scale)
                break
        if best is not None and best[2] >= readable:
            return best
    if best is None:
        raise ValueError(f"drawing: {bare_mm[0]:g} mm with tables fit no sheet")
    return best


def _blank(bare_mm: tuple[float, float], scale: float) -> Paper:
    paper = Paper()
    paper.line([(0.0, 0.0), (scale * bare_mm[0], scale * bare_mm[1])])
    return paper
