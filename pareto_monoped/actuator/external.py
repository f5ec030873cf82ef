"""Parts of the ESSPG: gearbox in front of the framed motor."""

import numpy as np

from pareto_monoped.actuator.common import (
    GEAR_NOTE,
    M3_CLEARANCE_MM,
    M3_THREAD_MM,
    RING_GROOVE_MM,
    carrier_parts,
    case_holes,
    gear_parts,
    slab,
    spigot,
    told,
    tube,
    vents,
)
from pareto_monoped.actuator.internal import back_holes
from pareto_monoped.actuator.layout import Layout
from pareto_monoped.actuator.motors import Motor
from pareto_monoped.actuator.settings import ActuatorSettings
from pareto_monoped.geometry.parts import Part
from pareto_monoped.geometry.roles import Group, Joint, JointKind, Role, Visibility
from pareto_monoped.geometry.screws import M3, screw_for, screw_part
from pareto_monoped.geometry.shapes import Pattern

_END_PLAY_MM = 0.5
_BORE_RING_MM = 1.5
"""Thickness of the retaining ring behind the main bearing: DIN 472 has 1.5 to 2.5 mm in the range used."""
_GROOVE_WALL_MM = 1.0
"""What is left of the bearing's seat behind that ring's groove."""
_FLANGE_WIDTH_MM = 6.0
_FLANGE_BOLTS_MM = 3.2
"""Of the flange between ring housing and casing, and from the tube to its bolt circle: a hexagon head of M3, 6.01 mm
over its corners, turns beside the tube; a spanner reaches it from the side, where the front plate bars a key."""
_RING_STEP_MM = 1.0
"""How far the ring stands out of its housing into the casing, which it centres."""
MOTOR_THREAD_MM = 5.0
"""How deep screws go into the base of a framed motor: M5 x 8 through the backplate."""
_HUB_MM = 4.0
"""Metal around the sun's shaft in the coupling."""


def external_parts(at: Layout, motor: Motor, settings: ActuatorSettings) -> tuple[Part, ...]:
    """All parts of an ESSPG, or of many at once.

    The motor's base is screwed to the backplate, its turning face carries the coupling with the sun's shaft; the casing
    is the bridge around the motor from the backplate to the ring housing, which carries ring and main bearing.
    """
    data, materials = settings.parts, settings.materials
    case, coupling = data.case, data.coupling
    frame = motor.framed
    assert frame is not None
    assert motor.output_holes is not None

    z_coupling = at.z_secondary_back - case.motor_carrier_clearance_mm
    z_motor = z_coupling - coupling.thickness_mm
    z_plate = z_motor - frame.length_mm
    z_end = z_plate - case.plate_mm
    z_groove_back = at.z_bearing_back - _BORE_RING_MM
    z_seat_back = z_groove_back - _GROOVE_WALL_MM
    z_flange = at.z_gear_back + _RING_STEP_MM
    z_web = z_flange - case.flange_mm

    r_boss = at.r_seat + case.seat_wall_mm
    r_tube = np.maximum(at.r_ring + case.ring_wall_mm, r_boss)
    r_tube_in = np.maximum(at.r_ring - case.ring_lip_mm, r_boss)
    r_flange = r_tube + _FLANGE_WIDTH_MM
    r_web = np.maximum(r_flange, at.r_case + case.wall_mm)
    bolts = r_tube + _FLANGE_BOLTS_MM
    count = data.interface.mount_bolt_count
    threads = Pattern(radius_mm=M3_THREAD_MM, pitch_radius_mm=bolts, count=count)
    screws = Pattern(radius_mm=M3_CLEARANCE_MM, pitch_radius_mm=bolts, count=count)
    mount, back = case_holes(at, settings), case_holes(at, settings, M3_CLEARANCE_MM)
    shaft = 0.5 * data.gears.sun_bore_mm

    output = motor.output_holes
    rotor_screws = Pattern(
        radius_mm=0.5 * output.diameter_mm + 0.1, pitch_radius_mm=0.5 * output.pitch_circle_mm, count=output.count
    )
    rotor_threads = Pattern(
        radius_mm=0.5 * output.diameter_mm - 0.25, pitch_radius_mm=0.5 * output.pitch_circle_mm, count=output.count
    )
    r_coupling = 0.5 * (output.pitch_circle_mm + output.diameter_mm) + coupling.rim_mm - 1.5
    # Lightening holes between hub and bolt circle, as large as webs of 2 mm allow.
    low, high = shaft + _HUB_MM, 0.5 * (output.pitch_circle_mm - output.diameter_mm) - 2.0
    middle = 0.5 * (low + high)
    window = min(0.5 * (high - low) - 1.0, middle * np.sin(np.pi / 6.0) - 1.0)
    windows = (Pattern(radius_mm=window, pitch_radius_mm=middle, count=6),) if window >= 2.0 else ()

    rotor_share = motor.rotor_share()
    base = frame_base_mm(frame.length_mm)
    mount_holes = motor.mount_holes
    assert mount_holes is not None
    r_mount = 0.5 * (mount_holes.pitch_circle_mm + mount_holes.diameter_mm)
    back_vents = vents(r_mount + case.vent_wall_mm, at.r_case, case.vent_wall_mm)
    return (
        *gear_parts(at, settings),
        *carrier_parts(at, settings),
        Part(
            name="sun",
            role=Role.GEAR,
            visibility=Visibility.INSIDE,
            material=materials.gear_steel,
            prisms=slab(at.z_gear_back, at.z_gear_front, at.gears.sun(data.gears.backlash_mm), shaft),
            process="machined",
            group=Group.ROTOR,
            note=told(GEAR_NOTE, at.gears.sun_teeth, at.gears.module_mm, data.gears.backlash_mm),
            joint=Joint(kind=JointKind.PRESSED, how="pressed onto", partner="sun_shaft"),
        ),
        Part(
            name="sun_shaft",
            role=Role.SHAFT,
            visibility=Visibility.INSIDE,
            material=materials.steel,
            prisms=slab(z_motor, -_END_PLAY_MM, shaft),
            process="machined",
            group=Group.ROTOR,
            note="hardened dowel",
            joint=Joint(kind=JointKind.PRESSED, how="pressed into", partner="coupling"),
        ),
        Part(
            name="coupling",
            role=Role.COUPLING,
            visibility=Visibility.INSIDE,
            material=materials.aluminium,
            prisms=slab(z_motor, z_coupling, r_coupling, shaft, rotor_screws, *windows),
            process="machined",
            group=Group.ROTOR,
            note="screwed to the motor's turning face",
        ),
        Part(
            name="ring_housing",
            role=Role.HOUSING,
            material=materials.aluminium,
            prisms=(
                *slab(-case.plate_mm, 0.0, at.r_plate, at.r_open, mount),
                *tube(-case.rim_mm, -case.plate_mm, at.r_plate, at.r_case, mount),
                *tube(at.z_bearing_front, -case.plate_mm, r_boss, at.r_open),
                *tube(at.z_bearing_back, at.z_bearing_front, r_boss, at.r_seat),
                *tube(z_groove_back, at.z_bearing_back, r_boss, at.r_seat + RING_GROOVE_MM),
                *tube(z_seat_back, z_groove_back, r_boss, at.r_seat),
                *tube(z_seat_back, -case.plate_mm, r_tube, r_tube_in),
                *tube(at.z_gear_front, z_seat_back, r_tube, at.r_ring - case.ring_lip_mm),
                *tube(z_flange, at.z_gear_front, r_tube, at.r_ring),
                *tube(z_flange, z_flange + case.flange_mm, r_flange, r_tube, screws),
            ),
            process="machined",
            group=Group.HOUSING,
            note=told(
                "EN AW-6082; seats {} J7 for the main bearing, {} H7 for the ring", 2.0 * at.r_seat, 2.0 * at.r_ring
            ),
        ),
        Part(
            name="bore_retaining_ring",
            role=Role.RETAINING_RING,
            visibility=Visibility.INSIDE,
            material=materials.steel,
            prisms=tube(z_groove_back, at.z_bearing_back, at.r_seat + RING_GROOVE_MM, at.r_open),
            process="bought",
            group=Group.HOUSING,
            note=told("DIN 472 for {} mm, in the ring housing's groove behind the main bearing", 2.0 * at.r_seat),
        ),
        Part(
            name="casing",
            role=Role.HOUSING,
            material=materials.aluminium,
            prisms=(
                *tube(at.z_gear_back, z_flange, r_web, at.r_ring, threads),
                *tube(z_web, at.z_gear_back, r_web, at.r_ring - case.ring_lip_mm, threads),
                *tube(z_plate + case.flange_mm, z_web, at.r_case + case.wall_mm, at.r_case),
                *tube(z_plate, z_plate + case.flange_mm, at.r_plate, at.r_case, mount),
            ),
            process="machined",
            group=Group.HOUSING,
            note="EN AW-6082; bore and faces in one clamping",
        ),
        Part(
            name="backplate",
            role=Role.HOUSING,
            material=materials.aluminium,
            prisms=(
                *slab(z_end, z_plate, at.r_plate, 8.0, back, back_holes(motor, 0.5), *back_vents),
                *spigot(z_plate, at, settings),
            ),
            process="machined",
            group=Group.HOUSING,
            note="EN AW-6082; step to fit the casing",
        ),
        screw_part(
            "casing_screw",
            M3,
            head="hexagon",
            seat_mm=z_flange + case.flange_mm,
            grip_mm=case.flange_mm,
            room_mm=case.flange_mm,
            direction=-1.0,
            material=materials.steel,
            count=count,
            pitch_radius_mm=bolts,
            group=Group.HOUSING,
            note="from the ring housing into the casing",
        ),
        screw_part(
            "backplate_screw",
            M3,
            head="cap",
            seat_mm=z_end,
            grip_mm=case.plate_mm,
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
            screw_for(output.diameter_mm, 0.5 * output.diameter_mm - 0.25),
            head="countersunk",
            seat_mm=z_coupling,
            grip_mm=coupling.thickness_mm,
            room_mm=base,
            direction=-1.0,
            material=materials.steel,
            count=output.count,
            pitch_radius_mm=0.5 * output.pitch_circle_mm,
            group=Group.ROTOR,
            note="into the motor's turning face, flush",
        ),
        screw_part(
            "stator_screw",
            screw_for(mount_holes.diameter_mm, 0.5 * mount_holes.diameter_mm - 0.4),
            head="cap",
            seat_mm=z_end,
            grip_mm=case.plate_mm,
            room_mm=MOTOR_THREAD_MM,
            direction=1.0,
            material=materials.steel,
            count=mount_holes.count,
            pitch_radius_mm=0.5 * mount_holes.pitch_circle_mm,
            group=Group.HOUSING,
            role=Role.STATOR_SCREW,
            note="into the motor's base; left out where the journal's screws go there",
        ),
        Part(
            name="motor_stator",
            role=Role.MOTOR_STATOR,
            visibility=Visibility.INSIDE,
            material=materials.motor_stator,
            prisms=(
                *slab(z_plate, z_plate + base, at.r_stator_out, back_holes(motor, -0.8)),
                *tube(z_plate + base, z_motor - base - case.rotor_clearance_mm, at.r_stator_out, at.r_stator_in),
            ),
            process="bought",
            group=Group.HOUSING,
            catalogue_mass_kg=(1.0 - rotor_share) * frame.mass_kg,
            note=f"{motor.name}, framed: stator, base and bearings",
        ),
        Part(
            name="motor_rotor",
            role=Role.MOTOR_ROTOR,
            material=materials.motor_rotor,
            prisms=(
                *slab(z_motor - base, z_motor, at.r_motor, rotor_threads),
                *tube(z_plate + base, z_motor - base, at.r_motor, at.r_rotor_in),
            ),
            process="bought",
            group=Group.ROTOR,
            catalogue_mass_kg=rotor_share * frame.mass_kg,
            note=f"{motor.name}, framed: rotor with its face",
            joint=Joint(kind=JointKind.RUNNING, how="in the motor's own bearings on", partner="motor_stator"),
        ),
    )


def frame_base_mm(length_mm: float) -> float:
    """Thickness of base and face in the envelope of a framed motor: 3 mm, less for short ones."""
    return min(3.0, 0.1 * length_mm)
