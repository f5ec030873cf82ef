"""What joins the thigh to both actuators at the hip: couplings, drive sprocket, screws."""

import numpy as np

from pareto_monoped.geometry.parts import Part, Prism
from pareto_monoped.geometry.roles import Group, Role
from pareto_monoped.geometry.screws import M3, screw_part
from pareto_monoped.geometry.shapes import Circle, Pattern, Shape
from pareto_monoped.leg.dimensions import LegDimensions
from pareto_monoped.leg.sprocket import HEAD_PLAY, sprocket_prisms
from pareto_monoped.materials import ALLOYS, MATERIALS

# Our own layout of the couplings, mm.
_RADIUS = 15.0  # 3 mm outside the circle of their screws
_BORE_RADIUS = 6.75  # covers the outer ring of the bearing in the output flange, 15 mm wide
_RELIEF_RADIUS = 2.2  # of a hole between every two screws: 0.8 mm to the rim, 2.4 mm to the screws' holes


def hip_joints(d: LegDimensions) -> tuple[Part, ...]:
    """What joins the thigh to both actuators, whose output flanges are flush with their mounting faces."""
    return (*_hip_coupling(d), _knee_mount_screw(d), *_knee_drive(d))


def _coupling_holes(d: LegDimensions) -> tuple[Shape, ...]:
    """Bore, clearance holes for the screws into the output flange, and lightening holes between these."""
    return (
        Circle(radius_mm=_BORE_RADIUS),
        Pattern(radius_mm=M3.hole, pitch_radius_mm=d.output_pitch_radius_mm, count=d.output_holes),
        Pattern(
            radius_mm=_RELIEF_RADIUS,
            pitch_radius_mm=d.output_pitch_radius_mm,
            count=d.output_holes,
            phase_rad=np.pi / d.output_holes,
        ),
    )


def _hip_coupling(d: LegDimensions) -> tuple[Part, ...]:
    """What turns the thigh: a coupling between the hip's output and the inner plate, with its screws."""
    half_gap, face = 0.5 * d.gap_mm, d.thigh_face_mm
    return (
        Part(
            name="hip_coupling",
            role=Role.COUPLING,
            material=MATERIALS.aluminium,
            process="machined",
            prisms=(
                Prism(outline=Circle(radius_mm=_RADIUS), z0_mm=d.hip_mount_mm, z1_mm=-face, holes=_coupling_holes(d)),
            ),
            grade=ALLOYS["aw_6082_t6"],
            note="between hip output and inner plate; friction joint, dry",
        ),
        screw_part(
            "hip_coupling_screw",
            M3,
            head="cap",
            seat_mm=-half_gap,
            grip_mm=-half_gap - d.hip_mount_mm,
            room_mm=d.output_thread_mm,
            direction=-1.0,
            material=MATERIALS.steel,
            count=d.output_holes,
            pitch_radius_mm=d.output_pitch_radius_mm,
            grade="12.9",
            note="from inside the thigh into the hip's output flange",
        ),
    )


def _knee_mount_screw(d: LegDimensions) -> Part:
    """The screws that carry the knee actuator on the outer plate."""
    return screw_part(
        "knee_mount_screw",
        M3,
        head="cap",
        seat_mm=0.5 * d.gap_mm,
        grip_mm=d.plate_mm,
        room_mm=d.mount_thread_mm,
        direction=1.0,
        material=MATERIALS.steel,
        count=d.mount_holes,
        pitch_radius_mm=d.mount_pitch_radius_mm,
        grade="12.9",
        note="from inside the thigh into the knee actuator's case",
    )


def _knee_drive(d: LegDimensions) -> tuple[Part, ...]:
    """What turns with the knee actuator's output: sprocket, coupling, screws."""
    half_tooth = 0.5 * d.chain.sprocket_width_mm
    return (
        Part(
            name="drive_sprocket",
            role=Role.SPROCKET,
            material=MATERIALS.steel,
            process="machined",
            prisms=sprocket_prisms(d, M3.head + HEAD_PLAY),
            group=Group.KNEE_DRIVE,
            grade=ALLOYS["c45_n"],
            note=f"{d.chain.name}, {d.chain.teeth} teeth (ISO 606)",
        ),
        Part(
            name="drive_coupling",
            role=Role.COUPLING,
            material=MATERIALS.aluminium,
            process="machined",
            prisms=(
                Prism(
                    outline=Circle(radius_mm=_RADIUS),
                    z0_mm=half_tooth,
                    z1_mm=d.knee_mount_mm,
                    holes=_coupling_holes(d),
                ),
            ),
            group=Group.KNEE_DRIVE,
            grade=ALLOYS["aw_6082_t6"],
            note="between knee output and drive sprocket",
        ),
        screw_part(
            "drive_screw",
            M3,
            head="cap",
            seat_mm=d.sprocket_recess_mm - half_tooth,
            grip_mm=d.knee_mount_mm + half_tooth - d.sprocket_recess_mm,
            room_mm=d.output_thread_mm,
            direction=1.0,
            material=MATERIALS.steel,
            count=d.output_holes,
            pitch_radius_mm=d.output_pitch_radius_mm,
            group=Group.KNEE_DRIVE,
            grade="12.9",
            note="through the sprocket into the knee's output flange",
        ),
    )
