"""The assembly seen from its side, and cut along the leg with straight joints, from the parts' meshes."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import manifold3d as m3
import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry.base import BaseGeometry

from pareto_monoped.cad.assembly import Pose, body_frames
from pareto_monoped.cad.drawing.paper import NARROW_MM, Paper
from pareto_monoped.cad.drawing.profile import polygons
from pareto_monoped.cad.drawing.section import hatch
from pareto_monoped.cad.drawing.sheet import scale_text
from pareto_monoped.cad.product import Product
from pareto_monoped.cad.shape.meshes import placed
from pareto_monoped.geometry.roles import SCREWS, Role, Visibility

Floats = NDArray[np.float64]

_LEAST_MM2 = 0.3  # smaller visible areas on paper are not drawn
_NOT_CUT = SCREWS | {Role.BOLT, Role.PIN, Role.SHAFT, Role.ROD}
"""Parts that are drawn uncut where the plane runs along them (ISO 128-3)."""
# Rows: right, up and towards the viewer of each view, in the assembly's frame.
_FROM_RIGHT = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]])
FROM_LEFT = np.array([[-1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0]])
FROM_FRONT = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]])
FROM_FRONT_LYING = np.array([[0.0, 0.0, -1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]])
"""The same turned by a right angle: the joints' axes are upright, the leg points to the right."""

_CAPTION_MM = 3.5  # height of the names of views


@dataclass(frozen=True, slots=True, kw_only=True)
class Seen:
    """A part's instance in a view: its visible region on the view's plane in millimetres, and its item."""

    item: int
    region: BaseGeometry
    cut: bool


def side_view(product: Product) -> list[Seen]:
    """Visible regions of the robot in its pose, seen from the right, the nearest first."""
    shown = []
    for (instance, unique), item in zip(product.placed(), product.kinds, strict=True):
        if instance.part.visibility is Visibility.INSIDE:
            continue
        body = placed(unique.mesh.body, to_view(_FROM_RIGHT) @ instance.world)
        shown.append((body.bounding_box()[5], item, body))
    found = []
    covered: BaseGeometry = shapely.Polygon()
    for _, item, body in sorted(shown, key=lambda entry: -entry[0]):
        region = outline_of(body.project())
        visible = region.difference(covered)
        if not visible.is_empty:
            found.append(Seen(item=item, region=visible, cut=False))
            covered = covered.union(region)
    return found


def leg_section(product: Product) -> list[Seen]:
    """Regions of the robot with straight joints on the plane through all joint axes, seen from the front."""
    frames = body_frames(product.robot, Pose(hip_rad=0.0, knee_rad=0.0))
    found = []
    for (instance, unique), item in zip(product.placed(), product.kinds, strict=True):
        body = placed(unique.mesh.body, to_view(FROM_FRONT) @ frames[instance.body] @ instance.in_body)
        low, high = body.bounding_box()[2], body.bounding_box()[5]
        if low >= 0.0 or high <= 0.0:
            continue
        region = outline_of(body.slice(0.0))
        if not region.is_empty:
            found.append(Seen(item=item, region=region, cut=instance.part.role not in _NOT_CUT))
    return found


def drawn(seen: Sequence[Seen], scale: float) -> Paper:
    """The regions on paper, cut ones hatched, neighbouring parts in different directions."""
    paper = Paper()
    for one in seen:
        region = shapely.transform(one.region, lambda points: points * scale)
        for polygon in polygons(region):
            if polygon.area < _LEAST_MM2:
                continue
            for ring in (polygon.exterior, *polygon.interiors):
                width = NARROW_MM if polygon.area < 20.0 * _LEAST_MM2 else 0.35
                paper.line(list(ring.simplify(0.02).coords)[:-1], width_mm=width, closed=True)
        if one.cut:
            hatch(paper, region, falling=one.item % 2 == 1)
    return paper


def within(seen: Sequence[Seen], low_mm: float, high_mm: float) -> list[Seen]:
    """The regions of a view between two heights."""
    band = shapely.box(-1e5, low_mm, 1e5, high_mm)
    clipped = [replace(one, region=one.region.intersection(band)) for one in seen]
    return [one for one in clipped if not one.region.is_empty]


def areas(seen: Sequence[Seen]) -> dict[int, float]:
    """The largest visible region of each item in mm2 of the robot."""
    found: dict[int, float] = {}
    for one in seen:
        found[one.item] = max(found.get(one.item, 0.0), max((p.area for p in polygons(one.region)), default=0.0))
    return found


def to_view(axes: Floats) -> Floats:
    """From the assembly's frame to a view's."""
    matrix = np.eye(4)
    matrix[:3, :3] = axes
    return matrix


def outline_of(section: m3.CrossSection) -> BaseGeometry:
    """A region of the plane as a Shapely geometry."""
    rings = [np.asarray(ring) for ring in section.to_polygons() if len(ring) > 2]
    # Manifold gives outer boundaries anticlockwise and holes clockwise; even-odd filling needs no order.
    region: BaseGeometry = shapely.Polygon()
    for ring in sorted((shapely.Polygon(ring).buffer(0.0) for ring in rings), key=lambda area: -area.area):
        region = region.symmetric_difference(ring)
    return region


def captioned(paper: Paper, name: str, scale: float) -> Paper:
    """A finished view with its name and scale over it, and its middle, without these, at y = 0."""
    left, low, right, high = paper.box()
    paper.text(f"{name}, {scale_text(scale)}", 0.5 * (left + right), high + 6.0, height_mm=_CAPTION_MM, align="centre")
    centred = Paper()
    centred.lay(paper, 0.0, -0.5 * (low + high))
    return centred
