"""Exact area integrals of polygons, an oracle for shapes: sums over their edges, no quadrature."""

import numpy as np


def polygon_integrals(points):
    """Area, x, y, xx, yy, xy of a closed polygon, anticlockwise positive (Steger, 1996)."""
    x0, y0 = np.asarray(points, dtype=np.float64).T
    x1, y1 = np.roll(x0, -1), np.roll(y0, -1)
    cross = x0 * y1 - x1 * y0
    return np.array(
        [
            cross.sum() / 2.0,
            (cross * (x0 + x1)).sum() / 6.0,
            (cross * (y0 + y1)).sum() / 6.0,
            (cross * (x0 * x0 + x0 * x1 + x1 * x1)).sum() / 12.0,
            (cross * (y0 * y0 + y0 * y1 + y1 * y1)).sum() / 12.0,
            (cross * (x0 * y1 + 2 * x0 * y0 + 2 * x1 * y1 + x1 * y0)).sum() / 24.0,
        ]
    )


def region_integrals(polygon):
    """The same for a shapely polygon with holes."""
    total = polygon_integrals(np.array(polygon.exterior.coords)[:-1])
    total = total * np.sign(total[0])
    for ring in polygon.interiors:
        hole = polygon_integrals(np.array(ring.coords)[:-1])
        total = total - hole * np.sign(hole[0])
    return total


def integrals_of(moments):
    return np.array([moments.area, moments.x, moments.y, moments.xx, moments.yy, moments.xy], dtype=np.float64)
