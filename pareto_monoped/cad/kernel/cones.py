"""Bevels on solids: the kernel chamfers the edges of cylinders, and fuses countersunk heads. Millimetres.

Chamfering costs 1 ms per edge, a seventh of what cutting with cones does.
"""

from collections.abc import Sequence

import numpy as np
from OCP.BRepAdaptor import BRepAdaptor_Curve, BRepAdaptor_Surface
from OCP.BRepAlgoAPI import BRepAlgoAPI_Fuse
from OCP.BRepFilletAPI import BRepFilletAPI_MakeChamfer
from OCP.BRepPrimAPI import BRepPrimAPI_MakeCone
from OCP.collections import IndexedDataMap_TopoDS_Shape_List_TopoDS_Shape_TopTools_ShapeMapHasher as EdgeMap
from OCP.GeomAbs import GeomAbs_CurveType, GeomAbs_SurfaceType
from OCP.gp import gp_Ax2, gp_Dir, gp_Pnt
from OCP.TopAbs import TopAbs_ShapeEnum
from OCP.TopExp import TopExp
from OCP.TopoDS import TopoDS, TopoDS_Edge, TopoDS_Face, TopoDS_Shape

from pareto_monoped.geometry.bevels import Bevel

_ON_EDGE_MM = 1e-5  # from where an edge should be to where fused solids have it


def beveled(solid: TopoDS_Shape, bevels: Sequence[Bevel]) -> TopoDS_Shape:
    """A solid with cones on the edges of its cylinders.

    Raises:
        ValueError: a bevel stands on no edge of the solid, or does not fit there.
    """
    wider = [bevel for bevel in bevels if _adds(bevel)]
    cuts = [bevel for bevel in bevels if not _adds(bevel) and float(bevel.edge_mm) != float(bevel.at.radius_mm)]
    shape = _chamfered(solid, cuts) if cuts else solid
    for bevel in wider:
        shape = BRepAlgoAPI_Fuse(shape, _head(bevel)).Shape()
    return shape


def _adds(bevel: Bevel) -> bool:
    return not bevel.hole and float(bevel.edge_mm) > float(bevel.at.radius_mm)


def _head(bevel: Bevel) -> TopoDS_Shape:
    """The cone of a countersunk head, around its shank."""
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
    """The circular edges between a plane and something else: edges, planes, and rows of x, y, z, radius."""
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
