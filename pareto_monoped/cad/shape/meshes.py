"""Part -> closed triangle mesh, from the same outlines as the solid; millimetres.

Every prism is a polygon extruded, the prisms of a part are united by manifold3d, which keeps meshes closed. Polygons
stay within ``TOLERANCE_MM`` of their arcs: at most a few thousandths of the volume of thin round parts.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import manifold3d as m3
import numpy as np
from numpy.typing import NDArray

from pareto_monoped.cad.shape.outlines import all_polygons
from pareto_monoped.cad.shape.stacks import regrouped
from pareto_monoped.geometry.parts import Ball, Part, Prism

TOLERANCE_MM = 0.01


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
    def is_closed(self) -> bool:
        """Whether every edge borders two triangles, which run along it in opposite directions."""
        t = self.triangles
        edges = np.concatenate([t[:, [0, 1]], t[:, [1, 2]], t[:, [2, 0]]])
        count = len(self.points_mm)
        there, back = np.sort(edges @ (count, 1)), np.sort(edges @ (1, count))
        return bool(np.all(there[1:] != there[:-1]) and np.array_equal(there, back))

    @property
    def volume_mm3(self) -> float:
        """Enclosed volume."""
        return float(self.body.volume())


def mesh_of(part: Part, tolerance_mm: float = TOLERANCE_MM) -> Mesh:
    """The mesh of one instance of a part in its own frame."""
    return _mesh(part.prisms, part.balls, tolerance_mm)


# Designs of one study share most of their 70 kinds of parts, each in two tolerances; a mesh takes about 0.1 MB.
@lru_cache(maxsize=512)
def _mesh(prisms: tuple[Prism, ...], balls: tuple[Ball, ...], tolerance_mm: float) -> Mesh:
    body = m3.Manifold.batch_boolean(
        [_extruded(prism, tolerance_mm) for prism in regrouped(prisms)] + [_ball(ball, tolerance_mm) for ball in balls],
        m3.OpType.Add,
    )
    return mesh_from(body)


def mesh_from(body: m3.Manifold) -> Mesh:
    """The triangles of a manifold."""
    raw = body.to_mesh64()
    return Mesh(
        points_mm=np.asarray(raw.vert_properties)[:, :3].astype(np.float64),
        triangles=np.asarray(raw.tri_verts).astype(np.int64),
        body=body,
    )


def joined(members: Sequence[tuple[Mesh, NDArray[np.float64]]]) -> Mesh:
    """Meshes that do not touch as one, each moved by its 4 x 4 matrix.

    Put together here, since manifold3d orders triangles by when their meshes were made, which is not the same in every
    process.
    """
    starts = np.cumsum([0, *(len(mesh.points_mm) for mesh, _ in members)])
    return Mesh(
        points_mm=np.concatenate([mesh.points_mm @ matrix[:3, :3].T + matrix[:3, 3] for mesh, matrix in members]),
        triangles=np.concatenate([mesh.triangles + at for (mesh, _), at in zip(members, starts, strict=False)]),
        body=m3.Manifold.compose([placed(mesh.body, matrix) for mesh, matrix in members]),
    )


def placed(body: m3.Manifold, matrix: NDArray[np.float64]) -> m3.Manifold:
    """A manifold moved by a 4 x 4 matrix."""
    return body.transform(matrix[:3, :])


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
