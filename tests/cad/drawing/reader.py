"""A small reader of PDF files, written from ISO 32000-1 and not from the writer: objects by the table, pages, texts."""

import re
import zlib
from dataclasses import dataclass


@dataclass(frozen=True)
class Page:
    """A page: size in millimetres, and what is written on it with where it begins."""

    width_mm: float
    height_mm: float
    texts: tuple[tuple[str, float, float], ...]


def objects(data):
    """The objects of a file by number, found by the cross-reference table."""
    assert data.startswith(b"%PDF-1.4")
    start = int(re.search(rb"startxref\n(\d+)\n%%EOF\n$", data)[1])
    head = re.match(rb"xref\n0 (\d+)\n", data[start:])
    table = data[start + head.end() :]
    found = {}
    for number in range(1, int(head[1])):
        offset, generation, kind = table[20 * number : 20 * number + 18].split()
        assert (generation, kind) == (b"00000", b"n")
        body = data[int(offset) :]
        assert body.startswith(b"%d 0 obj\n" % number)
        found[number] = body[: body.index(b"\nendobj\n")]
    return found


def stream_of(body):
    """The content of a stream object, whose length must be the one that it states."""
    head, _, rest = body.partition(b"stream\n")
    length = int(re.search(rb"/Length (\d+)", head)[1])
    assert rest[length:] == b"\nendstream"
    return zlib.decompress(rest[:length])


def pages(data):
    """All pages of a file."""
    found = objects(data)
    result = []
    for body in found.values():
        if b"/Type /Page " not in body:
            continue
        width, height = map(float, re.search(rb"/MediaBox \[0 0 (\S+) (\S+)\]", body).groups())
        content = stream_of(found[int(re.search(rb"/Contents (\d+) 0 R", body)[1])]).decode("cp1252")
        texts = tuple(
            (re.sub(r"\\(.)", r"\1", text), float(x), float(y))
            for x, y, text in re.findall(r"(\S+) (\S+) Tm \(((?:\\.|[^\\)])*)\) Tj", content)
        )
        result.append(Page(width_mm=width * 25.4 / 72.0, height_mm=height * 25.4 / 72.0, texts=texts))
    return result


def texts(data):
    """Everything that a file says."""
    return [text for page in pages(data) for text, _, _ in page.texts]
