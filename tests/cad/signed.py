"""Signatures of files: few numbers that move when a dimension, a place, a text or a colour of the file does."""

import re
import zlib

import numpy as np
from PIL import Image

from pareto_monoped import __date__
from tests.cad.drawing.reader import objects, stream_of

PROSE = ("README.md", "parameters.csv")  # their words are docstrings', which change without a meaning
GOLDEN = 0.5 * (5.0**0.5 - 1.0)  #: Weights by its multiples do not repeat, so that no two numbers change places unseen.
_NUMBER = re.compile(r"(?<![\w.])-?\d+\.?\d*(?:[eE][+-]?\d+)?")
_NEVER_THE_SAME = re.compile(rf"pareto-monoped \d+\.\d+\.\d+|(?<![.\w])[0-9a-f]{{12,64}}\b|{__date__}")


def signature(path):
    """What a file of an export is known by, or nothing where other checks see every change."""
    match path.suffix:
        case ".pdf":
            return of_pdf(path.read_bytes())
        case ".csv" | ".dxf" | ".html" | ".md" | ".txt" | ".urdf" | ".xml":
            return _of_text(path.read_text(), words=path.name not in PROSE)
        case ".stl":
            return _of_triangles(path.read_bytes())
        case ".png":
            return _of_picture(path)
    return None


def of_pdf(data):
    """The same of a drawing in memory."""
    return _of_text("\n".join(_drawn(data)))


def _of_text(text, *, words=True):
    """How many numbers, their sum weighted by place, and a checksum of all between them."""
    text = _NEVER_THE_SAME.sub("", text)
    numbers = np.array([float(one) for one in _NUMBER.findall(text)])
    total = round(float(numbers @ (1.0 + np.arange(len(numbers)) * GOLDEN % 1.0)), 3)
    return [len(numbers), total, *([zlib.crc32(_NUMBER.sub("#", text).encode())] if words else [])]


def _drawn(data):
    """The operators of every page."""
    found = objects(data)
    for body in found.values():
        if b"/Type /Page " in body:
            yield stream_of(found[int(re.search(rb"/Contents (\d+) 0 R", body)[1])]).decode("cp1252")


def _of_triangles(data):
    """Roots of volume and area, and the area's centre: the same however a face is cut into triangles."""
    fields = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("colour", "<u2")])
    corners = np.frombuffer(data, fields, offset=84)["corners"].astype(np.float64)
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    area = 0.5 * np.linalg.norm(normal, axis=1)
    centre = area @ corners.mean(axis=1) / area.sum()
    volume = np.sum(corners[:, 0] * normal) / 6.0
    return [round(float(length), 7) for length in (np.cbrt(volume), np.sqrt(area.sum()), *centre)]


def _of_picture(path):
    """Width and height, the mean of each colour, and the mean place of what is not white, in pixels."""
    with Image.open(path) as image:
        pixels = np.asarray(image.convert("RGB"))
    ink = 255.0 - pixels.mean(axis=2)
    across, down = ink.sum(axis=0), ink.sum(axis=1)
    centre = [row @ np.arange(len(row)) / ink.sum() for row in (across, down)]
    return [*pixels.shape[1::-1], *(round(float(v), 3) for v in (*pixels.mean(axis=(0, 1)), *centre))]
