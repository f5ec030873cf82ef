"""The thigh as a list of parts: sandwich, hip joints, chain, and knee bearings."""

from typing import Literal

import numpy as np

from pareto_monoped.geometry.dowels import Dowel
from pareto_monoped.geometry.features import Hole, tap_run_out_mm
from pareto_monoped.geometry.making import Fit
from pareto_monoped.geometry.parts import Part, disc, layer, machined_part, sheet_part
from pareto_monoped.geometry.roles import Role
from pareto_monoped.geometry.screws import M3, M25, clearance, screw_part, tapped
from pareto_monoped.geometry.shapes import Circle, Numbers, Pattern, Shape
from pareto_monoped.leg.chain import chain_parts
from pareto_monoped.leg.dimensions import LegDimensions
from pareto_monoped.leg.hip import hip_joints
from pareto_monoped.leg.journal import LIP
from pareto_monoped.leg.knee import cup_holes, knee_bearings
from pareto_monoped.leg.sandwich import (
    BRIDGE,
    Place,
    bolts_at,
    core_part,
    holes_at,
    sleeve_bolt,
    sleeve_hole,
    windows_between,
    with_rungs,
)
from pareto_monoped.leg.sprocket import BOSS_RADIUS
from pareto_monoped.leg.stop_parts import thigh_stop_bolts, thigh_stop_parts
from pareto_monoped.leg.thigh_outline import outer_hip_radius_mm, thigh_outline

# Our own layout, mm.
_KNEE_END = 34.0  # from the knee axis to the core above it, clear of the sprocket's teeth
_STANDOFF_RADIUS, _STANDOFF_PITCH_RADIUS = 3.5, 39.5  # around the hip: 1.8 mm or more outside the chain
_STANDOFF_ANGLES = (np.pi / 6, np.pi / 2, 5 * np.pi / 6)  # on top of the hip, where no strand runs down to the knee
# The same where the circle of the knee actuator's screws is as small: between these and the dowels in their gaps.
_SMALL_STANDOFF_ANGLES, _STANDOFF_ROOM = (np.pi / 4, 5 * np.pi / 12, 3 * np.pi / 4), 5.7
_SPIGOT_RADIUS = 2.0  # of a standoff, in the inner plate
_STANDOFF_THREAD = 7.0  # in a standoff
_STANDOFF_RIM = 5.5  # of the inner plate outside the standoffs' axes: 3.4 mm around their bolts
_BOSS_PLAY = 0.05  # of the inner plate around the hip coupling's boss
_INNER_RELIEF_RADIUS, _INNER_RELIEF_PITCH_RADIUS = 5.5, 25.5  # six holes between screws and standoffs
_OUTER_BORE_PLAY = 1.0  # of the outer plate around the knee's output flange
# Six holes between the outer plate's bore and the circle of its mounting screws.
_OUTER_RELIEF_MOST = 11.0  # their largest radius, that of the VT8020's leg; wider legs carry more and keep more metal
_OUTER_RELIEF_TO_FLANGE = 5.5  # from the output flange's radius: 4.5 mm of metal around the bore
_OUTER_RELIEF_TO_SCREWS = 5.0  # from the circle of the screws: 3.4 mm of metal to their holes


def bridges_of(length_mm: Numbers, d: LegDimensions) -> tuple[Numbers, Numbers, Numbers]:
    """Return the heights of the three bridges that bolt the sandwich together, mm from the hip axis."""
    first, last = -d.first_bridge_mm, _KNEE_END + BRIDGE - length_mm
    return first, 0.5 * (first + last), last


def thigh_parts(thigh_length_m: Numbers, d: LegDimensions) -> tuple[Part, ...]:
    """Build the thigh from hip axis to knee axis: plates, core, chain drive, hip coupling, knee bearings, fasteners.

    The knee actuator is not part of it: it is placed at ``z = d.knee_mount_mm`` with its output towards -z. The parts
    of ``Group.KNEE_DRIVE`` turn with the knee actuator's output and, by the chain, with the shank.

    ``thigh_length_m``: hip axis to knee axis, float or shape (n,).
    """
    length = 1000.0 * thigh_length_m
    bridges, core = bridges_of(length, d), (d.thigh_core_half_width_mm, d.thigh_core_window_half_width_mm)
    small = d.knee.mount_pitch_radius_mm < _STANDOFF_PITCH_RADIUS + _STANDOFF_ROOM
    standoffs = tuple(
        (_STANDOFF_PITCH_RADIUS * float(np.cos(angle)), _STANDOFF_PITCH_RADIUS * float(np.sin(angle)), 0.0)
        for angle in (_SMALL_STANDOFF_ANGLES if small else _STANDOFF_ANGLES)
    )
    bolts = (*bolts_at(bridges), *thigh_stop_bolts(length, d))
    return (
        *_plates(length, bridges, bolts, standoffs, d),
        core_part("thigh_core", BRIDGE - d.first_bridge_mm, _KNEE_END - length, d.gap_mm, core, bridges),
        *_standoffs(standoffs, d),
        sleeve_bolt("thigh_bolt", M3, d.thigh_face_mm, bolts, plate_on_core_mm=d.plate_mm),
        *hip_joints(d),
        *chain_parts(length, d),
        *knee_bearings(length, d),
        *thigh_stop_parts(length, d),
    )


def _plates(
    length: Numbers,
    bridges: tuple[Numbers, ...],
    bolts: tuple[Place, ...],
    standoffs: tuple[Place, ...],
    d: LegDimensions,
) -> tuple[Part, ...]:
    """Build the inner plate, which the hip's output turns, and the outer one, which carries the knee actuator."""
    half_gap, face = 0.5 * d.gap_mm, d.thigh_face_mm
    bolted, cups = holes_at(bolts, sleeve_hole(M3)), cup_holes(-length, M25.hole, d)
    spigots, screwed = holes_at(standoffs, _SPIGOT_RADIUS), holes_at(standoffs, M3.hole)
    common = (
        *windows_between(with_rungs(bridges), d.thigh_window_half_width_mm),
        *bolted,
        Circle(radius_mm=d.bearing_outer_radius_mm - LIP, y_mm=-length),
        cups,
    )

    def flush(low_mm: float, outside: Literal["low", "high"]) -> tuple[Hole, ...]:
        """Return the holes of the screws whose heads are flush outside."""
        return tuple(
            clearance(screw, shapes, low_mm, low_mm + d.plate_mm, countersunk=outside)
            for screw, shapes in ((M3, bolted), (M25, (cups,)))
        )

    note = f"{d.plate_mm:g} mm sheet"
    return (
        sheet_part(
            name="thigh_plate_inner",
            role=Role.PLATE,
            prisms=(
                layer(
                    thigh_outline(_STANDOFF_PITCH_RADIUS + _STANDOFF_RIM, length, d),
                    -face,
                    -half_gap,
                    *common,
                    *spigots,
                    *inner_hip_holes(d),
                ),
            ),
            features=flush(-face, "low"),
            fits=(Dowel(diameter_mm=d.hip.output_dowel_mm).hole_fit,),
            note=note,
        ),
        sheet_part(
            name="thigh_plate_outer",
            role=Role.PLATE,
            prisms=(
                layer(
                    thigh_outline(outer_hip_radius_mm(d), length, d),
                    half_gap,
                    face,
                    *common,
                    *screwed,
                    *outer_hip_holes(d),
                ),
            ),
            features=(*flush(half_gap, "high"), clearance(M3, screwed, half_gap, face, countersunk="high")),
            fits=(Dowel(diameter_mm=d.knee.mount_dowel_mm).hole_fit,),
            note=note + "; carries the knee actuator",
        ),
    )


def inner_hip_holes(d: LegDimensions) -> tuple[Shape, ...]:
    """Return the inner plate's holes around the hip axis: bore, screws into the hip's output, lightening."""
    return (
        Circle(radius_mm=BOSS_RADIUS + _BOSS_PLAY),
        d.hip.output_bolts,
        d.hip.output_dowel,
        Pattern(radius_mm=_INNER_RELIEF_RADIUS, pitch_radius_mm=_INNER_RELIEF_PITCH_RADIUS, count=6),
    )


def outer_hip_holes(d: LegDimensions) -> tuple[Shape, ...]:
    """Return the outer plate's holes around the hip axis: bore, screws into the knee actuator's case, lightening."""
    outside_mm = d.knee.mount_pitch_radius_mm - _OUTER_RELIEF_TO_SCREWS
    inside_mm = d.knee.coupler_radius_mm + _OUTER_RELIEF_TO_FLANGE
    relief = min(_OUTER_RELIEF_MOST, 0.5 * (outside_mm - inside_mm))
    return (
        Circle(radius_mm=d.knee.coupler_radius_mm + _OUTER_BORE_PLAY),
        d.knee.mount_bolts,
        d.knee.mount_dowel,
        Pattern(radius_mm=relief, pitch_radius_mm=outside_mm - relief, count=6),
    )


def _standoffs(places: tuple[Place, ...], d: LegDimensions) -> tuple[Part, ...]:
    """Build the pillars that keep the plates apart around the hip, with their screws.

    Once the leg's halves carry their actuators no key reaches the plates here. The pillars are therefore screwed to the
    outer plate before it takes the knee actuator, and the inner plate only slides onto their spigots.
    """
    half_gap, face = 0.5 * d.gap_mm, d.thigh_face_mm
    thread = (Circle(radius_mm=M3.core),)
    tap = half_gap - _STANDOFF_THREAD - tap_run_out_mm(M3.thread.pitch_mm)
    pillar = machined_part(
        name="thigh_standoff",
        role=Role.SPACER,
        prisms=(
            disc(_SPIGOT_RADIUS, -face, -half_gap),
            disc(_STANDOFF_RADIUS, -half_gap, tap),
            disc(_STANDOFF_RADIUS, tap, half_gap, *thread),
        ),
        places_mm=places,
        fits=(Fit(diameter_mm=2.0 * _SPIGOT_RADIUS, zone="h6"),),
        features=(tapped(M3, thread, tap, half_gap, enters="high", usable_mm=_STANDOFF_THREAD),),
        note="spigot into the inner plate, screwed to the outer one",
    )
    screw = screw_part(
        "thigh_standoff_screw",
        M3,
        head="countersunk",
        seat_mm=face,
        grip_mm=d.plate_mm,
        room_mm=_STANDOFF_THREAD,
        direction=-1.0,
        places_mm=places,
        note="flush, under the knee actuator",
    )
    return pillar, screw
