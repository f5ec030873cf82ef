"""Further sheets of the assembly: its units pulled apart along the joints' axis, so that every item has a balloon."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import shapely

from pareto_monoped.cad.assembly import Instance, Pose, body_frames
from pareto_monoped.cad.drawing.assembly_views import FROM_FRONT_LYING, Seen, captioned, drawn, outline_of, to_view
from pareto_monoped.cad.drawing.balloons import clear_balloons
from pareto_monoped.cad.drawing.paper import Paper
from pareto_monoped.cad.drawing.sheet import A0, A1, SCALES, Size, compose
from pareto_monoped.cad.product import Product, UniquePart
from pareto_monoped.cad.shape.meshes import placed
from pareto_monoped.cad.shape.pulled_apart import pulled_apart

_SCALE = 0.5
"""At most: heads of M3 are then 2.8 mm wide."""
_NO_WIDTH = (0.0, 1.0)  # what lies behind a part in the view is pulled apart from it too

Sheet = tuple[Paper, Size, float]


@dataclass(frozen=True, slots=True, kw_only=True)
class _Group:
    """The instances of one item that lie at one height of a unit, which stay together."""

    item: int
    members: tuple[tuple[Instance, UniquePart], ...]


def exploded_sheets(product: Product) -> list[Sheet]:
    """As few sheets as hold all units; each item is shown and numbered once.

    Raises:
        ValueError: a unit fits no sheet.
    """
    views = list(_unit_views(product))
    sheets: list[Sheet] = []
    while views:
        taken, sheet = _filled(views)
        sheets.append(sheet)
        views = views[taken:]
    return sheets


def _filled(views: Sequence[tuple[str, list[Seen]]]) -> tuple[int, Sheet]:
    """The largest scale at which the first view fits a sheet, and with it as many more as fit."""
    for scale in (scale for scale in SCALES if scale <= _SCALE):
        papers = [_view(name, seen, scale) for name, seen in views]
        for size in (A1, A0):
            for count in range(len(papers), 0, -1):
                paper = compose(size, papers[:count], [], ["The numbers are those of sheet 1."])
                if paper is not None:
                    return count, (paper, size, scale)
    raise ValueError(f"drawing of the assembly: {views[0][0]} fits no sheet")


def _view(name: str, seen: Sequence[Seen], scale: float) -> Paper:
    paper = drawn(seen, scale)
    clear_balloons(paper, seen, scale)
    return captioned(paper, name, scale)


def _unit_views(product: Product) -> Iterator[tuple[str, list[Seen]]]:
    """The parts of each unit that no unit before it has, pulled apart, seen from the front with their axes upright."""
    frames = body_frames(product.robot, Pose(hip_rad=0.0, knee_rad=0.0))
    shown: set[int] = set()
    for unit in product.robot.units:
        groups = list(_groups(product, unit.name, shown))
        shown |= {group.item for group in groups}
        if not groups:
            continue
        regions, boxes = [], []
        for group in groups:
            bodies = [
                placed(unique.mesh.body, to_view(FROM_FRONT_LYING) @ frames[instance.body] @ instance.in_body)
                for instance, unique in group.members
            ]
            regions.append(shapely.union_all([outline_of(body.project()) for body in bodies]))
            corners = np.array([body.bounding_box() for body in bodies])
            boxes.append([*corners[:, :3].min(axis=0), *corners[:, 3:].max(axis=0)])
        limits = np.array(boxes)
        limits[:, [2, 5]] = _NO_WIDTH
        moves = pulled_apart(limits, axis=1)
        yield (
            unit.name.replace("_", " ").capitalize(),
            [
                Seen(item=group.item, region=shapely.affinity.translate(region, 0.0, move), cut=False)
                for group, region, move in zip(groups, regions, moves, strict=True)
            ],
        )


def _groups(product: Product, unit: str, shown: set[int]) -> Iterator[_Group]:
    """The items of a unit that are not shown yet, each with its instances at the first of its heights."""
    found: dict[int, dict[float, list[tuple[Instance, UniquePart]]]] = {}
    for (instance, unique), kind in zip(product.placed(), product.kinds, strict=True):
        if instance.unit == unit and kind not in shown:
            height = round(float(instance.in_body[1, 3]), 3)
            found.setdefault(kind, {}).setdefault(height, []).append((instance, unique))
    for item, heights in found.items():
        yield _Group(item=item, members=tuple(next(iter(heights.values()))))
