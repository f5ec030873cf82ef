"""No two parts overlap in the pose of the export."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.cad.assembly import Instance
from pareto_monoped.cad.check.contact import TOUCH_MM, Overlap, PlacedMesh, deepest, near, overlap_of
from pareto_monoped.cad.check.limits import OVERLAP
from pareto_monoped.cad.check.result import Check
from pareto_monoped.cad.product import Product
from pareto_monoped.cad.shape.outlines import all_polygons
from pareto_monoped.geometry.features import CountersunkHead
from pareto_monoped.geometry.gears import InternalGear
from pareto_monoped.geometry.shapes import Circle, Numbers


def check(product: Product) -> Check:
    """Look at all pairs of instances."""
    found, pairs = in_pose(product)
    return deepest(OVERLAP, f"all {pairs} pairs in the exported pose", found)


def in_pose(product: Product) -> tuple[list[Overlap], int]:
    """Overlaps of all pairs of instances in the product's pose, and the number of pairs."""
    meshes = [PlacedMesh.of(i.name, k.mesh.body, i.world) for i, k in product.placed()]
    rings = {instance.name: _rings(instance) for instance in product.instances}
    found: list[Overlap] = []
    for one, other in near(meshes):
        if not _apart(rings[one.name], rings[other.name]):
            found += overlap_of(one, other, "in the pose")
    count = len(meshes)
    return found, count * (count - 1) // 2


@dataclass(frozen=True, slots=True, kw_only=True)
class _Rings:
    """An instance's prisms as rings around its own axis.

    Attributes:
        axis: x and z of the axis in the assembly, in mm.
        rows: per prism the least and greatest radius, the low and high y, in mm; shape (n, 4).
    """

    axis: NDArray[np.float64]
    rows: NDArray[np.float64]


def _rings(instance: Instance) -> _Rings | None:
    """The rings of an instance; None if it is not made of prisms only."""
    rows = []
    for prism in instance.part.prisms:
        heights = _heights(instance, prism.z0_mm, prism.z1_mm)
        bores = [hole for hole in prism.holes if isinstance(hole, Circle | InternalGear)]
        least = max((_bore_radius(bore) for bore in bores), default=0.0)
        greatest = max(float(np.hypot(*points.T).max()) for points in all_polygons([prism.outline]))
        rows.append((least, greatest, min(heights), max(heights)))
    # A head counts as a cylinder as wide as its face: the question is only whether the meshes need a look.
    for head in instance.part.features:
        if isinstance(head, CountersunkHead):
            (bevel,) = head.bevels
            heights = _heights(instance, bevel.face_mm, bevel.end_mm)
            rows.append((0.0, float(head.radius_mm), min(heights), max(heights)))
    return _Rings(axis=instance.world[[0, 2], 3], rows=np.array(rows)) if rows and not instance.part.balls else None


def _heights(instance: Instance, *along_mm: Numbers) -> list[float]:
    """Heights y in the assembly of heights along an instance's own axis."""
    return [float((instance.world @ np.array([0.0, 0.0, float(z), 1.0]))[1]) for z in along_mm]


def _bore_radius(hole: Circle | InternalGear) -> float:
    """Radius of a hole around the part's axis; 0 for one that is elsewhere."""
    if isinstance(hole, InternalGear):
        return float(hole.tip_radius_mm)
    return float(hole.radius_mm) if float(hole.x_mm) == 0.0 and float(hole.y_mm) == 0.0 else 0.0


def _apart(one: _Rings | None, other: _Rings | None) -> bool:
    """Whether two instances on one axis keep apart as rings, so that their meshes need not be intersected."""
    if one is None or other is None or float(np.abs(one.axis - other.axis).max()) > TOUCH_MM:
        return False
    a, b = one.rows[:, None], other.rows[None]
    radial = np.minimum(a[..., 1], b[..., 1]) - np.maximum(a[..., 0], b[..., 0]) > TOUCH_MM
    axial = np.minimum(a[..., 3], b[..., 3]) - np.maximum(a[..., 2], b[..., 2]) > TOUCH_MM
    return not bool(np.any(radial & axial))
