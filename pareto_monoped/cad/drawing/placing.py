"""Names beside what they name, placed by a rule: where their boxes meet no line, no arrow and no other text.

Places are tried outwards; a name that stands far off has a leader, which meets no text and no other leader.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from pareto_monoped.cad.drawing.paper import Align, Label, Paper

Floats = NDArray[np.float64]

_NEAR_MM = 4.0
"""Names that stand off farther have a leader."""
_REACHES_MM = np.array(
    [1.0, 2.0, 3.5, 5.0, 7.0, 9.0, 12.0, 15.0, 19.0, 24.0, 30.0, 38.0, 48.0, 60.0, 80.0, 110.0, 150.0]
)
_ANGLES = np.radians(
    [45.0, 135.0, 225.0, 315.0, 0.0, 90.0, 180.0, 270.0, 22.5, 67.5, 112.5, 157.5, 202.5, 247.5, 292.5, 337.5]
)
_WAYS = np.array([[np.cos(angle), np.sin(angle)] for angle in _ANGLES])
_ALIGNS: tuple[Align, ...] = tuple("left" if x > 0.3 else "right" if x < -0.3 else "centre" for x in _WAYS[:, 0])
"""Directions in which a name may stand, and how it is then aligned."""
_CLEAR_MM, _APART_MM = 0.2, 0.4
"""Least distance of a name from lines and from other texts."""
_LEADER_GAP_MM = 0.3


@dataclass(frozen=True, slots=True, kw_only=True)
class Tag:
    """A name to place.

    Attributes:
        text: what it says.
        x, y: of what it names, on the part.
        radius: of that; 0 for a point.
        height_mm: of the text on paper.
    """

    text: str
    x: float
    y: float
    radius: float
    height_mm: float


@dataclass(frozen=True, slots=True, kw_only=True)
class _Place:
    """Where a name may stand, and its leader as two points if it needs one."""

    label: Label
    leader: Floats | None


def place_tags(paper: Paper, tags: Sequence[Tag], scale: float) -> None:
    """Write names on a view.

    Args:
        paper: the view, complete but for them.
        tags: the names.
        scale: paper over part.

    Raises:
        ValueError: a name has no free place.
    """
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
    """Every straight piece of the lines of a paper, and its arrow heads."""
    runs = [np.vstack([s.points, s.points[:1]]) if s.closed else s.points for s in paper.strokes]
    pairs = [np.stack([run[:-1], run[1:]], axis=1) for run in runs if len(run) > 1]
    straight = shapely.linestrings(np.concatenate(pairs)) if pairs else np.empty(0, dtype=object)
    return np.concatenate([straight, np.array([shapely.polygons(fill.points) for fill in paper.fills], dtype=object)])


def _free(tag: Tag, scale: float, lines: shapely.STRtree, texts: Floats, leaders: Sequence[Floats]) -> _Place:
    """The nearest free place of a name, at best one whose leader crosses nothing that can be read or followed."""
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
    """Which boxes, shape (n, 4), meet a line, another text or a leader; all of them at once, as there are many."""
    high, low = boxes[:, None, 2:] + _APART_MM, boxes[:, None, :2] - _APART_MM
    covered = np.any(np.all((texts[:, :2] < high) & (texts[:, 2:] > low), axis=2), axis=1)
    areas = _grown(boxes, _CLEAR_MM)
    covered[lines.query(areas, predicate="intersects")[0]] = True
    covered |= np.any(shapely.intersects(areas[:, None], leaders), axis=1)
    return np.asarray(covered)


def _leaders(at: Floats, radius: float, boxes: Floats) -> Floats:
    """The lines from what is named to the nearest points of the boxes of its name, shape (n, 2, 2)."""
    ends = np.clip(at, boxes[:, :2], boxes[:, 2:])
    along = (ends - at) / np.hypot(*(ends - at).T)[:, None]
    return np.stack([at + radius * along, ends - _LEADER_GAP_MM * along], axis=1)


def _crossing(leaders: Floats, texts: Floats, others: NDArray[np.object_]) -> NDArray[np.bool_]:
    """Which leaders, shape (n, 2, 2), meet a text or another leader."""
    obstacles = np.concatenate([others, _grown(texts, _CLEAR_MM)])
    return np.asarray(np.any(shapely.intersects(shapely.linestrings(leaders)[:, None], obstacles), axis=1))


def _grown(boxes: Floats, by_mm: float) -> Any:
    """Boxes of shape (..., 4) as areas, wider on all sides."""
    return shapely.box(*np.moveaxis(boxes + by_mm * np.array([-1.0, -1.0, 1.0, 1.0]), -1, 0))
