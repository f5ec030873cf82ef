"""The knee joint: bearings in cups at the end of the thigh, and the axle of the shank that turns in them."""

import numpy as np

from pareto_monoped.geometry.dowels import Dowel, dowel_part
from pareto_monoped.geometry.features import bored, turned
from pareto_monoped.geometry.making import Fit, narrower
from pareto_monoped.geometry.parts import Part, Prism, disc, layer, machined_part, steel_part, strong_part
from pareto_monoped.geometry.roles import Role, Visibility
from pareto_monoped.geometry.screws import (
    HEXAGON_FLATS_MM,
    LENGTHS_MM,
    M4,
    M25,
    between,
    cylinder,
    hexagon,
    ordered_nut,
    ordered_screw,
    screw_part,
    tapped,
)
from pareto_monoped.geometry.shapes import Circle, Numbers, Pattern
from pareto_monoped.leg.dimensions import LegDimensions
from pareto_monoped.leg.journal import SHOULDER_RADIUS, bearing_part
from pareto_monoped.leg.sprocket import relief_holes, sprocket_outline

# Our own layout of the cups, mm.
_CUP_WALL = 5.0  # around the bearing
_CUP_SCREWS = 4  # M2.5, in the middle of that wall
_CUP_THREAD = 6.0  # usable depth in a cup, which is as deep as the bearing is wide
# Our own layout of the axle, mm.
_BOLTS, _BOLT_PITCH_RADIUS = 4, 5.5  # M4: 2.35 mm of metal between their holes and the bearing's seat
AXLE_DOWEL = Dowel(diameter_mm=4.0)  # as many as bolts, in the gaps between them: 0.7 mm of metal between the holes
_DOWEL_PITCH_RADIUS = 6.8  # 1.2 mm of metal to the bearing's seat
DOWEL_DEPTH = 7.0  # in the axle: with the plate, 10 mm long ones fit
_TO_GRIND = 0.5  # of each spacer: shoulders, rings and ends may make up 0.74 mm of both by their general tolerances
# The nut of an axle bolt, M4 (ISO 4032), mm. The bolts are 7.8 mm apart, so that washers of 8 mm have no room.
# Heads and nuts press the plates less than ``strength.threads`` allows.
_NUT_HEIGHT = 3.2
_NUT_TURN = np.pi / 12.0  # of its hexagon: each nut turns a flat to one neighbour and a corner to the other
_NUT_SPARE = 0.7  # by which the bolt stands out of it, one pitch of its thread


def cup_holes(y_mm: Numbers, radius_mm: float, d: LegDimensions) -> Pattern:
    """Return the holes for the screws of a bearing cup around a knee axis at height ``y_mm``."""
    circle_mm = d.bearing_outer_radius_mm + 0.5 * _CUP_WALL
    return Pattern(radius_mm=radius_mm, pitch_radius_mm=circle_mm, count=_CUP_SCREWS, phase_rad=np.pi / 4, y_mm=y_mm)


def knee_bearings(thigh_length_mm: Numbers, d: LegDimensions) -> tuple[Part, ...]:
    """Build the bearings of the knee and their cups, which are screwed to the insides of the thigh's plates."""
    half_gap = 0.5 * d.gap_mm
    y_mm = -thigh_length_mm
    places = ((0.0, y_mm, half_gap - d.bearing_width_mm), (0.0, y_mm, -half_gap))
    seat, threads = Circle(radius_mm=d.bearing_outer_radius_mm), cup_holes(0.0, M25.core, d)
    return (
        machined_part(
            name="knee_bearing_cup",
            role=Role.HOUSING,
            visibility=Visibility.INSIDE,
            prisms=(disc(d.bearing_outer_radius_mm + _CUP_WALL, 0.0, d.bearing_width_mm, seat, threads),),
            places_mm=places,
            fits=(Fit(diameter_mm=2.0 * d.bearing_outer_radius_mm, zone="H7", seat=True),),
            # One cup stands the other way round.
            features=(
                bored(seat, 0.0, d.bearing_width_mm, enters="both"),
                tapped(M25, (threads,), 0.0, d.bearing_width_mm, enters="both"),
            ),
            note="the plate's lip holds the bearing outwards",
        ),
        *(
            screw_part(
                f"knee_cup_screw_{side}",
                M25,
                visibility=Visibility.OUTSIDE,
                head="countersunk",
                seat_mm=-direction * d.thigh_face_mm,
                grip_mm=d.plate_mm,
                room_mm=_CUP_THREAD,
                direction=direction,
                holes=threads,
                places_mm=((0.0, y_mm, 0.0),),
                note="flush, from outside",
            )
            for side, direction in (("near", 1.0), ("far", -1.0))
        ),
        bearing_part("knee_bearing", d, places_mm=places),
    )


def axle_holes() -> Pattern:
    """Return the holes of the bolts that clamp the whole knee."""
    return Pattern(radius_mm=M4.hole, pitch_radius_mm=_BOLT_PITCH_RADIUS, count=_BOLTS, phase_rad=np.pi / 4)


def axle_dowels() -> Pattern:
    """Return the holes of the dowels by which the axle turns a plate of the shank."""
    return AXLE_DOWEL.holes(2.0 * _DOWEL_PITCH_RADIUS, _BOLTS, 0.0)


def axle_parts(d: LegDimensions) -> tuple[Part, ...]:
    """Build what turns in the thigh's knee bearings: the axle with its teeth, clamped between the shank's plates."""
    return (_axle(d), *_dowels(d), _spacer(d), _axle_bolt(d))


def _axle(d: LegDimensions) -> Part:
    """Build axle and sprocket in one piece, put in from the inside of the thigh before the second plate closes it."""
    half_gap, half_tooth, shoulder = (
        0.5 * d.shank_gap_mm,
        0.5 * d.chain.sprocket_width_mm,
        0.5 * d.gap_mm - d.bearing_width_mm,
    )
    bolts, dowels, blind = axle_holes(), axle_dowels(), half_gap - DOWEL_DEPTH

    def both(radius_mm: float, low_mm: float, high_mm: float, *holes: Pattern) -> tuple[Prism, Prism]:
        return (disc(radius_mm, -high_mm, -low_mm, bolts, *holes), disc(radius_mm, low_mm, high_mm, bolts, *holes))

    return strong_part(
        name="knee_axle",
        role=Role.SPROCKET,
        prisms=(
            layer(sprocket_outline(d.chain), -half_tooth, half_tooth, bolts, relief_holes(d)),
            *both(SHOULDER_RADIUS, half_tooth, shoulder),
            *both(d.bearing_bore_radius_mm, shoulder, blind),
            *both(d.bearing_bore_radius_mm, blind, half_gap, dowels),
        ),
        fits=(Fit(diameter_mm=2.0 * d.bearing_bore_radius_mm, zone="h6", seat=True), AXLE_DOWEL.hole_fit),
        lengths=(narrower("shoulders", -shoulder, shoulder),),
        features=(turned(d.bearing_bore_radius_mm, half_gap, -1.0), turned(d.bearing_bore_radius_mm, -half_gap, 1.0)),
        note="axle and sprocket in one piece, both seats turned on one axis within 0.02 mm and the roots of the teeth "
        f"within 0.1 mm of it; dowels' holes drilled up to 1.5 mm deeper than reamed; "
        f"{d.chain.name}, {d.chain.teeth} teeth (ISO 606)",
    )


def _dowels(d: LegDimensions) -> tuple[Part, ...]:
    """Build the dowels between axle and plates, flush with the plates' outer faces."""
    holes, face = axle_dowels(), 0.5 * d.shank_gap_mm + d.shank_plate_mm
    return tuple(
        dowel_part(
            f"knee_axle_dowel_{side}",
            AXLE_DOWEL,
            end_mm=sign * face,
            room_mm=d.shank_plate_mm + DOWEL_DEPTH,
            direction=-sign,
            holes=holes,
            partner="knee_axle",
            note="holes reamed together with the plate",
        )
        for side, sign in (("near", -1.0), ("far", 1.0))
    )


def _spacer(d: LegDimensions) -> Part:
    """Build the spacers that clamp the bearings' inner rings between axle and shank."""
    half_gap, half_thigh_gap = 0.5 * d.shank_gap_mm, 0.5 * d.gap_mm
    return machined_part(
        name="knee_spacer",
        role=Role.SPACER,
        prisms=(disc(SHOULDER_RADIUS, 0.0, half_gap - half_thigh_gap, Circle(radius_mm=d.bearing_bore_radius_mm)),),
        places_mm=((0.0, 0.0, half_thigh_gap), (0.0, 0.0, -half_gap)),
        registers=(Fit(diameter_mm=2.0 * d.bearing_bore_radius_mm, zone="F7"),),
        at_assembly="measured and ground before it goes in: with bearings, it must stand 0.02 to 0.05 mm out over the "
        "axle's end at its side",
        note=f"clamps the bearing's inner ring; made {_TO_GRIND:g} mm longer than drawn, then both ground until "
        "spacers and bearings together stand 0.02 to 0.05 mm out over the axle's ends",
    )


def _axle_bolt(d: LegDimensions) -> Part:
    """Build the bolts through shank plates, spacers and axle; they only clamp, in the lowest property class."""
    face = 0.5 * d.shank_gap_mm + d.shank_plate_mm
    length = float(LENGTHS_MM[2.0 * face + _NUT_HEIGHT + _NUT_SPARE <= LENGTHS_MM][0])
    return steel_part(
        name="knee_bolt",
        role=Role.BOLT,
        prisms=(
            cylinder(M4.head, -face - M4.head_height, -face),
            cylinder(M4.shank, -face, face),
            between(hexagon(HEXAGON_FLATS_MM[2.0 * M4.shank], _NUT_TURN), face, face + _NUT_HEIGHT),
            cylinder(M4.core, face + _NUT_HEIGHT, length - face),
        ),
        count=_BOLTS,
        pitch_radius_mm=_BOLT_PITCH_RADIUS,
        phase_rad=np.pi / 4,
        fastening=M4.fastening("cap", "8.8"),
        purchases=(ordered_screw(M4, "cap", length, "8.8"), ordered_nut("M4")),
        note="clamps the whole knee",
    )
