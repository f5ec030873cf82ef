"""One actuator: motor, gearbox, parts, and what it can do."""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

from pareto_monoped.actuator.external import external_parts
from pareto_monoped.actuator.gearset import GearSet, contact_ratios, efficiency
from pareto_monoped.actuator.internal import BACK_THREAD_MM, internal_parts
from pareto_monoped.actuator.layout import Family, Layout, layout
from pareto_monoped.actuator.motor import HolePattern, Motor
from pareto_monoped.actuator.rating.build import build_stage
from pareto_monoped.actuator.rating.sheet import Rating, rate
from pareto_monoped.actuator.rating.width import face_width_mm
from pareto_monoped.actuator.settings import ActuatorSettings
from pareto_monoped.geometry.gears import ExternalGear, InternalGear
from pareto_monoped.geometry.parts import Part
from pareto_monoped.geometry.roles import GREASE, GREASE_G_PER_MM3, SCREWS, Group, Role
from pareto_monoped.geometry.screws import M3
from pareto_monoped.geometry.shapes import Numbers


@dataclass(frozen=True, slots=True, kw_only=True)
class OutputInterface:
    """Output flange, the same on every actuator: its face lies at z = 0 of the actuator frame."""

    flange_radius_mm: float  #: of the turning face
    bolts: HolePattern  #: M3 threads in the flange, the first on the x axis
    dowels: HolePattern  #: holes for dowels in every second gap of the bolts, as deep as the threads
    thread_depth_mm: float  #: depth of these threads


@dataclass(frozen=True, slots=True, kw_only=True)
class MountInterface:
    """How the housing is held, the same on every actuator of a motor and family."""

    housing_radius_mm: float  #: largest radius of the housing
    bolts: HolePattern  #: M3 threads in the face at z = 0, the first on the x axis
    dowels: HolePattern  #: holes for dowels in every gap of the bolts, as deep as the threads
    thread_depth_mm: float  #: depth of these threads
    #: The motor's own mounting pattern in the backplate: threads in an ISSPG; in an ESSPG, clearance holes for the
    #: screws that reach the motor's base
    back_bolts: HolePattern
    back_depth_mm: float  #: depth of these holes: that of the thread (ISSPG) or of the plate (ESSPG)


@dataclass(frozen=True, slots=True, kw_only=True)
class Actuator:
    """A motor with a planetary gearbox, and all its parts in the actuator frame (see ``layout``)."""

    motor: Motor  #: the motor
    family: Family  #: ``ISSPG`` or ``ESSPG``
    gears: GearSet  #: the gear set
    face_width_mm: float  #: of all gears
    ratio: float  #: motor speed over output speed, as the gear set has it
    mass_kg: float  #: sum over the parts
    #: peak_torque_n_m, continuous_torque_n_m: at the output: ratio times the motor's, without losses (paper, section
    #: III-A)
    peak_torque_n_m: float
    continuous_torque_n_m: float
    no_load_speed_rad_per_s: float  #: at the output
    efficiency: float  #: of both gear meshes together
    contact_ratio_sun: float  #: of sun and planet
    contact_ratio_ring: float  #: of planet and ring
    reflected_inertia_kg_m2: float  #: of everything that turns with the motor or in the gearbox, at the output
    length_mm: float  #: from the output face to the back, without the screw heads and the encoder that stand out there
    output: OutputInterface  #: where a link is bolted to the output
    mount: MountInterface  #: where the housing is held
    parts: tuple[Part, ...]  #: every part, including the screws that hold a framed motor
    rating: Rating | None = None  #: of the gears after ISO 6336; None under the rules ``paper``

    def __repr__(self) -> str:
        """One line: motor, gearbox, ratio, mass and torque."""
        return (
            f"Actuator({self.motor.name!r}, {self.family} {self.gears}, {self.ratio:.4f}:1, {self.mass_kg:.3f} kg, "
            f"peak {self.peak_torque_n_m:.1f} N m)"
        )

    @property
    def parts_bolted_at_back(self) -> tuple[Part, ...]:
        """The parts if something is bolted to the back: its screws then hold the framed motor instead of its own."""
        return tuple(part for part in self.parts if part.role is not Role.STATOR_SCREW)

    def mass_breakdown_kg(self) -> dict[str, float]:
        """Return the mass by part, all instances of each."""
        return {part.name: float(part.mass_kg()) for part in self.parts}


def actuator_parts(at: Layout, motor: Motor, family: Family, settings: ActuatorSettings) -> tuple[Part, ...]:
    """Build all parts of one actuator, or of many at once."""
    build = internal_parts if family == "ISSPG" else external_parts
    return build(at, motor, settings)


def actuator_mass_kg(at: Layout, motor: Motor, family: Family, settings: ActuatorSettings) -> Numbers:
    """Return the sum over the parts; the same for one actuator and for many at once."""
    mass: Numbers = 0.0
    for part in actuator_parts(at, motor, family, settings):
        mass = mass + part.mass_kg()
    return mass


def build_actuator(
    motor: Motor,
    family: Family,
    gears: GearSet,
    settings: ActuatorSettings,
    width_mm: float | None = None,
    rating: Rating | None = None,
) -> Actuator:
    """Build the actuator around a gear set, unchecked; ``width_mm`` and ``rating`` are computed where not given."""
    width = float(face_width_mm(gears, motor, family, settings)) if width_mm is None else width_mm
    at = layout(motor, family, gears, width, settings)
    parts = actuator_parts(at, motor, family, settings)
    if settings.rules == "iso6336":
        rating = rating or rate(build_stage(gears, motor, family, settings), width)
    parts = tuple(_finished(part, rating if settings.rules == "iso6336" else None, gears) for part in parts)
    ratio = float(gears.ratio)
    outer, inner = contact_ratios(gears)
    return Actuator(
        motor=motor,
        family=family,
        gears=gears,
        face_width_mm=width,
        ratio=ratio,
        mass_kg=float(sum(part.mass_kg() for part in parts)),
        peak_torque_n_m=ratio * motor.peak_torque_n_m,
        continuous_torque_n_m=ratio * motor.continuous_torque_n_m,
        no_load_speed_rad_per_s=motor.no_load_speed_rad_per_s / ratio,
        efficiency=float(efficiency(gears, settings.materials.gear_steel.mesh_friction_coefficient)),
        contact_ratio_sun=float(outer),
        contact_ratio_ring=float(inner),
        reflected_inertia_kg_m2=reflected_inertia_kg_m2(parts, gears, motor),
        length_mm=-min(float(p.z0_mm) for part in parts if part.role not in _STANDING_OUT for p in part.prisms),
        output=output_interface(settings),
        mount=mount_interface(motor, family, settings),
        parts=parts,
        rating=rating,
    )


_STANDING_OUT = SCREWS | {Role.ELECTRONICS}
"""Roles of what may stand out at the back, where journal or air is."""
_GEAR_OF_GROUP = {Group.ROTOR: "sun", Group.PLANET: "planet", Group.HOUSING: "ring"}
"""Group of a gear -> which one it is; the rating names them so."""


def _finished(part: Part, rating: Rating | None, gears: GearSet) -> Part:
    """Build a gear with its grease, and its least safety factors in the note; any other part as it is."""
    if part.role is not Role.GEAR:
        return part
    part = replace(part, purchases=(replace(GREASE, count=_grease_g(part, gears)),))
    if rating is None:
        return part
    flank, root = rating.of(_GEAR_OF_GROUP[part.group])
    return replace(part, note=f"{part.note}; S_H {flank:.2f}, S_F {root:.2f} (ISO 6336)")


_GREASED = 1.0 / 3.0
"""Of the space between teeth: full gears churn and warm up. Our own choice."""


def _grease_g(part: Part, gears: GearSet) -> float:
    """Return the grease between the teeth of a gear; splines are bonded and have none."""
    teeth = {(number, gears.module_mm) for number in (gears.sun_teeth, gears.planet_teeth, gears.ring_teeth)}
    free_mm3 = 0.0
    for prism in part.prisms:
        width_mm = float(prism.z1_mm) - float(prism.z0_mm)
        for shape in (prism.outline, *prism.holes):
            if isinstance(shape, ExternalGear | InternalGear) and (shape.teeth, shape.module_mm) in teeth:
                free_mm3 += width_mm * abs(math.pi * float(shape.tip_radius_mm) ** 2 - float(shape.area_mm2()))
    return _GREASED * GREASE_G_PER_MM3 * free_mm3


def reflected_inertia_kg_m2(parts: tuple[Part, ...], gears: GearSet, motor: Motor) -> float:
    """Return the inertia at the output of all that moves when it turns: each moment at the square of its speed."""
    # One sum per part: floating-point sums depend on their order, and the results of stored studies on this one.
    return sum(sum(inertia * speed**2 for inertia, speed in terms) for terms in turning_terms(parts, gears, motor))


def turning_terms(parts: tuple[Part, ...], gears: GearSet, motor: Motor) -> Iterator[tuple[tuple[float, float], ...]]:
    """Yield for each part that turns its moments of inertia in kg m2, each with its speed relative to the output's.

    Rotor, sun, coupling and shafts turn at the ratio; the carrier and everything fixed to it turn once; the planets
    turn once on their orbit, and about themselves at 1 - Nr / Np (Willis, ring fixed). The motor's rotor counts with
    the figure of its data sheet, not with its envelope's.
    """
    ratio = float(gears.ratio)
    spin = 1.0 - float(gears.ring_teeth) / float(gears.planet_teeth)
    yield ((motor.rotor_inertia_kg_m2, ratio),)
    for part in parts:
        if part.role is Role.MOTOR_ROTOR or part.group is Group.HOUSING:
            continue
        about_axis = float(part.mass_properties().inertia_about_z_kg_m2)
        if part.group is Group.ROTOR:
            yield ((about_axis, ratio),)
        elif part.group is Group.PLANET:
            orbit = float(part.mass_kg()) * (1e-3 * float(part.pitch_radius_mm)) ** 2
            yield (orbit, 1.0), (about_axis - orbit, spin)
        else:
            yield ((about_axis, 1.0),)


def output_interface(settings: ActuatorSettings) -> OutputInterface:
    """Return the output flange's patterns of bolts and dowels."""
    carrier, data = settings.parts.carrier, settings.parts.interface
    circle, count = data.output_bolt_circle_mm, data.output_bolt_count
    return OutputInterface(
        flange_radius_mm=carrier.flange_radius_mm,
        bolts=HolePattern(pitch_circle_mm=circle, diameter_mm=2.0 * M3.shank, count=count),
        dowels=HolePattern(pitch_circle_mm=circle, diameter_mm=data.output_dowel_mm, count=count // 2),
        thread_depth_mm=carrier.thread_depth_mm,
    )


def mount_interface(motor: Motor, family: Family, settings: ActuatorSettings) -> MountInterface:
    """Return the housing's patterns of bolts and dowels."""
    body = motor.frameless if family == "ISSPG" else motor.framed
    assert body is not None
    assert motor.mount_holes is not None
    casing, data = settings.parts.casing, settings.parts.interface
    radius = 0.5 * body.outer_diameter_mm
    circle, count = 2.0 * (radius + casing.bolt_offset_mm), data.mount_bolt_count
    return MountInterface(
        housing_radius_mm=radius + casing.flange_width_mm,
        bolts=HolePattern(pitch_circle_mm=circle, diameter_mm=2.0 * M3.shank, count=count),
        dowels=HolePattern(pitch_circle_mm=circle, diameter_mm=data.mount_dowel_mm, count=count),
        thread_depth_mm=casing.rim_mm,
        back_bolts=motor.mount_holes,
        back_depth_mm=BACK_THREAD_MM if family == "ISSPG" else casing.plate_mm,
    )
