"""Sheets as PDF (ISO 32000-1): vector lines and searchable text, the same bytes for the same drawing.

The font is one of the fourteen that every reader has, so nothing is embedded; there is no time stamp.
"""

import zlib
from collections.abc import Iterator, Sequence

from pareto_monoped.cad.drawing.lettering import CAPITAL
from pareto_monoped.cad.drawing.paper import Fill, Label, Paper, Stroke

_POINTS_PER_MM = 72.0 / 25.4


def pdf(sheets: Sequence[tuple[Paper, float, float]], title: str) -> bytes:
    """A document of one page per sheet.

    Args:
        sheets: what stands on it, its width and its height in millimetres.
        title: of the document.
    """
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
    return _file(bodies)


def _file(bodies: Sequence[bytes]) -> bytes:
    """Objects with their numbers, the table of where they begin, the trailer."""
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
    """The operators that draw a page, in millimetres."""
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


def _number(value: float) -> str:
    text = f"{value:.3f}".rstrip("0").rstrip(".")
    return "0" if text == "-0" else text
