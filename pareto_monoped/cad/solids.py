"""Part -> solid: a face with holes and one extrusion for every prism, then one fusion of what touches. Millimetres."""

from collections.abc import Iterable
from typing import TypeAlias

import build123d as bd
from OCP.BOPAlgo import BOPAlgo_GlueShift
from OCP.BRepAlgoAPI import BRepAlgoAPI_Fuse
from OCP.collections import List_TopoDS_Shape

from pareto_monoped.cad.curves import Loop, Spline, ends, on_arc
from pareto_monoped.cad.outlines import loops
from pareto_monoped.cad.stacks import regrouped
from pareto_monoped.geometry.parts import Ball, Part, Prism
from pareto_monoped.geometry.shapes import Line

Solid: TypeAlias = "bd.Solid | bd.Compound"


def solid_of(part: Part) -> Solid:
    """One instance of a part in its own frame: a solid, or a compound if the part has separate bodies.

    The part's numbers must be floats, not arrays.
    """
    pieces = [piece for prism in regrouped(part.prisms) for piece in _extruded(prism)]
    pieces += [_ball(ball) for ball in part.balls]
    return pieces[0] if len(pieces) == 1 else _fused(pieces)


def wire_of(loop: Loop, z_mm: float = 0.0) -> bd.Wire:
    """A closed curve as a wire in a plane across the z axis."""
    if loop.circle is not None:
        circle = loop.circle
        plane = bd.Plane((float(circle.x_mm), float(circle.y_mm), z_mm))
        return bd.Wire([bd.Edge.make_circle(float(circle.radius_mm), plane)])
    edges = []
    for piece in loop.pieces:
        if isinstance(piece, Spline):
            edges.append(bd.Edge.make_spline([(float(x), float(y), z_mm) for x, y in piece.points_mm]))
            continue
        first, last = ends(piece)
        if isinstance(piece, Line):
            edges.append(bd.Edge.make_line((*first, z_mm), (*last, z_mm)))
        else:
            middle = on_arc(piece, 0.5 * (float(piece.start_rad) + float(piece.end_rad)))
            edges.append(bd.Edge.make_three_point_arc((*first, z_mm), (*middle, z_mm), (*last, z_mm)))
    return bd.Wire(edges)


def _extruded(prism: Prism) -> Iterable[bd.Solid]:
    z0, z1 = float(prism.z0_mm), float(prism.z1_mm)
    holes = [wire_of(loop, z0) for hole in prism.holes for loop in loops(hole)]
    outlines = loops(prism.outline)
    for outline in outlines:
        # Holes belong to the one region; a pattern of discs has none.
        face = bd.Face(wire_of(outline, z0), holes if len(outlines) == 1 else None)
        if face.normal_at().Z < 0.0:
            face = -face
        yield bd.Solid.extrude(face, bd.Vector(0.0, 0.0, z1 - z0))


def _ball(ball: Ball) -> bd.Solid:
    radius, top, y = float(ball.radius_mm), float(ball.top_mm), float(ball.y_mm)
    centre = bd.Location((0.0, y, 0.0))
    above = bd.Solid.make_box(2.0 * radius, radius, 2.0 * radius, bd.Plane((-radius, top, -radius), z_dir=(0, 0, 1)))
    shape = bd.Solid.make_sphere(radius, angle1=-90, angle2=90).moved(centre).cut(above.moved(centre))
    if ball.pocket is not None:
        shape = shape.cut(*_extruded(ball.pocket))
    return shape.solids()[0]


def _fused(pieces: list[bd.Solid]) -> Solid:
    """Everything that touches as one solid; the pieces share faces but no volume, so that glueing is enough.

    Called without the simplification that build123d adds, which costs more than the operation.
    """
    arguments, tools = List_TopoDS_Shape(), List_TopoDS_Shape()
    arguments.Append(pieces[0].wrapped)
    for piece in pieces[1:]:
        tools.Append(piece.wrapped)
    fuse = BRepAlgoAPI_Fuse()
    fuse.SetArguments(arguments)
    fuse.SetTools(tools)
    fuse.SetGlue(BOPAlgo_GlueShift)
    fuse.Build()
    result = bd.Compound(fuse.Shape())
    solids = result.solids()
    return solids[0] if len(solids) == 1 else result
