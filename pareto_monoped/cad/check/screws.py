"""Every countersunk head has a countersink of its size, every screw in a made part a tapped hole of its size.

The records of holes are compared with those of screws, so that what is drawn is also what the maker is told. Every
screw and bolt stands in holes of at least two other parts, on the holes' axes.
"""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.cad.assembly import Instance
from pareto_monoped.cad.check.result import BOLT_OFFSET, BOLT_PARTS, SEATS, Check, Finding, count_of, worst_of
from pareto_monoped.cad.check.retention import cylinders, thread_diameter_mm
from pareto_monoped.cad.product import Product
from pareto_monoped.cad.shape.outlines import centres_mm
from pareto_monoped.geometry.features import Cone, CountersunkHead, Hole
from pareto_monoped.geometry.parts import Part
from pareto_monoped.geometry.roles import FASTENERS, SCREWS
from pareto_monoped.geometry.shapes import Circle, Pattern

_SAME_MM = 0.05  # heights and sizes that differ by less are one
_ENGAGED_MM = 0.3  # a screw's core stands in a hole by at least this
_PLAY_MM = 0.1  # of a screw's core in its tapped hole, radial
_SEARCH_MM = 1.0
"""A hole whose axis is nearer than this is meant for the screw: a third of the smallest one's diameter, M3."""
_STANDS_MM = 0.1  # least common length of a screw and its hole: thinner than any sheet


@dataclass(frozen=True, slots=True, kw_only=True)
class _Round:
    """Something round in the assembly: x and z of its axis, its extent along y, and its size, in mm."""

    owner: str
    x: float
    z: float
    low: float
    high: float
    size: float


def check_seats(product: Product) -> Check:
    """Look at every countersunk head, and at every screw in a part that is made."""
    everything = product.instances
    sinks = [found for instance in everything for found in _each(instance, _countersinks)]
    threads = [found for instance in everything for found in _each(instance, _threads)]
    holes = [found for instance in everything if instance.part.process != "bought" for found in _each(instance, _holes)]
    failures, looked_at = [], 0
    for fastener in everything:
        if fastener.part.role not in FASTENERS:
            continue
        looked_at += 1
        for head in _each(fastener, _heads):
            if not any(_on_axis(head, sink) and _same(head, sink) for sink in sinks):
                failures.append(f"{fastener.name}: no countersink of {2.0 * head.size:.2f} mm under its head")
        for core in _each(fastener, _cores):
            for hole in holes:
                if _on_axis(core, hole) and abs(hole.size - core.size) < _PLAY_MM and _engaged(core, hole):
                    cut = [t for t in threads if t.owner == hole.owner and _on_axis(core, t) and _engaged(core, t)]
                    diameter = thread_diameter_mm(fastener.part)
                    if not any(abs(thread.size - diameter) < _SAME_MM for thread in cut):
                        failures.append(f"{fastener.name}: no thread M{diameter:g} in {hole.owner}")
    return count_of(SEATS, f"{looked_at} screws and bolts", failures)


def _on_axis(one: _Round, other: _Round) -> bool:
    return math.hypot(one.x - other.x, one.z - other.z) <= BOLT_OFFSET.value


def _same(one: _Round, other: _Round) -> bool:
    return max(abs(one.low - other.low), abs(one.high - other.high), abs(one.size - other.size)) < _SAME_MM


def _engaged(one: _Round, other: _Round) -> bool:
    return min(one.high, other.high) - max(one.low, other.low) > _ENGAGED_MM


_Local = tuple[float, float, float, float, float]
"""x and y of an axis, two heights along it and a size, in a part's own frame."""


def _each(instance: Instance, of: Callable[[Part], Iterator[_Local]]) -> Iterator[_Round]:
    """Yield what a part has, where an instance has it."""
    for x, y, one, other, size in of(instance.part):
        ends = [instance.world @ np.array([x, y, z, 1.0]) for z in (one, other)]
        low, high = sorted(float(end[1]) for end in ends)
        yield _Round(owner=instance.name, x=float(ends[0][0]), z=float(ends[0][2]), low=low, high=high, size=size)


def _heads(part: Part) -> Iterator[_Local]:
    """Heads, from the face over a height that countersinks of any hole have."""
    for head in part.features:
        if isinstance(head, CountersunkHead):
            face = float(head.face_mm)
            yield 0.0, 0.0, face, face + head.inwards, float(head.radius_mm)


def _countersinks(part: Part) -> Iterator[_Local]:
    for hole in part.features:
        if not isinstance(hole, Hole):
            continue
        for mouth, face, inwards in ((hole.low, hole.low_mm, 1.0), (hole.high, hole.high_mm, -1.0)):
            if mouth is not None and mouth.kind is Cone.COUNTERSINK:
                for shape in hole.shapes:
                    for x, y in centres_mm(shape):
                        yield x, y, float(face), float(face) + inwards, float(mouth.radius_mm)


def _threads(part: Part) -> Iterator[_Local]:
    """Tapped holes with their nominal diameters."""
    for hole in part.features:
        if isinstance(hole, Hole) and hole.thread is not None:
            for shape in hole.shapes:
                for x, y in centres_mm(shape):
                    yield x, y, float(hole.low_mm), float(hole.high_mm), hole.thread.diameter_mm


def _holes(part: Part) -> Iterator[_Local]:
    for prism in part.prisms:
        for hole in prism.holes:
            if isinstance(hole, Circle | Pattern):
                for x, y in centres_mm(hole):
                    yield x, y, float(prism.z0_mm), float(prism.z1_mm), float(hole.radius_mm)


def _cores(part: Part) -> Iterator[_Local]:
    """Yield the threaded end of a screw, which is drawn with the radius of its core."""
    if part.role in SCREWS:
        radius, low, high = min(cylinders(part))
        yield 0.0, 0.0, low, high, radius


def check_bolts(product: Product) -> tuple[Check, Check]:
    """Look at every screw and bolt: how far it is off the axes of its holes, and how many parts it joins."""
    holes = [hole for instance in product.instances for hole in _each(instance, _holes)]
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


def _offsets_mm(fastener: Instance, holes: list[_Round]) -> dict[str, float]:
    """Return the greatest distance of a fastener's axis from those of the holes in which it stands, by their owners."""
    centre, low, high = _shaft(fastener)
    found: dict[str, float] = {}
    for hole in holes:
        if hole.owner == fastener.name or min(hole.high, high) - max(hole.low, low) <= _STANDS_MM:
            continue
        offset = float(np.hypot(hole.x - centre[0], hole.z - centre[1]))
        if offset < _SEARCH_MM:
            found[hole.owner] = max(offset, found.get(hole.owner, 0.0))
    return found


def _shaft(fastener: Instance) -> tuple[NDArray[np.float64], float, float]:
    """Return where a fastener's axis pierces the x-z plane, and its extent along y, in the assembly's frame."""
    ends = [
        fastener.world @ np.array([0.0, 0.0, float(z), 1.0]) for p in fastener.part.prisms for z in (p.z0_mm, p.z1_mm)
    ]
    heights = [float(end[1]) for end in ends]
    return ends[0][[0, 2]], min(heights), max(heights)
