"""The drawing of the assembly: the robot from its side, sections of hip and knee, balloons and the list of items."""

from collections.abc import Sequence

from pareto_monoped.cad.drawing.assembly_views import Seen, areas, drawn, leg_section, side_view, within
from pareto_monoped.cad.drawing.balloons import balloons
from pareto_monoped.cad.drawing.paper import Paper
from pareto_monoped.cad.drawing.sheet import A0, A1, SCALES, Size, compose, scale_text, table
from pareto_monoped.cad.product import Product

_ITEMS = 99
"""Rows of the list of items in one column."""
_CLEAR_MM2 = 12.0
"""Area on paper of a region that a balloon's leader is sure to find (our own choice)."""
_SECTION_SCALE = 1.0
_ABOVE_MM, _BELOW_MM = 130.0, 110.0
"""How far the hip's section reaches above and below its axis; the knee's reaches as far as 70 mm either way."""
_KNEE_MM = 70.0
_CAPTION_MM = 3.5
_NOTES = ("The numbers are the rows of bom.csv.", "The sheets that follow show every item.")


def assembly_sheet(product: Product) -> tuple[Paper, Size, float]:
    """The sheet of the assembly.

    Raises:
        ValueError: the robot fits no sheet.
    """
    side, section = side_view(product), leg_section(product)
    knee = -1000.0 * product.robot.design.thigh_length_m
    cuts = (
        ("Section through the hip, joints straight", within(section, -_BELOW_MM, _ABOVE_MM)),
        ("Section through the knee, joints straight", within(section, knee - _KNEE_MM, knee + _KNEE_MM)),
    )
    tables = _lists(product)
    for size in (A1, A0):
        for scale in (scale for scale in SCALES if scale <= _SECTION_SCALE):
            views = _views(side, cuts, scale)
            paper = compose(size, views, tables, _NOTES)
            if paper is not None:
                return paper, size, scale
    raise ValueError("drawing of the assembly: the robot fits no sheet")


def _views(side: Sequence[Seen], cuts: Sequence[tuple[str, list[Seen]]], scale: float) -> list[Paper]:
    """Side view, and the sections below each other; each item has its balloon where it is seen best."""
    pointed: dict[int, int] = {}
    shown = [(side, scale), *((seen, _SECTION_SCALE) for _, seen in cuts)]
    for least in (_CLEAR_MM2, 0.0):
        for k, (seen, at) in enumerate(shown):
            for item, area in areas(seen).items():
                if area * at**2 > least:
                    pointed.setdefault(item, k)
    papers = []
    captions = [f"Side view, {scale_text(scale)}", *(f"{name}, {scale_text(_SECTION_SCALE)}" for name, _ in cuts)]
    for k, (seen, at) in enumerate(shown):
        paper = drawn(seen, at)
        balloons(paper, seen, at, [item for item, view in pointed.items() if view == k])
        left, _, right, top = paper.box()
        paper.text(captions[k], 0.5 * (left + right), top + 6.0, height_mm=_CAPTION_MM, align="centre")
        papers.append(paper)
    return [_centred([papers[0]]), _centred(papers[1:])]


def _centred(papers: Sequence[Paper]) -> Paper:
    """Papers below each other, with the middle of the column at the origin."""
    column = Paper()
    y = 0.0
    for paper in papers:
        left, low, right, high = paper.box()
        column.lay(paper, -0.5 * (left + right), y - high)
        y -= high - low + 15.0
    whole = column.box()
    middle = Paper()
    middle.lay(column, 0.0, -0.5 * (whole[1] + whole[3]))
    return middle


def _lists(product: Product) -> list[Paper]:
    """The list of items, in the order of ``bom.csv``."""
    rows = [
        (
            f"{k}",
            f"{unique.count}",
            unique.name.replace("_", " "),
            _material(unique.part.grade, unique.part.material.name),
        )
        for k, unique in enumerate(product.unique, 1)
    ]
    head = ("Item", "Count", "Part", "Material")
    chunks = [rows[k : k + _ITEMS] for k in range(0, len(rows), _ITEMS)]
    return [table("Items" if k == 0 else "Items, continued", head, chunk) for k, chunk in enumerate(chunks)]


def _material(grade: object, name: str) -> str:
    return str(getattr(grade, "name", name))
