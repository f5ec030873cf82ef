"""No two parts overlap in the pose of the export; how much volume two parts share, and how deep on average."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

import manifold3d as m3
import numpy as np
from numpy.typing import NDArray

from pareto_monoped.cad.assembly import Instance, Matrix
from pareto_monoped.cad.check.result import OVERLAP, Check, Finding, Limit, worst_of
from pareto_monoped.cad.product import Product
from pareto_monoped.cad.shape.meshes import TOLERANCE_MM, cross_section, placed
from pareto_monoped.cad.shape.outlines import all_polygons, centres_mm
from pareto_monoped.geometry.features import CountersunkHead
from pareto_monoped.geometry.gears import InternalGear
from pareto_monoped.geometry.parts import Part
from pareto_monoped.geometry.shapes import Circle, Pattern

TOUCH_MM = 1e-6  #: Closer than this is touching, not overlapping.
_LEAST_MM3 = 1e-6  # rounding in manifold3d
_LEAST_MM2 = 1e-9
"""Areas below this are rounding: over the height of any part they make less than the least volume of an overlap."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Overlap:
    """Two instances that share volume."""

    one: str
    other: str
    volume_mm3: float  #: shared volume
    depth_mm: float  #: mean depth, twice the shared volume over its surface
    where: str  #: in which position of the robot, in words

    def __str__(self) -> str:
        size = f"{self.volume_mm3:.2f} mm3, {self.depth_mm:.3f} mm deep"
        return f"{self.one} and {self.other} overlap by {size}, {self.where}"


@dataclass(frozen=True, slots=True, kw_only=True)
class PlacedMesh:
    """An instance's mesh in some frame, with the low and the high corner of its bounding box."""

    name: str
    body: m3.Manifold
    low: NDArray[np.float64]
    high: NDArray[np.float64]

    @classmethod
    def of(cls, name: str, body: m3.Manifold, matrix: Matrix) -> "PlacedMesh":
        """Return a mesh moved by a 4 x 4 matrix."""
        moved = placed(body, matrix)
        box = np.asarray(moved.bounding_box())
        return cls(name=name, body=moved, low=box[:3], high=box[3:])


def near(meshes: Sequence[PlacedMesh]) -> Iterator[tuple[PlacedMesh, PlacedMesh]]:
    """Yield pairs of different meshes whose bounding boxes overlap, each pair once."""
    low, high = np.array([mesh.low for mesh in meshes]), np.array([mesh.high for mesh in meshes])
    meets = np.all((low[:, None] < high[None] - TOUCH_MM) & (low[None] < high[:, None] - TOUCH_MM), axis=2)
    for i, j in np.argwhere(np.triu(meets, 1)):
        yield meshes[i], meshes[j]


def boxes_meet(one: PlacedMesh, other: PlacedMesh) -> bool:
    """Return whether two bounding boxes overlap."""
    return bool(np.all(one.low < other.high - TOUCH_MM) and np.all(other.low < one.high - TOUCH_MM))


def overlap_of(one: PlacedMesh, other: PlacedMesh, where: str) -> Iterator[Overlap]:
    """Yield the overlap of two meshes, if they have one."""
    shared = one.body ^ other.body
    volume = shared.volume()
    if volume > _LEAST_MM3:
        depth = 2.0 * volume / shared.surface_area()
        yield Overlap(one=one.name, other=other.name, volume_mm3=volume, depth_mm=depth, where=where)


def deepest(limit: Limit, looked_at: str, found: Iterable[Overlap]) -> Check:
    """Return a check of overlaps: each pair of parts counts once, with its deepest overlap."""
    worst: dict[tuple[str, str], Overlap] = {}
    for overlap in found:
        key = (overlap.one, overlap.other)
        if key not in worst or overlap.depth_mm > worst[key].depth_mm:
            worst[key] = overlap
    return worst_of(limit, looked_at, [Finding(value=o.depth_mm, text=str(o)) for o in worst.values()])


def check(product: Product) -> Check:
    """Look at all pairs of instances in the product's pose."""
    found, pairs = in_pose(product)
    return deepest(OVERLAP, f"all {pairs} pairs in the exported pose", found)


def in_pose(product: Product) -> tuple[list[Overlap], int]:
    """Return the overlaps of all pairs of instances in the product's pose, and the number of pairs."""
    meshes = [PlacedMesh.of(i.name, k.mesh.body, i.world) for i, k in product.placed()]
    parts = {id(instance.part): instance.part for instance in product.instances}
    records = {key: _record(part) for key, part in parts.items()}
    stacks = {instance.name: _stack(instance, records[id(instance.part)]) for instance in product.instances}
    found: list[Overlap] = []
    for one, other in near(meshes):
        if not _apart(stacks[one.name], stacks[other.name]):
            found += overlap_of(one, other, "in the pose")
    return found, len(meshes) * (len(meshes) - 1) // 2


@dataclass(frozen=True, slots=True, kw_only=True)
class _Stack:
    """The layers of a part around its axis, in the part's frame or in the assembly."""

    axis: NDArray[np.float64]  #: x and z of the axis in the assembly, in mm
    rows: NDArray[np.float64]  #: per prism the least and greatest radius, low and high end, in mm; shape (n, 4)
    bores: NDArray[np.float64]  #: per round hole its prism's number, x and y of its axis, its radius; shape (m, 4)
    sections: tuple[m3.CrossSection, ...]  #: per row the flat shape that its triangles are made from, or one around it


def _record(part: Part) -> _Stack | None:
    """Return the layers of a part in its own frame; None if it is not made of prisms only."""
    rows, bores, sections = [], [], []
    for number, prism in enumerate(part.prisms):
        inner = [_bore_radius(hole) for hole in prism.holes if isinstance(hole, Circle | InternalGear)]
        greatest = max(float(np.hypot(*points.T).max()) for points in all_polygons([prism.outline]))
        rows.append((max(inner, default=0.0), greatest, float(prism.z0_mm), float(prism.z1_mm)))
        for hole in prism.holes:
            if isinstance(hole, Circle | Pattern):
                bores += [(float(number), x, y, float(hole.radius_mm)) for x, y in centres_mm(hole)]
        section = cross_section([prism.outline], TOLERANCE_MM)
        sections.append(section - cross_section(prism.holes, TOLERANCE_MM) if prism.holes else section)
    # A head counts as a cylinder as wide as its face: the question is only whether the meshes need a look.
    for head in part.features:
        if isinstance(head, CountersunkHead):
            (bevel,) = head.bevels
            rows.append((0.0, float(head.radius_mm), float(bevel.face_mm), float(bevel.end_mm)))
            sections.append(cross_section([Circle(radius_mm=head.radius_mm)], TOLERANCE_MM))
    if not rows or part.balls:
        return None
    return _Stack(axis=np.zeros(2), rows=np.array(rows), bores=np.array(bores).reshape(-1, 4), sections=tuple(sections))


def _stack(instance: Instance, record: _Stack | None) -> _Stack | None:
    """Return a part's layers where an instance of it stands; its axis is parallel to the joints'."""
    if record is None:
        return None
    world = instance.world
    rows, bores = record.rows.copy(), record.bores.copy()
    rows[:, 2:] = np.sort(world[1, 2] * rows[:, 2:] + world[1, 3], axis=1)
    bores[:, 1:3] = bores[:, 1:3] @ world[[0, 2], :2].T + world[[0, 2], 3]
    flat = world[[0, 2]][:, [0, 1, 3]]
    sections = tuple(section.transform(flat) for section in record.sections)
    return _Stack(axis=world[[0, 2], 3], rows=rows, bores=bores, sections=sections)


def _bore_radius(hole: Circle | InternalGear) -> float:
    """Return the radius of a hole around the part's axis; 0 for one that is elsewhere."""
    if isinstance(hole, InternalGear):
        return float(hole.tip_radius_mm)
    return float(hole.radius_mm) if float(hole.x_mm) == 0.0 and float(hole.y_mm) == 0.0 else 0.0


def _apart(one: _Stack | None, other: _Stack | None) -> bool:
    """Return whether the records of two instances say that they keep apart, so that no meshes need intersecting."""
    if one is None or other is None:
        return False
    on_one_axis = float(np.abs(one.axis - other.axis).max()) <= TOUCH_MM
    as_rings = on_one_axis and _as_rings(one, other)
    return as_rings or _in_holes(one, other) or _in_holes(other, one) or _in_layers(one, other)


def _common(one: _Stack, other: _Stack) -> NDArray[np.bool_]:
    """Return which layers have a stretch of the axis in common, shape (n of one, n of the other)."""
    a, b = one.rows[:, None], other.rows[None]
    return np.asarray(np.minimum(a[..., 3], b[..., 3]) - np.maximum(a[..., 2], b[..., 2]) > TOUCH_MM)


def _as_rings(one: _Stack, other: _Stack) -> bool:
    """Return whether two instances on one axis are rings, one around the other or one behind the other."""
    a, b = one.rows[:, None], other.rows[None]
    radial = np.minimum(a[..., 1], b[..., 1]) - np.maximum(a[..., 0], b[..., 0]) > TOUCH_MM
    return not bool(np.any(radial & _common(one, other)))


def _in_holes(one: _Stack, other: _Stack) -> bool:
    """Return whether each layer of one, such as a screw, stands in a round hole of each layer of the other beside."""
    beside = _common(one, other)
    room = other.bores[:, 3] - np.hypot(*(other.bores[:, 1:3] - one.axis).T)
    widest = np.zeros(len(other.rows))
    np.maximum.at(widest, other.bores[:, 0].astype(np.intp), room)
    return bool(np.all(one.rows[:, 1, None] <= widest[None] + TOUCH_MM, where=beside))


def _in_layers(one: _Stack, other: _Stack) -> bool:
    """Return whether the flat shapes of two layers with a common stretch of the axis never have an area in common."""
    return all(
        (one.sections[a] ^ other.sections[b]).area() <= _LEAST_MM2 for a, b in np.argwhere(_common(one, other)).tolist()
    )
