"""The housing of the ESSPG: ring housing in front, casing around the motor, backplate, and what holds them together."""

from pareto_monoped.actuator.bearings import groove, ring_thickness
from pareto_monoped.actuator.features import (
    MOTOR_CLEARANCE_HOLE_MM,
    SPIGOT_MM,
    backplate_screw,
    casing_dowel_holes,
    casing_holes,
    housing_part,
    housing_screw,
    motor_holes,
    skirt,
    slab,
    spigot,
    tube,
)
from pareto_monoped.actuator.layout import ExternalLayout, Layout, vents
from pareto_monoped.actuator.motor import Motor
from pareto_monoped.actuator.settings import ActuatorSettings
from pareto_monoped.geometry.dowels import Dowel
from pareto_monoped.geometry.features import bored, turned
from pareto_monoped.geometry.making import FINE_MM, Fit, Length, narrower, wider
from pareto_monoped.geometry.parts import Part, steel_part
from pareto_monoped.geometry.roles import Group, Role, Visibility
from pareto_monoped.geometry.screws import M3, tapped
from pareto_monoped.geometry.shapes import Circle, Pattern

BACK_BORE_MM = 8.0
"""Radius of the backplate's central hole, behind the motor's shaft; our own choice."""


def housing_parts(at: Layout, shell: ExternalLayout, motor: Motor, settings: ActuatorSettings) -> tuple[Part, ...]:
    """Build what stands still around gears and motor."""
    return (
        *_ring_housing(at, shell, settings),
        *_casing_and_backplate(at, shell, motor, settings),
        *_housing_screws(at, shell, settings),
    )


def _flange_holes(shell: ExternalLayout, settings: ActuatorSettings, radius_mm: float) -> Pattern:
    """Return the bolt pattern of the flange between ring housing and casing."""
    return Pattern(radius_mm=radius_mm, pitch_radius_mm=shell.r_bolts, count=settings.parts.interface.mount_bolt_count)


def _ring_housing(at: Layout, shell: ExternalLayout, settings: ActuatorSettings) -> tuple[Part, ...]:
    """Build the ring housing, which carries main bearing and ring, and the retaining ring behind the bearing.

    A boss around the bearing ties the mounting face to the tube around the ring: one wall, turned from outside, where a
    tube around the boss would leave a slot too deep to cut.
    """
    casing, materials = settings.parts.casing, settings.materials
    z_seat_back, z_groove_back, z_groove = shell.z_seat_back, shell.z_groove_back, shell.z_groove
    z_flange, ring = shell.z_flange, at.bore_ring
    mount, screws = casing_holes(at, settings), _flange_holes(shell, settings, M3.hole)
    dowels = casing_dowel_holes(at, settings)
    return (
        housing_part(
            name="ring_housing",
            material=materials.aluminium,
            prisms=(
                *slab(-casing.plate_mm, 0.0, at.r_plate, at.r_open, mount, dowels),
                *tube(-casing.rim_mm, -casing.plate_mm, at.r_plate, at.r_casing, mount, dowels),
                *tube(at.z_bearing_front, -casing.plate_mm, shell.r_boss, at.r_open),
                *tube(z_groove, at.z_bearing_front, shell.r_boss, at.r_seat),
                *tube(z_groove_back, z_groove, shell.r_boss, ring.r_groove),
                *tube(z_seat_back, z_groove_back, shell.r_boss, at.r_seat),
                *tube(z_seat_back, shell.z_step, shell.r_tube, shell.r_boss),
                *tube(at.z_gear_front, z_seat_back, shell.r_tube, at.r_ring - casing.ring_lip_mm),
                *tube(z_flange, at.z_gear_front, shell.r_tube, at.r_ring),
                *tube(z_flange, z_flange + casing.flange_mm, shell.r_flange, shell.r_tube, screws),
            ),
            fits=(
                Fit(diameter_mm=2.0 * at.r_seat, zone="H7", seat=True),
                Fit(diameter_mm=2.0 * at.r_ring, zone="H7", seat=True),
                Dowel(diameter_mm=settings.parts.interface.mount_dowel_mm).hole_fit,
                Fit(diameter_mm=ring.groove_diameter_mm, zone=ring.groove_zone),
            ),
            lengths=(
                wider("seat", z_groove_back, at.z_bearing_front),
                groove(z_groove_back, ring),
                narrower("wall", z_seat_back, at.z_bearing_front),
                wider("ring seat", z_flange, at.z_gear_front),
                narrower("length", z_flange, at.z_bearing_front),
            ),
            features=(
                tapped(M3, (mount,), -casing.rim_mm, 0.0, enters="high"),
                bored(Circle(radius_mm=at.r_ring), z_flange, at.z_gear_front, enters="low"),
            ),
            note=ring.groove_note,
        ),
        steel_part(
            name="bore_retaining_ring",
            role=Role.RETAINING_RING,
            visibility=Visibility.INSIDE,
            material=materials.steel,
            prisms=tube(z_groove_back, at.z_bearing_back, ring.r_groove, ring.r_free),
            lengths=(ring_thickness(ring, z_groove_back),),
            group=Group.HOUSING,
            catalogue_mass_kg=ring.mass_kg,
            purchases=ring.purchases,
            note="in the ring housing's groove behind the main bearing",
        ),
    )


def _casing_and_backplate(
    at: Layout, shell: ExternalLayout, motor: Motor, settings: ActuatorSettings
) -> tuple[Part, ...]:
    """Build the bridge around the motor, and the plate that carries the motor's base."""
    casing, materials = settings.parts.casing, settings.materials
    z_flange, z_plate = shell.z_flange, shell.z_plate
    threads = _flange_holes(shell, settings, M3.core)
    mount, back = casing_holes(at, settings), casing_holes(at, settings, M3.hole)
    assert motor.mount_holes is not None
    r_mount = 0.5 * (motor.mount_holes.pitch_circle_mm + motor.mount_holes.diameter_mm)
    back_vents = vents(r_mount + casing.vent_wall_mm, at.r_casing, casing.vent_wall_mm)
    return (
        housing_part(
            name="casing",
            material=materials.aluminium,
            prisms=(
                *tube(at.z_gear_back, z_flange, shell.r_web, at.r_ring, threads),
                *tube(shell.z_web, at.z_gear_back, shell.r_web, at.r_ring - casing.ring_lip_mm, threads),
                *skirt(z_plate + casing.flange_mm, shell.z_web, at, settings, shell.r_bolts),
                *tube(z_plate, z_plate + casing.flange_mm, at.r_plate, at.r_casing, mount),
            ),
            features=(
                tapped(M3, (threads,), shell.z_web, z_flange, enters="high"),
                tapped(M3, (mount,), z_plate, z_plate + casing.flange_mm, enters="low"),
                bored(Circle(radius_mm=at.r_ring), at.z_gear_back, z_flange, enters="high"),
                bored(Circle(radius_mm=at.r_casing), z_plate, shell.z_web, enters="low"),
            ),
            lengths=(
                wider("ring seat", at.z_gear_back, z_flange),
                Length(name="length", z0_mm=z_plate, z1_mm=z_flange, lower_mm=0.0, upper_mm=2.0 * FINE_MM),
            ),
            registers=(Fit(diameter_mm=2.0 * at.r_ring, zone="H7"), Fit(diameter_mm=2.0 * at.r_casing, zone="H7")),
            note=f"bores and faces in one clamping; one for the ring, one for the backplate's step, {SPIGOT_MM:g} mm",
        ),
        housing_part(
            name="backplate",
            material=materials.aluminium,
            prisms=(
                *slab(
                    shell.z_end,
                    z_plate,
                    at.r_plate,
                    BACK_BORE_MM,
                    back,
                    motor_holes(motor, MOTOR_CLEARANCE_HOLE_MM),
                    *back_vents,
                ),
                *spigot(z_plate, at, settings),
            ),
            features=(turned(at.r_casing, z_plate + SPIGOT_MM, -1.0),),
            registers=(Fit(diameter_mm=2.0 * at.r_casing, zone="h7"), Fit(diameter_mm=2.0 * BACK_BORE_MM, zone="H7")),
            note="the step is the register in the casing; the bore takes the encoder's cap",
        ),
    )


def _housing_screws(at: Layout, shell: ExternalLayout, settings: ActuatorSettings) -> tuple[Part, ...]:
    """Build the screws from the ring housing and from the backplate into the casing."""
    casing = settings.parts.casing
    return (
        housing_screw(
            "casing_screw",
            settings,
            head="hexagon",
            seat_mm=shell.z_flange + casing.flange_mm,
            grip_mm=casing.flange_mm,
            direction=-1.0,
            holes=_flange_holes(shell, settings, M3.hole),
            note="from the ring housing into the casing",
        ),
        backplate_screw(at, shell.z_end, casing.plate_mm, settings),
    )
