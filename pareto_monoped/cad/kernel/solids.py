"""Part -> solid: one extruded face with holes per prism, one fusion of all prisms that touch, then cones. Millimetres.

Open CASCADE is called directly, as importing it takes a fifth of the time that a library above it takes. Cones are
chamfers of the edges of cylinders, 1 ms each, a seventh of what cutting with cones takes.
"""

from collections.abc import Iterator, Sequence
from functools import lru_cache

import numpy as np
from OCP.BOPAlgo import BOPAlgo_GlueShift
from OCP.BRepAdaptor import BRepAdaptor_Curve, BRepAdaptor_Surface
from OCP.BRepAlgoAPI import BRepAlgoAPI_Cut, BRepAlgoAPI_Fuse
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeEdge, BRepBuilderAPI_MakeFace, BRepBuilderAPI_MakeWire
from OCP.BRepFilletAPI import BRepFilletAPI_MakeChamfer
from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox, BRepPrimAPI_MakeCone, BRepPrimAPI_MakePrism, BRepPrimAPI_MakeSphere
from OCP.collections import HArray1_gp_Pnt, List_TopoDS_Shape
from OCP.collections import IndexedDataMap_TopoDS_Shape_List_TopoDS_Shape_TopTools_ShapeMapHasher as EdgeMap
from OCP.GC import GC_MakeArcOfCircle
from OCP.Geom import Geom_BSplineCurve
from OCP.GeomAbs import GeomAbs_CurveType, GeomAbs_SurfaceType
from OCP.GeomAPI import GeomAPI_Interpolate
from OCP.gp import gp_Ax2, gp_Circ, gp_Dir, gp_Pln, gp_Pnt, gp_Vec
from OCP.TopAbs import TopAbs_ShapeEnum
from OCP.TopExp import TopExp, TopExp_Explorer
from OCP.TopoDS import TopoDS, TopoDS_Edge, TopoDS_Face, TopoDS_Shape, TopoDS_Wire

from pareto_monoped.cad.shape.outlines import (
    Contour,
    Points,
    Spline,
    ends,
    on_arc,
    regions,
    regrouped,
    stands_on,
    without_teeth,
)
from pareto_monoped.geometry.features import Bevel
from pareto_monoped.geometry.parts import Ball, Part, Prism
from pareto_monoped.geometry.shapes import Circle, Line

_ON_EDGE_MM = 1e-5  # from where an edge should be to where fused solids have it
_UP = gp_Dir(0.0, 0.0, 1.0)
_FIT_MM = 1e-6  # distance of splines from their points


def beveled(solid: TopoDS_Shape, bevels: Sequence[Bevel]) -> TopoDS_Shape:
    """Return a solid with cones on the edges of its cylinders; ``ValueError`` if one fits no edge."""
    cuts = [bevel for bevel in bevels if not _adds(bevel) and float(bevel.edge_mm) != float(bevel.at.radius_mm)]
    shape = _chamfered(solid, cuts) if cuts else solid
    for bevel in bevels:
        if _adds(bevel):
            shape = BRepAlgoAPI_Fuse(shape, _head(bevel)).Shape()
    return shape


def _adds(bevel: Bevel) -> bool:
    return not bevel.hole and float(bevel.edge_mm) > float(bevel.at.radius_mm)


def _head(bevel: Bevel) -> TopoDS_Shape:
    ((x, y),) = bevel.centres_mm()
    along = float(bevel.end_mm) - float(bevel.face_mm)
    axes = gp_Ax2(gp_Pnt(x, y, float(bevel.face_mm)), gp_Dir(0.0, 0.0, float(np.sign(along))))
    return BRepPrimAPI_MakeCone(axes, float(bevel.edge_mm), float(bevel.at.radius_mm), abs(along)).Shape()


def _chamfered(solid: TopoDS_Shape, bevels: Sequence[Bevel]) -> TopoDS_Shape:
    edges, faces, circles = _round_edges(solid)
    chamfer = BRepFilletAPI_MakeChamfer(solid)
    for bevel in bevels:
        wall, face, along = (float(v) for v in (bevel.at.radius_mm, bevel.face_mm, bevel.end_mm - bevel.face_mm))
        for x, y in bevel.centres_mm():
            found = np.flatnonzero(np.all(np.abs(circles - (x, y, face, wall)) < _ON_EDGE_MM, axis=1))
            if not found.size:
                raise ValueError(f"bevel at ({x:g}, {y:g}, {face:g}) mm: no edge of radius {wall:g} mm is there")
            for k in found.tolist():
                chamfer.Add(abs(float(bevel.edge_mm) - wall), abs(along), edges[k], faces[k])
    chamfer.Build()
    if not chamfer.IsDone():
        raise ValueError("bevels: one does not fit between its neighbours; correct the part's features")
    return chamfer.Shape()


def _round_edges(solid: TopoDS_Shape) -> tuple[list[TopoDS_Edge], list[TopoDS_Face], np.ndarray]:
    """Return the circular edges between a plane and something else: edges, planes, and rows of x, y, z, radius."""
    borders = EdgeMap()
    TopExp.MapShapesAndAncestors_s(solid, TopAbs_ShapeEnum.TopAbs_EDGE, TopAbs_ShapeEnum.TopAbs_FACE, borders)
    edges, faces, rows = [], [], []
    for k in range(1, borders.Extent() + 1):
        edge = TopoDS.Edge(borders.FindKey(k))
        curve = BRepAdaptor_Curve(edge)
        if curve.GetType() != GeomAbs_CurveType.GeomAbs_Circle:
            continue
        for face in borders.FindFromIndex(k):
            if BRepAdaptor_Surface(TopoDS.Face(face), False).GetType() == GeomAbs_SurfaceType.GeomAbs_Plane:
                circle = curve.Circle()
                centre = circle.Location()
                edges.append(edge)
                faces.append(TopoDS.Face(face))
                rows.append((centre.X(), centre.Y(), centre.Z(), circle.Radius()))
    return edges, faces, np.array(rows, dtype=np.float64).reshape(-1, 4)


def solid_of(part: Part) -> TopoDS_Shape:
    """Return one instance of a part, whose numbers are floats: a solid, or a compound of separate bodies."""
    return solid_from(part.prisms, part.balls, part.bevels)


@lru_cache(maxsize=256)
def solid_from(prisms: tuple[Prism, ...], balls: tuple[Ball, ...], bevels: tuple[Bevel, ...] = ()) -> TopoDS_Shape:
    """Return the same from a part's geometry, kept since designs of one study share most of their 70 or so parts."""
    pieces, left = [], list(bevels)
    # Before the fusion, pieces have few faces, which makes their cones cheap.
    layers = [layer for prism in regrouped(prisms) for layer in without_teeth(prism, bevels)]
    for prism in layers:
        bodies = list(_extruded(prism))
        # The cones of a pattern over several bodies wait until these are one.
        own = [bevel for bevel in left if stands_on(bevel, prism)] if len(bodies) == 1 else []
        left = [bevel for bevel in left if bevel not in own]
        pieces += [beveled(body, own) for body in bodies]
    pieces += [_ball(ball) for ball in balls]
    shape = beveled(pieces[0] if len(pieces) == 1 else _fused(pieces), left)
    solids = solids_in(shape)
    return solids[0] if len(solids) == 1 else shape


def solids_in(shape: TopoDS_Shape) -> list[TopoDS_Shape]:
    """Return the solids that a shape consists of: itself if it is one."""
    explorer, found = TopExp_Explorer(shape, TopAbs_ShapeEnum.TopAbs_SOLID), []
    while explorer.More():
        found.append(explorer.Current())
        explorer.Next()
    return found


def wire_of(contour: Contour, z_mm: float = 0.0) -> TopoDS_Wire:
    """Return a closed curve as a wire in a plane across the z axis, anticlockwise."""
    wire = BRepBuilderAPI_MakeWire()
    for edge in _circle(contour.circle, z_mm) if contour.circle is not None else _edges(contour, z_mm):
        wire.Add(edge)
    return wire.Wire()


def _circle(circle: Circle, z_mm: float) -> Iterator[TopoDS_Edge]:
    axes = gp_Ax2(gp_Pnt(float(circle.x_mm), float(circle.y_mm), z_mm), _UP)
    yield BRepBuilderAPI_MakeEdge(gp_Circ(axes, float(circle.radius_mm))).Edge()


def _edges(contour: Contour, z_mm: float) -> Iterator[TopoDS_Edge]:
    for piece in contour.pieces:
        if isinstance(piece, Spline):
            yield BRepBuilderAPI_MakeEdge(_spline(piece, z_mm)).Edge()
            continue
        first, last = (_point(end, z_mm) for end in ends(piece))
        if isinstance(piece, Line):
            yield BRepBuilderAPI_MakeEdge(first, last).Edge()
        else:
            middle = on_arc(piece, 0.5 * (float(piece.start_rad) + float(piece.end_rad)))
            yield BRepBuilderAPI_MakeEdge(GC_MakeArcOfCircle(first, _point(middle, z_mm), last).Value()).Edge()


def _point(xy: Points, z_mm: float) -> gp_Pnt:
    return gp_Pnt(float(xy[0]), float(xy[1]), z_mm)


def _spline(piece: Spline, z_mm: float) -> Geom_BSplineCurve:
    points = HArray1_gp_Pnt(1, len(piece.points_mm))
    for k, point in enumerate(piece.points_mm, 1):
        points.SetValue(k, _point(point, z_mm))
    through = GeomAPI_Interpolate(points, False, _FIT_MM)
    through.Perform()
    return through.Curve()


def _extruded(prism: Prism) -> Iterator[TopoDS_Shape]:
    z0, z1 = float(prism.z0_mm), float(prism.z1_mm)
    for outline, holes in regions(prism.outline, prism.holes):
        face = BRepBuilderAPI_MakeFace(gp_Pln(gp_Pnt(0.0, 0.0, z0), _UP), wire_of(outline, z0), True)
        for hole in holes:
            face.Add(TopoDS.Wire(wire_of(hole, z0).Reversed()))
        yield BRepPrimAPI_MakePrism(face.Face(), gp_Vec(0.0, 0.0, z1 - z0)).Shape()


def _ball(ball: Ball) -> TopoDS_Shape:
    radius, top, y = float(ball.radius_mm), float(ball.top_mm), float(ball.y_mm)
    sphere = BRepPrimAPI_MakeSphere(gp_Ax2(gp_Pnt(0.0, y, 0.0), _UP), radius).Shape()
    above = BRepPrimAPI_MakeBox(gp_Pnt(-radius, y + top, -radius), 2.0 * radius, radius, 2.0 * radius).Shape()
    shape = BRepAlgoAPI_Cut(sphere, above).Shape()
    if ball.pocket is not None:
        for pocket in _extruded(ball.pocket):
            shape = BRepAlgoAPI_Cut(shape, pocket).Shape()
    return solids_in(shape)[0]


def _fused(pieces: list[TopoDS_Shape]) -> TopoDS_Shape:
    """Return everything that touches as one solid; the pieces share faces but no volume, so glueing suffices."""
    arguments, tools = List_TopoDS_Shape(), List_TopoDS_Shape()
    arguments.Append(pieces[0])
    for piece in pieces[1:]:
        tools.Append(piece)
    fuse = BRepAlgoAPI_Fuse()
    fuse.SetArguments(arguments)
    fuse.SetTools(tools)
    fuse.SetGlue(BOPAlgo_GlueShift)
    fuse.Build()
    return fuse.Shape()
