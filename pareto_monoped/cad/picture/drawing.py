"""Pictures without a display: shaded triangles, and a PNG writer.

Parallel projection, light from over the viewer's shoulder, and dark lines where the part or the depth changes. Numba
compiles the way from triangles to pixels; importing it takes long, so this module is imported where pictures are drawn.
"""

import struct
import zlib
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.compute.compiled import compiled

Floats = NDArray[np.float64]
Indices = NDArray[np.int32]
Colour = tuple[float, float, float]

_LIGHTS = (((-0.35, 0.55, 0.75), 0.75), ((0.7, 0.1, 0.4), 0.25))  # directions in the view (right, up, to the viewer)
_AMBIENT = 0.28
_LINE = np.array([0.10, 0.11, 0.13])
_PAPER = np.array([1.0, 1.0, 1.0])
_LINE_DEPTH_MM = 1.5  # a line is drawn where the depth jumps by more than this, beyond what a slope explains


@dataclass(frozen=True, slots=True, kw_only=True)
class Body:
    """What to draw: triangles in one frame and their colour."""

    points_mm: Floats  #: corners, shape (n, 3)
    triangles: NDArray[np.int64]  #: indices of corners, shape (m, 3)
    colour: Colour
    number: int = 0  #: of the row in the legend that names it; 0 for none


@dataclass(frozen=True, slots=True, kw_only=True)
class Faces:
    """What a viewer sees of a body, in the axes of the view: right, up and towards the viewer."""

    box_mm: Floats  #: low and high corner of the body, shape (2, 3)
    corners_mm: Floats  #: of the triangles that look at the viewer, shape (n, 3, 3)
    light: Floats  #: how bright each of them is, shape (n,)


@dataclass(frozen=True, slots=True, kw_only=True)
class Shown:
    """Faces in a picture."""

    faces: Faces
    colour: Colour
    number: int  #: of the row in the legend that names the body; 0 for none
    move_mm: Floats  #: in the axes of the view, shape (3,)


@dataclass(frozen=True, slots=True, kw_only=True)
class Drawn:
    """A picture, and what is where in it."""

    image: NDArray[np.uint8]  #: shape (height, width, 3)
    numbers: NDArray[np.int64]  #: number of the body that is seen at each pixel, 0 for none, shape (height, width)
    px_per_mm: float  #: scale in the plane of the picture


@dataclass(frozen=True, slots=True, kw_only=True)
class View:
    """The direction of view: ``towards`` points from the viewer to the scene, ``up`` is upward in the picture."""

    towards: tuple[float, float, float]
    up: tuple[float, float, float] = (0.0, 0.0, 1.0)

    def axes(self) -> Floats:
        """Return the rows right, up and towards the viewer, in the scene's frame."""
        return _axes(self)


@lru_cache(maxsize=16)
def _axes(view: View) -> Floats:
    back = -np.asarray(view.towards, dtype=np.float64)
    back /= np.linalg.norm(back)
    right = np.cross(view.up, back)
    right /= np.linalg.norm(right)
    axes = np.stack([right, np.cross(back, right), back])
    axes.flags.writeable = False
    return axes


def faces_of(points_mm: Floats, triangles: NDArray[np.int64], axes: Floats) -> Faces:
    """Return what a viewer sees of a body; ``axes`` are those of ``View.axes``."""
    points = points_mm @ axes.T
    corners = points[triangles]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    length = np.linalg.norm(normal, axis=1)
    facing = normal[:, 2] > 1e-9 * np.maximum(length, 1e-12)
    return Faces(
        box_mm=np.stack([points.min(axis=0), points.max(axis=0)]),
        corners_mm=corners[facing],
        light=_lit(normal[facing] / length[facing, None]),
    )


def draw(bodies: Sequence[Body], view: View, *, width: int, height: int) -> Drawn:
    """Return a picture of all bodies, scaled to fill it."""
    axes, still, shown = view.axes(), np.zeros(3), []
    for body in bodies:
        faces = faces_of(body.points_mm, body.triangles, axes)
        shown.append(Shown(faces=faces, colour=body.colour, number=body.number, move_mm=still))
    return draw_faces(shown, width=width, height=height)


def draw_faces(shown: Sequence[Shown], *, width: int, height: int, margin: float = 0.04) -> Drawn:
    """Return a picture of faces that one viewer sees, scaled to fill it."""
    # Two by two pixels are drawn per pixel of the picture, which smooths edges.
    w, h = 2 * width, 2 * height
    boxes = np.array([one.faces.box_mm + one.move_mm for one in shown])
    low, high = boxes[:, 0].min(axis=0), boxes[:, 1].max(axis=0)
    scale = float(np.min(np.array([w, h]) / (high - low)[:2])) * (1.0 - 2.0 * margin)
    # From the view's millimetres to pixels to the right, pixels down and millimetres towards the viewer.
    stretch = np.array([scale, -scale, 1.0])
    start = np.array([0.5 * w, 0.5 * h, 0.0]) - 0.5 * (low + high) * stretch * (1.0, 1.0, 0.0)
    pixels = np.concatenate([one.faces.corners_mm * stretch + (one.move_mm * stretch + start) for one in shown])
    count = len(pixels)
    winner, depth = np.full((h, w), count, dtype=np.int32), np.full((h, w), -np.inf)
    nearest(pixels, winner, depth)
    owners = np.repeat(np.arange(len(shown) + 1, dtype=np.int32), [*(len(one.faces.light) for one in shown), 1])
    colours = np.concatenate([*(one.faces.light[:, None] * np.asarray(one.colour) for one in shown), _PAPER[None]])
    image = composed(winner, depth, owners, colours, _LINE, _LINE_DEPTH_MM + 6.0 / scale)
    number = np.array([*(one.number for one in shown), 0])
    return Drawn(
        image=np.clip(image * 255.0 + 0.5, 0, 255).astype(np.uint8),
        numbers=number[owners[winner[::2, ::2]]],
        px_per_mm=0.5 * scale,
    )


def prepare() -> None:
    """Load what draws triangles, which takes longer than a picture."""
    nowhere = Faces(box_mm=np.array([[0.0] * 3, [1.0] * 3]), corners_mm=np.zeros((0, 3, 3)), light=np.zeros(0))
    draw_faces([Shown(faces=nowhere, colour=(0.0, 0.0, 0.0), number=0, move_mm=np.zeros(3))], width=1, height=1)


def png(image: NDArray[np.uint8]) -> bytes:
    """Return the bytes of a PNG file (ISO 15948) of an RGB image, shape (height, width, 3)."""
    height, width, _ = image.shape
    # Each row begins with its filter: 2, the difference to the row above, which suits flat shading.
    above = np.vstack([np.zeros((1, width, 3), np.uint8), image[:-1]])
    rows = np.concatenate([np.full((height, 1), 2, np.uint8), (image - above).reshape(height, -1)], axis=1)

    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    data = chunk(b"IDAT", zlib.compress(rows.tobytes(), 6))
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + data + chunk(b"IEND", b"")


def _lit(normal: Floats) -> Floats:
    """Return the brightness of faces with the given normals in the view, shape (n,)."""
    light = np.full(len(normal), _AMBIENT)
    for direction, strength in _LIGHTS:
        unit = np.asarray(direction) / np.linalg.norm(direction)
        light += strength * np.clip(normal @ unit, 0.0, None)
    return np.asarray(np.minimum(light, 1.15))


@compiled
def nearest(triangles: Floats, winner: Indices, depth: Floats) -> None:
    """Find which triangle is nearest at each pixel, of shape (height, width); of equally near ones the first.

    ``triangles`` has corners in pixels right and down and their nearness, shape (n, 3, 3). ``winner`` keeps its values
    where no triangle is, ``depth`` begins as -infinity.
    """
    height, width = winner.shape
    for index in range(len(triangles)):
        t = triangles[index]
        area = (t[1, 0] - t[0, 0]) * (t[2, 1] - t[0, 1]) - (t[1, 1] - t[0, 1]) * (t[2, 0] - t[0, 0])
        if area == 0.0:
            continue
        # Depth is linear over a triangle.
        slope_x = ((t[1, 2] - t[0, 2]) * (t[2, 1] - t[0, 1]) - (t[2, 2] - t[0, 2]) * (t[1, 1] - t[0, 1])) / area
        slope_y = ((t[2, 2] - t[0, 2]) * (t[1, 0] - t[0, 0]) - (t[1, 2] - t[0, 2]) * (t[2, 0] - t[0, 0])) / area
        top, bottom = min(t[0, 1], t[1, 1], t[2, 1]), max(t[0, 1], t[1, 1], t[2, 1])
        # A pixel belongs to the triangle that covers its centre.
        for row in range(max(int(np.ceil(top - 0.5)), 0), min(int(np.ceil(bottom - 0.5)), height)):
            y = row + 0.5
            left, right = np.inf, -np.inf
            for i in range(3):
                j = (i + 1) % 3
                y0, y1 = t[i, 1], t[j, 1]
                if y0 != y1 and min(y0, y1) <= y <= max(y0, y1):
                    x = t[i, 0] + (y - y0) / (y1 - y0) * (t[j, 0] - t[i, 0])
                    left, right = min(left, x), max(right, x)
            if left > right:
                continue
            for column in range(max(int(np.ceil(left - 0.5)), 0), min(int(np.ceil(right - 0.5)), width)):
                z = t[0, 2] + slope_x * (column + 0.5 - t[0, 0]) + slope_y * (y - t[0, 1])
                if z > depth[row, column]:
                    depth[row, column] = z
                    winner[row, column] = index


@compiled
def composed(winner: Indices, depth: Floats, owner: Indices, colours: Floats, line: Floats, jump: float) -> Floats:
    """Return the colours from 0 to 1 of a picture of half the size, with lines where another body or depth begins.

    ``winner`` and ``depth`` are those of ``nearest``; the last colour is the paper's. ``owner`` has the body of each
    triangle, and a last number for the background. A line is drawn where the depth jumps by more than ``jump``.
    """
    height, width = winner.shape
    picture = np.zeros((height // 2, width // 2, 3))
    for row in range(height):
        for column in range(width):
            here = winner[row, column]
            edge = False
            for step in range(2):
                there_row, there_column = row + step, column + 1 - step
                if there_row < height and there_column < width:
                    there = winner[there_row, there_column]
                    if owner[there] != owner[here] or abs(depth[there_row, there_column] - depth[row, column]) > jump:
                        edge = True
            for channel in range(3):
                colour = line[channel] if edge else colours[here, channel]
                picture[row // 2, column // 2, channel] += 0.25 * colour
    return picture
