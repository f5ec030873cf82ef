"""Radii and heights of both families, for one gear set or for arrays of them: the common front, then what follows
it.

Actuator frame: z is the gearbox axis. The housing is bolted to what carries it by its face at z = 0. The output flange
is flush with this face and points to +z; everything lies at z <= 0. From the front:

    output flange, main bearing around the carrier | planets between sun and ring | secondary carrier | coupling, motor

In the ISSPG, the stator sits on the ring housing around the gears. In the ESSPG, the motor follows behind them.
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from pareto_monoped.actuator.bearings import (
    Bearing,
    RetainingRing,
    main_bearing,
    retaining_ring,
    small_bearing,
    width_less_mm,
)
from pareto_monoped.actuator.gearset import GearSet
from pareto_monoped.actuator.motor import AIR_GAP_MM, FramelessMotor, Motor
from pareto_monoped.actuator.settings import ActuatorSettings
from pareto_monoped.actuator.webs import Webs, webs_of
from pareto_monoped.geometry.dowels import Dowel
from pareto_monoped.geometry.gears import ExternalGear
from pareto_monoped.geometry.screws import LENGTHS_MM, M3, screw_for
from pareto_monoped.geometry.shapes import Numbers, Pattern

Family = Literal["ISSPG", "ESSPG"]
FAMILIES: tuple[Family, ...] = ("ISSPG", "ESSPG")
_PLANET_TO_SEAT_MM = 0.25
"""From the collar behind the bearing's ring to the planets, which turn past it, where they and the bearing are at the
near ends of their limits: what the chain ``planets to the wall behind the groove`` takes else; our own choice."""
BUSH_PLAY_MM = 0.2
"""Between the ends of a planet's bush and the carriers: the bush stands out of the planet and keeps it in its place."""
END_BEARING_BORE_MM = 6.0
"""Bore of the bearing that carries the sun's end in the carrier; our own choice."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Layout:
    """What the parts of both families have in common, in mm; r are radii, z are heights and negative."""

    gears: GearSet
    face_width_mm: Numbers
    bearing: Bearing
    end_bearing: Bearing
    rear_bearing: Bearing
    shaft_ring: RetainingRing  # in the carrier, before the main bearing
    bore_ring: RetainingRing  # in the ring housing of the ESSPG, behind the main bearing
    webs: Webs
    # Radii.
    r_plate: float
    r_casing: float
    r_bolts: float
    r_motor: float
    r_stator_in: float
    r_stator_out: float
    r_rotor_in: float
    r_bore: Numbers
    r_seat: Numbers
    r_open: Numbers
    r_pins: Numbers
    r_ring: Numbers
    r_carrier_in: Numbers
    r_secondary_in: Numbers
    r_secondary_out: Numbers
    # Heights, from the front.
    z_bearing_front: Numbers
    z_bearing_back: Numbers
    z_shoulder: Numbers
    z_gear_front: Numbers
    z_gear_back: Numbers
    z_secondary_front: Numbers
    z_secondary_back: Numbers


def radial_room_mm(motor: Motor, family: Family, settings: ActuatorSettings) -> float:
    """Return D_GB, the largest diameter of the gearbox (paper, after eq. 5)."""
    if family == "ISSPG":
        assert motor.frameless is not None
        return motor.frameless.stator_inner_diameter_mm - settings.diameter_clearance_mm
    assert motor.framed is not None
    return motor.framed.outer_diameter_mm - settings.diameter_clearance_mm


def ring_radius_mm(gears: GearSet, family: Family, settings: ActuatorSettings) -> Numbers:
    """Return the ring's outer radius: fixed beyond the pitch circle (``paper``), or with a rim of some modules.

    Its diameter is a multiple of 0.1 mm, for which there are gauges.
    """
    data = settings.parts.gears
    if settings.rules == "iso6336":
        radius = gears.ring_root_radius_mm + data.ring_rim_modules * gears.module_mm
    else:
        radius = gears.ring_pitch_radius_mm + (
            data.ring_width_internal_mm if family == "ISSPG" else data.ring_width_external_mm
        )
    return np.ceil(20.0 * radius - 1e-6) / 20.0


def layout(motor: Motor, family: Family, gears: GearSet, face_width_mm: Numbers, settings: ActuatorSettings) -> Layout:
    """Return the common layout of an actuator."""
    data = settings.parts
    carrier, casing = data.carrier, data.casing
    r_pins = gears.carrier_radius_mm
    least_bore = np.maximum(
        2.0 * r_pins + carrier.bearing_clearance_mm, 2.0 * carrier.flange_radius_mm + carrier.flange_clearance_mm
    )
    bearing = main_bearing(least_bore, settings.bearings)
    body = motor.frameless if family == "ISSPG" else motor.framed
    assert body is not None
    r_motor = 0.5 * body.outer_diameter_mm
    stator_in, stator_out = motor.stator_diameters_mm
    r_ring = ring_radius_mm(gears, family, settings)
    if family == "ESSPG" and settings.rules == "iso6336":
        # The main bearing passes through the ring's shoulder.
        r_ring = np.maximum(r_ring, 0.5 * bearing.outer_diameter_mm + casing.ring_lip_mm)
    shaft_ring = retaining_ring("DIN 471", bearing.inner_diameter_mm)
    bore_ring = retaining_ring("DIN 472", bearing.outer_diameter_mm)
    z_bearing_front = -(carrier.flange_thickness_mm + shaft_ring.collar_mm + shaft_ring.thickness_mm)
    z_bearing_back = z_bearing_front - bearing.width_mm
    shoulder_mm: Numbers = carrier.shoulder_thickness_mm
    if family == "ESSPG":
        # The ring behind the bearing, and the wall behind its groove, end before the gears begin.
        room_mm = bore_ring.thickness_mm + bore_ring.collar_mm + _PLANET_TO_SEAT_MM
        play_mm = data.needles.washer_play_mm if settings.planet_bearing == "needles" else BUSH_PLAY_MM
        room_mm = room_mm + width_less_mm(bearing.inner_diameter_mm) + play_mm
        shoulder_mm = np.maximum(shoulder_mm, room_mm - settings.planet_clearance_mm)
    z_shoulder = z_bearing_back - shoulder_mm
    z_gear_front = z_shoulder - settings.planet_clearance_mm
    z_gear_back = z_gear_front - face_width_mm
    z_secondary_front = z_gear_back - settings.planet_clearance_mm
    webs = webs_of(gears, settings)
    pin_reach = 0.5 * carrier.pin_diameter_mm + carrier.pin_wall_mm
    return Layout(
        gears=gears,
        face_width_mm=face_width_mm,
        bearing=bearing,
        end_bearing=small_bearing(END_BEARING_BORE_MM),
        rear_bearing=small_bearing(2.0 * data.coupling.shaft_radius_mm),
        shaft_ring=shaft_ring,
        bore_ring=bore_ring,
        webs=webs,
        r_plate=r_motor + casing.flange_width_mm,
        r_casing=r_motor + casing.motor_clearance_mm,
        r_bolts=r_motor + casing.bolt_offset_mm,
        r_motor=r_motor,
        r_stator_in=0.5 * stator_in,
        r_stator_out=0.5 * stator_out,
        r_rotor_in=0.5 * stator_out + AIR_GAP_MM,
        r_bore=0.5 * bearing.inner_diameter_mm,
        r_seat=0.5 * bearing.outer_diameter_mm,
        r_open=0.5 * bearing.outer_diameter_mm - casing.lip_mm,
        r_pins=r_pins,
        r_ring=r_ring,
        r_carrier_in=r_pins - pin_reach,
        r_secondary_in=np.maximum(r_pins - pin_reach, gears.sun().tip_radius_mm + carrier.sun_clearance_mm),
        r_secondary_out=np.maximum(r_pins + pin_reach, np.where(webs.present, webs.reach_mm, 0.0))[()],
        z_bearing_front=z_bearing_front,
        z_bearing_back=z_bearing_back,
        z_shoulder=z_shoulder,
        z_gear_front=z_gear_front,
        z_gear_back=z_gear_back,
        z_secondary_front=z_secondary_front,
        z_secondary_back=z_secondary_front - carrier.secondary_thickness_mm,
    )


_NECK_RADIUS_MM = 3.8
"""Of the sun's neck, which touches the inner ring of its end bearing only (619/6: abutment from 7.6 mm diameter)."""
NECK_PLAY_MM, NECK_WITHIN_MM = 0.2, 0.1
"""From the sun's neck to its end bearing, and within which limits it is set when the sun is bonded; our own choice."""
NECK_NOTE = (
    f"bonded with its neck {NECK_PLAY_MM:g} +-{NECK_WITHIN_MM:g} mm from the end bearing, the carrier pushed towards "
    "the motor"
)
NECK_SET = (
    "before its bond, try the case together dry: push the carrier towards the motor and the sun against the end "
    f"bearing, take them apart and measure how far the sun stands out of its coupling; bond it {NECK_PLAY_MM:g} +-"
    f"{NECK_WITHIN_MM:g} mm deeper"
)
"""How that is set, since nobody sees the neck in the closed case."""
COUPLING_DOWEL = Dowel(diameter_mm=2.5)
"""Between the coupling and what turns it; our own choice: they stand between screws of M3 or M4 on 22 mm."""
DOWEL_STANDS_OUT_MM = 1.0
"""How far such a dowel may stand out: half of ``motor_carrier_clearance_mm``."""
_HOB_RADIUS_MM = 12.0
"""Of the hob, or of the wheel that grinds the teeth: as small as both are sold; our own choice."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SunNeck:
    """The front end of the sun's shaft, in mm."""

    z: Numbers  #: back of the end that turns in the end bearing
    r_journal: Numbers  #: radius of this end
    r: Numbers  #: radius of the neck behind it


def sun_neck(at: Layout, settings: ActuatorSettings) -> SunNeck:
    """Return the neck, which keeps the sun from moving forwards and clears the carrier."""
    r_journal = 0.5 * at.end_bearing.inner_diameter_mm
    room = at.r_carrier_in - settings.parts.casing.rotor_clearance_mm
    return SunNeck(
        z=-at.end_bearing.width_mm - NECK_PLAY_MM,
        r_journal=r_journal,
        r=np.maximum(r_journal, np.minimum(_NECK_RADIUS_MM, room))[()],
    )


def hub_note(settings: ActuatorSettings) -> str:
    """Return how the coupling is made to fit."""
    return f"wire-cut to the shaft's spline, {settings.parts.spline.play_mm:g} mm play"


def _run_out_mm(root_radius_mm: Numbers, shaft_radius_mm: Numbers) -> float:
    """Return how far such a tool runs out along a shaft that is wider than the roots, rounded up to 0.5 mm; 0 if it
    does not cut into it.
    """
    depth = max(float(shaft_radius_mm) - float(root_radius_mm), 0.0)
    return float(np.ceil(2.0 * np.sqrt(_HOB_RADIUS_MM**2 - (_HOB_RADIUS_MM - depth) ** 2)) / 2.0)


def shoulder_note(gear: ExternalGear, neck_radius_mm: Numbers, shaft_radius_mm: Numbers) -> str:
    """Return how far the tool of the sun's teeth may run out on either side of them; '' where it cuts into neither."""
    if np.ndim(gear.teeth):
        return ""
    sides = ((neck_radius_mm, "neck"), (shaft_radius_mm, "shaft"))
    cut = [(_run_out_mm(gear.root_radius_mm, radius_mm), name) for radius_mm, name in sides]
    where = " and ".join(f"{long:g} mm into the {name}" for long, name in cut if long > 0.0)
    tool = f"hob and wheel of {2.0 * _HOB_RADIUS_MM:g} mm or less may run out"
    return f"teeth with roots of {2.0 * float(gear.root_radius_mm):.2f} mm: {tool} {where}; " if where else ""


def spline_note(spline: ExternalGear, shaft_radius_mm: float) -> str:
    """Return the spline in words. It is toothed like a gear, so that it needs no tool of its own."""
    note = f"splined end of {spline.teeth:g} teeth, module {spline.module_mm:g} mm, 20 degrees"
    root, shaft = 2.0 * float(spline.root_radius_mm), 2.0 * shaft_radius_mm
    if root >= shaft:
        return note
    run_out = _run_out_mm(spline.root_radius_mm, shaft_radius_mm)
    return f"{note}, roots of {root:g} mm below the shaft's {shaft:g} mm: hob may run out into it over {run_out:g} mm"


_FLANGE_WIDTH_MM = 6.0
"""Of the flange between ring housing and casing: 2.8 mm outside the bolt circle, a hexagon head's inner radius."""
_FLANGE_BOLTS_MM = 3.2
"""From the tube to that flange's bolt circle. A hexagon head of M3, 6.01 mm over its corners, turns beside the tube; a
spanner reaches it from the side, where the front plate bars a key."""
THIN_WALL_MM = 0.75
"""What is left of the casing's wall beside threads at least; our own choice: thinner ones give way to the tool."""
_NOTCH_MM = 0.7
"""How far the taps of that flange may cut into the casing's wall: 23 percent of the holes; our own choice."""
_THREAD_SHARE = 0.6
"""Least depth of thread over the screw's diameter, as the export's check of held parts asks for."""
_STEP_WALL_MM = 1.0
"""By how much the step from boss to tube reaches beyond the groove, which weakens the boss; our own choice."""
_RING_STEP_MM = 1.0
"""How far the ring stands out of its housing into the casing, which it centres; our own choice."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ExternalLayout:
    """Radii and heights of coupling, motor and housing, in mm, beyond what ``Layout`` has.

    From the front: the neck of the sun's shaft; the ring housing's seat, its ring's groove, and the step between both
    from the seat's boss to the tube around the ring; flange and web, where ring housing and casing meet; coupling;
    motor; backplate.
    """

    z_step: Numbers
    z_groove: Numbers
    z_groove_back: Numbers
    z_seat_back: Numbers
    z_flange: Numbers
    z_web: Numbers
    z_coupling: Numbers
    z_motor: Numbers
    z_plate: Numbers
    z_end: Numbers
    r_boss: Numbers
    r_tube: Numbers
    r_flange: Numbers
    r_web: Numbers
    r_bolts: Numbers
    neck: SunNeck
    coupling_mm: float
    base_mm: float


def external_layout(at: Layout, motor: Motor, settings: ActuatorSettings) -> ExternalLayout:
    """Return the layout of an ESSPG behind its front, for one gear set or for arrays of them."""
    casing, coupling_mm = settings.parts.casing, _coupling_mm(motor, settings)
    assert motor.framed is not None
    z_coupling = at.z_secondary_back - casing.motor_carrier_clearance_mm
    z_motor = z_coupling - coupling_mm
    z_plate = z_motor - motor.framed.length_mm
    z_groove_back = at.z_bearing_back - at.bore_ring.thickness_mm
    # The bearing presses the ring backwards; the groove's play is on its other side, under the bearing.
    z_groove = z_groove_back + at.bore_ring.groove_width_mm
    z_flange = at.z_gear_back + _RING_STEP_MM
    r_boss = at.r_seat + casing.seat_wall_mm
    r_tube = np.maximum(at.r_ring + casing.ring_wall_mm, r_boss)
    # A thread more than a quarter of which ends in the casing's wall has no way for its tap: it moves outwards.
    near, far = (at.r_casing + by for by in (_NOTCH_MM - M3.core, THIN_WALL_MM + M3.core - _NOTCH_MM))
    r_bolts = r_tube + _FLANGE_BOLTS_MM
    r_bolts = np.where((r_bolts > near) & (r_bolts < far), far, r_bolts)[()]
    r_flange = r_bolts + _FLANGE_WIDTH_MM - _FLANGE_BOLTS_MM
    return ExternalLayout(
        z_step=z_groove + _STEP_WALL_MM,
        z_groove=z_groove,
        z_groove_back=z_groove_back,
        z_seat_back=z_groove_back - at.bore_ring.collar_mm,
        z_flange=z_flange,
        z_web=z_flange - casing.flange_mm,
        z_coupling=z_coupling,
        z_motor=z_motor,
        z_plate=z_plate,
        z_end=z_plate - casing.plate_mm,
        r_boss=r_boss,
        r_tube=r_tube,
        r_flange=r_flange,
        r_web=np.maximum(r_flange, at.r_casing + casing.wall_mm),
        r_bolts=r_bolts,
        neck=sun_neck(at, settings),
        coupling_mm=coupling_mm,
        base_mm=_frame_base_mm(motor, coupling_mm),
    )


def _coupling_mm(motor: Motor, settings: ActuatorSettings) -> float:
    """Return the coupling's thickness, with room for the heads of its countersunk screws, in steps of 0.1 mm."""
    assert motor.output_holes is not None
    screw = screw_for(motor.output_holes.diameter_mm, 0.0)
    return max(
        settings.parts.coupling.thickness_mm, float(np.ceil(10.0 * (screw.countersunk - screw.shank) - 1e-9)) / 10.0
    )


def _frame_base_mm(motor: Motor, coupling_mm: float) -> float:
    """Return the thickness of a framed motor's base and face: at most 3 mm, or more to hold the coupling's screws."""
    assert motor.framed is not None
    assert motor.output_holes is not None
    least = coupling_mm + _THREAD_SHARE * motor.output_holes.diameter_mm
    length = LENGTHS_MM[np.searchsorted(LENGTHS_MM, least - 1e-9)]
    return max(min(3.0, 0.1 * motor.framed.length_mm), float(length) - coupling_mm)


_FLANGE_LESS_MM = 1.0
"""By how much the ring housing's flange is narrower than the casing's, within whose bolts it stays."""


@dataclass(frozen=True, slots=True, kw_only=True)
class InternalLayout:
    """Radii and heights of ring housing, rotor, coupling, rear bearing and backplate, in mm, beyond ``Layout``."""

    z_flange: float  #: back of the ring housing's flange
    z_lip: Numbers  #: back of the lip behind the main bearing
    z_bell: Numbers  #: front of the bell
    z_stator_back: Numbers  #: back of the stator
    z_coupling: Numbers  #: front of the coupling, at the bell's back
    z_seat: Numbers  #: front of the rear bearing
    z_plate: Numbers  #: front of the backplate
    z_end: Numbers  #: back of the backplate
    neck: SunNeck  #: front end of the sun's shaft
    #: r_seat_out, r_flange, r_flange_bolts, r_lip, r_ring_lip: of the ring housing: outside of its seat, its flange,
    #: the flange's bolt circle, the openings of the lips behind the main bearing and in front of the ring
    r_seat_out: Numbers
    r_flange: Numbers
    r_flange_bolts: Numbers
    r_lip: Numbers
    r_ring_lip: Numbers
    r_rear_seat: Numbers  #: of the rear bearing's seat


def internal_layout(at: Layout, motor: Motor, settings: ActuatorSettings) -> InternalLayout:
    """Return the layout of an ISSPG behind its front, for one gear set or for arrays of them."""
    data, kit = settings.parts, frameless(motor)
    casing = data.casing
    assert kit.stator_height_mm is not None
    # Where the main bearing is too large for the stator's bore, its seat stands in front of the stator.
    fits = at.r_seat + casing.ring_wall_mm <= at.r_stator_in
    r_seat_out = np.where(fits, at.r_stator_in, at.r_seat + casing.ring_wall_mm)[()]
    z_flange = -(casing.plate_mm + casing.flange_mm)
    z_lip = at.z_shoulder
    z_free = np.where(fits, z_flange, z_lip)[()] - casing.rotor_clearance_mm
    # The rotor's cavity is as high as the stator, and the rotor needs axial clearance to the second carrier.
    z_bell = np.minimum(
        z_free - kit.stator_height_mm - casing.rotor_clearance_mm,
        at.z_secondary_back - casing.motor_carrier_clearance_mm,
    )
    z_coupling = z_bell - kit.bell_thickness_mm
    z_seat = z_coupling - data.coupling.thickness_mm - casing.bearing_play_mm
    z_plate = z_seat - at.rear_bearing.width_mm
    r_shoulder = at.r_bore + data.carrier.shoulder_height_mm
    r_flange = r_seat_out + casing.flange_width_mm - _FLANGE_LESS_MM
    return InternalLayout(
        z_flange=z_flange,
        z_lip=z_lip,
        z_bell=z_bell,
        z_stator_back=z_bell + casing.rotor_clearance_mm,
        z_coupling=z_coupling,
        z_seat=z_seat,
        z_plate=z_plate,
        z_end=z_plate - casing.wall_mm,
        neck=sun_neck(at, settings),
        r_seat_out=r_seat_out,
        r_flange=r_flange,
        r_flange_bolts=r_flange - 0.5 * (casing.flange_width_mm - _FLANGE_LESS_MM),
        # It holds the bearing's outer ring and the ring gear, and clears the carrier's shoulder.
        r_lip=np.maximum(
            np.minimum(at.r_seat - casing.lip_mm, at.r_ring - 0.5 * casing.ring_lip_mm),
            r_shoulder + casing.rotor_clearance_mm,
        ),
        # Its corner clears the shoulder's corner, which turns in the same plane.
        r_ring_lip=np.maximum(at.r_ring - 0.5 * casing.ring_lip_mm, r_shoulder + casing.shoulder_clearance_mm),
        r_rear_seat=0.5 * at.rear_bearing.outer_diameter_mm,
    )


def frameless(motor: Motor) -> FramelessMotor:
    """Return the frameless motor, which every ISSPG has."""
    assert motor.frameless is not None
    return motor.frameless


def vents(inner_mm: Numbers, outer_mm: Numbers, wall_mm: float) -> tuple[Pattern, ...]:
    """Return as many round holes as fit between two radii, ``wall_mm`` around each; none if they were below M3."""
    radius, middle = 0.5 * (outer_mm - inner_mm) - wall_mm, 0.5 * (outer_mm + inner_mm)
    count = np.floor(np.pi / np.arcsin(np.clip((radius + wall_mm) / middle, 0.01, 1.0)))
    count = np.where(radius >= M3.hole, count, 0.0)[()]
    if np.ndim(count) == 0 and count == 0.0:
        return ()
    return (Pattern(radius_mm=radius, pitch_radius_mm=middle, count=count),)
