"""Dimensions after ISO 129-1 and names of features, placed by rule so that none stands on another.

All lengths are millimetres of paper. Names stand where their boxes meet no line, no arrow and no other text. Places are
tried outwards; a name that stands far off has a leader, which meets no text and no other leader.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
import shapely
from numpy.typing import NDArray

from pareto_monoped.cad.drawing.paper import ARROW_MM, LETTER_MM, Align, Label, Paper, width_mm
from pareto_monoped.geometry.making import Fit

Floats = NDArray[np.float64]
Side = Literal["below", "above", "left", "right"]

GAP_MM = 1.0  #: From a feature to the beginning of its extension line.
OVERSHOOT_MM = 1.5  #: Of an extension line beyond the dimension line.
FIRST_MM, PITCH_MM = 9.0, 7.0
"""From the outline to the first dimension line, and from line to line (ISO 129-1: not less than about 10 and 7)."""
SLOT_MM = 4.2  #: Least distance of parallel texts of 2.5 mm.
_BESIDE_MM = 1.2  # from an upright dimension line to its text, which stands clear of the arrows
_ROW_MM = 3.0  # from the texts of lengths to those of diameters and chamfers
_JOG_MM, _TAIL_MM = 3.0, 1.5
_TICK_MM = 1.2
_ORIGIN_MM = 0.9
FRAME_MM = 5.0  #: Height of a tolerance frame: twice the lettering's (ISO 1101).
DATUM, SECOND = "A", "B"  #: Letters of datums.
_NEAR_MM = 4.0  # names that stand off farther have a leader
_REACHES_MM = np.array([1.0, 2.0, 3.5, 5, 7, 9, 12, 15, 19, 24, 30, 38, 48, 60, 80, 110, 150])
_ANGLES = np.radians([45.0, 135, 225, 315, 0, 90, 180, 270, 22.5, 67.5, 112.5, 157.5, 202.5, 247.5, 292.5, 337.5])
_WAYS = np.array([[np.cos(angle), np.sin(angle)] for angle in _ANGLES])
_ALIGNS: tuple[Align, ...] = tuple("left" if x > 0.3 else "right" if x < -0.3 else "centre" for x in _WAYS[:, 0])
"""Directions in which a name may stand, and how it is then aligned."""
_CLEAR_MM, _APART_MM = 0.2, 0.4  # least distance of a name from lines and from other texts
_LEADER_GAP_MM = 0.3


@dataclass(frozen=True, slots=True, kw_only=True)
class Mark:
    """One rung of a ladder."""

    at: float  #: where the feature is, along the ladder
    start: float  #: where it is across the ladder: its extension line begins here
    text: str  #: its dimension; '' for an extension line alone
    leader: bool = False  #: whether the line ends on the feature with an arrow instead of beginning beside it


def spread(at: Sequence[float], pitch: float) -> list[float]:
    """Return places near the wanted ones, which ascend, at least ``pitch`` apart; the sum of squared moves is least.

    With the multiples of the pitch taken off, the places need only ascend: pooling neighbours (isotonic regression).
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
    """Draw running dimensions: each feature has an extension line to a row of texts that keep their distance.

    ``level`` is where, across the ladder, the extension lines may begin to bend. ``origin`` is where, along it, the
    lengths begin; a dimension line runs from there through all marks.
    """
    outwards = 1.0 if side in ("above", "right") else -1.0
    flat = side in ("above", "below")
    ordered = sorted((mark for mark in marks if mark.text), key=lambda mark: mark.at)
    places = spread([mark.at for mark in ordered], SLOT_MM)

    def point(along: float, across: float) -> tuple[float, float]:
        return (along, across) if flat else (across, along)

    bend, near = level + outwards * _JOG_MM, level + outwards * (_JOG_MM + _TAIL_MM)
    # What is no length stands in a row of its own, beyond the lengths.
    lengths = [width_mm(mark.text, LETTER_MM) for mark in ordered if not mark.leader]
    beyond = near + outwards * (max(lengths) + _ROW_MM if lengths else 0.0)
    for mark, place in zip(ordered, places, strict=True):
        tail = beyond if mark.leader else near
        begin = mark.start if mark.leader else mark.start + outwards * GAP_MM
        paper.line([point(mark.at, begin), point(mark.at, level), point(place, bend), point(place, tail)])
        if mark.leader:
            paper.arrow(*point(mark.at, mark.start), point(0.0, -outwards))
        elif origin is not None:
            tick = 0.5 * _TICK_MM
            paper.line([point(mark.at - tick, level - tick), point(mark.at + tick, level + tick)], width_mm=0.35)
        text_at = tail + outwards * 0.8
        far: Align = "left" if outwards > 0.0 else "right"
        if flat:
            paper.text(mark.text, place + 0.5 * LETTER_MM, text_at, align=far, upward=True)
        else:
            paper.text(mark.text, text_at, place - 0.5 * LETTER_MM, align=far)
    for mark in marks:
        if not mark.text:
            begin, end = mark.start + outwards * GAP_MM, level + outwards * OVERSHOOT_MM
            paper.line([point(mark.at, begin), point(mark.at, end)])
    measured = [mark.at for mark in ordered if not mark.leader]
    if origin is not None and measured:
        paper.line([point(min(origin, *measured), level), point(max(origin, *measured), level)])
        paper.circle(*point(origin, level), _ORIGIN_MM)


def fits_between(text: str, span: float) -> bool:
    """Return whether a text fits over a dimension line of this length."""
    return span >= width_mm(text, LETTER_MM) + 2.0


def across(paper: Paper, x: float, half: float, text: str, *, edge: float) -> None:
    """Draw an upright dimension of a diameter around the axis y = 0; its edge is at x = ``edge``."""
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
    paper: Paper,
    lines: Sequence[str],
    x: float,
    y: float,
    tip: tuple[float, float],
    *,
    place: Sequence[str] = (),
    letter: str = "",
) -> None:
    """Write text beside a shelf, with a leader to a feature.

    The first line stands on the shelf, whose left end is (x, y); the leader ends at ``tip``. ``place`` is a tolerance
    of position and its datum, drawn as a frame below the text. ``letter`` is the datum that the
    feature itself is.
    """
    long = max(width_mm(line, LETTER_MM) for line in lines)
    paper.line([tip, (x - 3.0, y), (x + long + 1.0, y)])
    paper.arrow(*tip, (tip[0] - (x - 3.0), tip[1] - y))
    paper.text(lines[0], x, y + 0.8)
    for k, line in enumerate(lines[1:], 1):
        paper.text(line, x, y - k * 4.0 + 0.4)
    if place:
        low = y - len(lines) * 4.0 - 1.8
        wide = frame(paper, ["position", *place], x, low)
        if letter:
            paper.line([(x + wide, low + 0.5 * FRAME_MM), (x + wide + 3.0, low + 0.5 * FRAME_MM)])
            datum(paper, letter, x + wide + 3.0, low)


def callout_height(lines: Sequence[str], place: Sequence[str]) -> float:
    """Return the distance from the top of a callout to the top of the next one."""
    return 4.0 * len(lines) + (6.0 if place else 0.0) + 3.0


def frame(paper: Paper, cells: Sequence[str], x: float, y: float) -> float:
    """Draw a frame (ISO 1101) of symbol, value and datum, its lower left corner at (x, y), and return its width."""
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
    """Draw a datum's letter in its box (ISO 5459), with the lower left corner at (x, y)."""
    paper.line(np.array([(x, y), (x + FRAME_MM, y), (x + FRAME_MM, y + FRAME_MM), (x, y + FRAME_MM)]), closed=True)
    paper.text(letter, x + 0.5 * FRAME_MM, y + 0.5 * (FRAME_MM - LETTER_MM), align="centre")


def datum_fit(fits: Sequence[Fit]) -> Fit | None:
    """Return the fit whose axis positions refer to: the largest seat, or the largest of all."""
    seats = [fit for fit in fits if fit.seat] or list(fits)
    return max(seats, key=lambda fit: float(fit.diameter_mm), default=None)


def datum_letters(fits: Sequence[Fit], alone: Sequence[bool]) -> list[str]:
    """Return the datum that each fit's face is; '' for others. ``alone`` is as for ``fit_table``."""
    first = datum_fit(fits)
    # A shaft with two seats turns about the axis of both.
    seats = [fit for fit, single in zip(fits, alone, strict=True) if single and fit.seat and fit.zone[0].islower()]
    second = next((fit for fit in seats if fit is not first), None) if first in seats else None
    return [
        DATUM if single and fit is first else SECOND if fit is second else ""
        for fit, single in zip(fits, alone, strict=True)
    ]


def datum_below(paper: Paper, letter: str, x: float, y: float, lines: Sequence[float]) -> None:
    """Draw a datum's triangle below the extension line at (x, y) of the dimension whose axis it is, and its letter.

    The letter's box keeps clear of other extension lines, which are at the heights ``lines``.
    """
    top = y - 4.0
    for line in sorted(lines, reverse=True):
        if top - FRAME_MM - 1.0 < line < top + 1.0:
            top = line - 1.5
    paper.fill(np.array([(x - 1.2, y), (x + 1.2, y), (x, y - 2.1)]))
    paper.line([(x, y - 2.1), (x, top)])
    datum(paper, letter, x - 0.5 * FRAME_MM, top - FRAME_MM)


@dataclass(frozen=True, slots=True, kw_only=True)
class Tag:
    """A name to place."""

    text: str
    #: x, y, radius: where what it names stands on the part; radius 0 for a point
    x: float
    y: float
    radius: float
    height_mm: float  #: of the text on paper


@dataclass(frozen=True, slots=True, kw_only=True)
class _Place:
    """Where a name may stand, and its leader as two points if it needs one."""

    label: Label
    leader: Floats | None


def place_tags(paper: Paper, tags: Sequence[Tag], scale: float) -> None:
    """Write names on a view; ``ValueError`` if one has no free place."""
    lines = shapely.STRtree(_pieces(paper))
    texts = [label.box() for label in paper.labels]
    leaders: list[Floats] = []
    for tag in tags:
        found = _free(tag, scale, lines, np.array(texts).reshape(-1, 4), leaders)
        paper.labels.append(found.label)
        texts.append(found.label.box())
        if found.leader is not None:
            paper.line(found.leader)
            leaders.append(found.leader)


def _pieces(paper: Paper) -> NDArray[np.object_]:
    """Return every straight piece of the lines of a paper, and its arrow heads."""
    runs = [np.vstack([s.points, s.points[:1]]) if s.closed else s.points for s in paper.strokes]
    pairs = [np.stack([run[:-1], run[1:]], axis=1) for run in runs if len(run) > 1]
    straight = shapely.linestrings(np.concatenate(pairs)) if pairs else np.empty(0, dtype=object)
    return np.concatenate([straight, np.array([shapely.polygons(fill.points) for fill in paper.fills], dtype=object)])


def _free(tag: Tag, scale: float, lines: shapely.STRtree, texts: Floats, leaders: Sequence[Floats]) -> _Place:
    """Return the nearest free place of a name, at best one whose leader crosses nothing readable."""
    at, radius = scale * np.array([tag.x, tag.y]), scale * tag.radius
    around = np.array([_label(tag, 0.0, 0.0, align).box() for align in _ALIGNS])
    lowered = tag.height_mm * (0.5 - 0.5 * _WAYS[:, 1])
    others = shapely.linestrings(leaders) if leaders else np.empty(0, dtype=object)
    second_best: _Place | None = None
    for reach in _REACHES_MM.tolist():
        starts = at + (radius + reach) * _WAYS
        starts[:, 1] -= lowered
        boxes = around + np.tile(starts, 2)
        free = np.flatnonzero(~_covered(boxes, lines, texts, others))
        if not free.size:
            continue
        labels = [_label(tag, float(starts[k, 0]), float(starts[k, 1]), _ALIGNS[k]) for k in free]
        if reach <= _NEAR_MM:
            return _Place(label=labels[0], leader=None)
        own = _leaders(at, radius, boxes[free])
        for label, leader, crosses in zip(labels, own, _crossing(own, texts, others), strict=True):
            place = _Place(label=label, leader=leader)
            if not crosses:
                return place
            second_best = second_best or place
    # On a sheet that is too small for its names; a larger one is taken if there is any.
    if second_best is not None:
        return second_best
    raise ValueError(f"no free place for the name {tag.text!r} on a drawing")


def _label(tag: Tag, x: float, y: float, align: Align) -> Label:
    return Label(text=tag.text, x=x, y=y, height_mm=tag.height_mm, align=align)


def _covered(boxes: Floats, lines: shapely.STRtree, texts: Floats, leaders: NDArray[np.object_]) -> NDArray[np.bool_]:
    """Return which boxes, shape (n, 4), meet a line, another text or a leader; all at once, as there are many."""
    high, low = boxes[:, None, 2:] + _APART_MM, boxes[:, None, :2] - _APART_MM
    covered = np.any(np.all((texts[:, :2] < high) & (texts[:, 2:] > low), axis=2), axis=1)
    areas = _grown(boxes, _CLEAR_MM)
    covered[lines.query(areas, predicate="intersects")[0]] = True
    covered |= np.any(shapely.intersects(areas[:, None], leaders), axis=1)
    return np.asarray(covered)


def _leaders(at: Floats, radius: float, boxes: Floats) -> Floats:
    """Return the lines from what is named to the nearest points of the boxes of its name, shape (n, 2, 2)."""
    ends = np.clip(at, boxes[:, :2], boxes[:, 2:])
    along = (ends - at) / np.hypot(*(ends - at).T)[:, None]
    return np.stack([at + radius * along, ends - _LEADER_GAP_MM * along], axis=1)


def _crossing(leaders: Floats, texts: Floats, others: NDArray[np.object_]) -> NDArray[np.bool_]:
    """Return which leaders, shape (n, 2, 2), meet a text or another leader."""
    obstacles = np.concatenate([others, _grown(texts, _CLEAR_MM)])
    return np.asarray(np.any(shapely.intersects(shapely.linestrings(leaders)[:, None], obstacles), axis=1))


def _grown(boxes: Floats, by_mm: float) -> Any:
    """Return boxes of shape (..., 4) as areas, wider on all sides."""
    return shapely.box(*np.moveaxis(boxes + by_mm * np.array([-1.0, -1.0, 1.0, 1.0]), -1, 0))
