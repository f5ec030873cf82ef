"""Dimensions after ISO 129-1, placed by rule so that none stands on another: ladders, stacks, leaders, frames.

All lengths are millimetres of paper.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from pareto_monoped.cad.drawing.lettering import width_mm
from pareto_monoped.cad.drawing.paper import ARROW_MM, LETTER_MM, Paper

Side = Literal["below", "above", "left", "right"]

GAP_MM = 1.0
"""From a feature to the beginning of its extension line."""
OVERSHOOT_MM = 1.5
"""Of an extension line beyond the dimension line."""
FIRST_MM, PITCH_MM = 9.0, 7.0
"""From the outline to the first dimension line, and from line to line (ISO 129-1: not less than about 10 and 7)."""
SLOT_MM = 4.2
"""Least distance of parallel texts of 2.5 mm."""
_BESIDE_MM = 1.2
"""From an upright dimension line to its text, which stands clear of the arrows."""
_JOG_MM, _TAIL_MM = 3.0, 1.5
_TICK_MM = 1.2
_ORIGIN_MM = 0.9


@dataclass(frozen=True, slots=True, kw_only=True)
class Mark:
    """One rung of a ladder.

    Attributes:
        at: where the feature is, along the ladder.
        start: where it is across the ladder: its extension line begins here.
        text: its dimension; '' for an extension line alone.
        leader: whether the line ends on the feature with an arrow instead of beginning beside it.
    """

    at: float
    start: float
    text: str
    leader: bool = False


def spread(at: Sequence[float], pitch: float) -> list[float]:
    """Places near the wanted ones, which ascend, at least ``pitch`` apart; the sum of squared moves is least.

    With the multiples of the pitch taken off, the places need only ascend, which pooling neighbours achieves (isotonic
    regression).
    """
    pools: list[tuple[float, int]] = []
    for k, wanted in enumerate(at):
        pools.append((wanted - k * pitch, 1))
        while len(pools) > 1 and pools[-2][0] > pools[-1][0]:
            (b, n), (a, m) = pools.pop(), pools.pop()
            pools.append(((a * m + b * n) / (m + n), m + n))
    flat = [mean for mean, count in pools for _ in range(count)]
    return [mean + k * pitch for k, mean in enumerate(flat)]


def ladder(paper: Paper, marks: Sequence[Mark], side: Side, level: float, *, origin: float | None = None) -> None:
    """Running dimensions: each feature has an extension line to a row of texts that keep their distance.

    Args:
        paper: to draw on.
        marks: the features.
        side: where the row stands.
        level: across the ladder, where the extension lines may begin to bend.
        origin: along the ladder, where the lengths begin; a dimension line runs from there through all marks.
    """
    outwards = 1.0 if side in ("above", "right") else -1.0
    flat = side in ("above", "below")
    ordered = sorted((mark for mark in marks if mark.text), key=lambda mark: mark.at)
    places = spread([mark.at for mark in ordered], SLOT_MM)

    def point(along: float, across: float) -> tuple[float, float]:
        return (along, across) if flat else (across, along)

    bend, tail = level + outwards * _JOG_MM, level + outwards * (_JOG_MM + _TAIL_MM)
    for mark, place in zip(ordered, places, strict=True):
        begin = mark.start if mark.leader else mark.start + outwards * GAP_MM
        paper.line([point(mark.at, begin), point(mark.at, level), point(place, bend), point(place, tail)])
        if mark.leader:
            paper.arrow(*point(mark.at, mark.start), point(0.0, -outwards))
        elif origin is not None:
            tick = 0.5 * _TICK_MM
            paper.line([point(mark.at - tick, level - tick), point(mark.at + tick, level + tick)], width_mm=0.35)
        text_at = tail + outwards * 0.8
        if flat:
            paper.text(
                mark.text,
                place + 0.5 * LETTER_MM,
                text_at,
                align="left" if side == "above" else "right",
                upward=True,
            )
        else:
            paper.text(mark.text, text_at, place - 0.5 * LETTER_MM, align="left" if side == "right" else "right")
    for mark in marks:
        if not mark.text:
            paper.line(
                [point(mark.at, mark.start + outwards * GAP_MM), point(mark.at, level + outwards * OVERSHOOT_MM)]
            )
    measured = [mark.at for mark in ordered if not mark.leader]
    if origin is not None and measured:
        paper.line([point(min(origin, *measured), level), point(max(origin, *measured), level)])
        paper.circle(*point(origin, level), _ORIGIN_MM)


def fits_between(text: str, span: float) -> bool:
    """Whether a text fits over a dimension line of this length."""
    return span >= width_mm(text, LETTER_MM) + 2.0


def across(paper: Paper, x: float, half: float, text: str, *, edge: float) -> None:
    """An upright dimension of a diameter around the axis y = 0.

    Args:
        paper: to draw on.
        x: of the dimension line.
        half: half of the diameter on paper.
        text: the dimension.
        edge: x where the diameter's edge is.
    """
    outwards = 1.0 if x > edge else -1.0
    for y in (half, -half):
        paper.line([(edge + outwards * GAP_MM, y), (x + outwards * OVERSHOOT_MM, y)])
    paper.line([(x, -half), (x, half)])
    inside = 2.0 * half >= 2.0 * ARROW_MM + 1.0
    for y, sign in ((half, 1.0), (-half, -1.0)):
        paper.arrow(x, y, (0.0, sign if inside else -sign))
        if not inside:
            paper.line([(x, y), (x, y + sign * 2.0 * ARROW_MM)])
    paper.text(text, x - _BESIDE_MM, 0.0, align="centre", upward=True)


def callout(
    paper: Paper, lines: Sequence[str], x: float, y: float, tip: tuple[float, float], *, place: str | None = None
) -> None:
    """Text beside a shelf, with a leader to a feature.

    Args:
        paper: to draw on.
        lines: the text; the first stands on the shelf.
        x: left end of the shelf.
        y: of the shelf.
        tip: where the leader ends.
        place: a tolerance of position and its datum, such as ``Ø0.1 A``, drawn as a frame below the text.
    """
    long = max(width_mm(line, LETTER_MM) for line in lines)
    paper.line([tip, (x - 3.0, y), (x + long + 1.0, y)])
    paper.arrow(*tip, (tip[0] - (x - 3.0), tip[1] - y))
    paper.text(lines[0], x, y + 0.8)
    for k, line in enumerate(lines[1:], 1):
        paper.text(line, x, y - k * 4.0 + 0.4)
    if place:
        frame(paper, ["position", *place.split()], x, y - len(lines) * 4.0 - 1.8)


def callout_height(lines: Sequence[str], place: str | None) -> float:
    """From the top of a callout to the top of the next one."""
    return 4.0 * len(lines) + (6.0 if place else 0.0) + 3.0


FRAME_MM = 5.0
"""Height of a tolerance frame: twice the lettering's (ISO 1101)."""


def frame(paper: Paper, cells: Sequence[str], x: float, y: float) -> float:
    """A tolerance frame (ISO 1101) with its lower left corner at (x, y); returns its width.

    Args:
        paper: to draw on.
        cells: the symbol's name (``position``, ``coaxial``, ``square``, ``round``), value, datum.
        x: of its left edge.
        y: of its lower edge.
    """
    left = x
    for k, cell in enumerate(cells):
        wide = FRAME_MM if k == 0 else max(width_mm(cell, LETTER_MM) + 2.4, FRAME_MM)
        paper.line([(left, y), (left + wide, y), (left + wide, y + FRAME_MM), (left, y + FRAME_MM)], closed=True)
        if k == 0:
            _symbol(paper, cell, left + 0.5 * wide, y + 0.5 * FRAME_MM)
        else:
            paper.text(cell, left + 0.5 * wide, y + 0.5 * (FRAME_MM - LETTER_MM), align="centre")
        left += wide
    return left - x


def _symbol(paper: Paper, name: str, x: float, y: float) -> None:
    """A symbol of ISO 1101 around (x, y)."""
    if name == "position":
        paper.circle(x, y, 1.1)
        paper.line([(x - 1.8, y), (x + 1.8, y)])
        paper.line([(x, y - 1.8), (x, y + 1.8)])
    elif name == "coaxial":
        paper.circle(x, y, 0.9)
        paper.circle(x, y, 1.6)
    elif name == "square":
        paper.line([(x - 1.6, y - 1.4), (x + 1.6, y - 1.4)])
        paper.line([(x, y - 1.4), (x, y + 1.6)])
    else:
        raise ValueError(f"no symbol for a tolerance of {name!r}")


def datum(paper: Paper, letter: str, x: float, y: float) -> None:
    """A datum's letter in its box (ISO 5459), with the lower left corner at (x, y)."""
    paper.line(np.array([(x, y), (x + FRAME_MM, y), (x + FRAME_MM, y + FRAME_MM), (x, y + FRAME_MM)]), closed=True)
    paper.text(letter, x + 0.5 * FRAME_MM, y + 0.5 * (FRAME_MM - LETTER_MM), align="centre")
