"""Outlines of the links: windows with round corners, plates around holes."""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from pareto_monoped.geometry.shapes import Arc, Line, Numbers, Path


def rounded(*, half_width_mm: Numbers, high_mm: Numbers, low_mm: Numbers, corner_mm: Numbers) -> Path:
    """A rectangle with round corners, upright on the y axis from ``low_mm`` to ``high_mm``."""
    w, r, pi = half_width_mm, corner_mm, np.pi
    return Path(
        (
            Line(w, low_mm + r, w, high_mm - r),
            Arc(w - r, high_mm - r, r, 0.0, pi / 2),
            Line(w - r, high_mm, r - w, high_mm),
            Arc(r - w, high_mm - r, r, pi / 2, pi),
            Line(-w, high_mm - r, -w, low_mm + r),
            Arc(r - w, low_mm + r, r, pi, 3 * pi / 2),
            Line(r - w, low_mm, w - r, low_mm),
            Arc(w - r, low_mm + r, r, 3 * pi / 2, 2 * pi),
        )
    )


def rounded_hull(points_mm: Sequence[tuple[float, float]], radius_mm: float) -> Path:
    """The convex hull of discs of one radius, such as a plate with a rim around its outermost holes.

    Args:
        points_mm: centres (x, y) of the discs, not all on a line.
        radius_mm: of the discs.
    """
    from shapely import MultiPoint
    from shapely.geometry.polygon import orient

    corners = list(orient(MultiPoint(list(points_mm)).convex_hull).exterior.coords)  # anticlockwise, the first twice
    sides = list(pairwise(corners))
    normals = [np.arctan2(x0 - x1, y1 - y0) for (x0, y0), (x1, y1) in sides]  # outwards
    pieces: list[Line | Arc] = []
    for k, ((x0, y0), (x1, y1)) in enumerate(sides):
        before, out = normals[k - 1], normals[k]
        pieces.append(Arc(x0, y0, radius_mm, before, before + (out - before) % (2.0 * np.pi)))
        dx, dy = radius_mm * np.cos(out), radius_mm * np.sin(out)
        pieces.append(Line(x0 + dx, y0 + dy, x1 + dx, y1 + dy))
    return Path(tuple(pieces))
