"""The base frame: two cheeks joined by four rods; it carries the hip actuator and the knee actuator's free end."""

import numpy as np

from pareto_monoped.geometry.parts import Part, Prism
from pareto_monoped.geometry.roles import Role, Visibility
from pareto_monoped.geometry.screws import M3, M4, screw_part
from pareto_monoped.geometry.shapes import Circle, Numbers, Path, Pattern, hull
from pareto_monoped.leg.common import Place, holes_at, motor_screw
from pareto_monoped.leg.dimensions import DEFAULT, LegDimensions
from pareto_monoped.materials import MATERIALS

# Our own layout, mm: the rods stand above the hip, outside the reach of the thigh's round hip end and, up to the end
# of the hip's range, of its bar.
_TOP_RADIUS = 40.0
_LOWER_ROD = (32.0 / 68.0, 60.0 / 68.0)  # direction from the hip axis
_UPPER_ROD_X, _UPPER_ROD_RISE = 18.0, 30.0
_ROD_RADIUS = 5.0
_ROD_THREAD = 10.0
_JOURNAL_FLANGE = 4.0
_JOURNAL_STEP = 6.5  # room for the screws' heads
_BACK_THREAD = 6.0  # M5 x 10 in the backplate of an ISSPG, M5 x 12 through that of an ESSPG, 5 mm into its motor
_SHOULDER = 11.8  # radius that touches the bearing's inner ring only


def _far_z(knee_actuator_length_m: Numbers, d: LegDimensions) -> tuple[Numbers, Numbers, Numbers]:
    """Heights z of the knee actuator's back, of the far cheek's inner face and of its outer face."""
    back = d.knee_mount_mm + 1000.0 * knee_actuator_length_m
    inner = back + _JOURNAL_FLANGE + _JOURNAL_STEP
    return back, inner, inner + d.far_cheek_mm


def _rods(d: LegDimensions) -> tuple[Place, ...]:
    """Where the rods stand: two as close to the hip axis as the thigh lets them, two above."""
    x, y = (d.rod_circle_mm * share for share in _LOWER_ROD)
    up = y + _UPPER_ROD_RISE
    return ((-x, y, 0.0), (x, y, 0.0), (-_UPPER_ROD_X, up, 0.0), (_UPPER_ROD_X, up, 0.0))


def base_parts(knee_actuator_length_m: Numbers, d: LegDimensions = DEFAULT) -> tuple[Part, ...]:
    """The base frame in the frame of the base: origin on the hip axis in the middle plane, y up, z along the axis.

    The hip actuator is placed at ``z = d.hip_mount_mm`` with its output towards +z.

    Args:
        knee_actuator_length_m: from the mounting face to the back of the knee actuator, float or shape (n,).
        d: dimensions.
    """
    near0, near1 = d.hip_mount_mm, d.hip_mount_mm + d.cheek_mm
    _, far0, far1 = _far_z(knee_actuator_length_m, d)
    seat1 = far0 + d.bearing_width_mm
    places = _rods(d)
    rods = holes_at(places, M4.hole)
    low_y = places[0][1]
    top_y = low_y + 6.0
    window = hull(top_radius_mm=10.0, bottom_radius_mm=10.0, length_mm=14.0, y_mm=low_y + 16.0)
    outer_race = Circle(radius_mm=d.bearing_outer_radius_mm)

    def cheek(bottom_radius_mm: float) -> Path:
        return hull(top_radius_mm=_TOP_RADIUS, bottom_radius_mm=bottom_radius_mm, length_mm=top_y, y_mm=top_y)

    thread = Circle(radius_mm=M4.core)
    return (
        Part(
            name="base_near_cheek",
            role=Role.PLATE,
            material=MATERIALS.aluminium,
            process="laser cut",
            prisms=(
                Prism(
                    outline=cheek(d.rim_radius_mm),
                    z0_mm=near0,
                    z1_mm=near1,
                    holes=(
                        Circle(radius_mm=d.coupler_radius_mm + 1.0),
                        Pattern(
                            radius_mm=M3.hole,
                            pitch_radius_mm=d.mount_pitch_radius_mm,
                            count=d.mount_holes,
                        ),
                        # Lightening between the bore and the screws, a hole below each gap of the screws.
                        Pattern(radius_mm=9.0, pitch_radius_mm=31.0, count=6, phase_rad=np.pi / 6),
                        window,
                        *rods,
                    ),
                ),
            ),
            note="6 mm sheet EN AW-6082 T6; countersink the screw holes on the thigh's side",
        ),
        screw_part(
            "hip_mount_screw",
            M3,
            head="countersunk",
            seat_mm=near1,
            grip_mm=d.cheek_mm,
            room_mm=d.mount_thread_mm,
            direction=-1.0,
            material=MATERIALS.steel,
            count=d.mount_holes,
            pitch_radius_mm=d.mount_pitch_radius_mm,
            grade="10.9",
            note="flush, into the hip actuator's case",
        ),
        Part(
            name="base_far_cheek",
            role=Role.PLATE,
            material=MATERIALS.aluminium,
            process="machined",
            prisms=(
                Prism(outline=cheek(26.0), z0_mm=far0, z1_mm=seat1, holes=(outer_race, window, *rods)),
                Prism(
                    outline=cheek(26.0),
                    z0_mm=seat1,
                    z1_mm=far1,
                    holes=(Circle(radius_mm=d.bearing_outer_radius_mm - 2.0), window, *rods),
                ),
            ),
            note="8 mm plate EN AW-6082 T6; seat 32 J7, 7 mm deep",
        ),
        Part(
            name="base_bearing",
            role=Role.BEARING,
            material=MATERIALS.steel,
            process="bought",
            prisms=(
                Prism(
                    outline=outer_race,
                    z0_mm=far0,
                    z1_mm=seat1,
                    holes=(Circle(radius_mm=d.bearing_bore_radius_mm),),
                ),
            ),
            catalogue_mass_kg=d.bearing_kg,
            note="6804, 20 x 32 x 7 mm (ISO 15)",
        ),
        Part(
            name="base_rod",
            role=Role.ROD,
            material=MATERIALS.aluminium,
            process="machined",
            prisms=(Prism(outline=Circle(radius_mm=_ROD_RADIUS), z0_mm=near1, z1_mm=far0, holes=(thread,)),),
            places_mm=places,
            note="10 mm tube, tapped M4 at both ends; the test stand's carriage clamps to the rods",
        ),
        screw_part(
            "base_rod_screw_near",
            M4,
            visibility=Visibility.OUTSIDE,
            head="cap",
            seat_mm=near0,
            grip_mm=d.cheek_mm,
            room_mm=_ROD_THREAD,
            direction=1.0,
            material=MATERIALS.steel,
            places_mm=places,
        ),
        screw_part(
            "base_rod_screw_far",
            M4,
            visibility=Visibility.OUTSIDE,
            head="cap",
            seat_mm=far1,
            grip_mm=d.far_cheek_mm,
            room_mm=_ROD_THREAD,
            direction=-1.0,
            material=MATERIALS.steel,
            places_mm=places,
        ),
    )


def journal_parts(
    knee_actuator_length_m: Numbers, d: LegDimensions = DEFAULT, *, back_clearance_mm: Numbers = 0.0
) -> tuple[Part, ...]:
    """The journal on the knee actuator's back that turns in the far cheek; in the frame of the thigh, part of it.

    Args:
        knee_actuator_length_m: from the mounting face to the back of the knee actuator, float or shape (n,).
        back_clearance_mm: how much of the knee actuator's back the screws pass through before their threads begin,
            float or shape (n,).
        d: dimensions.
    """
    back, far0, _ = _far_z(knee_actuator_length_m, d)
    flange = back + _JOURNAL_FLANGE
    seat1 = far0 + d.bearing_width_mm
    bore = Circle(radius_mm=d.bearing_bore_radius_mm - 3.0)
    screw = motor_screw(d.back_screw_mm)
    holes = Pattern(radius_mm=screw.hole, pitch_radius_mm=d.back_pitch_radius_mm, count=d.back_holes)
    return (
        Part(
            name="journal",
            role=Role.SHAFT,
            material=MATERIALS.aluminium,
            process="machined",
            prisms=(
                Prism(
                    outline=Circle(radius_mm=d.back_pitch_radius_mm + 5.0),
                    z0_mm=back,
                    z1_mm=flange,
                    holes=(bore, holes),
                ),
                Prism(outline=Circle(radius_mm=_SHOULDER), z0_mm=flange, z1_mm=far0, holes=(bore,)),
                Prism(outline=Circle(radius_mm=d.bearing_bore_radius_mm), z0_mm=far0, z1_mm=seat1, holes=(bore,)),
            ),
            note="EN AW-7075; seat 20 h6; the bore takes the knee actuator's cables",
        ),
        screw_part(
            "journal_screw",
            screw,
            head="cap",
            seat_mm=flange,
            grip_mm=_JOURNAL_FLANGE + back_clearance_mm,
            room_mm=_BACK_THREAD,
            direction=-1.0,
            material=MATERIALS.steel,
            count=d.back_holes,
            pitch_radius_mm=d.back_pitch_radius_mm,
            note="into the knee motor's own mounting pattern",
        ),
    )
