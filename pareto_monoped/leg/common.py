"""What all links share: metric screws, the sandwich's bolted bridges and windows, the sprocket."""

from itertools import pairwise

from pareto_monoped.geometry.parts import Prism
from pareto_monoped.geometry.shapes import Circle, Numbers, Pattern, Shape
from pareto_monoped.leg.dimensions import LegDimensions
from pareto_monoped.leg.outlines import rounded, sprocket

# Metric screws: nominal radius, clearance hole (ISO 273 fine), cap head radius and height (ISO 4762).
M3, M3_HOLE, M3_HEAD, M3_HEAD_HEIGHT = 1.5, 1.6, 2.75, 3.0
M4, M4_HOLE, M4_HEAD, M4_HEAD_HEIGHT = 2.0, 2.15, 3.5, 4.0

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


def cap_screw(*, seat_mm: float, length_mm: float, direction: float) -> tuple[Prism, ...]:
    """A cap screw M3 around the z axis: its head's seat at ``seat_mm``, its tip in ``direction`` (-1 or 1) of it."""
    shank = sorted((seat_mm, seat_mm + direction * length_mm))
    head = sorted((seat_mm, seat_mm - direction * M3_HEAD_HEIGHT))
    return (
        Prism(outline=Circle(radius_mm=M3), z0_mm=shank[0], z1_mm=shank[1]),
        Prism(outline=Circle(radius_mm=M3_HEAD), z0_mm=head[0], z1_mm=head[1]),
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
            Pattern(radius_mm=M3_HOLE, pitch_radius_mm=d.output_pitch_radius_mm, count=d.output_holes),
            Pattern(radius_mm=3.0, pitch_radius_mm=18.3, count=15),
        ),
    )
