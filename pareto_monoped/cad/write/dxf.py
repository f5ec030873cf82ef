"""DXF drawings of laser-cut plates: the true outline and holes, without kerf, on one layer, in millimetres."""

import numpy as np

from pareto_monoped.cad.shape.curves import Loop, Spline
from pareto_monoped.cad.shape.outlines import loops
from pareto_monoped.geometry.parts import Part
from pareto_monoped.geometry.shapes import Line

LAYER = "CUT"


def is_flat(part: Part) -> bool:
    """Whether a part is one plate that a laser can cut."""
    return part.process == "laser cut" and len(part.prisms) == 1


def dxf(part: Part) -> str:
    """The text of a DXF file (R12, which every laser's software reads) of a flat part.

    Raises:
        ValueError: the part is not flat, or has curves that R12 cannot hold.
    """
    if not is_flat(part):
        raise ValueError(f"{part.name}: not a flat part")
    prism = part.prisms[0]
    entities = [
        line for shape in (prism.outline, *prism.holes) for loop in loops(shape) for line in _entities(part.name, loop)
    ]
    head = ["0", "SECTION", "2", "HEADER", "9", "$ACADVER", "1", "AC1009", "9", "$INSUNITS", "70", "4", "0", "ENDSEC"]
    layer = ["0", "LAYER", "2", LAYER, "70", "0", "62", "7", "6", "CONTINUOUS"]
    tables = [
        "0",
        "SECTION",
        "2",
        "TABLES",
        "0",
        "TABLE",
        "2",
        "LAYER",
        "70",
        "1",
        *layer,
        "0",
        "ENDTAB",
        "0",
        "ENDSEC",
    ]
    body = ["0", "SECTION", "2", "ENTITIES", *entities, "0", "ENDSEC", "0", "EOF"]
    return "\n".join([*head, *tables, *body]) + "\n"


def _entities(name: str, loop: Loop) -> list[str]:
    if loop.circle is not None:
        c = loop.circle
        return [*_kind("CIRCLE"), *_point(10, float(c.x_mm), float(c.y_mm)), "40", _n(float(c.radius_mm))]
    found = []
    for piece in loop.pieces:
        if isinstance(piece, Spline):
            raise ValueError(f"{name}: a spline cannot be drawn for the laser")
        if isinstance(piece, Line):
            found += _kind("LINE") + _point(10, float(piece.x0_mm), float(piece.y0_mm))
            found += _point(11, float(piece.x1_mm), float(piece.y1_mm))
        else:
            # DXF arcs run anticlockwise.
            start, end = sorted((float(piece.start_rad), float(piece.end_rad)))
            found += _kind("ARC") + _point(10, float(piece.x_mm), float(piece.y_mm))
            found += ["40", _n(float(piece.radius_mm)), "50", _n(np.degrees(start) % 360.0)]
            found += ["51", _n(np.degrees(end) % 360.0)]
    return found


def _kind(name: str) -> list[str]:
    return ["0", name, "8", LAYER]


def _point(code: int, x: float, y: float) -> list[str]:
    return [str(code), _n(x), str(code + 10), _n(y), str(code + 20), "0.0"]


def _n(value: float) -> str:
    return f"{value:.6f}"
