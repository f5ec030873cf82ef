"""All drawings of a robot as PDF files (ISO 32000-1): one of each part that is made, one of the assembly.

Sheets are vector lines and searchable text, the same bytes for the same drawing. The font is one of the fourteen that
every reader has, so nothing is embedded; there is no time stamp.
"""

import zlib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from functools import lru_cache
from typing import Any

from pareto_monoped import __date__
from pareto_monoped.cad.drawing.assembly_sheets import assembly_sheet, cable_sheet, exploded_sheets
from pareto_monoped.cad.drawing.bores import number as _number
from pareto_monoped.cad.drawing.paper import CAPITAL, Fill, Label, Paper, Stroke
from pareto_monoped.cad.drawing.part_sheet import Sheet, part_sheet
from pareto_monoped.cad.drawing.sheet import Title, titled
from pareto_monoped.cad.product import ListedPart, Product
from pareto_monoped.geometry.parts import Part

_POINTS_PER_MM = 72.0 / 25.4
_TOLERANCES: Mapping[str, tuple[str, str]] = {
    "machined": ("ISO 2768-mK", "3.2"),
    "laser cut": ("ISO 2768-mK", "12.5"),
    "3D printed": ("ISO 2768-cL", ""),
    "moulded": ("ISO 3302-1 M3", ""),
}
"""General tolerances and roughness Ra in micrometres by process: what milling and turning, cutting by laser, printing
with layers of 0.2 mm and casting rubber reach without effort (our own choice of classes)."""


def pdf(sheets: Sequence[tuple[Paper, float, float]], title: str) -> bytes:
    """Return a document of one page per sheet."""
    bodies = [
        b"<< /Type /Catalog /Pages 2 0 R >>",
        b"",  # the list of pages, filled in below
        b"<< /Type /Font /Subtype /Type1 /BaseFont /Helvetica /Encoding /WinAnsiEncoding >>",
        f"<< /Title ({_escaped(title)}) /Producer (pareto-monoped) >>".encode("cp1252"),
    ]
    pages = []
    for paper, width, height in sheets:
        stream = zlib.compress("\n".join(_content(paper)).encode("cp1252"), 9)
        bodies.append(b"<< /Length %d /Filter /FlateDecode >>\nstream\n%b\nendstream" % (len(stream), stream))
        media = f"[0 0 {_number(width * _POINTS_PER_MM)} {_number(height * _POINTS_PER_MM)}]"
        bodies.append(
            f"<< /Type /Page /Parent 2 0 R /MediaBox {media} /Resources << /Font << /F1 3 0 R >> >> "
            f"/Contents {len(bodies)} 0 R >>".encode()
        )
        pages.append(len(bodies))
    kids = " ".join(f"{page} 0 R" for page in pages)
    bodies[1] = f"<< /Type /Pages /Kids [{kids}] /Count {len(pages)} >>".encode()
    return _pdf_file(bodies)


def _pdf_file(bodies: Sequence[bytes]) -> bytes:
    """Join objects with their numbers, the table of where they begin, the trailer."""
    out = bytearray(b"%PDF-1.4\n%\xe2\xe3\xcf\xd3\n")
    starts = []
    for number, body in enumerate(bodies, 1):
        starts.append(len(out))
        out += b"%d 0 obj\n%b\nendobj\n" % (number, body)
    table = len(out)
    out += b"xref\n0 %d\n0000000000 65535 f \n" % (len(bodies) + 1)
    out += b"".join(b"%010d 00000 n \n" % start for start in starts)
    out += b"trailer\n<< /Size %d /Root 1 0 R /Info 4 0 R >>\nstartxref\n%d\n%%%%EOF\n" % (len(bodies) + 1, table)
    return bytes(out)


def _content(paper: Paper) -> Iterator[str]:
    """Yield the operators that draw a page, in millimetres."""
    yield f"{_POINTS_PER_MM:.8f} 0 0 {_POINTS_PER_MM:.8f} 0 0 cm 1 J 1 j"
    style: tuple[float, tuple[float, ...]] | None = None
    for stroke in paper.strokes:
        if style != (stroke.width_mm, stroke.dashes):
            style = (stroke.width_mm, stroke.dashes)
            dashes = " ".join(map(_number, stroke.dashes))
            yield f"{_number(stroke.width_mm)} w [{dashes}] 0 d"
        yield _path(stroke) + (" s" if stroke.closed else " S")
    for fill in paper.fills:
        yield _path(fill) + " f"
    for label in paper.labels:
        yield _words(label)


def _path(shape: Stroke | Fill) -> str:
    points = [f"{_number(x)} {_number(y)}" for x, y in shape.points.tolist()]
    return f"{points[0]} m " + " ".join(f"{point} l" for point in points[1:])


def _words(label: Label) -> str:
    x, y = label.start()
    turn = "0 1 -1 0" if label.upward else "1 0 0 1"
    size = _number(label.height_mm / CAPITAL)
    return f"BT /F1 {size} Tf {turn} {_number(x)} {_number(y)} Tm ({_escaped(label.text)}) Tj ET"


def _escaped(text: str) -> str:
    return text.replace("\\", r"\\").replace("(", r"\(").replace(")", r"\)")


@dataclass(frozen=True, slots=True, kw_only=True)
class Origin:
    """What all title blocks of a robot have in common: the robot in words, hash and date of its design, the program."""

    design: str
    digest: str
    date: str
    maker: str


def origin_of(record: Mapping[str, Any]) -> Origin:
    """Return what title blocks take from the record of an export, which may still lack what is computed last.

    The date is that of the study, or of the program's version: never of the clock, so that exports can be repeated.
    """
    source = record["source"]
    name = (
        f"case {source['case']}"
        if "case" in source
        else " trial ".join(str(source[key]) for key in ("study", "trial") if key in source)
    )
    return Origin(
        design=", ".join(filter(None, (name, record["motor"], record.get("rules", "paper")))),
        digest=record["design_hash"],
        date=str(source.get("date", __date__)),
        maker=record["made_by"],
    )


def part_drawings(parts: Sequence[ListedPart], origin: Origin, first: int = 1) -> dict[str, bytes]:
    """Return the drawing of every part that is not bought, by the part's name."""
    made = [unique for unique in parts if unique.part.process != "bought"]
    return {unique.name: part_drawing(unique, origin, number) for number, unique in enumerate(made, first)}


def part_drawing(unique: ListedPart, origin: Origin, number: int) -> bytes:
    """Return the drawing of one part."""
    part, grade = unique.part, unique.part.grade
    tolerances, finish = _TOLERANCES[part.process]
    title = Title(
        name=unique.name.replace("_", " "),
        number=f"{origin.digest}-{number:02d}",
        material=grade.name if grade is not None else part.material.name,
        hardness=grade.hardness if grade is not None else "",
        mass=_mass(float(part.unit_mass_kg())),
        count=unique.count,
        process=next((one.making for one in part.teeth if one.quality), part.process),
        tolerances=tolerances,
        finish=finish,
        **asdict(origin),
    )
    return _file([_drawn(part, (part.toleranced, part.lengths, part.teeth, part.accuracy_class, part.note))], title)


def assembly_drawing(product: Product, origin: Origin) -> bytes:
    """Return the drawing of the robot."""
    title = Title(
        name="monoped",
        number=f"{origin.digest}-00",
        material="see the list of items",
        mass=_mass(product.robot.mass_kg),
        count=1,
        process="assembled",
        **asdict(origin),
    )
    return _file([assembly_sheet(product), *exploded_sheets(product), cable_sheet(product)], title)


@lru_cache(maxsize=256)
def _drawn(part: Part, _making: tuple[object, ...]) -> Sheet:
    """Return the sheet of a part without its title block; ``_making`` is what does not count when parts are compared.

    Designs of one study share most of their parts.
    """
    return part_sheet(part)


def _file(sheets: Sequence[Sheet], title: Title) -> bytes:
    pages = []
    for number, (drawn, size, scale) in enumerate(sheets, 1):
        paper = Paper()
        paper.lay(drawn)
        titled(paper, size, scale, title, f"{number}/{len(sheets)}")
        pages.append((paper, size.width_mm, size.height_mm))
    return pdf(pages, f"{title.name}, {title.number}")


def _mass(mass_kg: float) -> str:
    return f"{mass_kg:.3f} kg" if mass_kg >= 1.0 else f"{1e3 * mass_kg:.1f} g"
