"""The test stand's adapter: two equal arms, by which the base hangs on two vertical linear guides.

The jump model holds the base upright. On a test stand two rails do that, one beside either cheek, behind the robot. An
arm lies on the outside of each cheek, under the screws of three rods, and carries two carriages one above the other.
The arms are tools: they are no part of the robot, of its mass or of its checks. A calibration with a table ``stand``
lets the robot jump on the rails, with what it has to lift there.

The hip's torque wants to turn the base about the joint's axis. Friction under the rods' screws takes it from the
cheeks, and each arm passes it to its carriages as a couple of sideways forces.
"""

import math
from dataclasses import dataclass
from functools import lru_cache

from pareto_monoped.geometry.parts import Part, layer, sheet_part
from pareto_monoped.geometry.roles import Role
from pareto_monoped.geometry.screws import M3, M4, screw_length_mm
from pareto_monoped.geometry.shapes import Shape
from pareto_monoped.leg.base import ROD_THREAD
from pareto_monoped.leg.dimensions import LegDimensions
from pareto_monoped.leg.electronics import DRIVER_PLATE_MM
from pareto_monoped.leg.sandwich import holes_at, rounded_hull
from pareto_monoped.materials import MATERIALS

ARM_MM = 5.0
"""Thickness of an arm; our own choice: M3 x 8 reach 3 mm into a carriage."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Carriage:
    """A carriage of a miniature linear guide."""

    name: str  #: of carriage and rail
    rail: str  #: that it runs on
    length_mm: float
    width_mm: float
    hole_length_mm: float  #: between its four threads, along the rail
    hole_width_mm: float  #: across the rail
    thread_mm: float  #: depth of these M3 threads
    mass_kg: float


MGN12H = Carriage(
    name="MGN12H",
    rail="MGN12",
    length_mm=45.4,
    width_mm=27.0,
    hole_length_mm=20.0,
    hole_width_mm=20.0,
    thread_mm=3.5,
    mass_kg=0.054,
)
"""HIWIN, miniature guideways, series MGN: long carriage of size 12 (catalogue G99TE20, section 2-4)."""
CARRIAGES, SCREWS_PER_CARRIAGE = 4, 4  #: Two carriages on either arm.

# Our own layout, mm.
_RAIL_TO_ROD = 60.0  # from the rear lower rod back to the rail: the actuators' cases stay clear of the carriages
_CARRIAGES_APART = 60.0  # between their middles: 14.6 mm of space between them
_RIM = 8.0  # of an arm around its outermost holes
_WINDOW_RIM = 8.0  # between the arm's holes and its window
_CORNER = 5.0


def carriage_places(d: LegDimensions) -> tuple[tuple[float, float, float], ...]:
    """Return the middles of an arm's two carriages, in the frame of the base."""
    x, y = d.lower_rod_mm
    return tuple((-x - _RAIL_TO_ROD, y + 0.5 * side * _CARRIAGES_APART + 15.0, 0.0) for side in (-1.0, 1.0))


def rod_places(d: LegDimensions) -> tuple[tuple[float, float, float], ...]:
    """Return the rods whose screws hold an arm: the rear lower one and both upper ones, as of the driver's plate."""
    (x, y), (upper_x, upper_y) = d.lower_rod_mm, d.upper_rod_mm
    return (-x, y, 0.0), (-upper_x, upper_y, 0.0), (upper_x, upper_y, 0.0)


def arm(d: LegDimensions) -> Part:
    """Build an arm, in the frame of the base with its back at z = 0; both sides have the same one."""
    bolts = tuple(
        (x + 0.5 * across * MGN12H.hole_width_mm, y + 0.5 * along * MGN12H.hole_length_mm, 0.0)
        for x, y, _ in carriage_places(d)
        for across in (-1.0, 1.0)
        for along in (-1.0, 1.0)
    )
    rods = rod_places(d)
    points = [(x, y) for x, y, _ in (*bolts, *rods)]
    return sheet_part(
        name="test_stand_arm",
        role=Role.BRACKET,
        prisms=(
            layer(
                rounded_hull(points, _RIM), 0.0, ARM_MM, _window(d), *holes_at(rods, M4.hole), *holes_at(bolts, M3.hole)
            ),
        ),
        count=2,
        note=f"{ARM_MM:g} mm sheet",
    )


def _window(d: LegDimensions) -> Shape:
    """Return what lightens an arm, between the carriages and the rods."""
    (x, low, _), (_, high, _) = carriage_places(d)
    left = x + 0.5 * MGN12H.hole_width_mm + _WINDOW_RIM + _CORNER
    right = -d.lower_rod_mm[0] - _WINDOW_RIM - _CORNER
    bottom, rod = low + _CORNER, d.lower_rod_mm[1] + _CORNER
    top_left, top_right = high - _CORNER, high - 2.0 * _CORNER
    return rounded_hull([(left, bottom), (right, rod), (right, top_right), (left, top_left)], _CORNER)


@lru_cache(maxsize=64)
def stand_mass_kg(d: LegDimensions) -> float:
    """Return the mass that a base on the stand has to lift as well: both arms and their carriages, with their screws.

    The rods' screws under an arm are as long beyond their own as the arm is thick, which is left out (0.5 g each).
    """
    length_mm = float(screw_length_mm(ARM_MM, MGN12H.thread_mm))
    screw_mm3 = math.pi * (M3.head**2 * M3.head_height + M3.shank**2 * length_mm)
    screw_kg = 1e-9 * screw_mm3 * MATERIALS.steel.density_kg_per_m3
    return float(arm(d).mass_kg()) + CARRIAGES * (MGN12H.mass_kg + SCREWS_PER_CARRIAGE * screw_kg)


def rod_screws(d: LegDimensions) -> tuple[tuple[str, int, str], ...]:
    """Return the screws that hold both arms in place of the rods' own: where, how many, which."""
    rows = []
    for side, cheek_mm in (("near", d.cheek_mm), ("far", d.far_cheek_mm)):
        for row, count, plate_mm in (("rear lower rod", 1, 0.0), ("upper rods", 2, DRIVER_PLATE_MM)):
            length = float(screw_length_mm(cheek_mm + ARM_MM + plate_mm, ROD_THREAD))
            rows.append((f"{side} cheek, {row}", count, f"{M4.name} x {length:g} cap screw (ISO 4762) 8.8"))
    return tuple(rows)


def carriage_screw() -> str:
    """Return the screw of an arm's carriages."""
    length = float(screw_length_mm(ARM_MM, MGN12H.thread_mm))
    return f"{M3.name} x {length:g} cap screw (ISO 4762) 8.8"
