"""The shank as a list of parts: a fork of two plates around the thigh's knee end, the knee axle, and the foot."""

import numpy as np

from pareto_monoped.geometry.parts import Ball, Part, Prism
from pareto_monoped.geometry.roles import Joint, JointKind, Role
from pareto_monoped.geometry.screws import LENGTHS_MM, M3, M4, cylinder, screw_part
from pareto_monoped.geometry.shapes import Circle, Numbers, Pattern, hull, rectangle
from pareto_monoped.leg.common import (
    BRIDGE,
    WINDOW_CORNER,
    bolts_at,
    holes_at,
    sleeve_bolt,
    sleeve_hole,
    sprocket_prisms,
    windows_between,
)
from pareto_monoped.leg.dimensions import DEFAULT, LegDimensions
from pareto_monoped.leg.outlines import rounded
from pareto_monoped.materials import MATERIALS

# Our own layout, mm.
_AXLE_BOLT_PITCH = 5.5
_NECK = 9.0  # radius of the axle inside the sprocket
_SHOULDER = 11.8  # radius that touches the bearing's inner ring only
_FOOT_BLOCK = 34.0  # height of the foot's block above the ball's flat
_NUT_HEIGHT, _NUT_SPARE = 3.2, 0.7  # M4 (ISO 4032), and a pitch that stands out of it
_NUT_RADIUS = 3.68  # of a disc with the nut's area, 7 mm across flats
_TONGUE = 15.0  # how deep the foot's tongue reaches into the ball


def shank_parts(shank_length_m: Numbers, d: LegDimensions = DEFAULT) -> tuple[Part, ...]:
    """The shank from knee axis to foot centre, without the rubber foot: fork, core, knee axle, foot block, fasteners.

    Args:
        shank_length_m: knee axis to the centre of the foot, float or shape (n,).
        d: dimensions.
    """
    length = 1000.0 * shank_length_m
    half_gap = 0.5 * d.shank_gap_mm
    face = half_gap + d.shank_plate_mm
    flat = d.foot_flat_mm - length
    block_top = flat + _FOOT_BLOCK
    bridges = (-d.fork_mm - BRIDGE, block_top + 1.0 + BRIDGE)
    bolts = holes_at(bolts_at(bridges), sleeve_hole(M3))
    foot_bolts = tuple((0.0, flat + up, 0.0) for up in (6.5, _FOOT_BLOCK - 6.5))
    foot_holes = holes_at(foot_bolts, sleeve_hole(M4))
    return (
        Part(
            name="shank_plate",
            role=Role.PLATE,
            material=MATERIALS.aluminium,
            process="laser cut",
            prisms=(
                Prism(
                    outline=hull(
                        top_radius_mm=d.shank_top_radius_mm,
                        bottom_radius_mm=d.shank_bottom_radius_mm,
                        length_mm=-flat - 1.0 - d.shank_bottom_radius_mm,
                    ),
                    z0_mm=0.0,
                    z1_mm=d.shank_plate_mm,
                    holes=(
                        _axle_holes(),
                        rounded(
                            half_width_mm=d.shank_window_half_width_mm,
                            high_mm=-28.0,
                            low_mm=-d.fork_mm + 4.0,
                            corner_mm=WINDOW_CORNER,
                        ),
                        *windows_between(bridges, d.shank_window_half_width_mm),
                        *bolts,
                        *foot_holes,
                    ),
                ),
            ),
            places_mm=((0.0, 0.0, half_gap), (0.0, 0.0, -face)),
            note="3 mm sheet EN AW-6082 T6; countersink the bolt holes outside",
        ),
        Part(
            name="shank_core",
            role=Role.CORE,
            material=MATERIALS.printed_plastic,
            process="3D printed",
            prisms=(
                Prism(
                    outline=rectangle(
                        width_mm=2.0 * d.shank_core_half_width_mm,
                        height_mm=-d.fork_mm - (block_top + 1.0),
                        y_mm=0.5 * (block_top + 1.0 - d.fork_mm),
                    ),
                    z0_mm=-half_gap,
                    z1_mm=half_gap,
                    holes=(*windows_between(bridges, d.shank_core_window_half_width_mm), *bolts),
                ),
            ),
            note="print lying on a plate side, solid",
        ),
        sleeve_bolt("shank_bolt", M3, face, bolts_at(bridges)),
        *_axle_parts(d),
        Part(
            name="foot_block",
            role=Role.BRACKET,
            material=MATERIALS.aluminium,
            process="machined",
            prisms=(
                Prism(
                    outline=rectangle(width_mm=24.0, height_mm=_FOOT_BLOCK, y_mm=flat + 0.5 * _FOOT_BLOCK),
                    z0_mm=-half_gap,
                    z1_mm=half_gap,
                    holes=(*foot_holes, Circle(radius_mm=7.5, y_mm=flat + 0.5 * _FOOT_BLOCK)),
                ),
                _tongue(flat),
            ),
            note="holds the foot between the shank plates",
        ),
        sleeve_bolt("foot_bolt", M4, face, foot_bolts),
    )


def foot_part(shank_length_m: Numbers = 0.0, d: LegDimensions = DEFAULT) -> Part:
    """The rubber foot in the shank's frame; without a length around its own centre."""
    y_mm = -1000.0 * shank_length_m
    return Part(
        name="foot",
        role=Role.FOOT,
        material=MATERIALS.rubber,
        process="moulded",
        prisms=(),
        balls=(
            Ball(
                radius_mm=d.foot_radius_mm,
                y_mm=y_mm,
                top_mm=d.foot_flat_mm,
                pocket=_tongue(y_mm + d.foot_flat_mm),
            ),
        ),
        note="60 Shore A",
        joint=Joint(kind=JointKind.MOULDED, how="moulded onto the tongue of", partner="foot_block"),
    )


def _tongue(flat_mm: Numbers) -> Prism:
    return Prism(
        outline=rectangle(width_mm=16.0, height_mm=_TONGUE, y_mm=flat_mm - 0.5 * _TONGUE), z0_mm=-5.0, z1_mm=5.0
    )


def _axle_holes() -> Pattern:
    return Pattern(radius_mm=M4.hole, pitch_radius_mm=_AXLE_BOLT_PITCH, count=4, phase_rad=np.pi / 4)


def _axle_parts(d: LegDimensions) -> tuple[Part, ...]:
    """What turns in the thigh's knee bearings: two half axles with the sprocket between them, clamped by four bolts."""
    half_gap, half_thigh_gap = 0.5 * d.shank_gap_mm, 0.5 * d.gap_mm
    face = half_gap + d.shank_plate_mm
    half_tooth = 0.5 * d.sprocket_width_mm
    shoulder = half_thigh_gap - d.bearing_width_mm
    flange = shoulder - 0.4  # clear of the bearing's outer ring; leaves 3.2 mm of thread for the sprocket's screws
    bolts = _axle_holes()
    bolt_mm = float(LENGTHS_MM[2.0 * face + _NUT_HEIGHT + _NUT_SPARE <= LENGTHS_MM][0])
    threads = Pattern(radius_mm=M3.core, pitch_radius_mm=d.output_pitch_radius_mm, count=d.output_holes)

    def disc(radius_mm: float, z0_mm: float, z1_mm: float, *holes: Pattern) -> Prism:
        return Prism(outline=Circle(radius_mm=radius_mm), z0_mm=z0_mm, z1_mm=z1_mm, holes=(bolts, *holes))

    return (
        Part(
            name="knee_axle",
            role=Role.SHAFT,
            material=MATERIALS.aluminium,
            process="machined",
            prisms=(
                disc(_NECK, -half_tooth, half_tooth),
                disc(d.coupler_radius_mm - 1.0, half_tooth, flange, threads),
                disc(_SHOULDER, flange, shoulder),
                disc(d.bearing_bore_radius_mm, shoulder, half_gap),
            ),
            note="EN AW-7075; seat 20 h6; threads M3",
        ),
        Part(
            name="knee_axle_cap",
            role=Role.SHAFT,
            material=MATERIALS.aluminium,
            process="machined",
            prisms=(
                disc(d.bearing_bore_radius_mm, -half_gap, -shoulder),
                disc(_SHOULDER, -shoulder, -half_tooth),
            ),
            note="EN AW-7075; seat 20 h6",
        ),
        Part(
            name="knee_spacer",
            role=Role.SPACER,
            material=MATERIALS.aluminium,
            process="machined",
            prisms=(
                Prism(
                    outline=Circle(radius_mm=_SHOULDER),
                    z0_mm=0.0,
                    z1_mm=half_gap - half_thigh_gap,
                    holes=(Circle(radius_mm=d.bearing_bore_radius_mm),),
                ),
            ),
            places_mm=((0.0, 0.0, half_thigh_gap), (0.0, 0.0, -half_gap)),
            note="clamps the bearing's inner ring; 0.05 mm longer than nominal",
        ),
        Part(
            name="knee_sprocket",
            role=Role.SPROCKET,
            material=MATERIALS.steel,
            process="machined",
            prisms=sprocket_prisms(d),
            note=f"{d.chain_name}, {d.sprocket_teeth} teeth (ISO 606); as drive_sprocket, screw holes countersunk",
        ),
        screw_part(
            "knee_sprocket_screw",
            M3,
            head="countersunk",
            seat_mm=d.sprocket_recess_mm - half_tooth,
            grip_mm=2.0 * half_tooth - d.sprocket_recess_mm,
            room_mm=flange - half_tooth,
            direction=1.0,
            material=MATERIALS.steel,
            count=d.output_holes,
            pitch_radius_mm=d.output_pitch_radius_mm,
            grade="10.9",
            note="flush, into the axle; the four long bolts clamp the sprocket as well",
        ),
        Part(
            name="knee_bolt",
            role=Role.BOLT,
            material=MATERIALS.steel,
            process="bought",
            prisms=(
                cylinder(M4.head, -face - M4.head_height, -face),
                cylinder(M4.shank, -face, face),
                cylinder(_NUT_RADIUS, face, face + _NUT_HEIGHT),
                cylinder(M4.core, face + _NUT_HEIGHT, bolt_mm - face),
            ),
            count=4,
            pitch_radius_mm=_AXLE_BOLT_PITCH,
            phase_rad=np.pi / 4,
            note=f"M4 x {bolt_mm:g} cap screw (ISO 4762) 12.9 with nut (ISO 4032), clamps the whole knee",
        ),
    )
