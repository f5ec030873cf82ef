"""The base frame: two cheeks joined by four rods; it carries the hip actuator and the knee actuator's free end."""

from dataclasses import replace

import numpy as np

from pareto_monoped.geometry.dowels import Dowel, dowel_part
from pareto_monoped.geometry.features import bored, turned
from pareto_monoped.geometry.making import Fit, Length
from pareto_monoped.geometry.parts import Part, disc, layer, machined_part, sheet_part
from pareto_monoped.geometry.roles import BEARING_RETAINER, Joint, JointKind, Role, Visibility
from pareto_monoped.geometry.screws import M3, M4, clearance, screw_part, tapped
from pareto_monoped.geometry.shapes import Circle, Numbers, Path, Pattern, Shape, hull
from pareto_monoped.leg.dimensions import LegDimensions
from pareto_monoped.leg.electronics import DRIVER_PLATE_MM, driver_parts
from pareto_monoped.leg.journal import LIP, bearing_part, far_cheek_z_mm
from pareto_monoped.leg.sandwich import Place, holes_at
from pareto_monoped.leg.stop_parts import base_stop_parts, hip_seat_screws

# Our own layout of the rods, mm. They stand above the hip, see ``LegDimensions.lower_rod_mm``.
ROD_THREAD = 10.0  # usable depth, 2.5 diameters in aluminium
# Our own layout of the cheeks, mm.
_TOP_RADIUS, _TOP_RISE = 40.0, 6.0  # round upper end, its centre above the lower rods: 5 mm outside the upper ones
_FAR_WALL = 10.0  # of the far cheek around its bearing
_BORE_PLAY = 1.0  # of the near cheek around the hip's output flange
# Of the holes that lighten the near cheek: their largest radius, and metal to its bore and to the mount's dowels.
_RELIEF_MOST, _RELIEF_TO_BORE, _RELIEF_TO_DOWELS = 9.0, 4.5, 3.0
# A slot between the rods that lightens both cheeks, 10 mm or more from the rods' holes.
_ROD_OFF = 0.1  # all four are faced to one length in one set-up, within this of the drawing
_SLOT_RADIUS, _SLOT_LENGTH = 10.0, 14.0
_SLOT_RISE = 16.0  # of the centre of its upper end above the lower rods


def base_parts(knee_actuator_length_m: Numbers, d: LegDimensions) -> tuple[Part, ...]:
    """Build the base frame in the frame of the base: origin on the hip axis in the middle plane, y up, z along the
    axis.

    The hip actuator is placed at ``z = d.hip_mount_mm`` with its output towards +z.

    ``knee_actuator_length_m``: from the mounting face to the back of the knee actuator, float or shape (n,).
    """
    far_mm = far_cheek_z_mm(knee_actuator_length_m, d)
    return (
        *_near_cheek(d),
        *_far_cheek(far_mm, d),
        *_rods(far_mm, d),
        *base_stop_parts(d),
        *driver_parts("hip", d.hip_mount_mm, -1.0, d),
        *driver_parts("knee", far_mm + d.far_cheek_mm, 1.0, d),
    )


def _rod_places(d: LegDimensions) -> tuple[Place, ...]:
    """Return where the rods stand: two as close to the hip axis as the thigh lets them, two above."""
    return tuple((side * x, y, 0.0) for x, y in (d.lower_rod_mm, d.upper_rod_mm) for side in (-1.0, 1.0))


def _cheek_outline(bottom_radius_mm: float, d: LegDimensions) -> Path:
    """Return the outline from a disc around the hip axis up to the round end around the rods."""
    top_mm = d.lower_rod_mm[1] + _TOP_RISE
    return hull(top_radius_mm=_TOP_RADIUS, bottom_radius_mm=bottom_radius_mm, length_mm=top_mm, y_mm=top_mm)


def _common_holes(d: LegDimensions) -> tuple[Shape, ...]:
    """Return what both cheeks have: a slot that lightens them, and the holes of the rods' screws."""
    slot = hull(
        top_radius_mm=_SLOT_RADIUS,
        bottom_radius_mm=_SLOT_RADIUS,
        length_mm=_SLOT_LENGTH,
        y_mm=d.lower_rod_mm[1] + _SLOT_RISE,
    )
    return (slot, *holes_at(_rod_places(d), M4.hole))


def _reliefs(d: LegDimensions) -> Pattern:
    """Return the holes that lighten the near cheek: one below each gap between the screws, where its dowels are."""
    low = d.hip.coupler_radius_mm + _BORE_PLAY + _RELIEF_TO_BORE
    high = d.hip.mount_pitch_radius_mm - 0.5 * d.hip.mount_dowel_mm - _RELIEF_TO_DOWELS
    radius = min(_RELIEF_MOST, 0.5 * (high - low))
    return Pattern(radius_mm=radius, pitch_radius_mm=low + radius, count=6, phase_rad=np.pi / 6)


def _near_cheek(d: LegDimensions) -> tuple[Part, ...]:
    """Build the plate that the hip actuator is bolted to, with the screws."""
    z0, z1 = d.hip_mount_mm, d.hip_mount_mm + d.cheek_mm
    mount, mount_dowels = d.hip.mount_bolts, replace(d.hip.mount_dowel, count=d.hip.mount_dowels // 2)
    seats = holes_at(hip_seat_screws(d), M4.hole)
    return (
        dowel_part(
            "hip_mount_dowel",
            Dowel(diameter_mm=d.hip.mount_dowel_mm),
            end_mm=z0 - d.hip.mount_thread_mm,
            room_mm=d.hip.mount_thread_mm + d.cheek_mm,
            direction=1.0,
            holes=mount_dowels,
            partner="base_near_cheek",
            note="into every second of the holes in the hip actuator's case; ream them together",
        ),
        sheet_part(
            name="base_near_cheek",
            role=Role.PLATE,
            prisms=(
                layer(
                    _cheek_outline(d.hip.rim_radius_mm, d),
                    z0,
                    z1,
                    Circle(radius_mm=d.hip.coupler_radius_mm + _BORE_PLAY),
                    mount,
                    mount_dowels,
                    _reliefs(d),
                    *_common_holes(d),
                    *seats,
                ),
            ),
            # The actuator's screws come from the thigh's side, those of the hip's seats from the actuator's.
            features=(
                clearance(M3, (mount,), z0, z1, countersunk="high"),
                clearance(M4, seats, z0, z1, countersunk="low"),
            ),
            fits=(Dowel(diameter_mm=d.hip.mount_dowel_mm).hole_fit,),
            note=f"{d.cheek_mm:g} mm sheet",
        ),
        screw_part(
            "hip_mount_screw",
            M3,
            head="countersunk",
            seat_mm=z1,
            grip_mm=d.cheek_mm,
            room_mm=d.hip.mount_thread_mm,
            direction=-1.0,
            holes=mount,
            grade="10.9",
            note="flush, into the hip actuator's case",
        ),
    )


def _far_cheek(z0_mm: Numbers, d: LegDimensions) -> tuple[Part, ...]:
    """Build the plate that carries the journal, with its bearing."""
    outline, common = _cheek_outline(d.bearing_outer_radius_mm + _FAR_WALL, d), _common_holes(d)
    seat = Circle(radius_mm=d.bearing_outer_radius_mm)
    lip = Circle(radius_mm=d.bearing_outer_radius_mm - LIP)
    seat_end = z0_mm + d.bearing_width_mm
    return (
        machined_part(
            name="base_far_cheek",
            role=Role.PLATE,
            prisms=(
                layer(outline, z0_mm, seat_end, seat, *common),
                layer(outline, seat_end, z0_mm + d.far_cheek_mm, lip, *common),
            ),
            fits=(Fit(diameter_mm=2.0 * d.bearing_outer_radius_mm, zone="H7", seat=True),),
            features=(bored(seat, z0_mm, seat_end, enters="low"),),
            note=f"{d.far_cheek_mm:g} mm plate",
        ),
        replace(
            bearing_part("base_bearing", d, z0_mm=z0_mm),
            joint=Joint(
                kind=JointKind.BONDED,
                how="bonded into",
                partner="base_far_cheek",
                adhesive=BEARING_RETAINER,
                first=True,
            ),
        ),
    )


_SWUNG = (
    "swing the thigh through its whole range; once it swings freely, take off the knee driver, which covers two of "
    "these screws, tighten them with thread locker and put it back"
)


def _rods(far_mm: Numbers, d: LegDimensions) -> tuple[Part, ...]:
    """Build the rods between the cheeks' inner faces, with a screw at either end."""
    places = _rod_places(d)
    lower, upper = places[:2], places[2:]
    near_mm = d.hip_mount_mm + d.cheek_mm
    thread = Circle(radius_mm=M4.core)
    return (
        machined_part(
            name="base_rod",
            role=Role.ROD,
            prisms=(disc(d.rod_radius_mm, near_mm, far_mm, thread),),
            places_mm=places,
            lengths=(Length(name="length", z0_mm=near_mm, z1_mm=far_mm, lower_mm=-_ROD_OFF, upper_mm=_ROD_OFF),),
            features=(
                tapped(M4, (thread,), near_mm, far_mm, enters="both", usable_mm=ROD_THREAD),
                turned(d.rod_radius_mm, near_mm, 1.0),
                turned(d.rod_radius_mm, far_mm, -1.0),
            ),
            note=f"{2.0 * d.rod_radius_mm:g} mm bar, drilled from both ends; the test stand's carriage clamps to the "
            "rods",
        ),
        *(
            replace(
                screw_part(
                    f"base_{row}_rod_screw_{side}",
                    M4,
                    visibility=Visibility.OUTSIDE,
                    head="cap",
                    seat_mm=seat_mm - direction * under_mm,
                    grip_mm=grip_mm + under_mm,
                    room_mm=ROD_THREAD,
                    direction=direction,
                    places_mm=where,
                    note="; ".join(filter(None, (note, last))),
                ),
                at_last=_SWUNG if last else "",
            )
            for side, seat_mm, grip_mm, direction, last in (
                ("near", d.hip_mount_mm, d.cheek_mm, 1.0, ""),
                (
                    "far",
                    far_mm + d.far_cheek_mm,
                    d.far_cheek_mm,
                    -1.0,
                    "by hand only and dry, until the thigh has swung freely",
                ),
            )
            for row, where, under_mm, note in (
                ("lower", lower, 0.0, ""),
                ("upper", upper, DRIVER_PLATE_MM, "through the driver's plate and the cheek"),
            )
        ),
    )
