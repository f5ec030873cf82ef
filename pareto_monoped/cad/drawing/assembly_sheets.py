"""The drawing of the assembly: side view and sections, its units pulled apart, and its cables, with lists and balloons.

On the sheets with units pulled apart along the joints' axis every item has a balloon. The sheet of the cables shows
base and actuators from the front and from the left, with every corner of every cable.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from string import ascii_uppercase

import numpy as np
import shapely
from numpy.typing import NDArray

from pareto_monoped.cad.assembly import Instance, Pose, body_frames, pulled_apart
from pareto_monoped.cad.cables import Cable, cables, rounded
from pareto_monoped.cad.drawing.assembly_views import (
    FROM_FRONT,
    FROM_FRONT_LYING,
    FROM_LEFT,
    Seen,
    areas,
    balloons,
    captioned,
    clear_balloons,
    drawn,
    leg_section,
    outline_of,
    overall,
    side_view,
    to_view,
    within,
)
from pareto_monoped.cad.drawing.bores import number
from pareto_monoped.cad.drawing.dimension import Tag, place_tags
from pareto_monoped.cad.drawing.paper import Paper
from pareto_monoped.cad.drawing.sheet import A0, A1, A2, SCALES, Size, compose, scale_text, table
from pareto_monoped.cad.product import Product, UniquePart
from pareto_monoped.cad.shape.meshes import placed
from pareto_monoped.geometry.roles import Role, Visibility

_ITEMS = 99  # rows of the list of items in one column
_CLEAR_MM2 = 60.0  # least area on paper of a region with a balloon on the first sheet (our own choice)
_SECTION_SCALE = 1.0
_ABOVE_MM, _BELOW_MM = 130.0, 110.0
"""How far the hip's section reaches above and below its axis; the knee's reaches as far as 70 mm either way."""
_KNEE_MM = 70.0
_CAPTION_MM = 3.5
_NOTES = (
    "The numbers are the rows of bom.csv.",
    "Large items have balloons here; the sheets that follow show every item.",
    "Overall dimensions are those of the view, without cables.",
)
_EXPLODED_SCALE = 0.5  # at most: heads of M3 are then 2.8 mm wide
_NO_WIDTH = (0.0, 1.0)  # what lies behind a part in the view is pulled apart from it too
_CABLE_MM, _CORNER_MM = 0.7, 2.5
_CABLE_SCALE = 1.0
_CABLE_VIEWS = (("From the front", FROM_FRONT), ("From the left", FROM_LEFT))
_CABLE_NOTES = (
    "Lengths in mm, from the hip's axis in the middle of the leg: x forward, y left, z up. The thigh hangs down.",
    "Path: along the middle line with rounded corners. Cut: with the tails at both ends, rounded up.",
)

Sheet = tuple[Paper, Size, float]


def assembly_sheet(product: Product) -> Sheet:
    """Return the sheet of the assembly; ``ValueError`` if the robot fits no sheet."""
    side, section = side_view(product), leg_section(product)
    knee = -1000.0 * product.robot.design.thigh_length_m
    cuts = (
        ("Section through the hip, joints straight", within(section, -_BELOW_MM, _ABOVE_MM)),
        ("Section through the knee, joints straight", within(section, knee - _KNEE_MM, knee + _KNEE_MM)),
    )
    tables = _lists(product)
    for size in (A1, A0):
        for scale in (scale for scale in SCALES if scale <= _SECTION_SCALE):
            paper = compose(size, _views(side, cuts, scale), tables, _NOTES)
            if paper is not None:
                return paper, size, scale
    raise ValueError("drawing of the assembly: the robot fits no sheet")


def _views(side: Sequence[Seen], cuts: Sequence[tuple[str, list[Seen]]], scale: float) -> list[Paper]:
    """Return side view, and the sections below each other; each item has its balloon where it is seen best."""
    pointed: dict[int, int] = {}
    shown = [(side, scale), *((seen, _SECTION_SCALE) for _, seen in cuts)]
    for k, (seen, at) in enumerate(shown):
        for item, area in areas(seen).items():
            if area * at**2 > _CLEAR_MM2:
                pointed.setdefault(item, k)
    papers = []
    captions = [f"Side view, {scale_text(scale)}", *(f"{name}, {scale_text(_SECTION_SCALE)}" for name, _ in cuts)]
    for k, (seen, at) in enumerate(shown):
        paper = drawn(seen, at)
        extent = paper.box()
        balloons(paper, seen, at, [item for item, view in pointed.items() if view == k])
        overall(paper, extent, at, high=k == 0)
        left, _, right, top = paper.box()
        paper.text(captions[k], 0.5 * (left + right), top + 6.0, height_mm=_CAPTION_MM, align="centre")
        papers.append(paper)
    return [_centred([papers[0]]), _centred(papers[1:])]


def _centred(papers: Sequence[Paper]) -> Paper:
    """Return papers below each other, with the middle of the column at the origin."""
    column = Paper()
    y = 0.0
    for paper in papers:
        left, low, right, high = paper.box()
        column.lay(paper, -0.5 * (left + right), y - high)
        y -= high - low + 15.0
    _, low, _, high = column.box()
    middle = Paper()
    middle.lay(column, 0.0, -0.5 * (low + high))
    return middle


def _lists(product: Product) -> list[Paper]:
    rows = []
    for k, unique in enumerate(product.unique, 1):
        material = unique.part.grade or unique.part.material
        rows.append((f"{k}", f"{unique.count}", unique.name.replace("_", " "), material.name))
    head = ("Item", "Count", "Part", "Material")
    chunks = [rows[k : k + _ITEMS] for k in range(0, len(rows), _ITEMS)]
    return [table("Items" if k == 0 else "Items, continued", head, chunk) for k, chunk in enumerate(chunks)]


@dataclass(frozen=True, slots=True, kw_only=True)
class _Group:
    """The instances of one item that lie at one height of a unit, which stay together."""

    item: int
    members: tuple[tuple[Instance, UniquePart], ...]


def exploded_sheets(product: Product) -> list[Sheet]:
    """Return as few sheets as hold all units, each item once; ``ValueError`` if a unit fits no sheet."""
    views = list(_unit_views(product))
    sheets: list[Sheet] = []
    while views:
        taken, sheet = _filled(views)
        sheets.append(sheet)
        views = views[taken:]
    return sheets


def _filled(views: Sequence[tuple[str, list[Seen]]]) -> tuple[int, Sheet]:
    """Return the largest scale at which the first view fits a sheet, and with it as many more as fit."""
    for scale in (scale for scale in SCALES if scale <= _EXPLODED_SCALE):
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
    """Yield the parts that each unit adds, pulled apart, seen from the front with their axes upright."""
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
        moved = zip(groups, regions, pulled_apart(limits, axis=1), strict=True)
        seen = [Seen(item=g.item, region=shapely.affinity.translate(r, 0.0, up), cut=False) for g, r, up in moved]
        yield unit.name.replace("_", " ").capitalize(), seen


def _groups(product: Product, unit: str, shown: set[int]) -> Iterator[_Group]:
    """Yield the items of a unit that are not shown yet, each with its instances at the first of its heights."""
    found: dict[int, dict[float, list[tuple[Instance, UniquePart]]]] = {}
    for (instance, unique), kind in zip(product.placed(), product.kinds, strict=True):
        if instance.unit == unit and kind not in shown:
            height = round(float(instance.in_body[1, 3]), 3)
            found.setdefault(kind, {}).setdefault(height, []).append((instance, unique))
    for item, heights in found.items():
        yield _Group(item=item, members=tuple(next(iter(heights.values()))))


def cable_sheet(product: Product) -> Sheet:
    """Return the sheet of the cables; ``ValueError`` if the robot fits no sheet."""
    made = cables(product.robot)
    regions = {name: list(_near_cables(product, axes)) for name, axes in _CABLE_VIEWS}
    tables = _tables(made)
    warnings = [f"{cable.warning[0].upper()}{cable.warning[1:]}." for cable in made if cable.warning]
    notes = (*_CABLE_NOTES, *warnings)
    for scale in (scale for scale in SCALES if scale <= _CABLE_SCALE):
        views = [_cable_view(name, regions[name], axes, made, scale) for name, axes in _CABLE_VIEWS]
        for size in (A2, A1):
            paper = compose(size, views, tables, notes)
            if paper is not None:
                return paper, size, scale
    raise ValueError("drawing of the cables: the robot fits no sheet")


def _near_cables(product: Product, axes: NDArray[np.float64]) -> Iterator[Seen]:
    """Yield whole outlines of what stands on the base or belongs to an actuator, with the leg hanging down."""
    frames = body_frames(product.robot, Pose(hip_rad=0.0, knee_rad=0.0))
    units = {unit.name for unit in product.robot.units if unit.body == "base"}
    for (instance, unique), item in zip(product.placed(), product.kinds, strict=True):
        near = instance.unit in units or instance.part.role in (Role.HOUSING, Role.SHAFT, Role.ELECTRONICS)
        if instance.body == "shank" or not near or instance.part.visibility is not Visibility.OUTSIDE:
            continue
        body = placed(unique.mesh.body, to_view(axes) @ frames[instance.body] @ instance.in_body)
        yield Seen(item=item, region=outline_of(body.project()), cut=False)


def _cable_view(
    name: str, seen: Sequence[Seen], axes: NDArray[np.float64], made: Sequence[Cable], scale: float
) -> Paper:
    """Return the outlines with the cables over them, and a name at every corner."""
    paper = drawn(seen, scale)
    tags = []
    for letter, cable in zip(ascii_uppercase, made, strict=False):
        line = rounded(cable.points_mm, cable.bend_radius_mm) @ axes[:2].T * scale
        paper.line(line, width_mm=_CABLE_MM)
        for k, (x, y) in enumerate((cable.points_mm @ axes[:2].T).tolist(), 1):
            tags.append(Tag(text=f"{letter}{k}", x=x, y=y, radius=0.0, height_mm=_CORNER_MM))
    place_tags(paper, tags, scale)
    return captioned(paper, name, scale)


def _tables(made: Sequence[Cable]) -> list[Paper]:
    cut, corners = [], []
    for letter, cable in zip(ascii_uppercase, made, strict=False):
        what = (f"{cable.start} to {cable.end}", f"{cable.wires} x {cable.designation}")
        cut.append((letter, *what, f"{cable.length_mm:.0f}", f"{cable.cut_mm:g}", f"{cable.bend_radius_mm:.0f}"))
        for k, (point, note) in enumerate(zip(cable.points_mm.tolist(), cable.notes, strict=True), 1):
            corners.append((f"{letter}{k}", *(number(round(value, 1)) for value in point), note))
    return [
        table("Cables", ("Cable", "From, to", "Wires", "Path", "Cut", "Bend radius"), cut),
        table("Corners", ("Corner", "x", "y", "z", "What"), corners),
    ]
