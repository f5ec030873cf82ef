"""Pictures without a display: shaded triangles, and a PNG writer.

Parallel projection, light from over the viewer's shoulder, and dark lines where the part or the depth changes.
"""

import struct
import zlib
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Colour = tuple[float, float, float]

_LIGHTS = (((-0.35, 0.55, 0.75), 0.75), ((0.7, 0.1, 0.4), 0.25))  # directions in the view (right, up, to the viewer)
_AMBIENT = 0.28
_LINE = np.array([0.10, 0.11, 0.13])
_PAPER = np.array([1.0, 1.0, 1.0])
_LINE_DEPTH_MM = 1.5  # a line is drawn where the depth jumps by more than this, beyond what a slope explains


@dataclass(frozen=True, slots=True, kw_only=True)
class Body:
    """What to draw: triangles in one frame and their colour.

    Attributes:
        points_mm: corners, shape (n, 3).
        triangles: indices of corners, shape (m, 3).
        colour: of the body.
        number: of the row in the legend that names it; 0 for none.
    """

    points_mm: Floats
    triangles: NDArray[np.int64]
    colour: Colour
    number: int = 0


@dataclass(frozen=True, slots=True, kw_only=True)
class Drawn:
    """A picture, and what is where in it.

    Attributes:
        image: shape (height, width, 3).
        numbers: number of the body that is seen at each pixel, 0 for none, shape (height, width).
        px_per_mm: scale in the plane of the picture.
        axes: rows right, up and towards the viewer, shape (3, 3).
        middle_mm: point along right and up that is in the middle of the picture, shape (2,).
    """

    image: NDArray[np.uint8]
    numbers: NDArray[np.int64]
    px_per_mm: float
    axes: Floats
    middle_mm: Floats

    def pixel(self, point_mm: Floats) -> tuple[float, float]:
        """Where a point of the scene is in the picture: right and down from its upper left corner."""
        height, width, _ = self.image.shape
        right, up = self.axes[:2] @ point_mm - self.middle_mm
        return 0.5 * width + right * self.px_per_mm, 0.5 * height - up * self.px_per_mm


@dataclass(frozen=True, slots=True, kw_only=True)
class View:
    """The direction of view: ``towards`` points from the viewer to the scene, ``up`` is upward in the picture."""

    towards: tuple[float, float, float]
    up: tuple[float, float, float] = (0.0, 0.0, 1.0)

    def axes(self) -> Floats:
        """Rows: right, up and towards the viewer, in the scene's frame."""
        back = -np.asarray(self.towards, dtype=np.float64)
        back /= np.linalg.norm(back)
        right = np.cross(self.up, back)
        right /= np.linalg.norm(right)
        return np.stack([right, np.cross(back, right), back])


def draw(bodies: Sequence[Body], view: View, *, width: int, height: int, margin: float = 0.04) -> Drawn:
    """A picture of all bodies, scaled to fill it."""
    from pareto_monoped.cad.picture import raster

    axes = view.axes()
    # Two by two pixels are drawn per pixel of the picture, which smooths edges.
    w, h = 2 * width, 2 * height
    points = [body.points_mm @ axes.T for body in bodies]
    low = np.min([p[:, :2].min(axis=0) for p in points], axis=0)
    high = np.max([p[:, :2].max(axis=0) for p in points], axis=0)
    scale = min(w / (high[0] - low[0]), h / (high[1] - low[1])) * (1.0 - 2.0 * margin)
    middle = 0.5 * (low + high)
    corners, shade, owner = [], [], []
    for index, (body, p) in enumerate(zip(bodies, points, strict=True)):
        triangle = p[body.triangles]
        normal = np.cross(triangle[:, 1] - triangle[:, 0], triangle[:, 2] - triangle[:, 0])
        length = np.linalg.norm(normal, axis=1)
        facing = normal[:, 2] > 1e-9 * np.maximum(length, 1e-12)
        triangle, normal = triangle[facing], normal[facing] / length[facing, None]
        corners.append(triangle)
        shade.append(_lit(normal)[:, None] * np.asarray(body.colour))
        owner.append(np.full(len(triangle), index))
    triangles = np.concatenate(corners)
    pixels = np.empty_like(triangles)
    pixels[..., 0] = 0.5 * w + (triangles[..., 0] - middle[0]) * scale
    pixels[..., 1] = 0.5 * h - (triangles[..., 1] - middle[1]) * scale
    pixels[..., 2] = triangles[..., 2]
    count = len(triangles)
    winner, depth = np.full((h, w), count, dtype=np.int32), np.full((h, w), -np.inf)
    raster.nearest(pixels, winner, depth)
    owners = np.concatenate([*owner, [-1]]).astype(np.int32)
    colours = np.concatenate([*shade, _PAPER[None]])
    image = raster.composed(winner, depth, owners, colours, _LINE, _LINE_DEPTH_MM + 6.0 / scale)
    number = np.array([*(body.number for body in bodies), 0])
    return Drawn(
        image=np.asarray(np.clip(image * 255.0 + 0.5, 0, 255), dtype=np.uint8),
        numbers=number[owners[winner[::2, ::2]]],
        px_per_mm=0.5 * scale,
        axes=axes,
        middle_mm=middle,
    )


def png(image: NDArray[np.uint8]) -> bytes:
    """The bytes of a PNG file (ISO 15948) of an RGB image, shape (height, width, 3)."""
    height, width, _ = image.shape
    # Each row begins with its filter: 2, the difference to the row above, which suits flat shading.
    above = np.vstack([np.zeros((1, width, 3), np.uint8), image[:-1]])
    rows = np.concatenate([np.full((height, 1), 2, np.uint8), (image - above).reshape(height, -1)], axis=1)

    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    return (
        b"\x89PNG\r\n\x1a\n"
        + chunk(b"IHDR", header)
        + chunk(b"IDAT", zlib.compress(rows.tobytes(), 6))
        + chunk(b"IEND", b"")
    )


def _lit(normal: Floats) -> Floats:
    """Brightness of faces with the given normals in the view, shape (n,)."""
    light = np.full(len(normal), _AMBIENT)
    for direction, strength in _LIGHTS:
        unit = np.asarray(direction) / np.linalg.norm(direction)
        light += strength * np.clip(normal @ unit, 0.0, None)
    return np.minimum(light, 1.15)
