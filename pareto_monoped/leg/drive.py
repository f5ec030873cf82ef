"""What joins the thigh to both actuators at the hip: couplings, drive sprocket, screws."""

import numpy as np

from pareto_monoped.geometry.parts import Part, Prism
from pareto_monoped.geometry.roles import Group, Role
from pareto_monoped.geometry.screws import M3, screw_part
from pareto_monoped.geometry.shapes import Circle, Pattern
from pareto_monoped.leg.common import sprocket_prisms
from pareto_monoped.leg.dimensions import LegDimensions
from pareto_monoped.materials import MATERIALS

_RADIUS = 15.0  # of the couplings, 3 mm of metal outside their screws
_COVER = 6.75  # radius of the couplings' bore: covers the outer ring of the bearing in the output flange, 15 mm wide


def hip_joints(d: LegDimensions) -> tuple[Part, ...]:
    """What joins the thigh to both actuators at the hip."""
    half_gap, face = 0.5 * d.gap_mm, d.thigh_face_mm
    coupler_face = d.hip_mount_mm + d.coupler_height_mm
    drive_face = d.knee_mount_mm - d.coupler_height_mm
    half_tooth = 0.5 * d.sprocket_width_mm
    coupling_holes = (
        Circle(radius_mm=_COVER),
        Pattern(radius_mm=M3.hole, pitch_radius_mm=d.output_pitch_radius_mm, count=d.output_holes),
        # Lightening between the screws.
        Pattern(
            radius_mm=2.2,
            pitch_radius_mm=d.output_pitch_radius_mm,
            count=d.output_holes,
            phase_rad=np.pi / d.output_holes,
        ),
    )
    return (
        Part(
            name="hip_coupling",
            role=Role.COUPLING,
            material=MATERIALS.aluminium,
            process="machined",
            prisms=(Prism(outline=Circle(radius_mm=_RADIUS), z0_mm=coupler_face, z1_mm=-face, holes=coupling_holes),),
            note="between hip output and inner plate; friction joint, dry",
        ),
        screw_part(
            "hip_coupling_screw",
            M3,
            head="cap",
            seat_mm=-half_gap,
            grip_mm=-half_gap - coupler_face,
            room_mm=d.coupler_thread_mm,
            direction=-1.0,
            material=MATERIALS.steel,
            count=d.output_holes,
            pitch_radius_mm=d.output_pitch_radius_mm,
            grade="12.9",
            note="from inside the thigh into the hip's output flange",
        ),
        screw_part(
            "knee_mount_screw",
            M3,
            head="cap",
            seat_mm=half_gap,
            grip_mm=d.plate_mm,
            room_mm=d.mount_thread_mm,
            direction=1.0,
            material=MATERIALS.steel,
            count=d.mount_holes,
            pitch_radius_mm=d.mount_pitch_radius_mm,
            grade="12.9",
            note="from inside the thigh into the knee actuator's case",
        ),
        Part(
            name="drive_sprocket",
            role=Role.SPROCKET,
            material=MATERIALS.steel,
            process="machined",
            prisms=sprocket_prisms(d),
            group=Group.KNEE_DRIVE,
            note=f"{d.chain_name}, {d.sprocket_teeth} teeth (ISO 606)",
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
                    z1_mm=drive_face,
                    holes=coupling_holes,
                ),
            ),
            group=Group.KNEE_DRIVE,
            note="between knee output and drive sprocket",
        ),
        screw_part(
            "drive_screw",
            M3,
            head="cap",
            seat_mm=d.sprocket_recess_mm - half_tooth,
            grip_mm=drive_face + half_tooth - d.sprocket_recess_mm,
            room_mm=d.coupler_thread_mm,
            direction=1.0,
            material=MATERIALS.steel,
            count=d.output_holes,
            pitch_radius_mm=d.output_pitch_radius_mm,
            group=Group.KNEE_DRIVE,
            grade="12.9",
            note="through the sprocket into the knee's output flange",
        ),
    )
