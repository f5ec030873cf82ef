"""Pictures without a display: triangles -> pixels with a depth buffer in NumPy, and a PNG writer.

Parallel projection, light from the viewer's shoulder, dark lines where parts or their depth change. Needs no
graphics library display.
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


@dataclass(frozen=True, slots=True, kw_only=True)
class Body:
    """What to draw: triangles in one frame and their colour."""

    points_mm: Floats
    triangles: NDArray[np.int64]
    colour: Colour


@dataclass(frozen=True, slots=True, kw_only=True)
class View:
    """From where to look: ``towards`` points from the viewer to the scene, ``up`` is upward in the picture."""

    towards: tuple[float, float, float]
    up: tuple[float, float, float] = (0.0, 0.0, 1.0)

    def axes(self) -> Floats:
        """Rows: right, up and towards the viewer, in the scene's frame."""
        back = -np.asarray(self.towards, dtype=np.float64)
        back /= np.linalg.norm(back)
        right = np.cross(self.up, back)
        right /= np.linalg.norm(right)
        return np.stack([right, np.cross(back, right), back])


def draw(
    bodies: Sequence[Body], view: View, *, width: int, height: int, margin: float = 0.04, oversampling: int = 2
) -> NDArray[np.uint8]:
    """A picture of all bodies, scaled to fill it, shape (height, width, 3)."""
    axes = view.axes()
    w, h = width * oversampling, height * oversampling
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
    winner, depth = _nearest(pixels, w, h)
    colours = np.concatenate([np.concatenate(shade), _PAPER[None]])
    image = colours[winner]
    owners = np.concatenate([np.concatenate(owner), [-1]])[winner]
    image[_lines(owners, depth, scale)] = _LINE
    small = image.reshape(height, oversampling, width, oversampling, 3).mean(axis=(1, 3))
    return np.asarray(np.clip(small * 255.0 + 0.5, 0, 255), dtype=np.uint8)


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
    """Brightness of faces by their normals in the view."""
    light = np.full(len(normal), _AMBIENT)
    for direction, strength in _LIGHTS:
        unit = np.asarray(direction) / np.linalg.norm(direction)
        light += strength * np.clip(normal @ unit, 0.0, None)
    return np.minimum(light, 1.15)


def _nearest(triangles: Floats, width: int, height: int) -> tuple[NDArray[np.int64], Floats]:
    """Which triangle is nearest at each pixel (the last index plus one where none is), and how near.

    Every triangle becomes rows of pixels between its edges, every row its pixels: no more are looked at than covered.
    """
    count = len(triangles)
    winner = np.full(height * width, count, dtype=np.int64)
    nearest = np.full(height * width, -np.inf)
    # In portions, so that memory stays bounded.
    area = np.abs(_doubled_area(triangles))
    portion = np.cumsum(area + 8.0) // 8.0e6
    for which in np.unique(portion):
        chosen = np.flatnonzero(portion == which)
        pixel, depth, index = _covered(triangles[chosen], width, height)
        # The last of equal pixels wins when assigned, so sort by depth.
        order = np.argsort(depth, kind="stable")
        pixel, depth, index = pixel[order], depth[order], index[order]
        local = np.full(height * width, -1, dtype=np.int64)
        local[pixel] = np.arange(len(pixel))
        seen = np.flatnonzero(local >= 0)
        best = local[seen]
        nearer = depth[best] > nearest[seen]
        winner[seen[nearer]] = chosen[index[best[nearer]]]
        nearest[seen[nearer]] = depth[best[nearer]]
    return winner.reshape(height, width), nearest.reshape(height, width)


def _doubled_area(t: Floats) -> Floats:
    a, b, c = t[:, 0], t[:, 1], t[:, 2]
    return (b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0])


def _covered(t: Floats, width: int, height: int) -> tuple[NDArray[np.int64], Floats, NDArray[np.int64]]:
    """Every pixel whose centre a triangle covers: the pixel's number, its depth, the triangle's index."""
    y = t[..., 1]
    first = np.clip(np.ceil(y.min(axis=1) - 0.5), 0, height).astype(np.int64)
    last = np.clip(np.ceil(y.max(axis=1) - 0.5), 0, height).astype(np.int64)
    rows = last - first
    index = np.repeat(np.arange(len(t)), rows)
    row = first[index] + _counting(rows)
    middle = row + 0.5
    left, right = np.full(len(row), np.inf), np.full(len(row), -np.inf)
    for i, j in ((0, 1), (1, 2), (2, 0)):
        a, b = t[index, i], t[index, j]
        rise = b[:, 1] - a[:, 1]
        crosses = (np.minimum(a[:, 1], b[:, 1]) <= middle) & (middle <= np.maximum(a[:, 1], b[:, 1])) & (rise != 0.0)
        x = a[:, 0] + (middle - a[:, 1]) / np.where(rise == 0.0, 1.0, rise) * (b[:, 0] - a[:, 0])
        left = np.where(crosses, np.minimum(left, x), left)
        right = np.where(crosses, np.maximum(right, x), right)
    left, right = np.nan_to_num(left, posinf=width), np.nan_to_num(right, neginf=-1.0)
    start = np.clip(np.ceil(left - 0.5), 0, width).astype(np.int64)
    stop = np.clip(np.ceil(right - 0.5), 0, width).astype(np.int64)
    columns = np.maximum(stop - start, 0)
    span = np.repeat(np.arange(len(row)), columns)
    column = start[span] + _counting(columns)
    triangle, pixel_row = index[span], row[span]
    # Depth is linear over a triangle.
    area = _doubled_area(t)
    area = np.where(area == 0.0, 1.0, area)
    a, b, c = t[:, 0], t[:, 1], t[:, 2]
    slope_x = ((b[:, 2] - a[:, 2]) * (c[:, 1] - a[:, 1]) - (c[:, 2] - a[:, 2]) * (b[:, 1] - a[:, 1])) / area
    slope_y = ((c[:, 2] - a[:, 2]) * (b[:, 0] - a[:, 0]) - (b[:, 2] - a[:, 2]) * (c[:, 0] - a[:, 0])) / area
    at = a[triangle]
    depth = at[:, 2] + slope_x[triangle] * (column + 0.5 - at[:, 0]) + slope_y[triangle] * (pixel_row + 0.5 - at[:, 1])
    return pixel_row * width + column, depth, triangle


def _counting(lengths: NDArray[np.int64]) -> NDArray[np.int64]:
    """0, 1, ... up to each length, one after the other."""
    ends = np.cumsum(lengths)
    return np.arange(int(ends[-1]) if len(ends) else 0) - np.repeat(ends - lengths, lengths)


def _lines(owner: NDArray[np.int64], depth: Floats, scale: float) -> NDArray[np.bool_]:
    """Pixels at which another body begins or the depth jumps by more than 1.5 mm beyond a slope."""
    line = np.zeros(owner.shape, dtype=bool)
    finite = np.where(np.isfinite(depth), depth, -1e6)
    for axis in (0, 1):
        here, there = (slice(None, -1), slice(1, None))
        one = (here, slice(None)) if axis == 0 else (slice(None), here)
        two = (there, slice(None)) if axis == 0 else (slice(None), there)
        step = np.abs(finite[one] - finite[two])
        edge = (owner[one] != owner[two]) | (step > 1.5 + 6.0 / scale)
        line[one] |= edge
    return line
