"""Part -> closed triangle mesh, from the same outlines as the solid; millimetres.

Each prism is an extruded polygon. manifold3d unites the prisms of a part and keeps the mesh closed. Polygons stay
within ``TOLERANCE_MM`` of their arcs, which changes the volume of thin round parts by at most a few thousandths.

An STL file has no shared points. Its reader merges the corners of triangles that stand at the same place, after they
were rounded to single precision. A mesh that is closed in memory may therefore be open in its file: close points merge
and leave triangles without area, and parts that touch get edges that border four triangles. Points that would merge are
therefore welded, and parts that touch are moved apart.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

import manifold3d as m3
import numpy as np
from numpy.typing import NDArray

from pareto_monoped.cad.shape.outlines import all_polygons, is_on, regrouped
from pareto_monoped.geometry.features import Bevel
from pareto_monoped.geometry.parts import Ball, Part, Prism
from pareto_monoped.geometry.shapes import Shape

Points = NDArray[np.float64]
Triangles = NDArray[np.int64]

_LEAST_FACETS = 3
_ON_EDGE_MM = 1e-6  # from the edge of a cylinder to its points; far above rounding, far below the shortest facet
TOLERANCE_MM = 0.01
WELD_MM = 1e-4
"""Shorter edges are welded. A robot's mesh in metres has single-precision numbers 0.00006 mm apart at most (at 1 m)."""
APART_MM = 1e-3
"""How far touching parts are moved apart: many such numbers, and 1 percent of the coarsest mesh's tolerance."""
MERGED = 1e-8
"""Corners are merged when their coordinates are equal after rounding to this, in the file's unit (as in trimesh)."""
# Odd numbers without pattern (digits of pi, e and the golden section), for sums modulo 2^64 that tell places apart: two
# of a million places get the same number with a probability of 3e-8.
_PLACE = np.array([0x243F6A8885A308D3, 0xB7E151628AED2A6B, 0x9E3779B97F4A7C15], dtype=np.uint64)
_START, _END = np.uint64(0x13198A2E03707345), np.uint64(0xBF7158809CF4F3C7)

Numbers = NDArray[np.uint64]


def cross_section(shapes: Sequence[Shape], tolerance_mm: float = TOLERANCE_MM) -> m3.CrossSection:
    """Return the union of flat shapes, whose curves are polygons within a tolerance."""
    return m3.CrossSection(all_polygons(shapes, tolerance_mm), m3.FillRule.NonZero)


def has_cone(bevel: Bevel) -> bool:
    """Return whether there is a ring between cone and cylinder."""
    return float(bevel.edge_mm) != float(bevel.at.radius_mm)


def beveled(points_mm: Points, triangles: Triangles, bevels: Iterable[Bevel]) -> tuple[Points, Triangles]:
    """Return the mesh with cones on the edges of its cylinders: each edge becomes a cone between two edges.

    Boolean operations would do the same at twenty times the cost and leave slivers. Here the cap of the face is
    triangulated anew around the wider or narrower circle, the cylinder's edge slides along the axis to where the cone
    meets it, and a strip of triangles joins both. ``triangles`` are anticlockwise from outside.

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
    """Return all bevels of one plane across the axis, in caps that look up or down."""
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
    """Return twice the area of triangles seen from above, negative if they look down; corners: shape (n, 3, 3)."""
    one, other = corners[:, 1, :2] - corners[:, 0, :2], corners[:, 2, :2] - corners[:, 0, :2]
    return np.asarray(one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0])


def _border(triangles: Triangles) -> Triangles:
    """Return the directed edges of triangles that no neighbour has the other way round, shape (n, 2)."""
    edges = np.concatenate([triangles[:, [k, (k + 1) % 3]] for k in range(3)])
    low, high = edges.min(axis=1), edges.max(axis=1)
    _, where, counts = np.unique(low * (edges.max(initial=0) + 1) + high, return_index=True, return_counts=True)
    return np.asarray(edges[np.sort(where[counts == 1])])


def _filled(points: Points, border: Triangles, upward: bool) -> Triangles:
    """Return triangles that fill closed lines in a plane across the axis."""
    loops = _loops(border)
    seen = np.array([1.0, 1.0 if upward else -1.0])  # from the side to which they look, the lines run anticlockwise
    corners = np.asarray(m3.triangulate([points[loop, :2] * seen for loop in loops]), dtype=np.int64)
    return np.asarray(np.concatenate(loops)[corners])


def _loops(border: Triangles) -> list[NDArray[np.int64]]:
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


def place_numbers(points: NDArray[np.floating]) -> Numbers:
    """Return a number per point, equal for points that a reader merges; shape (..., 3), in the file's unit."""
    rounded = np.rint(points.astype(np.float32).astype(np.float64) / MERGED).astype(np.int64).view(np.uint64)
    x, y, z = np.moveaxis(rounded, -1, 0)
    return np.asarray(x * _PLACE[0] + y * _PLACE[1] + z * _PLACE[2])


def edge_numbers(start: Numbers, end: Numbers) -> Numbers:
    """Return a number for each directed edge, from the numbers of its ends."""
    return np.asarray(start * _START + end * _END)


def flaws(corners: NDArray[np.floating]) -> str:
    """Return what keeps triangles from enclosing a volume, in words; empty if nothing does.

    Every edge must border two triangles, which run along it in opposite directions. ``corners`` are as in the file,
    shape (n, 3, 3).
    """
    here = place_numbers(corners)
    following = here[:, [1, 2, 0]]
    flat = int(np.any(here == following, axis=1).sum())
    if flat:
        return f"{flat} triangles have no area"
    there, back = edge_numbers(here, following).ravel(), edge_numbers(following, here).ravel()
    there.sort()
    back.sort()
    if np.all(there[1:] != there[:-1]) and np.array_equal(there, back):
        return ""
    edges, counts = np.unique(there, return_counts=True)
    opposite, counts_opposite = np.unique(back, return_counts=True)
    sound = np.intersect1d(edges[counts == 1], opposite[counts_opposite == 1], assume_unique=True)
    return f"{len(edges) - len(sound)} edges do not border two triangles"


def volume(corners: NDArray[np.floating]) -> float:
    """Return the volume that closed triangles enclose, in the cube of the file's unit."""
    a, b, c = np.moveaxis(corners.astype(np.float64), 1, 0)
    return float(np.sum(a * np.cross(b, c)) / 6.0)


@dataclass(frozen=True, slots=True, kw_only=True)
class Mesh:
    """Triangles of one part in its own frame."""

    points_mm: Points  #: shape (n, 3)
    triangles: Triangles  #: indices of points, anticlockwise from outside, shape (m, 3)
    body: m3.Manifold  #: the same as a manifold, for intersections

    @property
    def volume_mm3(self) -> float:
        """Enclosed volume."""
        return float(self.body.volume())


def mesh_of(part: Part, tolerance_mm: float = TOLERANCE_MM) -> Mesh:
    """Return the mesh of one instance of a part in its own frame."""
    return _mesh(part.prisms, part.balls, part.bevels, tolerance_mm)


# Designs of one study share most of their 70 kinds of parts, each in two tolerances; a mesh takes about 0.1 MB.
@lru_cache(maxsize=512)
def _mesh(prisms: tuple[Prism, ...], balls: tuple[Ball, ...], bevels: tuple[Bevel, ...], tolerance_mm: float) -> Mesh:
    stack = regrouped(prisms)
    mesh = _united(stack, balls, bevels, tolerance_mm)
    # Prisms are apart by rounding if one ends at z0 + (z1 - z0) and the next begins at z1. Multiples of 2^-40 mm add up
    # exactly. They are not used for every part, since other heights order the triangles in another way.
    numbers = np.sort(place_numbers(mesh.points_mm))
    if np.all(numbers[1:] != numbers[:-1]):
        return mesh
    return _united([_exact(prism) for prism in stack], balls, bevels, tolerance_mm)


def _united(prisms: Sequence[Prism], balls: Sequence[Ball], bevels: Sequence[Bevel], tolerance_mm: float) -> Mesh:
    pieces = [_extruded(prism, tolerance_mm) for prism in prisms] + [_ball(ball, tolerance_mm) for ball in balls]
    mesh = mesh_from(m3.Manifold.batch_boolean(pieces, m3.OpType.Add))
    if any(has_cone(bevel) for bevel in bevels):
        points, triangles = beveled(mesh.points_mm, mesh.triangles, bevels)
        body = m3.Manifold(m3.Mesh64(points, triangles.astype(np.uint64)))
        mesh = Mesh(points_mm=points, triangles=triangles, body=body)
    return _welded(mesh)


def shell_of(part: Part, tolerance_mm: float) -> tuple[Points, Triangles]:
    """Return triangles that show a part: its prisms and balls one by one, with the cones on them, in its own frame.

    The pieces are not united, which would take four fifths of the time: inside the part there are faces that nobody
    sees. A cone on an edge that only the united part has is left out.
    """
    return _shell(part.prisms, part.balls, part.bevels, tolerance_mm)


@lru_cache(maxsize=256)
def _shell(
    prisms: tuple[Prism, ...], balls: tuple[Ball, ...], bevels: tuple[Bevel, ...], tolerance_mm: float
) -> tuple[Points, Triangles]:
    left = [bevel for bevel in bevels if has_cone(bevel)]
    points, triangles, count = [], [], 0
    pieces: list[Prism | Ball] = [*regrouped(prisms), *balls]
    for piece in pieces:
        mesh = mesh_from(_extruded(piece, tolerance_mm) if isinstance(piece, Prism) else _ball(piece, tolerance_mm))
        own = [bevel for bevel in left if isinstance(piece, Prism) and is_on(bevel, piece)]
        left = [bevel for bevel in left if bevel not in own]
        corners, faces = beveled(mesh.points_mm, mesh.triangles, own)
        points.append(corners)
        triangles.append(faces + count)
        count += len(corners)
    return np.concatenate(points), np.concatenate(triangles)


def _exact(prism: Prism) -> Prism:
    """Return the prism with its ends rounded to multiples of 2^-40 mm."""
    z0, z1 = (float(np.ldexp(np.rint(np.ldexp(float(z), 40)), -40)) for z in (prism.z0_mm, prism.z1_mm))
    return replace(prism, z0_mm=z0, z1_mm=z1)


def mesh_from(body: m3.Manifold) -> Mesh:
    """Return the triangles of a manifold."""
    raw = body.to_mesh64()
    return Mesh(
        points_mm=np.asarray(raw.vert_properties)[:, :3].astype(np.float64),
        triangles=np.asarray(raw.tri_verts).astype(np.int64),
        body=body,
    )


def joined(members: Sequence[tuple[Mesh, NDArray[np.float64]]], scale: float = 1.0) -> Mesh:
    """Return meshes that do not cut each other as one, each moved by its 4 x 4 matrix.

    Where members have edges in common, these would border four triangles in a file, whose unit is ``scale`` times a
    millimetre; the later members are then moved along y, the joints' axis, by as many micrometres as it takes. The
    meshes are put together here, since manifold3d orders triangles by when their meshes were made, which is not the
    same in every process.
    """
    starts = np.cumsum([0, *(len(mesh.points_mm) for mesh, _ in members)])
    points = np.concatenate([mesh.points_mm @ matrix[:3, :3].T + matrix[:3, 3] for mesh, matrix in members])
    triangles = np.concatenate([mesh.triangles + at for (mesh, _), at in zip(members, starts, strict=False)])
    owners = np.repeat(np.arange(len(members)), [len(mesh.points_mm) for mesh, _ in members])
    steps = np.zeros(len(members))
    # Ends, since the first member never moves, and each other one leaves the places of those before it one by one.
    while (touching := _touching(points * scale, triangles, owners)).size:
        steps[touching] += 1.0
        points[:, 1] += APART_MM * np.isin(owners, touching)
    moves = [np.array([0.0, APART_MM * step, 0.0]) for step in steps.tolist()]
    bodies = [placed(mesh.body, matrix).translate(move) for (mesh, matrix), move in zip(members, moves, strict=True)]
    return Mesh(points_mm=points, triangles=triangles, body=m3.Manifold.compose(bodies))


def placed(body: m3.Manifold, matrix: NDArray[np.float64]) -> m3.Manifold:
    """Return a manifold moved by a 4 x 4 matrix."""
    return body.transform(matrix[:3, :])


def _welded(mesh: Mesh) -> Mesh:
    """Return the same mesh with the ends of edges shorter than ``WELD_MM`` made one point."""
    edges = np.concatenate([mesh.triangles[:, [k, (k + 1) % 3]] for k in range(3)])
    short = np.all(np.abs(mesh.points_mm[edges[:, 0]] - mesh.points_mm[edges[:, 1]]) < WELD_MM, axis=1)
    if not short.any():
        return mesh
    target = np.arange(len(mesh.points_mm))
    for one, other in np.sort(edges[short], axis=1):
        target[target == target[other]] = target[one]
    triangles = target[mesh.triangles]
    flat = np.any(triangles == triangles[:, [1, 2, 0]], axis=1)
    used, triangles = np.unique(triangles[~flat], return_inverse=True)
    return Mesh(points_mm=mesh.points_mm[used], triangles=triangles.reshape(-1, 3), body=mesh.body)


def _touching(points: Points, triangles: Triangles, owners: NDArray[np.intp]) -> NDArray[np.intp]:
    """Return members that share an edge with an earlier one; of several with one edge at least the last."""
    here = place_numbers(points)
    start, end = here[triangles].ravel(), here[triangles[:, [1, 2, 0]]].ravel()
    # One direction is enough: the edges of a closed member run in both.
    chosen = np.flatnonzero(start < end)
    edges = edge_numbers(start[chosen], end[chosen])
    order = np.argsort(edges)
    same = np.flatnonzero(edges[order[1:]] == edges[order[:-1]])
    owner = owners[triangles[:, 0]][chosen[order] // 3]
    one, other = owner[same], owner[same + 1]
    return np.unique(np.maximum(one, other)[one != other])


def _extruded(prism: Prism, tolerance_mm: float) -> m3.Manifold:
    outline = cross_section([prism.outline], tolerance_mm)
    if prism.holes:
        outline = outline - cross_section(prism.holes, tolerance_mm)
    z0, z1 = float(prism.z0_mm), float(prism.z1_mm)
    return outline.extrude(z1 - z0).translate((0.0, 0.0, z0))


def _ball(ball: Ball, tolerance_mm: float) -> m3.Manifold:
    radius, top, y = float(ball.radius_mm), float(ball.top_mm), float(ball.y_mm)
    segments = 4 * int(np.ceil(np.pi / (4.0 * np.arccos(1.0 - 2.0 * tolerance_mm / radius))))
    body = m3.Manifold.sphere(radius, segments).translate((0.0, y, 0.0))
    if ball.pocket is not None:
        pocket = _extruded(ball.pocket, tolerance_mm)
        # The pocket opens at the cut, whatever rounding says.
        body = body - pocket - pocket.translate((0.0, 0.1, 0.0))
    return body.trim_by_plane((0.0, -1.0, 0.0), -(y + top))
