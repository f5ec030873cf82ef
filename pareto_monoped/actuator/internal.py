"""Parts of the ISSPG: gearbox inside the stator of the frameless motor."""

import numpy as np

from pareto_monoped.actuator.common import (
    GEAR_NOTE,
    M3_CLEARANCE_MM,
    M3_THREAD_MM,
    bought_bearing,
    carrier_parts,
    case_holes,
    gear_parts,
    slab,
    spigot,
    told,
    tube,
    vents,
)
from pareto_monoped.actuator.layout import Layout
from pareto_monoped.actuator.motors import Motor
from pareto_monoped.actuator.settings import ActuatorSettings
from pareto_monoped.geometry.parts import Part
from pareto_monoped.geometry.roles import Group, Joint, JointKind, Role, Visibility
from pareto_monoped.geometry.screws import M3, screw_part
from pareto_monoped.geometry.shapes import Pattern

_END_PLAY_MM = 0.5
"""From the sun shaft's end to the output face."""
_NECK_RADIUS_MM = 3.8
"""Of the sun's neck, which touches the inner ring of its end bearing only (619/6: abutment from 7.6 mm diameter)."""
_NECK_PLAY_MM = 0.2
"""Axial play of the rotor between end bearing and rear bearing."""
_HUB_WALL_MM = 1.2
"""Of the coupling's hub, which touches the inner ring of the rear bearing only (6800: abutment 12 mm)."""
BACK_THREAD_MM = 6.0
"""Depth of the motor's own pattern in the backplate: M5 screws need more than the case's M3."""


def internal_parts(at: Layout, motor: Motor, settings: ActuatorSettings) -> tuple[Part, ...]:
    """All parts of an ISSPG, or of many at once.

    The ring housing is one turned piece, solid between ring and stator: it carries the main bearing, the ring and the
    stator, takes the stator's torque and its heat. Where the gears need more depth than the stator has, the stator
    sits further back on it and the case grows.
    """
    data, materials = settings.parts, settings.materials
    case, coupling = data.case, data.coupling
    kit = motor.frameless
    assert kit is not None
    assert kit.stator_height_mm is not None
    height, bell = kit.stator_height_mm, kit.bell_thickness_mm

    # Where the main bearing is too large for the stator's bore, its seat stands in front of the stator.
    fits = at.r_seat + case.ring_wall_mm <= at.r_stator_in
    r_seat_out = np.where(fits, at.r_stator_in, at.r_seat + case.ring_wall_mm)[()]
    z_flange = -(case.plate_mm + case.flange_mm)
    z_lip = at.z_shoulder
    z_free = np.where(fits, z_flange, z_lip)[()] - case.rotor_clearance_mm
    # The rotor's cavity is as high as the stator; turned past each other with play at the back.
    z_bell = np.minimum(
        z_free - height - case.rotor_clearance_mm, at.z_secondary_back - case.motor_carrier_clearance_mm
    )
    z_stator_back = z_bell + case.rotor_clearance_mm
    z_coupling = z_bell - bell
    z_seat = z_coupling - coupling.thickness_mm - case.bearing_play_mm
    z_plate = z_seat - at.rear_bearing.width_mm
    z_end = z_plate - case.wall_mm

    r_flange = r_seat_out + case.flange_width_mm - 1.0
    flange_bolts = r_flange - 0.5 * (case.flange_width_mm - 1.0)
    count = data.interface.mount_bolt_count
    flange_threads = Pattern(radius_mm=M3_THREAD_MM, pitch_radius_mm=flange_bolts, count=count)
    flange_screws = Pattern(radius_mm=M3_CLEARANCE_MM, pitch_radius_mm=flange_bolts, count=count)
    mount, back = case_holes(at, settings), case_holes(at, settings, M3_CLEARANCE_MM)
    bell_circle = 0.5 * coupling.bolt_circle_mm
    bell_screws = Pattern(radius_mm=M3_CLEARANCE_MM, pitch_radius_mm=bell_circle, count=coupling.bolt_count)
    bell_threads = Pattern(radius_mm=M3_THREAD_MM, pitch_radius_mm=bell_circle, count=coupling.bolt_count)

    # Opening of the lip behind the main bearing: holds its outer ring and the ring gear, clears the carrier's shoulder.
    r_lip = np.maximum(
        np.minimum(at.r_seat - case.lip_mm, at.r_ring - 0.5 * case.ring_lip_mm),
        at.r_bore + data.carrier.shoulder_height_mm + case.rotor_clearance_mm,
    )
    shaft, journal = coupling.shaft_radius_mm, 0.5 * at.end_bearing.inner_diameter_mm
    z_neck = -at.end_bearing.width_mm - _NECK_PLAY_MM
    neck = np.maximum(journal, np.minimum(_NECK_RADIUS_MM, at.r_carrier_in - case.rotor_clearance_mm))[()]
    rear_seat = 0.5 * at.rear_bearing.outer_diameter_mm
    rotor_share = motor.rotor_share()
    mount_holes = motor.mount_holes
    assert mount_holes is not None
    r_mount = 0.5 * (mount_holes.pitch_circle_mm + mount_holes.diameter_mm)
    front_vents = vents(r_flange, at.r_case, case.vent_wall_mm)
    # A pad behind the motor's own bolt pattern gives its threads the same depth as the mounting threads.
    back_threads = back_holes(motor, -0.8)
    r_pad = 0.5 * (mount_holes.pitch_circle_mm - mount_holes.diameter_mm) - 0.5
    back_vents = vents(r_mount + case.vent_wall_mm, at.r_case, case.vent_wall_mm)
    return (
        *gear_parts(at, settings),
        *carrier_parts(at, settings),
        Part(
            name="sun",
            role=Role.GEAR,
            visibility=Visibility.INSIDE,
            material=materials.gear_steel,
            prisms=(
                *slab(z_neck, -_END_PLAY_MM, journal),
                *slab(at.z_gear_front, z_neck, neck),
                *slab(at.z_gear_back, at.z_gear_front, at.gears.sun(data.gears.backlash_mm)),
                *slab(z_plate, at.z_gear_back, shaft),
            ),
            process="machined",
            group=Group.ROTOR,
            note=told(
                "one piece with its shaft; " + GEAR_NOTE, at.gears.sun_teeth, at.gears.module_mm, data.gears.backlash_mm
            ),
            joint=Joint(kind=JointKind.PRESSED, how="pressed into", partner="coupling"),
        ),
        Part(
            name="coupling",
            role=Role.COUPLING,
            visibility=Visibility.INSIDE,
            material=materials.aluminium,
            prisms=(
                *slab(z_coupling - coupling.thickness_mm, z_coupling, coupling.radius_mm, shaft, bell_threads),
                *tube(z_seat, z_coupling - coupling.thickness_mm, shaft + _HUB_WALL_MM, shaft),
            ),
            process="machined",
            group=Group.ROTOR,
            note="screwed to the bell",
        ),
        Part(
            name="casing",
            role=Role.HOUSING,
            material=materials.aluminium,
            prisms=(
                *slab(-case.plate_mm, 0.0, at.r_plate, at.r_open, mount, flange_screws, *front_vents),
                *tube(at.z_bearing_front, -case.plate_mm, at.r_seat, at.r_open),
                *tube(-case.rim_mm, -case.plate_mm, at.r_plate, at.r_case, mount),
                *tube(z_plate + case.flange_mm, -case.rim_mm, at.r_case + case.wall_mm, at.r_case),
                *tube(z_plate, z_plate + case.flange_mm, at.r_plate, at.r_case, mount),
            ),
            process="machined",
            group=Group.HOUSING,
            note="EN AW-6082; bore and faces in one clamping",
        ),
        Part(
            name="ring_housing",
            role=Role.HOUSING,
            material=materials.aluminium,
            prisms=(
                *tube(z_flange, -case.plate_mm, r_flange, at.r_seat, flange_threads),
                *tube(at.z_bearing_back, z_flange, r_seat_out, at.r_seat),
                *tube(z_lip, at.z_bearing_back, r_seat_out, r_lip),
                *tube(at.z_gear_front, z_lip, at.r_stator_in, at.r_ring - 0.5 * case.ring_lip_mm),
                *tube(at.z_gear_back, at.z_gear_front, at.r_stator_in, at.r_ring),
                *tube(
                    np.minimum(z_stator_back, at.z_gear_back),
                    at.z_gear_back,
                    at.r_stator_in,
                    at.r_stator_in - case.ring_wall_mm,
                ),
            ),
            process="machined",
            group=Group.HOUSING,
            note=told(
                "EN AW-6082; seats {} J7 for the main bearing, {} H7 for the ring, {} for the stator",
                2.0 * at.r_seat,
                2.0 * at.r_ring,
                2.0 * at.r_stator_in,
            ),
        ),
        Part(
            name="backplate",
            role=Role.HOUSING,
            material=materials.aluminium,
            prisms=(
                *slab(z_end, z_plate, at.r_plate, rear_seat - case.lip_mm, back, back_threads, *back_vents),
                *tube(z_plate, z_end + BACK_THREAD_MM, r_mount + 0.5, r_pad, back_threads),
                *tube(z_plate, z_seat, rear_seat + case.seat_wall_mm, rear_seat),
                *spigot(z_plate, at, settings),
            ),
            process="machined",
            group=Group.HOUSING,
            note=told("EN AW-6082; seat {} J7 for the rear bearing, step to fit the casing", 2.0 * rear_seat),
        ),
        screw_part(
            "ring_housing_screw",
            M3,
            head="countersunk",
            seat_mm=0.0,
            grip_mm=case.plate_mm,
            room_mm=case.flange_mm,
            direction=-1.0,
            material=materials.steel,
            count=count,
            pitch_radius_mm=flange_bolts,
            group=Group.HOUSING,
            note="flush with the mounting face",
        ),
        screw_part(
            "backplate_screw",
            M3,
            head="cap",
            seat_mm=z_end,
            grip_mm=case.wall_mm,
            room_mm=case.flange_mm,
            direction=1.0,
            material=materials.steel,
            count=count,
            pitch_radius_mm=at.r_bolts,
            group=Group.HOUSING,
            note="into the casing",
        ),
        screw_part(
            "coupling_screw",
            M3,
            head="countersunk",
            seat_mm=z_bell,
            grip_mm=bell,
            room_mm=coupling.thickness_mm,
            direction=-1.0,
            material=materials.steel,
            count=coupling.bolt_count,
            pitch_radius_mm=bell_circle,
            group=Group.ROTOR,
            note="through the bell into the coupling, flush",
        ),
        bought_bearing(
            "rear_bearing",
            materials.bearing_steel,
            at.rear_bearing,
            z_seat,
            Group.HOUSING,
            "carries the rotor",
            joint=Joint(kind=JointKind.PRESSED, how="pressed into", partner="backplate"),
        ),
        Part(
            name="motor_stator",
            role=Role.MOTOR_STATOR,
            visibility=Visibility.INSIDE,
            material=materials.motor_stator,
            prisms=tube(z_stator_back, z_stator_back + height, at.r_stator_out, at.r_stator_in),
            process="bought",
            group=Group.HOUSING,
            catalogue_mass_kg=(1.0 - rotor_share) * kit.mass_kg,
            note=f"{motor.name}, frameless",
            joint=Joint(kind=JointKind.BONDED, how="bonded onto", partner="ring_housing"),
        ),
        Part(
            name="motor_rotor",
            role=Role.MOTOR_ROTOR,
            material=materials.motor_rotor,
            prisms=(
                *tube(z_bell, z_bell + height, at.r_motor, at.r_rotor_in),
                *slab(z_coupling, z_bell, at.r_motor, shaft + 1.0, bell_screws),
            ),
            process="bought",
            group=Group.ROTOR,
            catalogue_mass_kg=rotor_share * kit.mass_kg,
            note=f"{motor.name}, frameless",
        ),
    )


def back_holes(motor: Motor, play_mm: float) -> Pattern:
    """The motor's own mounting pattern in the backplate.

    Args:
        motor: which one.
        play_mm: added to the diameter: 0.5 for clearance holes, -0.8 for threads.
    """
    holes = motor.mount_holes
    assert holes is not None
    return Pattern(
        radius_mm=0.5 * (holes.diameter_mm + play_mm), pitch_radius_mm=0.5 * holes.pitch_circle_mm, count=holes.count
    )
