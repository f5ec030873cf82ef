"""The drawing of one part: which views it needs, at which scale and on which sheet."""

from collections.abc import Callable, Sequence

from pareto_monoped.cad.drawing.paper import Paper
from pareto_monoped.cad.drawing.plan import plan_of
from pareto_monoped.cad.drawing.plan_sheet import plan_notes, plan_tables, plan_views
from pareto_monoped.cad.drawing.profile import is_round
from pareto_monoped.cad.drawing.round_sheet import round_notes, round_part, round_tables, round_views
from pareto_monoped.cad.drawing.sheet import SCALES, SIZES, Size, compose, inner_mm
from pareto_monoped.geometry.parts import Part

_READABLE_MM, _PLAN_MM = 60.0, 120.0
"""Least length of the longest side on paper, if a sheet allows it: of round parts, and of others, which have more holes
and nodes along it (our own choice)."""

Sheet = tuple[Paper, Size, float]
"""What stands on it, its size, its scale."""


def part_sheet(part: Part) -> Sheet:
    """The sheet of a part without its title block.

    Raises:
        ValueError: no sheet is large enough.
    """
    said = [part.note, part.joint.text if part.joint else ""]
    notes = [f"{note[0].upper()}{note[1:]}." for note in said if note]
    if is_round(part):
        drawn = round_part(part)
        low, _, high, top = drawn.body.bounds
        bare = (high - low + (2.0 * top if drawn.bores else 0.0), 2.0 * top)
        readable = _READABLE_MM / max(high - low, 2.0 * top)
        tables = round_tables(part, drawn)
        notes = [*round_notes(drawn), *notes]
        return placed(bare, readable, lambda scale: round_views(drawn, scale), tables, notes)
    plan = plan_of(part)
    x0, y0, x1, y1 = plan.bounds
    tables, tags = plan_tables(plan, part)
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
    """The smallest sheet on which the views are readable, at the largest scale that it has room for.

    Args:
        bare_mm: width and height of the views without dimensions, at full size.
        readable: the least scale, if a sheet allows it.
        views: draws them at a scale.
        tables: beside the views.
        notes: lines of text.

    Raises:
        ValueError: no sheet is large enough.
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
    """The room that views need without dimensions."""
    paper = Paper()
    paper.line([(0.0, 0.0), (scale * bare_mm[0], scale * bare_mm[1])])
    return paper
