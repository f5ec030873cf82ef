"""The shank: a fork of two plates around the thigh's knee end, with the knee's axle, a core and the foot."""

import math
from typing import Literal

import numpy as np

from pareto_monoped.geometry.parts import Ball, Part, Prism, layer, machined_part, sheet_part
from pareto_monoped.geometry.roles import Joint, JointKind, Purchase, Role
from pareto_monoped.geometry.screws import M3, M4, clearance
from pareto_monoped.geometry.shapes import Circle, Numbers, Path, Shape, rectangle
from pareto_monoped.leg.dimensions import LegDimensions
from pareto_monoped.leg.knee import AXLE_DOWEL, axle_dowels, axle_holes, axle_parts
from pareto_monoped.leg.sandwich import (
    BRIDGE,
    WINDOW_CORNER,
    Place,
    Pulley,
    belt,
    bolts_at,
    core_part,
    holes_at,
    rounded,
    sleeve_bolt,
    sleeve_hole,
    windows_between,
)
from pareto_monoped.leg.stop_parts import shank_stop_bolts, shank_stop_parts
from pareto_monoped.materials import MATERIALS

# Our own layout of the fork, mm below the knee axis.
FORK_WINDOW_TOP = 28.0  # below the round end of the plates
FORK_WINDOW_END = 4.0  # from the window to the core: metal above the first bridge
# Our own layout of the ear for the striker, mm.
_EAR_RADIUS = 6.5  # 3.9 mm of metal around its bolt
_EAR_FILLET, _EAR_FOOT = 12.0, -72.0  # radius of the fillet below it, and height of its middle
# Our own layout of the foot, mm.
_FOOT_GAP = 1.0  # from the foot's flat to the plates, and from the foot's block to the core
_BLOCK_WIDTH, _BLOCK_HEIGHT = 24.0, 34.0  # of the block between the plates, above the foot's flat
_BLOCK_HOLE_RADIUS = 7.4  # lightens the block; 0.5 mm of metal are left to the holes of its bolts
_BLOCK_BOLT = 6.5  # from the ends of the block to its bolts: 3.9 mm of metal
_TONGUE_WIDTH, _TONGUE_DEPTH, _TONGUE_HALF_THICKNESS = 16.0, 15.0, 5.0  # of the block's tongue in the foot


def bridges_of(length_mm: Numbers, d: LegDimensions) -> tuple[Numbers, Numbers]:
    """Return the heights of the bridges at either end of the core, mm from the knee axis."""
    core_end = d.foot_flat_mm - length_mm + _BLOCK_HEIGHT + _FOOT_GAP
    return -d.fork_mm - BRIDGE, core_end + BRIDGE


def bottom_axis_mm(length_mm: Numbers, d: LegDimensions) -> Numbers:
    """Return the height of the axis of the plates' lower round end, mm from the knee axis."""
    return _bottom_mm(d.foot_flat_mm - length_mm, d)


def _bottom_mm(flat_mm: Numbers, d: LegDimensions) -> Numbers:
    return flat_mm + _FOOT_GAP + d.shank_bottom_radius_mm


def shank_parts(shank_length_m: Numbers, d: LegDimensions) -> tuple[Part, ...]:
    """Build the shank from knee axis to foot centre, without the foot; the length is a float or of shape (n,)."""
    flat = d.foot_flat_mm - 1000.0 * shank_length_m
    face = 0.5 * d.shank_gap_mm + d.shank_plate_mm
    bridges, core = (
        bridges_of(1000.0 * shank_length_m, d),
        (d.shank_core_half_width_mm, d.shank_core_window_half_width_mm),
    )
    foot_bolts = tuple((0.0, flat + up, 0.0) for up in (_BLOCK_BOLT, _BLOCK_HEIGHT - _BLOCK_BOLT))
    return (
        *_plates(flat, bridges, foot_bolts, d),
        core_part("shank_core", -d.fork_mm, bridges[1] - BRIDGE, d.shank_gap_mm, core, bridges),
        sleeve_bolt("shank_bolt", M3, face, bolts_at(bridges), plate_on_core_mm=d.shank_plate_mm),
        *axle_parts(d),
        _foot_block(flat, foot_bolts, d),
        sleeve_bolt("foot_bolt", M4, face, foot_bolts),
        *shank_stop_parts(d),
    )


def _plates(
    flat_mm: Numbers, bridges: tuple[Numbers, ...], foot_bolts: tuple[Place, ...], d: LegDimensions
) -> tuple[Part, ...]:
    """Build both plates, from the knee to the foot's flat: mirror images, as their screws are countersunk outside."""
    half_gap = 0.5 * d.shank_gap_mm
    fork_window = rounded(
        half_width_mm=d.shank_window_half_width_mm,
        high_mm=-FORK_WINDOW_TOP,
        low_mm=-d.fork_mm + FORK_WINDOW_END,
        corner_mm=WINDOW_CORNER,
    )
    bolted = holes_at(bolts_at(bridges), sleeve_hole(M3))
    thick = holes_at((*foot_bolts, *shank_stop_bolts(d)), sleeve_hole(M4))
    outline = _outline(flat_mm, d)
    holes: tuple[Shape, ...] = (
        axle_holes(),
        axle_dowels(),
        fork_window,
        *windows_between(bridges, d.shank_window_half_width_mm),
        *bolted,
        *thick,
    )
    sides: tuple[tuple[str, float, Literal["low", "high"]], ...] = (
        ("near", -half_gap - d.shank_plate_mm, "low"),
        ("far", half_gap, "high"),
    )
    return tuple(
        sheet_part(
            name=f"shank_plate_{side}",
            role=Role.PLATE,
            prisms=(layer(outline, low, low + d.shank_plate_mm, *holes),),
            features=tuple(
                clearance(screw, shapes, low, low + d.shank_plate_mm, countersunk=outside)
                for screw, shapes in ((M3, bolted), (M4, thick))
            ),
            fits=(AXLE_DOWEL.hole_fit,),
            note=f"{d.shank_plate_mm:g} mm sheet",
        )
        for side, low, outside in sides
    )


def _outline(flat_mm: Numbers, d: LegDimensions) -> Path:
    """Return two round ends joined by straight edges, with an ear in front for the striker's upper bolt."""
    (x, y, _), _ = shank_stop_bolts(d)
    bottom = Pulley(x_mm=0.0, y_mm=_bottom_mm(flat_mm, d), radius_mm=d.shank_bottom_radius_mm)
    return belt(
        (
            Pulley(x_mm=0.0, y_mm=0.0, radius_mm=d.shank_top_radius_mm),
            bottom,
            Pulley(x_mm=d.shank_top_radius_mm + _EAR_FILLET, y_mm=_EAR_FOOT, radius_mm=_EAR_FILLET, inside=False),
            Pulley(x_mm=x, y_mm=y, radius_mm=_EAR_RADIUS),
        )
    )


def _foot_block(flat_mm: Numbers, foot_bolts: tuple[Place, ...], d: LegDimensions) -> Part:
    """Build the block between the plates, on whose tongue the foot is moulded."""
    middle = flat_mm + 0.5 * _BLOCK_HEIGHT
    return machined_part(
        name="foot_block",
        role=Role.BRACKET,
        prisms=(
            layer(
                rectangle(width_mm=_BLOCK_WIDTH, height_mm=_BLOCK_HEIGHT, y_mm=middle),
                -0.5 * d.shank_gap_mm,
                0.5 * d.shank_gap_mm,
                *holes_at(foot_bolts, sleeve_hole(M4)),
                Circle(radius_mm=_BLOCK_HOLE_RADIUS, y_mm=middle),
            ),
            _tongue(flat_mm),
        ),
        note="holds the foot between the shank plates",
    )


def foot_part(shank_length_m: Numbers, d: LegDimensions) -> Part:
    """Build the rubber foot in the shank's frame, for lengths as in ``shank_parts``."""
    y_mm = -1000.0 * shank_length_m
    return Part(
        name="foot",
        role=Role.FOOT,
        material=MATERIALS.rubber,
        process="moulded",
        prisms=(),
        balls=(
            Ball(radius_mm=d.foot_radius_mm, y_mm=y_mm, top_mm=d.foot_flat_mm, pocket=_tongue(y_mm + d.foot_flat_mm)),
        ),
        purchases=_cast(d),
        note="60 Shore A",
        joint=Joint(kind=JointKind.MOULDED, how="moulded onto the tongue of", partner="foot_block"),
    )


def _cast(d: LegDimensions) -> tuple[Purchase, ...]:
    """Return what casting a foot takes: a tenth more than the ball, primer, and the pins of its mould."""
    ball_mm3 = 4.0 / 3.0 * np.pi * d.foot_radius_mm**3
    return (
        Purchase(
            kind="casting rubber",
            designation="polyurethane VytaFlex 60 (Smooth-On), 60 Shore A",
            count=math.ceil(1.1e-3 * ball_mm3),
            unit="ml",
        ),
        Purchase(
            kind="adhesive",
            designation="primer Cilbond 49SF",
            alternatives=("Chemlok 213",),
            unit="pack",
            remark="on the foot block's tongue",
        ),
        Purchase(kind="release agent", designation="mould release wax", unit="pack"),
        Purchase(
            kind="pin",
            designation="parallel pin ISO 2338 - 4 m6 x 16 - St",
            standard="ISO 2338",
            alternatives=("DIN 7 - 4 m6 x 16",),
            count=4,
            remark="align both halves of the mould",
        ),
    )


def _tongue(flat_mm: Numbers) -> Prism:
    """Build the tongue of the foot's block, which fills the pocket of the foot, below the foot's flat."""
    return layer(
        rectangle(width_mm=_TONGUE_WIDTH, height_mm=_TONGUE_DEPTH, y_mm=flat_mm - 0.5 * _TONGUE_DEPTH),
        -_TONGUE_HALF_THICKNESS,
        _TONGUE_HALF_THICKNESS,
    )
