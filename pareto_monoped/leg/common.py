"""What all links share: metric screws, the sandwich's bolted bridges and windows, the sprocket."""

from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from pareto_monoped.geometry.parts import Prism
from pareto_monoped.geometry.shapes import Circle, Numbers, Pattern, Shape
from pareto_monoped.leg.dimensions import LegDimensions
from pareto_monoped.leg.outlines import rounded, sprocket


@dataclass(frozen=True, slots=True, kw_only=True)
class Screw:
    """Radii of a metric screw in mm, and the height of its head.

    Attributes:
        shank: nominal.
        hole: clearance hole (ISO 273, fine).
        core: tapping hole; screws are drawn with it where they are in a thread, so that nothing overlaps.
        head, head_height: cap screw (ISO 4762).
    """

    shank: float
    hole: float
    core: float
    head: float
    head_height: float

    def prisms(self, *, seat_mm: Numbers, grip_mm: Numbers, thread_mm: Numbers, direction: float) -> tuple[Prism, ...]:
        """A cap screw on the z axis: head on its seat, through a grip into a thread, in ``direction`` (-1 or 1)."""
        return (
            _stretch(self.head, seat_mm - direction * self.head_height, seat_mm),
            *self.flush(seat_mm=seat_mm, grip_mm=grip_mm, thread_mm=thread_mm, direction=direction),
        )

    def flush(self, *, seat_mm: Numbers, grip_mm: Numbers, thread_mm: Numbers, direction: float) -> tuple[Prism, ...]:
        """The same with a countersunk head, drawn as a plain shank."""
        split = seat_mm + direction * grip_mm
        return (_stretch(self.shank, seat_mm, split), _stretch(self.core, split, split + direction * thread_mm))


def _stretch(radius_mm: float, one_mm: Numbers, other_mm: Numbers) -> Prism:
    """A cylinder between two heights in either order."""
    low, high = np.minimum(one_mm, other_mm)[()], np.maximum(one_mm, other_mm)[()]
    return Prism(outline=Circle(radius_mm=radius_mm), z0_mm=low, z1_mm=high)


M25 = Screw(shank=1.25, hole=1.35, core=1.025, head=2.25, head_height=2.5)
M3 = Screw(shank=1.5, hole=1.6, core=1.25, head=2.75, head_height=3.0)
M4 = Screw(shank=2.0, hole=2.15, core=1.65, head=3.5, head_height=4.0)
M5 = Screw(shank=2.5, hole=2.65, core=2.1, head=4.25, head_height=5.0)


def motor_screw(diameter_mm: float) -> Screw:
    """The cap screw for holes of a motor; its core fits the threads that the actuator draws, 0.8 mm below nominal."""
    known = {2.0 * screw.shank: screw for screw in (M25, M3, M4, M5)}
    # Between the standard sizes: proportions that are no smaller than those of ISO 4762 from M3 up.
    other = Screw(
        shank=0.5 * diameter_mm,
        hole=0.5 * diameter_mm + 0.15,
        core=0.0,
        head=0.92 * diameter_mm,
        head_height=diameter_mm,
    )
    return replace(known.get(diameter_mm, other), core=0.5 * diameter_mm - 0.4)


# Our own layout: half height of the solid bridges between windows, where the sandwich is bolted, and the bolts' x.
BRIDGE = 5.5
BRIDGE_BOLT_X = 12.0
WINDOW_CORNER = 6.0

Place = tuple[Numbers, Numbers, Numbers]


def bolts_at(heights: tuple[Numbers, ...]) -> tuple[Place, ...]:
    """Two bolts side by side on every bridge."""
    return tuple((side * BRIDGE_BOLT_X, y, 0.0) for y in heights for side in (-1.0, 1.0))


def holes_at(places: tuple[Place, ...], radius_mm: float) -> tuple[Shape, ...]:
    """A hole at every place."""
    return tuple(Circle(radius_mm=radius_mm, x_mm=x, y_mm=y) for x, y, _ in places)


def windows_between(heights: tuple[Numbers, ...], half_width_mm: float) -> tuple[Shape, ...]:
    """A window between every two neighbouring bridges."""
    return tuple(
        rounded(half_width_mm=half_width_mm, high_mm=high - BRIDGE, low_mm=low + BRIDGE, corner_mm=WINDOW_CORNER)
        for high, low in pairwise(heights)
    )


def sprocket_prism(d: LegDimensions) -> Prism:
    """The sprocket of hip and knee, with its bolts' holes, a bore and a ring of holes that lighten it."""
    half = 0.5 * d.sprocket_width_mm
    return Prism(
        outline=sprocket(teeth=d.sprocket_teeth, pitch_mm=d.chain_pitch_mm, roller_mm=d.chain_roller_mm),
        z0_mm=-half,
        z1_mm=half,
        holes=(
            Circle(radius_mm=d.bearing_bore_radius_mm - 1.0),
            Pattern(radius_mm=M3.hole, pitch_radius_mm=d.output_pitch_radius_mm, count=d.output_holes),
            Pattern(radius_mm=3.0, pitch_radius_mm=18.3, count=15),
        ),
    )
