"""What all links share: metric screws, the sandwich's bolted bridges and windows, the sprocket."""

from itertools import pairwise

from pareto_monoped.geometry.parts import Part, Prism
from pareto_monoped.geometry.roles import Role
from pareto_monoped.geometry.screws import M3, Screw, cylinder, screw_for, screw_length_mm
from pareto_monoped.geometry.shapes import Circle, Numbers, Pattern, Shape
from pareto_monoped.leg.dimensions import LegDimensions
from pareto_monoped.leg.outlines import rounded, sprocket
from pareto_monoped.materials import MATERIALS

Place = tuple[Numbers, Numbers, Numbers]


def motor_screw(diameter_mm: float) -> Screw:
    """The cap screw for holes of a motor; its core fits the threads that the actuator draws, 0.8 mm below nominal."""
    return screw_for(diameter_mm, 0.5 * diameter_mm - 0.4)


# A screw in a sleeve nut, both countersunk: outer diameter of the sleeve 1 mm above the thread's, as sold for furniture
# and cases; their lengths overlap by 6 to 8 mm.
_SLEEVE_WALL = 0.5
_OVERLAP = (6.0, 8.0)


def sleeve_hole(screw: Screw) -> float:
    """Radius of the hole for a sleeve nut, 0.1 mm of play around it."""
    return screw.shank + _SLEEVE_WALL + 0.1


def sleeve_bolt(name: str, screw: Screw, half_stack_mm: float, places_mm: tuple[Place, ...]) -> Part:
    """A countersunk screw in a countersunk sleeve nut, flush on both sides of a stack centred on z = 0."""
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
        countersunk_mm=(-half_stack_mm, half_stack_mm),
        note=f"{screw.name} x {long:g} countersunk (ISO 10642) 8.8 in a countersunk sleeve nut {screw.name} x "
        f"{sleeve:g}, flush, {stack:g} mm together",
    )


# Our own layout: half height of the solid bridges between windows, where the sandwich is bolted, and the bolts' x.
BRIDGE = 5.5
BRIDGE_BOLT_X = 12.0
WINDOW_CORNER = 6.0


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


def sprocket_prisms(d: LegDimensions, bolt_radius_mm: float = M3.hole) -> tuple[Prism, ...]:
    """The sprocket of hip and knee, with its bolts' holes, a bore and a ring of holes that lighten it.

    A wide one is counterbored at -z, so that screws of the same length do for any width.
    """
    half = 0.5 * d.sprocket_width_mm

    def slice_of(z0_mm: float, z1_mm: float, radius_mm: float) -> Prism:
        return Prism(
            outline=sprocket(teeth=d.sprocket_teeth, pitch_mm=d.chain_pitch_mm, roller_mm=d.chain_roller_mm),
            z0_mm=z0_mm,
            z1_mm=z1_mm,
            holes=(
                Circle(radius_mm=d.bearing_bore_radius_mm - 1.0),
                Pattern(radius_mm=radius_mm, pitch_radius_mm=d.output_pitch_radius_mm, count=d.output_holes),
                Pattern(radius_mm=3.0, pitch_radius_mm=18.3, count=15),
            ),
        )

    seat = d.sprocket_recess_mm - half
    whole = slice_of(seat, half, bolt_radius_mm)
    return (whole,) if d.sprocket_recess_mm == 0.0 else (slice_of(-half, seat, M3.head + 0.15), whole)
