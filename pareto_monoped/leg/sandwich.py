"""The sandwich that both links are made of: two plates on a core, with windows, bolted bridges and round outlines."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from pareto_monoped.geometry.features import CountersunkHead
from pareto_monoped.geometry.making import Length
from pareto_monoped.geometry.parts import Part, layer, steel_part
from pareto_monoped.geometry.roles import EPOXY, Purchase, Role
from pareto_monoped.geometry.screws import M3, Screw, cylinder, ordered_screw, screw_length_mm
from pareto_monoped.geometry.shapes import Arc, Circle, Line, Numbers, Path, Shape, rectangle
from pareto_monoped.geometry.tightening import LOCKER, Fastening
from pareto_monoped.materials import MATERIALS


def rounded(*, half_width_mm: Numbers, high_mm: Numbers, low_mm: Numbers, corner_mm: Numbers) -> Path:
    """Return a rectangle with round corners, upright on the y axis from ``low_mm`` to ``high_mm``."""
    w, r, pi = half_width_mm, corner_mm, np.pi
    return Path(
        (
            Line(w, low_mm + r, w, high_mm - r),
            Arc(w - r, high_mm - r, r, 0.0, pi / 2),
            Line(w - r, high_mm, r - w, high_mm),
            Arc(r - w, high_mm - r, r, pi / 2, pi),
            Line(-w, high_mm - r, -w, low_mm + r),
            Arc(r - w, low_mm + r, r, pi, 3 * pi / 2),
            Line(r - w, low_mm, w - r, low_mm),
            Arc(w - r, low_mm + r, r, 3 * pi / 2, 2 * pi),
        )
    )


def _corners(points: Sequence[tuple[float, float]]) -> list[tuple[float, float]]:
    """Return the corners of the convex hull, anticlockwise from the lowest (gift wrapping).

    Every jump needs the mass of the stand, and libraries that find hulls take 0.1 to 0.2 s to import.
    """
    corners = [min(points, key=lambda point: (point[1], point[0]))]
    while True:
        (x, y), found = corners[-1], corners[0]
        for px, py in points:
            along, across = (found[0] - x, found[1] - y), (px - x, py - y)
            turn = along[0] * across[1] - along[1] * across[0]
            if turn < 0.0 or (turn == 0.0 and math.hypot(*across) > math.hypot(*along)):
                found = (px, py)
        if found == corners[0]:
            return corners
        corners.append(found)


def rounded_hull(points_mm: Sequence[tuple[float, float]], radius_mm: float) -> Path:
    """Return the convex hull of discs of one radius, such as a plate with a rim around its outermost holes."""
    corners = _corners(points_mm)
    sides = list(pairwise((*corners, corners[0])))
    normals = [np.arctan2(x0 - x1, y1 - y0) for (x0, y0), (x1, y1) in sides]  # outwards
    pieces: list[Line | Arc] = []
    for k, ((x0, y0), (x1, y1)) in enumerate(sides):
        before, out = normals[k - 1], normals[k]
        pieces.append(Arc(x0, y0, radius_mm, before, before + (out - before) % (2.0 * np.pi)))
        dx, dy = radius_mm * np.cos(out), radius_mm * np.sin(out)
        pieces.append(Line(x0 + dx, y0 + dy, x1 + dx, y1 + dy))
    return Path(tuple(pieces))


Place = tuple[Numbers, Numbers, Numbers]


# A screw in a sleeve nut, both countersunk, as sold for furniture and cases, mm.
_SLEEVE_WALL = 0.5
_SLEEVE_PLAY = 0.1  # around the sleeve, in its hole
_OVERLAP = (6.0, 8.0)  # least and greatest length of thread
# Most preload of its sleeve: 0.7 of the yield stress, as torsion adds to the pull. Makers name no property class; 240
# MPa is that of the weakest one for steel (4.6, ISO 898-1).
_SLEEVE_MPA = 0.7 * 240.0
# Pressure that the printed core bears for years: a third of its yield stress, 45 to 50 MPa for PETG (makers' data).
_CORE_MPA = 15.0
_CORE_MORE = 0.2  # by which a core may be thicker, of its layers; the bearings of the knee stand between its plates
_CONE = 0.6  # by which the pressure of a head spreads in a plate, per depth (VDI 2230-1, eq. 44: 0.5 to 0.6)
_CORE_LOCK = f"{LOCKER}, a drop inside the sleeve, as it may crack the printed core"
# Our own layout, mm.
BRIDGE = 5.5  # half height of a bridge: 3.4 mm of metal around a sleeve for M3
BRIDGE_BOLT_X = 12.0  # of a bridge's two bolts: 2.9 mm of core outside their sleeves in the shank, the narrower link
WINDOW_CORNER = 6.0  # radius of a window's corners, against peaks of stress
_WINDOW_END = 0.5  # least straight half of a window's ends: without it, the corners of a narrow window cross


def sleeve_hole(screw: Screw) -> float:
    """Return the radius of the hole for a sleeve nut."""
    return screw.shank + _SLEEVE_WALL + _SLEEVE_PLAY


def sleeve_fastening(screw: Screw, plate_on_core_mm: float | None) -> Fastening:
    """Return how a screw is tightened in its sleeve nut, which is weaker than the screw.

    ``plate_on_core_mm``: thickness of the plates that press a printed core, on the area to which the pressure of the
    heads has spread; None if all that is clamped is metal.
    """
    hole, sleeve = sleeve_hole(screw), screw.shank + _SLEEVE_WALL
    most = _SLEEVE_MPA * math.pi * (sleeve**2 - screw.shank**2)
    full = screw.fastening("countersunk", "8.8")
    if plate_on_core_mm is None:
        return replace(full, most_preload_n=most)
    reach = 0.5 * (screw.countersunk + hole) + _CONE * plate_on_core_mm
    most = min(most, _CORE_MPA * math.pi * (reach**2 - hole**2))
    return replace(full, most_preload_n=most, lock=_CORE_LOCK)


def sleeve_bolt(
    name: str,
    screw: Screw,
    half_stack_mm: float,
    places_mm: tuple[Place, ...],
    *,
    plate_on_core_mm: float | None = None,
) -> Part:
    """Build a countersunk screw in a countersunk sleeve nut, flush on both sides of a stack centred on z = 0."""
    stack = 2.0 * half_stack_mm
    sleeve = float(screw_length_mm(stack, -_OVERLAP[0]))
    long = float(screw_length_mm(stack - sleeve, _OVERLAP[1]))
    return steel_part(
        name=name,
        role=Role.BOLT,
        prisms=(
            cylinder(screw.shank + _SLEEVE_WALL, -half_stack_mm, sleeve - half_stack_mm),
            cylinder(screw.shank, sleeve - half_stack_mm, half_stack_mm),
        ),
        places_mm=places_mm,
        features=(_head(screw.shank + _SLEEVE_WALL, screw, -half_stack_mm), _head(screw.shank, screw, half_stack_mm)),
        fastening=sleeve_fastening(screw, plate_on_core_mm),
        purchases=(
            ordered_screw(screw, "countersunk", long, "8.8"),
            Purchase(
                kind="nut",
                designation=f"sleeve nut {screw.name} x {sleeve:g}, countersunk 90 degrees, "
                f"{2.0 * (screw.shank + _SLEEVE_WALL):g} mm outside, internal hex or slot, steel zinc plated",
            ),
        ),
        note=f"flush, {stack:g} mm together",
        at_assembly="" if plate_on_core_mm is None else "while the epoxy between the core and both plates is wet",
    )


def _head(shank_mm: float, screw: Screw, face_mm: float) -> CountersunkHead:
    """Return the flush head of a screw or of its sleeve nut, which has the same cone."""
    return CountersunkHead(
        shank_mm=shank_mm, radius_mm=screw.countersunk, face_mm=face_mm, inwards=-math.copysign(1.0, face_mm)
    )


def bolts_at(heights: tuple[Numbers, ...]) -> tuple[Place, ...]:
    """Return two bolts side by side on every bridge."""
    return tuple((side * BRIDGE_BOLT_X, y, 0.0) for y in heights for side in (-1.0, 1.0))


def holes_at(places: tuple[Place, ...], radius_mm: float) -> tuple[Circle, ...]:
    """Return a hole at every place."""
    return tuple(Circle(radius_mm=radius_mm, x_mm=x, y_mm=y) for x, y, _ in places)


def windows_between(heights: tuple[Numbers, ...], half_width_mm: float) -> tuple[Shape, ...]:
    """Return a window between every two neighbouring bridges."""
    corner_mm = min(WINDOW_CORNER, half_width_mm - _WINDOW_END)
    return tuple(
        rounded(half_width_mm=half_width_mm, high_mm=high - BRIDGE, low_mm=low + BRIDGE, corner_mm=corner_mm)
        for high, low in pairwise(heights)
    )


def core_part(
    name: str,
    top_mm: Numbers,
    end_mm: Numbers,
    gap_mm: float,
    half_widths_mm: tuple[float, float],
    bridges: tuple[Numbers, ...],
) -> Part:
    """Build the printed core between two plates; ``half_widths_mm`` are its own and that of its windows."""
    half, window = half_widths_mm
    return Part(
        name=name,
        role=Role.CORE,
        material=MATERIALS.printed_plastic,
        process="3D printed",
        prisms=(
            layer(
                rectangle(width_mm=2.0 * half, height_mm=top_mm - end_mm, y_mm=0.5 * (top_mm + end_mm)),
                -0.5 * gap_mm,
                0.5 * gap_mm,
                *windows_between(bridges, window),
                *holes_at(bolts_at(bridges), sleeve_hole(M3)),
            ),
        ),
        lengths=(Length(name="thickness", z0_mm=-0.5 * gap_mm, z1_mm=0.5 * gap_mm, lower_mm=0.0, upper_mm=_CORE_MORE),),
        purchases=(EPOXY,),
        note="print lying on a plate side, solid; bond to both plates with epoxy, so that they cannot buckle",
        at_assembly="bond it to the plate that it meets now, and to the other one when that comes: epoxy on its whole "
        "faces, just before the bolts are driven",
    )


def with_rungs(heights: tuple[Numbers, ...]) -> tuple[Numbers, ...]:
    """Return a plate's bridges with a rung between every two: sides of high windows bend more (``strength.links``)."""
    halves = tuple(height for high, low in pairwise(heights) for height in (high, 0.5 * (high + low)))
    return (*halves, heights[-1])


_ROUNDING = 1e-9  # rad
_WHOLE_ARC = 3.0  # rad; a longer arc is drawn as two


@dataclass(frozen=True, slots=True, kw_only=True)
class Pulley:
    """A round corner of an outline."""

    x_mm: Numbers  #: of its centre
    y_mm: Numbers
    radius_mm: float  #: above zero
    inside: bool = True  #: whether the corner bulges outward, its centre inside the outline; otherwise it is a fillet

    @property
    def signed_mm(self) -> float:
        """Radius, negative for a fillet."""
        return self.radius_mm if self.inside else -self.radius_mm

    @property
    def mirrored(self) -> "Pulley":
        """Its image on the other side of the y axis."""
        return Pulley(x_mm=-self.x_mm, y_mm=self.y_mm, radius_mm=self.radius_mm, inside=self.inside)


def belt(pulleys: Sequence[Pulley]) -> Path:
    """Return the outline that runs anticlockwise around pulleys on straight common tangents.

    With the outward normal n of a tangent, the belt leaves a pulley of centre c and signed radius s at c + s n. Both
    ends of a tangent lie on it: n (c2 - c1) = s1 - s2.

    ``pulleys``: in the order in which the belt meets them; one may be met twice.
    """
    normals = [_normal_rad(one, other) for one, other in pairwise((*pulleys, pulleys[0]))]
    pieces: list[Line | Arc] = []
    for k, pulley in enumerate(pulleys):
        pieces += _corner(pulley, normals[k - 1], normals[k])
        following = pulleys[(k + 1) % len(pulleys)]
        pieces.append(Line(*_touch(pulley, normals[k]), *_touch(following, normals[k])))
    return Path(tuple(pieces))


def mirrored(pulleys: Sequence[Pulley]) -> tuple[Pulley, ...]:
    """Return the pulleys of the outline's image on the other side of the y axis."""
    return tuple(pulley.mirrored for pulley in reversed(pulleys))


def _normal_rad(one: Pulley, other: Pulley) -> Numbers:
    """Return the angle of the outward normal of the tangent from one pulley to the next."""
    across, along = other.x_mm - one.x_mm, other.y_mm - one.y_mm
    share = (one.signed_mm - other.signed_mm) / np.hypot(across, along)
    return np.arctan2(along, across) - np.arccos(share)


def _touch(pulley: Pulley, normal_rad: Numbers) -> tuple[Numbers, Numbers]:
    return (pulley.x_mm + pulley.signed_mm * np.cos(normal_rad), pulley.y_mm + pulley.signed_mm * np.sin(normal_rad))


def _corner(pulley: Pulley, before_rad: Numbers, after_rad: Numbers) -> list[Line | Arc]:
    """Return the belt's arc on a pulley, between the normals of the tangents before and after it."""
    if pulley.inside:
        start, turn = before_rad, _turn(after_rad - before_rad)
    else:
        start, turn = before_rad + np.pi, -_turn(before_rad - after_rad)
    count = 2 if np.max(np.abs(turn)) > _WHOLE_ARC else 1
    ends = [start + turn * (k / count) for k in range(count + 1)]
    return [Arc(pulley.x_mm, pulley.y_mm, pulley.radius_mm, one, other) for one, other in pairwise(ends)]


def _turn(angle_rad: Numbers) -> Numbers:
    """Return an angle from 0 to a full turn; one that rounding has left just below 0 is no full turn."""
    return np.mod(angle_rad + _ROUNDING, 2.0 * np.pi) - _ROUNDING
