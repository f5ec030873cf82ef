"""DXF drawings of laser-cut plates: the true outline and holes, without kerf, on one layer, in millimetres.

A second layer says in words what is done after cutting: countersinks, threads, reamed holes. A DXF file is a list of
pairs, each a group code and a value on lines of their own (AutoCAD DXF reference, release 12). The folder
``test_stand/`` of an export has the arms that hang the base on two vertical rails.
"""

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from pareto_monoped.cad.drawing.bores import bores
from pareto_monoped.cad.drawing.paper import TIMES
from pareto_monoped.cad.shape.outlines import Contour, Spline, contours
from pareto_monoped.geometry.parts import Part
from pareto_monoped.geometry.shapes import Arc, Circle, Line
from pareto_monoped.leg.dimensions import LegDimensions
from pareto_monoped.leg.stand import MGN12H, arm, carriage_places, carriage_screw, rod_screws

LAYER = "CUT"
NOTES = "NOTES"  #: Layer of texts, which the laser must not engrave.
_TEXT_MM = 2.5
_CHARACTERS = ((TIMES, "x"), ("Ø", "%%c"), ("°", "%%d"))  # how R12 writes what is not ASCII

Pair = tuple[int, str]  #: A group code and its value.


def _layer(name: str, colour: int) -> tuple[Pair, ...]:
    return (0, "LAYER"), (2, name), (70, "0"), (62, str(colour)), (6, "CONTINUOUS")  # 70: neither frozen nor locked


_HEAD: tuple[Pair, ...] = (  # release 12, millimetres
    *((0, "SECTION"), (2, "HEADER"), (9, "$ACADVER"), (1, "AC1009"), (9, "$INSUNITS"), (70, "4"), (0, "ENDSEC")),
)
_LAYERS: tuple[Pair, ...] = (  # two layers: black or white, whichever shows, and red
    *((0, "SECTION"), (2, "TABLES"), (0, "TABLE"), (2, "LAYER"), (70, "2")),
    *(*_layer(LAYER, 7), *_layer(NOTES, 1), (0, "ENDTAB"), (0, "ENDSEC")),
)
_ENTITIES: tuple[Pair, ...] = ((0, "SECTION"), (2, "ENTITIES"))
_END: tuple[Pair, ...] = ((0, "ENDSEC"), (0, "EOF"))

# Group codes of an entity's values; x of a point has the code given, y that plus 10, z that plus 20.
_ENTITY, _TEXT, _ON_LAYER, _FIRST_POINT, _SECOND_POINT = 0, 1, 8, 10, 11
_RADIUS, _HEIGHT, _START_DEG, _END_DEG = 40, 40, 50, 51


def is_flat(part: Part) -> bool:
    """Return whether a part is one plate that a laser can cut."""
    return part.process == "laser cut" and len(part.prisms) == 1


def dxf(part: Part) -> str:
    """Return a DXF file (R12, which every laser's software reads) of a flat part; ``ValueError`` for other parts."""
    if not is_flat(part):
        raise ValueError(f"{part.name}: not a flat part")
    (prism,) = part.prisms
    drawn = [contour for shape in (prism.outline, *prism.holes) for contour in contours(shape)]
    entities = [pair for contour in drawn for pair in _contour(part.name, contour)]
    pairs = (*_HEAD, *_LAYERS, *_ENTITIES, *entities, *_notes(part), *_END)
    return "".join(f"{code}\n{value}\n" for code, value in pairs)


def _notes(part: Part) -> Iterator[Pair]:
    """Yield a text beside the first of all equal holes that are worked on after cutting; the file shows z upwards."""
    for bore in bores(part, on_axis=True):
        details = list(bore.details(from_above=True))
        threaded = bore.feature is not None and bore.feature.thread is not None
        if not (details or threaded or bore.fit is not None):
            continue
        text = ", ".join([bore.size(), *details])
        if bore.count > 1:
            text = f"{bore.count} {TIMES} {text}"
        for character, code in _CHARACTERS:
            text = text.replace(character, code)
        x, y = bore.centres[0]
        yield from _entity("TEXT", NOTES)
        yield from _point(_FIRST_POINT, x + bore.radius + 1.0, y - 0.5 * _TEXT_MM)
        yield _HEIGHT, _number(_TEXT_MM)
        yield _TEXT, text


def _contour(name: str, contour: Contour) -> Iterator[Pair]:
    if contour.circle is not None:
        yield from _circle(contour.circle)
    for piece in contour.pieces:
        if isinstance(piece, Spline):
            raise ValueError(f"{name}: a spline cannot be drawn for the laser")
        yield from _line(piece) if isinstance(piece, Line) else _arc(piece)


def _circle(circle: Circle) -> Iterator[Pair]:
    yield from _entity("CIRCLE")
    yield from _point(_FIRST_POINT, float(circle.x_mm), float(circle.y_mm))
    yield _RADIUS, _number(float(circle.radius_mm))


def _line(line: Line) -> Iterator[Pair]:
    yield from _entity("LINE")
    yield from _point(_FIRST_POINT, float(line.x0_mm), float(line.y0_mm))
    yield from _point(_SECOND_POINT, float(line.x1_mm), float(line.y1_mm))


def _arc(arc: Arc) -> Iterator[Pair]:
    # DXF arcs run anticlockwise.
    start_rad, end_rad = sorted((float(arc.start_rad), float(arc.end_rad)))
    yield from _entity("ARC")
    yield from _point(_FIRST_POINT, float(arc.x_mm), float(arc.y_mm))
    yield _RADIUS, _number(float(arc.radius_mm))
    yield _START_DEG, _number(np.degrees(start_rad) % 360.0)
    yield _END_DEG, _number(np.degrees(end_rad) % 360.0)


def _entity(name: str, layer: str = LAYER) -> Iterator[Pair]:
    yield _ENTITY, name
    yield _ON_LAYER, layer


def _point(code: int, x_mm: float, y_mm: float) -> Iterator[Pair]:
    yield code, _number(x_mm)
    yield code + 10, _number(y_mm)
    yield code + 20, "0.0"


def _number(value: float) -> str:
    return f"{value:.6f}"


def stand_files(d: LegDimensions, record: Mapping[str, Any]) -> dict[str, str]:
    """Return content by path in the export's folder: the arm for the laser, and how it is used.

    ``record``: that of the export, which has both jumps.
    """
    return {"test_stand/arm.dxf": dxf(arm(d)), "test_stand/README.md": _readme(d, record)}


def _readme(d: LegDimensions, record: Mapping[str, Any]) -> str:
    part, there = arm(d), record["jumps"]["stand"]
    heights = (record["jumps"]["as_built"]["height_m"], there["height_m"])
    own, here = ("not at all" if height is None else f"{height:.3f} m high" for height in heights)
    (x, low, _), (_, high, _) = carriage_places(d)
    screws = "\n".join(f"| {count} | {which} | {where} |" for where, count, which in rod_screws(d))
    return f"""# Test stand

Two arms hang the base on two vertical rails. Each weighs {1e3 * float(part.unit_mass_kg()):.0f} g without carriages.

The rails hold the base upright, keep it from moving along the floor, and take {there["rail_friction_n"]:.1f} N of
friction; the robot lifts arms, carriages and screws of {there["mass_kg"]:.3f} kg as well. By simulation it jumps {here}
on this stand (`model/jump_stand.json`), and {own} under the calibration of this export, {record["calibration"]}.

| number | part | where |
|---:|---|---|
| 2 | `arm.dxf`: {part.note}, {part.grade.name if part.grade else ""} | outside of either cheek |
| 4 | carriage {MGN12H.name} (HIWIN, series MGN), preload Z0, oiled | two on the outside of each arm |
| 2 | rail {MGN12H.rail}, as long as the jump and {high - low + MGN12H.length_mm:.0f} mm | vertical |
| 16 | {carriage_screw()} | through the arms into the carriages |
{screws}

1. Take out the screws of the rear lower rod and of both upper rods, on both sides. The base stays together by its front
   lower rod.
2. Lay an arm on each cheek, its long end backwards, and the driver's plate on the arm again. Put the screws above in.
3. Screw the carriages to the outsides of the arms. Their middles are {-x:.1f} mm behind the hip's axis, {low:.1f} and
   {high:.1f} mm above it.
4. Let the rails end above the hip's axis in the robot's lowest position: the foot swings through the planes of the
   rails.
"""
