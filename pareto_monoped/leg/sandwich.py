"""The sandwich that both links are made of: two plates on a core, with windows and bolted bridges between them."""

import math
from dataclasses import replace
from itertools import pairwise

from pareto_monoped.geometry.features import CountersunkHead
from pareto_monoped.geometry.parts import Part
from pareto_monoped.geometry.roles import Role
from pareto_monoped.geometry.screws import Screw, cylinder, screw_length_mm
from pareto_monoped.geometry.shapes import Circle, Numbers, Shape
from pareto_monoped.geometry.tightening import LOCKER, Fastening
from pareto_monoped.leg.outlines import rounded
from pareto_monoped.materials import MATERIALS

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
_CONE = 0.6  # by which the pressure of a head spreads in a plate, per depth (VDI 2230-1, eq. 44: 0.5 to 0.6)
_CORE_LOCK = f"{LOCKER}, a drop inside the sleeve, as it may crack the printed core"
# Our own layout, mm.
BRIDGE = 5.5  # half height of a bridge: 3.4 mm of metal around a sleeve for M3
BRIDGE_BOLT_X = 12.0  # of a bridge's two bolts: 2.9 mm of core outside their sleeves in the shank, the narrower link
WINDOW_CORNER = 6.0  # radius of a window's corners, against peaks of stress
_WINDOW_END = 0.5  # least straight half of a window's ends: without it, the corners of a narrow window cross


def sleeve_hole(screw: Screw) -> float:
    """Radius of the hole for a sleeve nut."""
    return screw.shank + _SLEEVE_WALL + _SLEEVE_PLAY


def sleeve_fastening(screw: Screw, plate_on_core_mm: float | None) -> Fastening:
    """How a screw is tightened in its sleeve nut, which is weaker than the screw.

    Args:
        screw: which.
        plate_on_core_mm: thickness of the plates that press a printed core, on the area to which the pressure of the
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
    """A countersunk screw in a countersunk sleeve nut, flush on both sides of a stack centred on z = 0.

    Args:
        name: of the part.
        screw: its size.
        half_stack_mm: half of what is clamped.
        places_mm: where they stand.
        plate_on_core_mm: see ``sleeve_fastening``.
    """
    stack = 2.0 * half_stack_mm
    sleeve = float(screw_length_mm(stack, -_OVERLAP[0]))
    long = float(screw_length_mm(stack - sleeve, _OVERLAP[1]))
    return Part(
        name=name,
        role=Role.BOLT,
        material=MATERIALS.steel,
        process="bought",
        prisms=(
            cylinder(screw.shank + _SLEEVE_WALL, -half_stack_mm, sleeve - half_stack_mm),
            cylinder(screw.shank, sleeve - half_stack_mm, half_stack_mm),
        ),
        places_mm=places_mm,
        features=(
            _head(screw.shank + _SLEEVE_WALL, screw, -half_stack_mm),
            _head(screw.shank, screw, half_stack_mm),
        ),
        fastening=sleeve_fastening(screw, plate_on_core_mm),
        note=f"{screw.name} x {long:g} countersunk (ISO 10642) 8.8 in a countersunk sleeve nut {screw.name} x "
        f"{sleeve:g}, flush, {stack:g} mm together",
    )


def _head(shank_mm: float, screw: Screw, face_mm: float) -> CountersunkHead:
    """The flush head of a screw or of its sleeve nut, which has the same cone."""
    return CountersunkHead(
        shank_mm=shank_mm, radius_mm=screw.countersunk, face_mm=face_mm, inwards=-math.copysign(1.0, face_mm)
    )


def bolts_at(heights: tuple[Numbers, ...]) -> tuple[Place, ...]:
    """Two bolts side by side on every bridge."""
    return tuple((side * BRIDGE_BOLT_X, y, 0.0) for y in heights for side in (-1.0, 1.0))


def holes_at(places: tuple[Place, ...], radius_mm: float) -> tuple[Circle, ...]:
    """A hole at every place."""
    return tuple(Circle(radius_mm=radius_mm, x_mm=x, y_mm=y) for x, y, _ in places)


def windows_between(heights: tuple[Numbers, ...], half_width_mm: float) -> tuple[Shape, ...]:
    """A window between every two neighbouring bridges."""
    corner_mm = min(WINDOW_CORNER, half_width_mm - _WINDOW_END)
    return tuple(
        rounded(half_width_mm=half_width_mm, high_mm=high - BRIDGE, low_mm=low + BRIDGE, corner_mm=corner_mm)
        for high, low in pairwise(heights)
    )


def with_rungs(heights: tuple[Numbers, ...]) -> tuple[Numbers, ...]:
    """The bridges of a plate, with a rung as high as these in the middle between every two of them.

    The higher a window, the more its sides bend under a force across the link (``strength.links``).
    """
    halves = tuple(height for high, low in pairwise(heights) for height in (high, 0.5 * (high + low)))
    return (*halves, heights[-1])
