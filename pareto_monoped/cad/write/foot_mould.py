"""A mould for the rubber foot: two printed halves around it, which hold the foot's block by its sides."""

import manifold3d as m3
import numpy as np
from numpy.typing import NDArray

from pareto_monoped.cad.shape.meshes import Mesh, mesh_from
from pareto_monoped.cad.shape.outlines import all_polygons
from pareto_monoped.geometry.parts import Part
from pareto_monoped.geometry.shapes import Shape

# Our own layout, mm.
WALL_MM = 8.0
"""Least thickness around the foot."""
COLLAR_MM = 12.0
"""How far the halves reach up beside the foot's block, which they hold in its place."""
PLAY_MM = 0.15
"""Around the block: what a printed hole is too small by."""
PIN_DEPTH_MM = 8.0
"""Depth in each half of the dowel pins 4 x 16 (ISO 2338) that align them."""
_PIN_HOLE = 4.2
POUR_MM = 6.0
"""Diameter of the holes for pouring and for the air, beside the block."""
_SEGMENTS = 160  # of the ball: 0.013 mm from round at a radius of 33 mm


def foot_mould(foot: Part, block: Part) -> tuple[Mesh, Mesh]:
    """Both halves as they are printed: the plane that parts them upwards, z upwards, millimetres.

    Args:
        foot: a ball that is cut flat, with a pocket for the block's tongue.
        block: what the foot is moulded onto; it stands on the foot's flat.
    """
    (ball,) = foot.balls
    radius, top = float(ball.radius_mm), float(ball.top_mm)
    body = next(prism for prism in block.prisms if prism.holes)
    low, high = _extent(body.outline)
    half_width, half_thick = 0.5 * (high[0] - low[0]) + PLAY_MM, float(body.z1_mm) + PLAY_MM
    outside = radius + WALL_MM
    # The foot's centre is the origin here, y up, z across the parting plane.
    solid = _box((-outside, -outside, -outside), (outside, top + COLLAR_MM, outside))
    cavity = m3.Manifold.sphere(radius, _SEGMENTS).trim_by_plane((0.0, -1.0, 0.0), -top)
    seat = _box((-half_width, top, -half_thick), (half_width, top + COLLAR_MM + 1.0, half_thick))
    solid = solid - cavity - seat
    flat = float(np.sqrt(radius**2 - top**2))
    pour = 0.5 * (half_width + flat)
    for side in (-1.0, 1.0):
        hole = m3.Manifold.cylinder(COLLAR_MM + 6.0, 0.5 * POUR_MM, circular_segments=48).rotate((-90.0, 0.0, 0.0))
        solid -= hole.translate((side * pour, top - 5.0, 0.0))
    at = 0.5 * (radius + outside) * np.sqrt(0.5) + 4.0
    for x, up in ((-at, -at), (at, -at), (-outside + 5.0, top), (outside - 5.0, top)):
        pin = m3.Manifold.cylinder(2.0 * PIN_DEPTH_MM, 0.5 * _PIN_HOLE, circular_segments=48, center=True)
        solid -= pin.translate((float(x), float(up), 0.0))
    front = solid.trim_by_plane((0.0, 0.0, -1.0), 0.0)
    back = solid.trim_by_plane((0.0, 0.0, 1.0), 0.0).rotate((0.0, 180.0, 0.0))
    return mesh_from(front), mesh_from(back)


def rubber_ml(foot: Part) -> float:
    """Volume of the foot in millilitres."""
    return 1e-3 * float(foot.volume_mm3())


def _box(low: tuple[float, float, float], high: tuple[float, float, float]) -> m3.Manifold:
    size = tuple(b - a for a, b in zip(low, high, strict=True))
    return m3.Manifold.cube((size[0], size[1], size[2])).translate(low)


def _extent(outline: Shape) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    points = np.concatenate([np.asarray(polygon) for polygon in all_polygons([outline])])
    return points.min(axis=0), points.max(axis=0)
