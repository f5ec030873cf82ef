"""Part -> closed triangle mesh, from the same outlines as the solid; millimetres.

Each prism is an extruded polygon. manifold3d unites the prisms of a part and keeps the mesh closed. Polygons stay
within ``TOLERANCE_MM`` of their arcs, which changes the volume of thin round parts by at most a few thousandths.

Meshes must also be closed in their files, see ``closed``. Points that would merge there are welded, and parts that
touch are moved apart.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

import manifold3d as m3
import numpy as np
from numpy.typing import NDArray

from pareto_monoped.cad.shape.beveled import beveled, has_cone
from pareto_monoped.cad.shape.closed import edge_numbers, place_numbers
from pareto_monoped.cad.shape.outlines import all_polygons
from pareto_monoped.cad.shape.stacks import is_on, regrouped
from pareto_monoped.geometry.bevels import Bevel
from pareto_monoped.geometry.parts import Ball, Part, Prism

TOLERANCE_MM = 0.01
WELD_MM = 1e-4
"""Shorter edges are welded. A robot's mesh in metres has single-precision numbers 0.00006 mm apart at most (at 1 m)."""
APART_MM = 1e-3
"""How far touching parts are moved apart: many such numbers, and 1 percent of the coarsest mesh's tolerance."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Mesh:
    """Triangles of one part in its own frame.

    Attributes:
        points_mm: shape (n, 3).
        triangles: indices of points, anticlockwise from outside, shape (m, 3).
        body: the same as a manifold, for intersections.
    """

    points_mm: NDArray[np.float64]
    triangles: NDArray[np.int64]
    body: m3.Manifold

    @property
    def volume_mm3(self) -> float:
        """Enclosed volume."""
        return float(self.body.volume())


def mesh_of(part: Part, tolerance_mm: float = TOLERANCE_MM) -> Mesh:
    """The mesh of one instance of a part in its own frame."""
    return _mesh(part.prisms, part.balls, part.bevels, tolerance_mm)


# Designs of one study share most of their 70 kinds of parts, each in two tolerances; a mesh takes about 0.1 MB.
@lru_cache(maxsize=512)
def _mesh(prisms: tuple[Prism, ...], balls: tuple[Ball, ...], bevels: tuple[Bevel, ...], tolerance_mm: float) -> Mesh:
    stack = regrouped(prisms)
    mesh = _united(stack, balls, bevels, tolerance_mm)
    # Prisms are apart by rounding if one ends at z0 + (z1 - z0) and the next begins at z1. Multiples of 2^-40 mm add up
    # exactly. They are not used for every part, since other heights order the triangles in another way.
    if not _has_twins(mesh):
        return mesh
    return _united([_exact(prism) for prism in stack], balls, bevels, tolerance_mm)


def _united(prisms: Sequence[Prism], balls: Sequence[Ball], bevels: Sequence[Bevel], tolerance_mm: float) -> Mesh:
    pieces = [_extruded(prism, tolerance_mm) for prism in prisms] + [_ball(ball, tolerance_mm) for ball in balls]
    mesh = mesh_from(m3.Manifold.batch_boolean(pieces, m3.OpType.Add))
    if any(has_cone(bevel) for bevel in bevels):
        mesh = _mesh_of(*beveled(mesh.points_mm, mesh.triangles, bevels))
    return _welded(mesh)


def shell_of(part: Part, tolerance_mm: float) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Triangles that show a part: its prisms and balls one by one, with the cones on them, in its own frame.

    The pieces are not united, which would take four fifths of the time: inside the part there are faces that nobody
    sees. A cone on an edge that only the united part has is left out.

    Returns:
        points in millimetres, shape (n, 3), and indices of points, shape (m, 3).
    """
    return _shell(part.prisms, part.balls, part.bevels, tolerance_mm)


@lru_cache(maxsize=256)
def _shell(
    prisms: tuple[Prism, ...], balls: tuple[Ball, ...], bevels: tuple[Bevel, ...], tolerance_mm: float
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    left = [bevel for bevel in bevels if has_cone(bevel)]
    points, triangles, count = [], [], 0
    pieces: list[Prism | Ball] = [*regrouped(prisms), *balls]
    for piece in pieces:
        body = _extruded(piece, tolerance_mm) if isinstance(piece, Prism) else _ball(piece, tolerance_mm)
        mesh = mesh_from(body)
        own = [bevel for bevel in left if isinstance(piece, Prism) and is_on(bevel, piece)]
        left = [bevel for bevel in left if bevel not in own]
        corners, faces = beveled(mesh.points_mm, mesh.triangles, own)
        points.append(corners)
        triangles.append(faces + count)
        count += len(corners)
    return np.concatenate(points), np.concatenate(triangles)


def _exact(prism: Prism) -> Prism:
    """The prism with its ends rounded to multiples of 2^-40 mm."""
    z0, z1 = (float(np.ldexp(np.rint(np.ldexp(float(z), 40)), -40)) for z in (prism.z0_mm, prism.z1_mm))
    return replace(prism, z0_mm=z0, z1_mm=z1)


def _has_twins(mesh: Mesh) -> bool:
    """Whether two points of a mesh are one in a file."""
    numbers = np.sort(place_numbers(mesh.points_mm))
    return bool(np.any(numbers[1:] == numbers[:-1]))


def mesh_from(body: m3.Manifold) -> Mesh:
    """The triangles of a manifold."""
    raw = body.to_mesh64()
    return Mesh(
        points_mm=np.asarray(raw.vert_properties)[:, :3].astype(np.float64),
        triangles=np.asarray(raw.tri_verts).astype(np.int64),
        body=body,
    )


def _mesh_of(points_mm: NDArray[np.float64], triangles: NDArray[np.int64]) -> Mesh:
    """Triangles with the manifold that they bound."""
    body = m3.Manifold(m3.Mesh64(points_mm, triangles.astype(np.uint64)))
    return Mesh(points_mm=points_mm, triangles=triangles, body=body)


def joined(members: Sequence[tuple[Mesh, NDArray[np.float64]]], scale: float = 1.0) -> Mesh:
    """Meshes that do not cut each other as one, each moved by its 4 x 4 matrix.

    Where members have edges in common, these would border four triangles in a file; the later members are then moved
    along y, the joints' axis, by as many micrometres as it takes. The meshes are put together here, since manifold3d
    orders triangles by when their meshes were made, which is not the same in every process.

    Args:
        members: meshes with their matrices.
        scale: from millimetres to the unit of the file that is to hold them.
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
    """A manifold moved by a 4 x 4 matrix."""
    return body.transform(matrix[:3, :])


def _welded(mesh: Mesh) -> Mesh:
    """The same mesh with the ends of edges shorter than ``WELD_MM`` made one point."""
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


def _touching(points: NDArray[np.float64], triangles: NDArray[np.int64], owners: NDArray[np.intp]) -> NDArray[np.intp]:
    """Members that have an edge in common with an earlier member; of several with the same edge at least the last.

    Args:
        points: in the file's unit, shape (n, 3).
        triangles: indices of points, shape (m, 3).
        owners: to which member each point belongs, shape (n,).
    """
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
    outline = m3.CrossSection(all_polygons([prism.outline], tolerance_mm), m3.FillRule.NonZero)
    if prism.holes:
        outline = outline - m3.CrossSection(all_polygons(prism.holes, tolerance_mm), m3.FillRule.NonZero)
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
