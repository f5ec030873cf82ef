"""What joins the thigh to both actuators at the hip: couplings, drive sprocket and its far support, screws."""

import numpy as np

from pareto_monoped.geometry.dowels import Dowel, dowel_part
from pareto_monoped.geometry.making import Fit, narrower
from pareto_monoped.geometry.parts import Part, disc, machined_part, strong_part
from pareto_monoped.geometry.roles import Group, Role
from pareto_monoped.geometry.screws import M3, screw_part
from pareto_monoped.geometry.shapes import Circle, Pattern, Shape
from pareto_monoped.leg.actuator_fit import ActuatorFit
from pareto_monoped.leg.dimensions import LegDimensions
from pareto_monoped.leg.sprocket import (
    BACK,
    BOSS_RADIUS,
    FLANGE,
    FRONT,
    HEAD_PLAY,
    SEAT_RADIUS,
    sprocket_prisms,
    support_parts,
)
from pareto_monoped.leg.sprocket import BORE_RADIUS as NECK_RADIUS

# Our own layout of the couplings, mm.
_RADIUS = 15.0  # 3 mm outside the circle of their screws
_BORE_RADIUS = 6.75  # covers the outer ring of the bearing in the output flange, 15 mm wide
_RELIEF_RADIUS = 2.2  # of a hole in the gaps without dowels: 0.8 mm to the rim, 2.4 mm to the screws' holes
_DOWEL_STANDS_OUT = 1.0  # of the outer plate's inner face at most, between the heads of the screws


def hip_joints(d: LegDimensions) -> tuple[Part, ...]:
    """Build what joins the thigh to both actuators, whose output flanges are flush with their mounting faces."""
    return (*_hip_coupling(d), _knee_mount_screw(d), _knee_mount_dowels(d), *_knee_drive(d))


def _coupling_holes(fit: ActuatorFit, dowels: Pattern) -> tuple[Shape, ...]:
    """Return the holes for screws and dowels into the output flange, and lightening holes in the gaps that are left."""
    return (
        fit.output_bolts,
        dowels,
        Pattern(
            radius_mm=_RELIEF_RADIUS,
            pitch_radius_mm=fit.output_pitch_radius_mm,
            count=dowels.count,
            phase_rad=dowels.phase_rad + 2.0 * np.pi / fit.output_holes,
        ),
    )


def _hip_coupling(d: LegDimensions) -> tuple[Part, ...]:
    """Build what turns the thigh: a coupling between the hip's output and the inner plate, with its screws."""
    half_gap, face = 0.5 * d.gap_mm, d.thigh_face_mm
    bore, seat, holes = (
        Circle(radius_mm=_BORE_RADIUS),
        Circle(radius_mm=SEAT_RADIUS),
        _coupling_holes(d.hip, d.hip.output_dowel),
    )
    layers: tuple[tuple[float, float, float, tuple[Shape, ...]], ...] = (
        (_RADIUS, d.hip_mount_mm, BACK, (bore, *holes)),
        (_RADIUS, BACK, -face, (seat, *holes)),
        (BOSS_RADIUS, -face, FRONT, (seat,)),
    )
    return (
        machined_part(
            name="hip_coupling",
            role=Role.COUPLING,
            prisms=tuple(disc(radius, z0, z1, *cut) for radius, z0, z1, cut in layers),
            fits=(_output_dowel(d.hip).hole_fit, Fit(diameter_mm=2.0 * SEAT_RADIUS, zone="R6", seat=True)),
            lengths=(narrower("thickness", d.hip_mount_mm, -face),),
            note="between hip output and inner plate",
        ),
        _output_dowels(
            "hip_coupling_dowel",
            d.hip,
            d.hip.output_dowel,
            end_mm=-half_gap,
            room_mm=-half_gap - d.hip_mount_mm + d.hip.output_thread_mm,
            direction=-1.0,
            partner="hip_coupling",
        ),
        screw_part(
            "hip_coupling_screw",
            M3,
            head="cap",
            seat_mm=-half_gap,
            grip_mm=-half_gap - d.hip_mount_mm,
            room_mm=d.hip.output_thread_mm,
            direction=-1.0,
            holes=d.hip.output_bolts,
            grade="10.9",
            note="from inside the thigh into the hip's output flange",
        ),
    )


def _output_dowel(fit: ActuatorFit) -> Dowel:
    """Return the dowel between an output flange and what it turns; dowels carry the torque, the screws only clamp."""
    return Dowel(diameter_mm=fit.output_dowel_mm)


def _output_dowels(
    name: str,
    fit: ActuatorFit,
    holes: Pattern,
    *,
    end_mm: float,
    room_mm: float,
    direction: float,
    partner: str,
    group: Group = Group.FIXED,
) -> Part:
    """Build the dowels into an output flange, in the middle of their holes, which begin at ``end_mm``."""
    spare_mm = room_mm - float(_output_dowel(fit).length_mm(room_mm))
    return dowel_part(
        name,
        _output_dowel(fit),
        end_mm=end_mm + direction * 0.5 * spare_mm,
        room_mm=room_mm,
        direction=direction,
        holes=holes,
        group=group,
        partner=partner,
        note="ream its holes together",
    )


def _knee_mount_dowels(d: LegDimensions) -> Part:
    """Build the dowels of the knee actuator's case in the outer plate: they carry its torque and the chain's pull."""
    holes = d.knee.mount_dowel
    return dowel_part(
        "knee_mount_dowel",
        Dowel(diameter_mm=d.knee.mount_dowel_mm),
        end_mm=d.knee_mount_mm + d.knee.mount_thread_mm,
        room_mm=d.knee.mount_thread_mm + d.plate_mm + _DOWEL_STANDS_OUT,
        direction=-1.0,
        holes=holes,
        partner="thigh_plate_outer",
        note="ream its holes together",
    )


def _knee_mount_screw(d: LegDimensions) -> Part:
    """Build the screws that carry the knee actuator on the outer plate."""
    return screw_part(
        "knee_mount_screw",
        M3,
        head="cap",
        seat_mm=0.5 * d.gap_mm,
        grip_mm=d.plate_mm,
        room_mm=d.knee.mount_thread_mm,
        direction=1.0,
        holes=d.knee.mount_bolts,
        grade="8.8",
        note="from inside the thigh into the knee actuator's case",
    )


def _knee_drive(d: LegDimensions) -> tuple[Part, ...]:
    """Build what turns with the knee actuator's output: sprocket, coupling, screws."""
    half_tooth, holes = 0.5 * d.chain.sprocket_width_mm, _coupling_holes(d.knee, d.drive_dowel)
    return (
        *support_parts(d, _RADIUS, holes),
        strong_part(
            name="drive_sprocket",
            role=Role.SPROCKET,
            prisms=sprocket_prisms(d, M3.head + HEAD_PLAY),
            group=Group.KNEE_DRIVE,
            fits=(Fit(diameter_mm=2.0 * NECK_RADIUS, zone="H7"), _output_dowel(d.knee).hole_fit),
            note=f"{d.chain.name}, {d.chain.teeth} teeth (ISO 606)",
        ),
        machined_part(
            name="drive_coupling",
            role=Role.COUPLING,
            prisms=(disc(_RADIUS, half_tooth + FLANGE, d.knee_mount_mm, Circle(radius_mm=_BORE_RADIUS), *holes),),
            group=Group.KNEE_DRIVE,
            fits=(_output_dowel(d.knee).hole_fit,),
            note="between knee output and drive sprocket",
        ),
        _output_dowels(
            "drive_dowel",
            d.knee,
            d.drive_dowel,
            end_mm=d.knee_mount_mm + d.knee.output_thread_mm,
            room_mm=d.knee_mount_mm + half_tooth + d.knee.output_thread_mm,
            direction=-1.0,
            partner="drive_coupling",
            group=Group.KNEE_DRIVE,
        ),
        screw_part(
            "drive_screw",
            M3,
            head="cap",
            seat_mm=d.sprocket_recess_mm - half_tooth,
            grip_mm=d.knee_mount_mm + half_tooth - d.sprocket_recess_mm,
            room_mm=d.knee.output_thread_mm,
            direction=1.0,
            holes=d.knee.output_bolts,
            group=Group.KNEE_DRIVE,
            grade="10.9",
            note="through the sprocket into the knee's output flange",
        ),
    )
