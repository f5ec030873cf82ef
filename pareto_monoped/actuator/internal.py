"""Parts of the ISSPG: gearbox inside the stator of the frameless motor."""

from dataclasses import replace

import numpy as np

from pareto_monoped.actuator.features import (
    MOTOR_TAPPED_HOLE_MM,
    SPIGOT_MM,
    backplate_screw,
    bought_bearing,
    casing_dowel_holes,
    casing_holes,
    coupling_dowels,
    coupling_part,
    encoder_parts,
    housing_part,
    housing_screw,
    magnet_centre,
    motor_holes,
    rotor_part,
    shaft_end,
    skirt,
    slab,
    spigot,
    stator_part,
    sun_part,
    tube,
)
from pareto_monoped.actuator.front import carrier_parts, gear_parts
from pareto_monoped.actuator.layout import (
    COUPLING_DOWEL,
    DOWEL_STANDS_OUT_MM,
    NECK_SET,
    InternalLayout,
    Layout,
    frameless,
    internal_layout,
    vents,
)
from pareto_monoped.actuator.motor import Motor, envelope_length, motor_order
from pareto_monoped.actuator.settings import ActuatorSettings
from pareto_monoped.geometry.dowels import Dowel, dowel_part
from pareto_monoped.geometry.features import bored, turned
from pareto_monoped.geometry.making import FINE_MM, RELIEF_MM, Fit, Length, narrower, wider
from pareto_monoped.geometry.parts import Part
from pareto_monoped.geometry.roles import BEARING_RETAINER, RETAINER, Group, Joint, JointKind
from pareto_monoped.geometry.screws import M3, clearance, screw_for, screw_part, tapped
from pareto_monoped.geometry.shapes import Circle, Pattern

FLANGE_DOWEL = Dowel(diameter_mm=2.5)
"""Between ring housing and casing; our own choice: the thinnest sold whose length is that of both flanges."""
BACK_THREAD_MM = 6.0
"""Depth of the motor's own pattern in the backplate: M5 screws need more than the casing's M3."""
_HUB_WALL_MM = 1.2
"""Of the coupling's hub, which touches the inner ring of the rear bearing only (6800: abutment 12 mm)."""
_PAD_RIM_MM = 0.5
"""Metal inside and outside the threads in the backplate's pad; our own choice."""
_LEAST_GAP_MM = 2.0
"""Between pad and seat, which are one where it would be narrower: an end mill's diameter; our own choice."""
_BEHIND_RING_MM = 0.4
"""How much wider than its seat the bore is through which the ring gear enters: more than the seat's chamfer of 0.3 mm;
our own choice."""
_BELL_PLAY_MM = 0.5
"""From the spline of the sun's shaft, which is put through the bell, to the bell's bore; our own choice."""


def internal_parts(at: Layout, motor: Motor, settings: ActuatorSettings) -> tuple[Part, ...]:
    """Build all parts of an ISSPG, or of many at once.

    The ring housing is one turned piece, solid between ring and stator. It carries the main bearing, the ring and the
    stator, whose torque and heat it takes up. Where the gears need more depth than the stator has, the stator sits
    further back and the casing is longer.
    """
    shell = internal_layout(at, motor, settings)
    return (
        *gear_parts(at, settings),
        *carrier_parts(at, settings),
        *_turning_parts(at, shell, settings),
        *_casing_and_ring_housing(at, shell, settings),
        _flange_dowels(shell, settings),
        _backplate(at, shell, motor, settings),
        *_screws(at, shell, motor, settings),
        bought_bearing(
            "rear_bearing",
            settings.materials.bearing_steel,
            at.rear_bearing,
            shell.z_seat,
            Group.HOUSING,
            "carries the rotor",
            joint=Joint(
                kind=JointKind.BONDED,
                how="bonded onto the sun and into",
                partner="backplate",
                adhesive=BEARING_RETAINER,
            ),
        ),
        *_motor_parts(at, shell, motor, settings),
        *encoder_parts(shell.z_plate, shell.z_end, shell.r_rear_seat - settings.parts.casing.lip_mm, "sun"),
    )


def _turning_parts(at: Layout, shell: InternalLayout, settings: ActuatorSettings) -> tuple[Part, ...]:
    """Build what turns with the motor: the sun in one piece with its splined shaft, and the coupling to the bell."""
    coupling, spline = settings.parts.coupling, settings.parts.spline.internal
    shaft, (relief, depth) = coupling.shaft_radius_mm, RELIEF_MM
    z_hub, threads, dowels = (
        shell.z_coupling - coupling.thickness_mm,
        _bell_holes(settings, M3.core),
        _bell_dowel_holes(settings),
    )
    return (
        replace(
            sun_part(
                at,
                shell.neck,
                settings,
                spline,
                shaft,
                behind=(
                    *slab(shell.z_coupling, at.z_gear_back, shaft - depth),
                    *slab(z_hub, shell.z_coupling, spline),
                    *slab(z_hub - relief, z_hub, shaft - depth),
                    *shaft_end(shell.z_plate, z_hub - relief, shaft),
                ),
                seat_mm=shaft,
                rear=magnet_centre(shell.z_plate),
            ),
            at_assembly=NECK_SET,
        ),
        coupling_part(
            (
                *slab(z_hub, shell.z_coupling, coupling.radius_mm, spline, threads, dowels),
                *tube(shell.z_seat, z_hub, shaft + _HUB_WALL_MM, shaft),
            ),
            spline,
            tapped(M3, (threads,), z_hub, shell.z_coupling, enters="high"),
            "bell",
            settings,
        ),
        coupling_dowels(dowels, z_hub, shell.z_bell - z_hub + DOWEL_STANDS_OUT_MM, "bell", settings),
    )


def _bell_holes(settings: ActuatorSettings, radius_mm: float) -> Pattern:
    coupling = settings.parts.coupling
    return Pattern(radius_mm=radius_mm, pitch_radius_mm=0.5 * coupling.bolt_circle_mm, count=coupling.bolt_count)


def _bell_dowel_holes(settings: ActuatorSettings) -> Pattern:
    """Return one hole for a dowel between every two of these bolts."""
    return COUPLING_DOWEL.between(_bell_holes(settings, M3.hole))


def _flange_holes(shell: InternalLayout, settings: ActuatorSettings, radius_mm: float) -> Pattern:
    """Return the bolt pattern between casing and ring housing."""
    return Pattern(
        radius_mm=radius_mm, pitch_radius_mm=shell.r_flange_bolts, count=settings.parts.interface.mount_bolt_count
    )


def _flange_dowel_holes(shell: InternalLayout, settings: ActuatorSettings) -> Pattern:
    """Return the holes for dowels in every second gap of these bolts: they carry the ring's torque."""
    return FLANGE_DOWEL.between(_flange_holes(shell, settings, M3.hole), every=2)


def _casing_and_ring_housing(at: Layout, shell: InternalLayout, settings: ActuatorSettings) -> tuple[Part, ...]:
    casing, aluminium = settings.parts.casing, settings.materials.aluminium
    mount, screws = casing_holes(at, settings), _flange_holes(shell, settings, M3.hole)
    threads = _flange_holes(shell, settings, M3.core)
    dowels, flange_dowels = casing_dowel_holes(at, settings), _flange_dowel_holes(shell, settings)
    front_vents = vents(shell.r_flange, at.r_casing, casing.vent_wall_mm)
    z_plate, z_flange, z_lip = shell.z_plate, shell.z_flange, shell.z_lip
    z_back = np.minimum(shell.z_stator_back, at.z_gear_back)
    r_behind = np.maximum(at.r_stator_in - casing.ring_wall_mm, at.r_ring + _BEHIND_RING_MM)
    return (
        housing_part(
            name="casing",
            material=aluminium,
            prisms=(
                *slab(-casing.plate_mm, 0.0, at.r_plate, at.r_open, mount, dowels, screws, flange_dowels, *front_vents),
                *tube(at.z_bearing_front, -casing.plate_mm, at.r_seat, at.r_open),
                *tube(-casing.rim_mm, -casing.plate_mm, at.r_plate, at.r_casing, mount, dowels),
                *skirt(z_plate + casing.flange_mm, -casing.rim_mm, at, settings, at.r_bolts),
                *tube(z_plate, z_plate + casing.flange_mm, at.r_plate, at.r_casing, mount),
            ),
            features=(
                clearance(M3, (screws,), -casing.plate_mm, 0.0, countersunk="high"),
                tapped(M3, (mount,), -casing.rim_mm, 0.0, enters="high"),
                tapped(M3, (mount,), z_plate, z_plate + casing.flange_mm, enters="low"),
                bored(Circle(radius_mm=at.r_casing), z_plate, -casing.plate_mm, enters="low"),
            ),
            fits=(Dowel(diameter_mm=settings.parts.interface.mount_dowel_mm).hole_fit, FLANGE_DOWEL.hole_fit),
            lengths=(
                narrower("register", at.z_bearing_front, -casing.plate_mm),
                Length(name="length", z0_mm=z_plate, z1_mm=-casing.plate_mm, lower_mm=0.0, upper_mm=2.0 * FINE_MM),
            ),
            registers=(Fit(diameter_mm=2.0 * at.r_seat, zone="h7"), Fit(diameter_mm=2.0 * at.r_casing, zone="H7")),
            note="bore, faces and the register to the ring housing in one clamping; the bore takes the backplate's "
            f"step, {SPIGOT_MM:g} mm",
        ),
        housing_part(
            name="ring_housing",
            material=aluminium,
            prisms=(
                *tube(z_flange, -casing.plate_mm, shell.r_flange, at.r_seat, threads, flange_dowels),
                *tube(at.z_bearing_back, z_flange, shell.r_seat_out, at.r_seat),
                *tube(z_lip, at.z_bearing_back, shell.r_seat_out, shell.r_lip),
                *tube(at.z_gear_front, z_lip, at.r_stator_in, shell.r_ring_lip),
                *tube(at.z_gear_back, at.z_gear_front, at.r_stator_in, at.r_ring),
                *tube(z_back, at.z_gear_back, at.r_stator_in, r_behind),
            ),
            fits=(
                Fit(diameter_mm=2.0 * at.r_seat, zone="H7", seat=True),
                Fit(diameter_mm=2.0 * at.r_ring, zone="H7", seat=True),
                # A gap of 0.01 to 0.06 mm for the bond of a stator whose bore is H7; our own choice.
                Fit(diameter_mm=2.0 * at.r_stator_in, zone="g6"),
                FLANGE_DOWEL.hole_fit,
            ),
            lengths=(
                wider("seat", at.z_bearing_back, -casing.plate_mm),
                Length(name="length", z0_mm=z_back, z1_mm=-casing.plate_mm, lower_mm=-2.0 * FINE_MM, upper_mm=0.0),
            ),
            features=(
                tapped(M3, (threads,), z_flange, -casing.plate_mm, enters="high"),
                bored(Circle(radius_mm=at.r_seat), at.z_bearing_back, -casing.plate_mm, enters="high"),
                bored(Circle(radius_mm=at.r_ring), at.z_gear_back, at.z_gear_front, enters="low"),
            ),
            note="" if np.ndim(at.r_stator_in) else f"{2.0 * at.r_stator_in:g} mm outside to fit the stator",
        ),
    )


def _flange_dowels(shell: InternalLayout, settings: ActuatorSettings) -> Part:
    casing, holes = settings.parts.casing, _flange_dowel_holes(shell, settings)
    return dowel_part(
        "ring_housing_dowel",
        FLANGE_DOWEL,
        end_mm=shell.z_flange,
        room_mm=casing.plate_mm + casing.flange_mm,
        direction=1.0,
        material=settings.materials.steel,
        holes=holes,
        group=Group.HOUSING,
        partner="ring_housing",
        note="flush with the mounting face",
    )


def _backplate(at: Layout, shell: InternalLayout, motor: Motor, settings: ActuatorSettings) -> Part:
    """Build the plate with the rear bearing's seat and, on a pad that gives threads their depth, the motor's bolts."""
    casing = settings.parts.casing
    holes, rear_seat, z_plate = motor.mount_holes, shell.r_rear_seat, shell.z_plate
    assert holes is not None
    back, threads = casing_holes(at, settings, M3.hole), motor_holes(motor, MOTOR_TAPPED_HOLE_MM)
    r_mount = 0.5 * (holes.pitch_circle_mm + holes.diameter_mm)
    r_boss = rear_seat + casing.seat_wall_mm
    r_free = 0.5 * (holes.pitch_circle_mm - holes.diameter_mm) - _PAD_RIM_MM
    r_pad = np.where(r_free < r_boss + _LEAST_GAP_MM, r_boss, r_free)[()]
    back_vents = vents(r_mount + casing.vent_wall_mm, at.r_casing, casing.vent_wall_mm)
    return housing_part(
        name="backplate",
        material=settings.materials.aluminium,
        prisms=(
            *slab(shell.z_end, z_plate, at.r_plate, rear_seat - casing.lip_mm, back, threads, *back_vents),
            *tube(z_plate, shell.z_end + BACK_THREAD_MM, r_mount + _PAD_RIM_MM, r_pad, threads),
            *tube(z_plate, shell.z_seat, r_boss, rear_seat),
            *spigot(z_plate, at, settings),
        ),
        fits=(Fit(diameter_mm=2.0 * rear_seat, zone="H7", seat=True),),
        features=(
            tapped(
                screw_for(holes.diameter_mm, 0.5 * (holes.diameter_mm + MOTOR_TAPPED_HOLE_MM)),
                (threads,),
                shell.z_end,
                shell.z_end + BACK_THREAD_MM,
                enters="low",
            ),
            bored(Circle(radius_mm=rear_seat), z_plate, shell.z_seat, enters="high"),
            turned(at.r_casing, z_plate + SPIGOT_MM, -1.0),
        ),
        registers=(
            Fit(diameter_mm=2.0 * at.r_casing, zone="h7"),
            Fit(diameter_mm=2.0 * (rear_seat - casing.lip_mm), zone="H7"),
        ),
        note="the step is the register in the casing, the bore takes the encoder's cap; tap the motor's pattern before "
        f"the rims of its pad are turned {_PAD_RIM_MM:g} mm beside the threads",
    )


def _screws(at: Layout, shell: InternalLayout, motor: Motor, settings: ActuatorSettings) -> tuple[Part, ...]:
    casing, coupling, steel = settings.parts.casing, settings.parts.coupling, settings.materials.steel
    return (
        housing_screw(
            "ring_housing_screw",
            settings,
            head="countersunk",
            seat_mm=0.0,
            grip_mm=casing.plate_mm,
            direction=-1.0,
            holes=_flange_holes(shell, settings, M3.hole),
            note="flush with the mounting face",
        ),
        backplate_screw(at, shell.z_end, casing.wall_mm, settings),
        screw_part(
            "coupling_screw",
            M3,
            head="countersunk",
            seat_mm=shell.z_bell,
            grip_mm=frameless(motor).bell_thickness_mm,
            room_mm=coupling.thickness_mm,
            direction=-1.0,
            material=steel,
            holes=_bell_holes(settings, M3.hole),
            group=Group.ROTOR,
            note="through the bell into the coupling, flush",
        ),
    )


def _motor_parts(at: Layout, shell: InternalLayout, motor: Motor, settings: ActuatorSettings) -> tuple[Part, ...]:
    """Build the envelopes of stator and rotor, with their shares of the motor's mass."""
    kit, rotor_share = frameless(motor), motor.rotor_mass_share
    height = kit.stator_height_mm
    assert height is not None
    bell_bore = float(settings.parts.spline.internal.tip_radius_mm) + _BELL_PLAY_MM
    z_bell, z_stator_back, screws = shell.z_bell, shell.z_stator_back, _bell_holes(settings, M3.hole)
    return (
        stator_part(
            material=settings.materials.motor_stator,
            prisms=tube(z_stator_back, z_stator_back + height, at.r_stator_out, at.r_stator_in),
            catalogue_mass_kg=(1.0 - rotor_share) * kit.mass_kg,
            catalogue_price_eur=motor.price_share_eur(1.0 - rotor_share),
            purchases=(motor_order(motor, "frameless"),),
            note="stator",
            at_assembly="the rotor's magnets pull it in: guide it along three rods in screw holes, fingers clear",
            joint=Joint(kind=JointKind.BONDED, how="bonded onto", partner="ring_housing", adhesive=RETAINER),
        ),
        rotor_part(
            material=settings.materials.motor_rotor,
            prisms=(
                *tube(z_bell, z_bell + height, at.r_motor, at.r_rotor_in),
                *slab(shell.z_coupling, z_bell, at.r_motor, bell_bore, screws, _bell_dowel_holes(settings)),
            ),
            catalogue_mass_kg=rotor_share * kit.mass_kg,
            lengths=(envelope_length(shell.z_coupling, z_bell, name="bell"),),
            catalogue_price_eur=motor.price_share_eur(rotor_share),
            features=(clearance(M3, (screws,), shell.z_coupling, z_bell, countersunk="high"),),
            purchases=(replace(motor_order(motor, "frameless"), count=0.0),),
            note="rotor, comes with the stator; countersink the bell's holes "
            f"{2.0 * M3.countersunk:.1f} mm wide at 90 degrees, so that heads are flush",
        ),
    )
