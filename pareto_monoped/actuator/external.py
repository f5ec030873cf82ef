"""Parts of the ESSPG: gearbox in front of the framed motor."""

from dataclasses import replace

import numpy as np

from pareto_monoped.actuator.external_housing import BACK_BORE_MM, housing_parts
from pareto_monoped.actuator.features import (
    MOTOR_TAPPED_HOLE_MM,
    centre_hole,
    coupling_dowels,
    coupling_part,
    encoder_parts,
    motor_holes,
    rotor_part,
    seat_between,
    shaft_end,
    slab,
    stator_part,
    sun_part,
    tube,
)
from pareto_monoped.actuator.front import carrier_parts, gear_parts
from pareto_monoped.actuator.layout import (
    COUPLING_DOWEL,
    DOWEL_STANDS_OUT_MM,
    NECK_SET,
    ExternalLayout,
    Layout,
    external_layout,
)
from pareto_monoped.actuator.motor import HolePattern, Motor, envelope_length, motor_order
from pareto_monoped.actuator.settings import ActuatorSettings
from pareto_monoped.geometry.parts import Part
from pareto_monoped.geometry.roles import Group, Joint, JointKind, Role
from pareto_monoped.geometry.screws import Screw, clearance, screw_for, screw_part
from pareto_monoped.geometry.shapes import Pattern

_MOTOR_THREAD_MM = 5.0
"""How deep screws go into the base of a framed motor: M5 x 8 through the backplate."""
_HUB_MM = 3.0
"""Metal around the spline in the coupling; our own choice."""
_SHAFT_MM, _SHAFT_BORE_MM = 4.0, 4.5
"""Radii of a framed motor's shaft and of its bore in the base. The data sheets show no dimension of it; our own
assumption, with the rear end flush with the base."""
_ROTOR_HOLE_MM = 0.2
"""Clearance hole less screw diameter in the coupling (ISO 273, fine: 3.2 mm for M3)."""
_ROTOR_TAPPED_MM = -0.5
"""Tapping hole less thread diameter in the motor's turning face (ISO 2306: 2.5 mm for M3)."""
_RIM_LESS_MM = 1.5
"""By how much the rim around the coupling's screws may be narrower than ``coupling.rim_mm``, which is for the heads."""
_HEAD_RIM_MM = 0.1
"""Least metal outside the heads, whose cones are drawn sharp: real heads leave 0.3 mm more for M3, 0.5 mm for M4."""
_WEB_MM, _HALF_WEB_MM = 2.0, 1.0
"""Least metal between the coupling's lightening holes and its screws, and half of it between two such holes."""
_LEAST_WINDOW_MM = 2.0
"""Radius below which a lightening hole is not worth drilling."""


def external_parts(at: Layout, motor: Motor, settings: ActuatorSettings) -> tuple[Part, ...]:
    """Build all parts of an ESSPG, or of many at once.

    The motor's base is screwed to the backplate. Its turning face carries the coupling with the sun's shaft. The casing
    bridges the motor from the backplate to the ring housing, which carries ring and main bearing.
    """
    shell = external_layout(at, motor, settings)
    return (
        *gear_parts(at, settings),
        *carrier_parts(at, settings),
        *_turning_parts(at, shell, motor, settings),
        *housing_parts(at, shell, motor, settings),
        *_motor_screws(shell, motor, settings),
        *_motor_parts(at, shell, motor, settings),
        *encoder_parts(shell.z_plate, shell.z_end, BACK_BORE_MM, "motor_rotor"),
    )


def _turning_parts(at: Layout, shell: ExternalLayout, motor: Motor, settings: ActuatorSettings) -> tuple[Part, ...]:
    """Build what turns with the motor: the sun in one piece with its splined shaft, the coupling, and its dowels."""
    data, output, dowels = settings.parts, _output(motor), _dowel_holes(motor)
    spline, screw, through = data.spline.external, _output_screw(output), _rotor_holes(output, _ROTOR_HOLE_MM)
    r_coupling = 0.5 * output.pitch_circle_mm + max(
        0.5 * output.diameter_mm + data.coupling.rim_mm - _RIM_LESS_MM, screw.countersunk + _HEAD_RIM_MM
    )
    rear, windows = centre_hole(shell.z_motor, 1.0), _coupling_windows(float(spline.tip_radius_mm), output)
    return (
        replace(
            sun_part(
                at,
                shell.neck,
                settings,
                spline,
                data.spline.sun_shaft_radius_mm,
                behind=(
                    *seat_between(shell.z_coupling, at.z_gear_back, data.spline.sun_shaft_radius_mm),
                    *slab(rear.high_mm, shell.z_coupling, spline),
                    *slab(shell.z_motor, rear.high_mm, spline, *rear.shapes),
                ),
                seat_mm=data.spline.sun_shaft_radius_mm,
                rear=rear,
            ),
            at_assembly=f"{NECK_SET}; with the case closed, turn the output by hand until the motor has found its "
            "place, and tighten the screws in its base before the adhesive sets",
        ),
        coupling_part(
            slab(shell.z_motor, shell.z_coupling, r_coupling, spline, through, dowels, *windows),
            spline,
            clearance(screw, (through,), shell.z_motor, shell.z_coupling, countersunk="high"),
            "motor's turning face",
            settings,
        ),
        coupling_dowels(
            dowels,
            shell.z_motor - shell.base_mm,
            shell.base_mm + shell.coupling_mm + DOWEL_STANDS_OUT_MM,
            "turning face",
            settings,
        ),
    )


def _dowel_holes(motor: Motor) -> Pattern:
    """Return a dowel hole between every two screws of the turning face, whose friction alone carries too little."""
    return COUPLING_DOWEL.between(_rotor_holes(_output(motor), _ROTOR_HOLE_MM))


def _coupling_windows(hub_mm: float, output: HolePattern) -> tuple[Pattern, ...]:
    """Return six lightening holes between the coupling's hub and its bolt circle, as large as their webs allow."""
    low, high = hub_mm + _HUB_MM, 0.5 * (output.pitch_circle_mm - output.diameter_mm) - _WEB_MM
    middle = 0.5 * (low + high)
    radius = min(0.5 * (high - low) - _HALF_WEB_MM, middle * np.sin(np.pi / 6.0) - _HALF_WEB_MM)
    return (Pattern(radius_mm=radius, pitch_radius_mm=middle, count=6),) if radius >= _LEAST_WINDOW_MM else ()


_BY_HAND = "finger-tight now, as only the sun centres the motor: they are tightened once it has turned in its coupling"


def _motor_screws(shell: ExternalLayout, motor: Motor, settings: ActuatorSettings) -> tuple[Part, ...]:
    """Build the screws into the motor's turning face and into its base."""
    casing, steel = settings.parts.casing, settings.materials.steel
    output, base_holes = _output(motor), motor.mount_holes
    assert base_holes is not None
    return (
        screw_part(
            "coupling_screw",
            _output_screw(output),
            head="countersunk",
            seat_mm=shell.z_coupling,
            grip_mm=shell.coupling_mm,
            room_mm=shell.base_mm,
            direction=-1.0,
            material=steel,
            holes=_rotor_holes(output, _ROTOR_HOLE_MM),
            group=Group.ROTOR,
            note="into the motor's turning face, flush",
        ),
        replace(
            screw_part(
                "stator_screw",
                screw_for(base_holes.diameter_mm, 0.5 * base_holes.diameter_mm + 0.5 * MOTOR_TAPPED_HOLE_MM),
                head="cap",
                seat_mm=shell.z_end,
                grip_mm=casing.plate_mm,
                room_mm=_MOTOR_THREAD_MM,
                direction=1.0,
                material=steel,
                holes=motor_holes(motor, MOTOR_TAPPED_HOLE_MM),
                group=Group.HOUSING,
                role=Role.STATOR_SCREW,
                note="into the motor's base; left out where the journal's screws go there",
            ),
            at_assembly=_BY_HAND,
        ),
    )


def _motor_parts(at: Layout, shell: ExternalLayout, motor: Motor, settings: ActuatorSettings) -> tuple[Part, ...]:
    """Build the envelopes of stator and rotor, with their shares of the motor's mass."""
    clearance = settings.parts.casing.rotor_clearance_mm
    frame, rotor_share, base = motor.framed, motor.rotor_mass_share, shell.base_mm
    assert frame is not None
    z_motor, z_plate, holes = shell.z_motor, shell.z_plate, motor_holes(motor, MOTOR_TAPPED_HOLE_MM)
    return (
        stator_part(
            material=settings.materials.motor_stator,
            prisms=(
                *slab(z_plate, z_plate + base, at.r_stator_out, _SHAFT_BORE_MM, holes),
                *tube(z_plate + base, z_motor - base - clearance, at.r_stator_out, at.r_stator_in),
            ),
            catalogue_mass_kg=(1.0 - rotor_share) * frame.mass_kg,
            catalogue_price_eur=motor.price_share_eur(1.0 - rotor_share),
            purchases=(motor_order(motor, "framed"),),
            note="stator, base and bearings",
        ),
        rotor_part(
            material=settings.materials.motor_rotor,
            prisms=(
                *slab(
                    z_motor - base,
                    z_motor,
                    at.r_motor,
                    _rotor_holes(_output(motor), _ROTOR_TAPPED_MM),
                    _dowel_holes(motor),
                ),
                *tube(z_plate + base, z_motor - base, at.r_motor, at.r_rotor_in),
                *shaft_end(z_plate, z_motor - base, _SHAFT_MM),
            ),
            catalogue_mass_kg=rotor_share * frame.mass_kg,
            lengths=(envelope_length(z_plate, z_motor),),
            catalogue_price_eur=motor.price_share_eur(rotor_share),
            purchases=(replace(motor_order(motor, "framed"), count=0.0),),
            note="rotor with its face, comes with the stator",
            joint=Joint(kind=JointKind.RUNNING, how="in the motor's own bearings on", partner="motor_stator"),
        ),
    )


def _output(motor: Motor) -> HolePattern:
    assert motor.output_holes is not None
    return motor.output_holes


def _output_screw(output: HolePattern) -> Screw:
    return screw_for(output.diameter_mm, 0.5 * output.diameter_mm + 0.5 * _ROTOR_TAPPED_MM)


def _rotor_holes(output: HolePattern, play_mm: float) -> Pattern:
    """Return the pattern of the motor's turning face; ``play_mm`` is hole less screw diameter."""
    return Pattern(
        radius_mm=0.5 * output.diameter_mm + 0.5 * play_mm,
        pitch_radius_mm=0.5 * output.pitch_circle_mm,
        count=output.count,
    )
