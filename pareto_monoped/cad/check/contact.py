"""Two parts in each other's way: how much volume they share, and how deep the overlap is on average."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

import manifold3d as m3
import numpy as np
from numpy.typing import NDArray

from pareto_monoped.cad.assembly import Matrix
from pareto_monoped.cad.check.limits import Limit
from pareto_monoped.cad.check.result import Check, Finding, worst_of
from pareto_monoped.cad.shape.meshes import placed

TOUCH_MM = 1e-6
"""Closer than this is touching, not overlapping."""
_LEAST_MM3 = 1e-6  # rounding in manifold3d


@dataclass(frozen=True, slots=True, kw_only=True)
class Overlap:
    """Two instances that share volume.

    Attributes:
        one, other: their names.
        volume_mm3: shared volume.
        depth_mm: mean depth, twice the shared volume over its surface.
        where: in which position of the robot, in words.
    """

    one: str
    other: str
    volume_mm3: float
    depth_mm: float
    where: str

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
        """A mesh moved by a 4 x 4 matrix."""
        moved = placed(body, matrix)
        box = np.asarray(moved.bounding_box())
        return cls(name=name, body=moved, low=box[:3], high=box[3:])


def near(meshes: Sequence[PlacedMesh]) -> Iterator[tuple[PlacedMesh, PlacedMesh]]:
    """Pairs of different meshes whose bounding boxes overlap, each pair once."""
    low, high = np.array([mesh.low for mesh in meshes]), np.array([mesh.high for mesh in meshes])
    meets = np.all((low[:, None] < high[None] - TOUCH_MM) & (low[None] < high[:, None] - TOUCH_MM), axis=2)
    for i, j in np.argwhere(np.triu(meets, 1)):
        yield meshes[i], meshes[j]


def boxes_meet(one: PlacedMesh, other: PlacedMesh) -> bool:
    """Whether two bounding boxes overlap."""
    return bool(np.all(one.low < other.high - TOUCH_MM) and np.all(other.low < one.high - TOUCH_MM))


def overlap_of(one: PlacedMesh, other: PlacedMesh, where: str) -> Iterator[Overlap]:
    """The overlap of two meshes, if they have one."""
    shared = one.body ^ other.body
    volume = shared.volume()
    if volume > _LEAST_MM3:
        depth = 2.0 * volume / shared.surface_area()
        yield Overlap(one=one.name, other=other.name, volume_mm3=volume, depth_mm=depth, where=where)


def deepest(limit: Limit, looked_at: str, found: Iterable[Overlap]) -> Check:
    """A check of overlaps: each pair of parts counts once, with its deepest overlap."""
    worst: dict[tuple[str, str], Overlap] = {}
    for overlap in found:
        key = (overlap.one, overlap.other)
        if key not in worst or overlap.depth_mm > worst[key].depth_mm:
            worst[key] = overlap
    return worst_of(limit, looked_at, [Finding(value=o.depth_mm, text=str(o)) for o in worst.values()])
