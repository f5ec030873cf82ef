"""Bevels on a closed triangle mesh: the edge of a cylinder becomes a cone between two edges. Millimetres.

Boolean operations would do the same at twenty times the cost and leave slivers. Here the cap of the face is
triangulated anew around the wider or narrower circle, the cylinder's edge slides along the axis to where the cone meets
it, and a strip of triangles joins both.
"""

from collections.abc import Iterable

import manifold3d as m3
import numpy as np
from numpy.typing import NDArray

from pareto_monoped.geometry.bevels import Bevel

Points = NDArray[np.float64]
Triangles = NDArray[np.int64]

_LEAST_FACETS = 3
_ON_EDGE_MM = 1e-6  # from the edge of a cylinder to its points; far above rounding, far below the shortest facet


def has_cone(bevel: Bevel) -> bool:
    """Whether there is a ring between cone and cylinder."""
    return float(bevel.edge_mm) != float(bevel.at.radius_mm)


def beveled(points_mm: Points, triangles: Triangles, bevels: Iterable[Bevel]) -> tuple[Points, Triangles]:
    """The mesh with cones on the edges of its cylinders.

    Args:
        points_mm: shape (n, 3).
        triangles: indices of points, anticlockwise from outside, shape (m, 3).
        bevels: of plain numbers.

    Raises:
        ValueError: a bevel stands on no edge of the mesh, or is deeper than its cylinder.
    """
    faces: dict[tuple[float, bool], list[tuple[Bevel, float, float]]] = {}
    for bevel in bevels:
        if has_cone(bevel):
            key = float(bevel.face_mm), float(bevel.end_mm) < float(bevel.face_mm)
            faces.setdefault(key, []).extend((bevel, x, y) for x, y in bevel.centres_mm())
    for (face, upward), rings in faces.items():
        points_mm, triangles = _face_beveled(points_mm, triangles, face, upward, rings)
    return points_mm, triangles


def _face_beveled(
    points: Points, triangles: Triangles, face_mm: float, upward: bool, rings: list[tuple[Bevel, float, float]]
) -> tuple[Points, Triangles]:
    """All bevels of one plane across the axis, in caps that look up or down."""
    in_plane = np.abs(points[:, 2] - face_mm) < _ON_EDGE_MM
    cap = np.all(in_plane[triangles], axis=1)
    cap[cap] = (_doubled_area(points[triangles[cap]]) > 0.0) == upward
    border = _border(triangles[cap])
    sides = triangles[~cap]
    becomes = np.arange(len(points))  # the point in the cap that replaces each one
    points, count = points.copy(), len(points)
    added: list[Points] = []
    strips: list[Triangles] = []
    for bevel, x, y in rings:
        wall, edge, end = float(bevel.at.radius_mm), float(bevel.edge_mm), float(bevel.end_mm)
        away = points[:, :2] - (x, y)
        on_edge = in_plane & (np.abs(np.hypot(away[:, 0], away[:, 1]) - wall) < _ON_EDGE_MM)
        ring = np.flatnonzero(on_edge)
        steps = border[np.all(on_edge[border], axis=1)]
        around = sides[np.any(on_edge[sides], axis=1)]
        depth = (points[around, 2] - face_mm) / (end - face_mm)
        if len(ring) < _LEAST_FACETS or len(steps) != len(ring) or np.any((depth > 1e-9) & (depth <= 1.0)):
            raise ValueError(
                f"bevel at ({x:g}, {y:g}, {face_mm:g}) mm, {abs(end - face_mm):g} mm deep: must stand on an edge of "
                f"radius {wall:g} mm and be less deep than its cylinder; correct the part's features"
            )
        becomes[ring] = count + np.arange(len(ring))
        count += len(ring)
        added.append(np.column_stack([(x, y) + away[ring] * (edge / wall), np.full(len(ring), face_mm)]))
        start, stop = steps.T
        strips += [
            np.column_stack([start, stop, becomes[stop]]),
            np.column_stack([start, becomes[stop], becomes[start]]),
        ]
        points[ring, 2] = end
        in_plane[ring] = False
    points = np.concatenate([points, *added])
    return points, np.concatenate([sides, _filled(points, becomes[border], upward), *strips])


def _doubled_area(corners: Points) -> NDArray[np.float64]:
    """Twice the area of triangles seen from above, negative if they look down; ``corners`` has the shape (n, 3, 3)."""
    one, other = corners[:, 1, :2] - corners[:, 0, :2], corners[:, 2, :2] - corners[:, 0, :2]
    return np.asarray(one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0])


def _border(triangles: Triangles) -> Triangles:
    """Directed edges of triangles that no neighbour has the other way round, shape (n, 2)."""
    edges = np.concatenate([triangles[:, [k, (k + 1) % 3]] for k in range(3)])
    low, high = edges.min(axis=1), edges.max(axis=1)
    _, where, counts = np.unique(low * (edges.max(initial=0) + 1) + high, return_index=True, return_counts=True)
    single: Triangles = edges[np.sort(where[counts == 1])]
    return single


def _filled(points: Points, border: Triangles, upward: bool) -> Triangles:
    """Triangles that fill closed lines in a plane across the axis."""
    loops = _loops(border)
    seen = np.array([1.0, 1.0 if upward else -1.0])  # from the side to which they look, the lines run anticlockwise
    corners = np.asarray(m3.triangulate([points[loop, :2] * seen for loop in loops]), dtype=np.int64)
    return np.asarray(np.concatenate(loops)[corners])


def _loops(border: Triangles) -> list[NDArray[np.int64]]:
    """Closed lines from directed edges."""
    following = dict(border.tolist())
    loops = []
    while following:
        start, here = following.popitem()
        loop = [start]
        while here != start:
            loop.append(here)
            here = following.pop(here)
        loops.append(np.array(loop, dtype=np.int64))
    return loops
