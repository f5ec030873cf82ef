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
    at = scale * np.array([tag.x, tag.y])
    second_best: _Place | None = None
    for reach in _REACHES_MM:
        places = [_place(tag, at, scale * tag.radius, float(reach), float(angle)) for angle in _ANGLES]
        boxes = np.array([place.label.box() for place in places])
        covered = np.zeros(len(places), dtype=bool)
        covered[lines.query(_grown(boxes, _CLEAR_MM), predicate="intersects")[0]] = True
        others = shapely.linestrings(leaders) if leaders else np.empty(0, dtype=object)
        for place, box, hit in zip(places, boxes, covered, strict=True):
            if hit or _meets_texts(box, texts) or _meet(_grown(box, _CLEAR_MM), others):
                continue
            if place.leader is None:
                return place
            own = shapely.linestrings(place.leader)
            if not _meet(own, others) and not _meet(own, _grown(texts, _CLEAR_MM)):
                return place
            second_best = second_best or place
    # On a sheet that is too small for its names; a larger one is taken if there is any.
    if second_best is not None:
        return second_best
    raise ValueError(f"no free place for the name {tag.text!r} on a drawing")


def _place(tag: Tag, at: Floats, radius: float, reach: float, angle: float) -> _Place:
    """A name in some direction from what it names."""
    way = np.array([np.cos(angle), np.sin(angle)])
    x, y = at + (radius + reach) * way
    align: Align = "left" if way[0] > 0.3 else "right" if way[0] < -0.3 else "centre"
    lowered = y - tag.height_mm * (0.5 - 0.5 * way[1])
    label = Label(text=tag.text, x=float(x), y=float(lowered), height_mm=tag.height_mm, align=align)
    if reach <= _NEAR_MM:
        return _Place(label=label, leader=None)
    left, low, right, high = label.box()
    end = np.clip(at, [left, low], [right, high])
    along = (end - at) / np.hypot(*(end - at))
    return _Place(label=label, leader=np.array([at + radius * along, end - _LEADER_GAP_MM * along]))


def _grown(boxes: Floats, by_mm: float) -> Any:
    """Boxes of shape (..., 4) as areas, wider on all sides."""
    return shapely.box(*np.moveaxis(boxes + by_mm * np.array([-1.0, -1.0, 1.0, 1.0]), -1, 0))


def _meets_texts(box: Floats, texts: Floats) -> bool:
    near = (texts[:, :2] < box[2:] + _APART_MM) & (texts[:, 2:] > box[:2] - _APART_MM)
    return bool(np.any(np.all(near, axis=1)))


def _meet(one: Any, others: Any) -> bool:
    return bool(np.any(shapely.intersects(one, others)))
