"""Every screw and bolt stands in holes of at least two other parts, on the holes' axes."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.cad.assembly import Instance
from pareto_monoped.cad.check.limits import BOLT_OFFSET, BOLT_PARTS
from pareto_monoped.cad.check.result import Check, Finding, worst_of
from pareto_monoped.cad.product import Product
from pareto_monoped.geometry.parts import Prism
from pareto_monoped.geometry.roles import FASTENERS
from pareto_monoped.geometry.shapes import Circle, Pattern

_SEARCH_MM = 1.0
"""A hole whose axis is nearer than this is meant for the screw: a third of the smallest one's diameter, M3."""
_ENGAGED_MM = 0.1
"""Least common length of a screw and its hole: thinner than any sheet."""


@dataclass(frozen=True, slots=True, kw_only=True)
class _Hole:
    """A round hole in the assembly's frame: whose it is, x and z of its axis, its extent along y, in mm."""

    owner: str
    x: float
    z: float
    low: float
    high: float


def check(product: Product) -> tuple[Check, Check]:
    """Look at every screw and bolt: how far it is off the axes of its holes, and how many parts it joins."""
    holes = [hole for instance in product.instances for hole in _holes(instance)]
    offsets, joins = [], []
    fasteners = [instance for instance in product.instances if instance.part.role in FASTENERS]
    for fastener in fasteners:
        offset_mm = _offsets_mm(fastener, holes)
        offsets += [
            Finding(value=offset, text=f"{fastener.name}: {offset:.2f} mm off its hole in {name}")
            for name, offset in offset_mm.items()
        ]
        names = ", ".join(offset_mm) or "none"
        text = f"{fastener.name}: joins {len(offset_mm)} part(s), not two: {names}"
        joins.append(Finding(value=len(offset_mm), text=text))
    looked_at = f"{len(fasteners)} screws and bolts"
    return worst_of(BOLT_OFFSET, looked_at, offsets), worst_of(BOLT_PARTS, looked_at, joins)


def _offsets_mm(fastener: Instance, holes: list[_Hole]) -> dict[str, float]:
    """Greatest distance of a fastener's axis from the axes of the holes in which it stands, by the holes' owners."""
    centre, low, high = _shaft(fastener)
    found: dict[str, float] = {}
    for hole in holes:
        if hole.owner == fastener.name or min(hole.high, high) - max(hole.low, low) <= _ENGAGED_MM:
            continue
        offset = float(np.hypot(hole.x - centre[0], hole.z - centre[1]))
        if offset < _SEARCH_MM:
            found[hole.owner] = max(offset, found.get(hole.owner, 0.0))
    return found


def _shaft(fastener: Instance) -> tuple[NDArray[np.float64], float, float]:
    """Where a fastener's axis pierces the x-z plane, and its extent along y, in the assembly's frame."""
    ends = [
        fastener.world @ np.array([0.0, 0.0, float(z), 1.0]) for p in fastener.part.prisms for z in (p.z0_mm, p.z1_mm)
    ]
    heights = [float(end[1]) for end in ends]
    return ends[0][[0, 2]], min(heights), max(heights)


def _holes(instance: Instance) -> Iterator[_Hole]:
    """Every round hole of an instance."""
    for prism in instance.part.prisms:
        for x, y in _centres_mm(prism):
            ends = [instance.world @ np.array([x, y, float(z), 1.0]) for z in (prism.z0_mm, prism.z1_mm)]
            low, high = sorted(float(end[1]) for end in ends)
            yield _Hole(owner=instance.name, x=float(ends[0][0]), z=float(ends[0][2]), low=low, high=high)


def _centres_mm(prism: Prism) -> Iterator[tuple[float, float]]:
    for hole in prism.holes:
        if isinstance(hole, Circle):
            yield float(hole.x_mm), float(hole.y_mm)
        elif isinstance(hole, Pattern):
            yield from hole.centres_mm()
