"""Sheets after ISO 5457 with a title block after ISO 7200, and where views, tables and notes stand on them."""

from collections.abc import Sequence
from dataclasses import dataclass

from pareto_monoped.cad.drawing.paper import CHAIN, LETTER_MM, LINE_PITCH, WIDE_MM, Paper, width_mm

BINDING_MM, MARGIN_MM = 20.0, 10.0  #: Margins of the frame: for filing on the left, and on the other sides (ISO 5457).
_CENTRING_MM = 5.0
_FRAME_MM = 0.7  # width of the frame's line (ISO 5457)
TITLE_MM = (180.0, 44.0)  #: Width (ISO 7200: 180 mm at most) and height of the title block.
_CAPTION_MM = 1.8
_SPACE_MM = 6.0  # between things on a sheet


@dataclass(frozen=True, slots=True, kw_only=True)
class Size:
    """A size of paper: name, width and height."""

    name: str
    width_mm: float
    height_mm: float


A4 = Size(name="A4", width_mm=210.0, height_mm=297.0)
A3 = Size(name="A3", width_mm=420.0, height_mm=297.0)
A2 = Size(name="A2", width_mm=594.0, height_mm=420.0)
A1 = Size(name="A1", width_mm=841.0, height_mm=594.0)
A0 = Size(name="A0", width_mm=1189.0, height_mm=841.0)
SIZES = (A4, A3, A2, A1, A0)  #: The upright A4 and the others lying, as ISO 5457 has them.
SCALES = (10.0, 5.0, 2.0, 1.0, 0.5, 0.2, 0.1)  #: ISO 5455.
Box = tuple[float, float, float, float]
Placing = tuple[list[tuple[float, float]], float]  #: Lower left corners of tables, and how much room they take.


@dataclass(frozen=True, slots=True, kw_only=True)
class Title:
    """What the title block says."""

    name: str  #: of the part, in words
    number: str  #: of the drawing
    material: str  #: with condition
    hardness: str = ""
    mass: str  #: of one, with its unit
    count: int  #: how many the robot has
    process: str  #: how it is made
    tolerances: str = ""  #: general ones
    finish: str = ""  #: arithmetical mean height Ra in micrometres of all faces without another; '' for none
    design: str  #: which robot
    digest: str  #: hash of the design
    date: str  #: of the design; '' if nothing tells it
    maker: str  #: the program


def scale_text(scale: float) -> str:
    """Return a text such as ``2:1``."""
    return f"{scale:g}:1" if scale >= 1.0 else f"1:{1.0 / scale:g}"


def inner_mm(size: Size) -> tuple[float, float]:
    """Return width of a sheet within its frame, and height above its title block."""
    return (size.width_mm - BINDING_MM - MARGIN_MM, size.height_mm - 2.0 * MARGIN_MM - TITLE_MM[1])


def compose(size: Size, views: Sequence[Paper], tables: Sequence[Paper], notes: Sequence[str]) -> Paper | None:
    """Return a sheet without frame and title block, with its views in a row, tables at the right or below, and notes.

    The views' middles stand at their y = 0. There is no sheet if all that does not fit.
    """
    left, bottom = BINDING_MM, MARGIN_MM
    right, top = size.width_mm - MARGIN_MM, size.height_mm - MARGIN_MM
    boxes = [view.box() for view in views]
    wide = sum(box[2] - box[0] for box in boxes) + _SPACE_MM * (len(boxes) + 1)
    low, high = min(box[1] for box in boxes), max(box[3] for box in boxes)
    written = _written(notes, TITLE_MM[0] - 8.0 if size is A4 else right - left - TITLE_MM[0] - 12.0)
    note_box = written.box()
    note_height = note_box[3] - note_box[1]
    table_boxes = [table.box() for table in tables]
    beside = size is not A4
    # A last line that reaches the middle of the sheet would run into its centring mark.
    reaches = beside and bool(notes) and left + 4.0 + written.labels[-1].box()[2] > 0.5 * size.width_mm - 1.0
    under = _CENTRING_MM + 1.0 if reaches else 3.0
    floor = (
        bottom
        + (max(TITLE_MM[1], note_height + under - 3.0) if beside else TITLE_MM[1] + note_height + _SPACE_MM)
        + 2.0
    )
    placing = _columned(table_boxes, top - floor) if beside else _shelved(table_boxes, right - left - 8.0)
    if placing is None:
        return None
    places, taken = placing
    room_wide = right - left - (taken if beside else 0.0)
    room_low = floor + (0.0 if beside else taken)
    if wide > room_wide or high - low + 2.0 * _SPACE_MM > top - room_low:
        return None
    paper = Paper()
    spare = (room_wide - wide) / (len(views) + 1) + _SPACE_MM
    x, middle = left + spare, 0.5 * (room_low + top) - 0.5 * (low + high)
    for view, box in zip(views, boxes, strict=True):
        paper.lay(view, x - box[0], middle)
        x += box[2] - box[0] + spare
    corner = (right, top) if beside else (left + 4.0, floor)
    for table, box, (dx, dy) in zip(tables, table_boxes, places, strict=True):
        paper.lay(table, corner[0] + dx - box[0], corner[1] + dy - box[1])
    paper.lay(written, left + 4.0, bottom + under + (0.0 if beside else TITLE_MM[1]) - note_box[1])
    return paper


def _columned(boxes: Sequence[Box], height: float) -> Placing | None:
    """Return places of tables in columns, from the upper right corner leftwards; None if one is too high."""
    places: list[tuple[float, float]] = []
    x = y = column = 0.0
    for box in boxes:
        wide, high = box[2] - box[0], box[3] - box[1]
        if high + _SPACE_MM > height:
            return None
        if y + high + _SPACE_MM > height:
            x, y, column = x + column + _SPACE_MM, 0.0, 0.0
        column = max(column, wide)
        y += high + _SPACE_MM
        places.append((-x - _SPACE_MM - wide, -y))
    return places, x + column + 2.0 * _SPACE_MM if boxes else 0.0


def _shelved(boxes: Sequence[Box], width: float) -> Placing | None:
    """Return places of tables in rows, from the lower left corner upwards; None if one is too wide."""
    places: list[tuple[float, float]] = []
    x = y = row = 0.0
    for box in boxes:
        wide, high = box[2] - box[0], box[3] - box[1]
        if wide > width:
            return None
        if x > 0.0 and x + wide > width:
            x, y, row = 0.0, y + row + _SPACE_MM, 0.0
        places.append((x, y))
        x, row = x + wide + _SPACE_MM, max(row, high)
    return places, y + row + (_SPACE_MM if boxes else 0.0)


def _written(notes: Sequence[str], width: float) -> Paper:
    """Return notes as text, broken to a width, the last line at y = 0."""
    paper = Paper()
    lines = [line for note in notes for line in broken(note, width)]
    for k, line in enumerate(lines):
        paper.text(line, 0.0, (len(lines) - 1 - k) * LINE_PITCH * LETTER_MM)
    return paper


def broken(text: str, width: float, height_mm: float = LETTER_MM) -> list[str]:
    """Return a text broken into lines between its words."""
    lines: list[str] = []
    for word in text.split():
        longer = f"{lines[-1]} {word}" if lines else word
        if lines and width_mm(longer, height_mm) <= width:
            lines[-1] = longer
        else:
            lines.append(word)
    return lines


def titled(paper: Paper, size: Size, scale: float, title: Title, number: str = "1/1") -> None:
    """Add frame and title block to a sheet; ``number`` is the sheet's number over how many sheets there are."""
    _border(paper, size)
    _title_block(paper, size, scale, title, number)


def _border(paper: Paper, size: Size) -> None:
    left, right, top = BINDING_MM, size.width_mm - MARGIN_MM, size.height_mm - MARGIN_MM
    paper.line([(left, MARGIN_MM), (right, MARGIN_MM), (right, top), (left, top)], width_mm=_FRAME_MM, closed=True)
    x, y = 0.5 * size.width_mm, 0.5 * size.height_mm
    # The title block of an A4 covers the middle of its lower edge.
    for mark in (
        [(x, 5.0), (x, MARGIN_MM + (0.0 if size is A4 else _CENTRING_MM))],
        [(x, size.height_mm - 5.0), (x, top - _CENTRING_MM)],
        [(left - 10.0, y), (left + _CENTRING_MM, y)],
        [(size.width_mm - 5.0, y), (right - _CENTRING_MM, y)],
    ):
        paper.line(mark, width_mm=_FRAME_MM)


def _title_block(paper: Paper, size: Size, scale: float, title: Title, number: str) -> None:
    """Draw the block at the lower right: rows of cells, each with a small caption over its value."""
    x0, y0 = size.width_mm - MARGIN_MM - TITLE_MM[0], MARGIN_MM
    rows: tuple[tuple[tuple[float, str, str], ...], ...] = (
        ((80.0, "Name", title.name), (70.0, "Drawing", title.number), (30.0, "Sheet", f"{size.name}   {number}")),
        ((80.0, "Design", title.design), (35.0, "Design hash", title.digest), (35.0, "Date", title.date),
         (30.0, "Made by", title.maker)),
        ((64.0, "Material", title.material), (34.0, "Hardness", title.hardness), (20.0, "Mass of one", title.mass),
         (12.0, "Count", str(title.count)), (50.0, "Process", title.process)),
        ((35.0, "General tolerances", title.tolerances), (45.0, "Surface, Ra in µm (ISO 21920)", ""),
         (35.0, "Edges (ISO 13715)", "-0.3 / +0.1" if title.finish else ""), (25.0, "Scale", scale_text(scale)),
         (15.0, "Units", "mm"), (25.0, "Projection", "")),
    )  # fmt: skip
    high = TITLE_MM[1] / len(rows)
    for k, row in enumerate(rows):
        x, y = x0, y0 + k * high
        for wide, caption, value in row:
            paper.line([(x, y), (x + wide, y), (x + wide, y + high), (x, y + high)], closed=True)
            paper.text(caption, x + 1.2, y + high - _CAPTION_MM - 1.2, height_mm=_CAPTION_MM)
            height = 3.5 if caption in ("Name", "Drawing", "Scale") else LETTER_MM
            long, room = width_mm(value, height), wide - 2.4
            height = height if long <= room else height * room / long
            paper.text(value, x + 1.2, y + 2.2, height_mm=height)
            x += wide
    x1, y1 = x0 + TITLE_MM[0], y0 + TITLE_MM[1]
    paper.line([(x0, y0), (x1, y0), (x1, y1), (x0, y1)], width_mm=WIDE_MM, closed=True)
    y = y0 + 3.0 * high
    if title.finish:
        surface(paper, title.finish, x0 + 40.0, y + 1.6)
    _first_angle(paper, x0 + 167.0, y + 4.2)


def surface(paper: Paper, roughness: str, x: float, y: float) -> None:
    """Draw the symbol of a machined surface (ISO 21920-1) with its value; its tip is at (x, y)."""
    paper.line([(x - 1.5, y + 2.6), (x, y), (x + 3.0, y + 5.2), (x + 5.0 + width_mm(roughness, LETTER_MM), y + 5.2)])
    paper.line([(x - 1.5, y + 2.6), (x + 1.5, y + 2.6)])
    paper.text(roughness, x + 3.6, y + 2.0)


def _first_angle(paper: Paper, x: float, y: float) -> None:
    """Draw the symbol of first-angle projection (ISO 5456-2) around (x, y): the cone, then its view from the left."""
    paper.line([(x - 8.0, y - 1.25), (x - 2.0, y - 2.5), (x - 2.0, y + 2.5), (x - 8.0, y + 1.25)], closed=True)
    paper.line([(x - 9.0, y), (x - 1.0, y)], dashes=CHAIN)
    paper.circle(x + 4.0, y, 2.5)
    paper.circle(x + 4.0, y, 1.25)
    paper.centre_mark(x + 4.0, y, 3.5)


def table(title: str, head: Sequence[str], rows: Sequence[Sequence[str]]) -> Paper:
    """Return a table with a title, its lower left corner at the origin; without names of columns it has no head."""
    high = 5.0
    shown = (*([head] if any(head) else []), *rows)
    wide = [max(width_mm(row[k], LETTER_MM) for row in shown) + 3.0 for k in range(len(head))]
    whole, top = sum(wide), high * len(shown)
    paper = Paper()
    paper.text(title, 0.0, top + 1.6)
    for k, row in enumerate(shown):
        y, x = top - (k + 1) * high, 0.0
        for cell, width in zip(row, wide, strict=True):
            paper.text(cell, x + 1.5, y + 0.5 * (high - LETTER_MM) + 0.2)
            x += width
        paper.line([(0.0, y), (whole, y)])
    x = 0.0
    for width in (*wide[:-1], 0.0):
        paper.line([(x, 0.0), (x, top)])
        x += width
    paper.line([(0.0, 0.0), (whole, 0.0), (whole, top), (0.0, top)], width_mm=0.35, closed=True)
    return paper
