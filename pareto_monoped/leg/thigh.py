"""The thigh as a list of parts: sandwich, hip joints, chain, and knee bearings."""

import numpy as np

from pareto_monoped.geometry.parts import Part, Prism
from pareto_monoped.geometry.roles import Role, Visibility
from pareto_monoped.geometry.screws import M3, M25, screw_part
from pareto_monoped.geometry.shapes import Circle, Numbers, Pattern, Shape, rectangle
from pareto_monoped.leg.chain import chain_parts
from pareto_monoped.leg.common import BRIDGE, bolts_at, holes_at, sleeve_bolt, sleeve_hole, windows_between
from pareto_monoped.leg.dimensions import DEFAULT, LegDimensions
from pareto_monoped.leg.drive import hip_joints
from pareto_monoped.leg.outlines import waisted
from pareto_monoped.materials import MATERIALS

# Our own layout, mm along the thigh.
_KNEE_END = 32.0  # core above the knee axis, clear of the sprocket's teeth
_STANDOFF_RADIUS, _STANDOFF_PITCH = 3.5, 36.5
_CUP_THREAD = 6.0


def bridges_of(length_mm: Numbers, d: LegDimensions = DEFAULT) -> tuple[Numbers, Numbers, Numbers]:
    """Heights of the three bridges that bolt the sandwich together, mm from the hip axis."""
    first, last = -d.first_bridge_mm, _KNEE_END + BRIDGE - length_mm
    return first, 0.5 * (first + last), last


def thigh_parts(thigh_length_m: Numbers, d: LegDimensions = DEFAULT) -> tuple[Part, ...]:
    """The thigh from hip axis to knee axis: plates, core, chain drive, hip coupling, knee bearings, fasteners.

    The knee actuator itself is not in it: it is placed at ``z = d.knee_mount_mm`` with its output towards -z. The
    parts of group ``knee_drive`` turn with the knee actuator's output (and, by the chain, with the shank).

    Args:
        thigh_length_m: hip axis to knee axis, float or shape (n,).
        d: dimensions.
    """
    length = 1000.0 * thigh_length_m
    return (*_sandwich(length, d), *hip_joints(d), *chain_parts(length, d), *_knee_seats(length, d))


def _sandwich(length: Numbers, d: LegDimensions) -> tuple[Part, ...]:
    """Both plates, the printed core between them, and what holds them together."""
    half_gap, face = 0.5 * d.gap_mm, d.thigh_face_mm
    bridges = bridges_of(length, d)
    windows = windows_between(bridges, d.thigh_window_half_width_mm)
    bolts = holes_at(bolts_at(bridges), sleeve_hole(M3))
    knee_hole = Circle(radius_mm=d.bearing_outer_radius_mm - 2.0, y_mm=-length)
    cup_pitch = d.bearing_outer_radius_mm + 2.5
    cup_holes = Pattern(radius_mm=M25.hole, pitch_radius_mm=cup_pitch, count=4, phase_rad=np.pi / 4, y_mm=-length)
    # On top of the hip, outside the chain's turn: at 30, 90 and 150 degrees.
    standoffs = tuple(
        (_STANDOFF_PITCH * float(np.cos(a)), _STANDOFF_PITCH * float(np.sin(a)), 0.0)
        for a in (np.pi / 6, np.pi / 2, 5 * np.pi / 6)
    )
    standoff_holes = holes_at(standoffs, sleeve_hole(M3))
    output = Pattern(radius_mm=M3.hole, pitch_radius_mm=d.output_pitch_radius_mm, count=d.output_holes)
    mount = Pattern(radius_mm=M3.hole, pitch_radius_mm=d.mount_pitch_radius_mm, count=d.mount_holes)
    bore = Circle(radius_mm=d.bearing_bore_radius_mm - 2.5)
    # Lightening holes between the bore and the mounting screws.
    relief = min(11.0, 0.5 * (d.mount_pitch_radius_mm - d.coupler_radius_mm - 10.5))
    common = (*windows, *bolts, knee_hole, cup_holes, *standoff_holes)

    def plate(top_radius_mm: float) -> Shape:
        return waisted(
            top_radius_mm=top_radius_mm,
            bottom_radius_mm=d.knee_radius_mm,
            half_width_mm=d.thigh_half_width_mm,
            length_mm=length,
        )

    core_end = _KNEE_END - length
    core_top = BRIDGE - d.first_bridge_mm
    return (
        Part(
            name="thigh_plate_inner",
            role=Role.PLATE,
            material=MATERIALS.aluminium,
            process="laser cut",
            prisms=(
                Prism(
                    outline=plate(_STANDOFF_PITCH + 5.5),
                    z0_mm=-face,
                    z1_mm=-half_gap,
                    holes=(*common, bore, output, Pattern(radius_mm=5.5, pitch_radius_mm=25.5, count=6)),
                ),
            ),
            note="2.5 mm sheet EN AW-6082 T6; countersink the bolt holes outside",
        ),
        Part(
            name="thigh_plate_outer",
            role=Role.PLATE,
            material=MATERIALS.aluminium,
            process="laser cut",
            prisms=(
                Prism(
                    outline=plate(d.rim_radius_mm),
                    z0_mm=half_gap,
                    z1_mm=face,
                    holes=(
                        *common,
                        Circle(radius_mm=d.coupler_radius_mm + 1.0),
                        mount,
                        Pattern(radius_mm=relief, pitch_radius_mm=d.mount_pitch_radius_mm - 5.0 - relief, count=6),
                    ),
                ),
            ),
            note="2.5 mm sheet EN AW-6082 T6; carries the knee actuator; countersink the bolt holes outside",
        ),
        Part(
            name="thigh_core",
            role=Role.CORE,
            material=MATERIALS.printed_plastic,
            process="3D printed",
            prisms=(
                Prism(
                    outline=rectangle(
                        width_mm=2.0 * d.thigh_core_half_width_mm,
                        height_mm=core_top - core_end,
                        y_mm=0.5 * (core_top + core_end),
                    ),
                    z0_mm=-half_gap,
                    z1_mm=half_gap,
                    holes=(*windows, *bolts),
                ),
            ),
            note="print lying on a plate side, solid",
        ),
        Part(
            name="thigh_standoff",
            role=Role.SPACER,
            material=MATERIALS.aluminium,
            process="machined",
            prisms=(
                Prism(
                    outline=Circle(radius_mm=_STANDOFF_RADIUS),
                    z0_mm=-half_gap,
                    z1_mm=half_gap,
                    holes=(Circle(radius_mm=sleeve_hole(M3)),),
                ),
            ),
            places_mm=standoffs,
            note="tube, 7 mm outside, bored 4.2 mm",
        ),
        sleeve_bolt("thigh_bolt", M3, face, (*bolts_at(bridges), *standoffs)),
    )


def _knee_seats(length: Numbers, d: LegDimensions) -> tuple[Part, ...]:
    """The bearings of the knee and their cups, which are screwed to the insides of the plates."""
    half_gap = 0.5 * d.gap_mm
    places = ((0.0, -length, half_gap - d.bearing_width_mm), (0.0, -length, -half_gap))
    pitch = d.bearing_outer_radius_mm + 2.5
    return (
        Part(
            name="knee_bearing_cup",
            role=Role.HOUSING,
            visibility=Visibility.INSIDE,
            material=MATERIALS.aluminium,
            process="machined",
            prisms=(
                Prism(
                    outline=Circle(radius_mm=d.bearing_outer_radius_mm + 5.0),
                    z0_mm=0.0,
                    z1_mm=d.bearing_width_mm,
                    holes=(
                        Circle(radius_mm=d.bearing_outer_radius_mm),
                        Pattern(radius_mm=M25.core, pitch_radius_mm=pitch, count=4, phase_rad=np.pi / 4),
                    ),
                ),
            ),
            places_mm=places,
            note="seat 32 J7, threads M2.5; the plate's lip holds the bearing outwards",
        ),
        *(
            screw_part(
                f"knee_cup_screw_{side}",
                M25,
                visibility=Visibility.OUTSIDE,
                head="countersunk",
                seat_mm=-direction * d.thigh_face_mm,
                grip_mm=d.plate_mm,
                room_mm=_CUP_THREAD,
                direction=direction,
                material=MATERIALS.steel,
                count=4,
                pitch_radius_mm=pitch,
                phase_rad=np.pi / 4,
                places_mm=((0.0, -length, 0.0),),
                note="flush, from outside",
            )
            for side, direction in (("near", 1.0), ("far", -1.0))
        ),
        Part(
            name="knee_bearing",
            role=Role.BEARING,
            material=MATERIALS.steel,
            process="bought",
            prisms=(
                Prism(
                    outline=Circle(radius_mm=d.bearing_outer_radius_mm),
                    z0_mm=0.0,
                    z1_mm=d.bearing_width_mm,
                    holes=(Circle(radius_mm=d.bearing_bore_radius_mm),),
                ),
            ),
            places_mm=places,
            catalogue_mass_kg=d.bearing_kg,
            note="6804, 20 x 32 x 7 mm (ISO 15)",
        ),
    )
