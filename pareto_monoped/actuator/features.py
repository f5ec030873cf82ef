"""Building blocks of an actuator's parts: slabs, tubes, hole patterns, bearings, notes."""

import numpy as np

from pareto_monoped.actuator.bearings import Bearing
from pareto_monoped.actuator.layout import Layout
from pareto_monoped.actuator.motors import Motor
from pareto_monoped.actuator.settings import ActuatorSettings
from pareto_monoped.geometry.dowels import Dowel
from pareto_monoped.geometry.gears import ExternalGear, InternalGear
from pareto_monoped.geometry.parts import Part, Prism
from pareto_monoped.geometry.roles import Group, Joint, Role, Visibility
from pareto_monoped.geometry.screws import M3
from pareto_monoped.geometry.shapes import Circle, Numbers, Pattern, Shape
from pareto_monoped.materials import GearGrade, Material

SPIGOT_MM = 1.5
"""Height of the backplate's step that centres it in the casing; our own choice."""
END_PLAY_MM = 0.5
"""From the end of the sun's shaft to the output face; our own choice."""
MOTOR_CLEARANCE_HOLE_MM = 0.5
"""Clearance hole less screw diameter for the motor's mounting pattern (ISO 273, medium, M4 and M5)."""
MOTOR_TAPPED_HOLE_MM = -0.8
"""Tapping hole less thread diameter for the motor's mounting pattern (ISO 2306: 4.2 mm for M5)."""


def gear_grade(settings: ActuatorSettings, grade: GearGrade) -> GearGrade | None:
    """The steel of a gear under ``iso6336``; the rules of the paper name none."""
    return None if settings.rules == "paper" else grade


def gear_accuracy(settings: ActuatorSettings) -> int | None:
    """Accuracy class of a gear's teeth under ``iso6336``; the rules of the paper name none."""
    return None if settings.rules == "paper" else settings.parts.rating.accuracy_class


def gear_note(gear: ExternalGear | InternalGear, settings: ActuatorSettings) -> str:
    """A gear's note; '' for arrays. Wire-cutting after hardening would take a hard case off."""
    if np.ndim(gear.teeth):
        return ""
    shift = f"profile shift {gear.shift * gear.module_mm:+.3f} mm (outwards), " if gear.shift else ""
    making = "; hardened steel, wire-cut" if settings.rules == "paper" else ""
    return (
        f"{gear.teeth:g} teeth, module {gear.module_mm:g} mm, 20 degrees, {shift}"
        f"tooth thinned by {gear.backlash_mm:g} mm{making}"
    )


def note_with(text: str, *numbers: Numbers) -> str:
    """A note with numbers filled in; '' for arrays, because notes are used only for single actuators."""
    if any(np.ndim(number) for number in numbers):
        return ""
    return text.format(*(f"{float(number):g}" for number in numbers))


def slab(z0_mm: Numbers, z1_mm: Numbers, outline: Numbers | Shape, *holes: Numbers | Shape) -> tuple[Prism, ...]:
    """One prism between two heights, from radii or shapes; none if a single slab has no height.

    In arrays every prism is kept: those without height weigh nothing.

    Args:
        z0_mm: lower end, float or shape (n,).
        z1_mm: upper end, likewise.
        outline: outer radius in mm or shape.
        holes: likewise.
    """
    if _is_single(z0_mm) and _is_single(z1_mm) and float(z1_mm) - float(z0_mm) < 1e-9:
        return ()
    shapes = tuple(Circle(radius_mm=hole) if isinstance(hole, float | int | np.ndarray) else hole for hole in holes)
    disc = Circle(radius_mm=outline) if isinstance(outline, float | int | np.ndarray) else outline
    return (Prism(outline=disc, z0_mm=z0_mm, z1_mm=z1_mm, holes=shapes),)


def tube(z0_mm: Numbers, z1_mm: Numbers, outer_mm: Numbers, inner_mm: Numbers, *holes: Shape) -> tuple[Prism, ...]:
    """A slab with a central bore; none if a single tube has no wall."""
    if _is_single(outer_mm) and _is_single(inner_mm) and float(outer_mm) - float(inner_mm) < 1e-9:
        return ()
    return slab(z0_mm, z1_mm, outer_mm, inner_mm, *holes)


def _is_single(value: Numbers) -> bool:
    """As ``np.ndim(value) == 0``, which takes ten times as long for a float; a map asks it five thousand times."""
    return getattr(value, "ndim", 0) == 0


def output_holes(settings: ActuatorSettings, radius_mm: float = M3.core) -> Pattern:
    """Bolt pattern of the output flange."""
    data = settings.parts.interface
    return Pattern(radius_mm=radius_mm, pitch_radius_mm=0.5 * data.output_bolt_circle_mm, count=data.output_bolt_count)


def output_dowel_holes(settings: ActuatorSettings) -> Pattern:
    """Holes for dowels in the output flange, in every second gap of its bolts."""
    data = settings.parts.interface
    gap = np.pi / data.output_bolt_count
    return Dowel(diameter_mm=data.output_dowel_mm).holes(data.output_bolt_circle_mm, data.output_bolt_count // 2, gap)


def casing_dowel_holes(at: Layout, settings: ActuatorSettings) -> Pattern:
    """Holes for dowels in the mounting face, in every gap of its bolts."""
    data = settings.parts.interface
    gap = np.pi / data.mount_bolt_count
    return Dowel(diameter_mm=data.mount_dowel_mm).holes(2.0 * at.r_bolts, data.mount_bolt_count, gap)


def casing_holes(at: Layout, settings: ActuatorSettings, radius_mm: float = M3.core) -> Pattern:
    """Bolt pattern of the mounting face, and of the backplate on the casing."""
    return Pattern(radius_mm=radius_mm, pitch_radius_mm=at.r_bolts, count=settings.parts.interface.mount_bolt_count)


def motor_holes(motor: Motor, play_mm: float) -> Pattern:
    """The motor's own mounting pattern.

    Args:
        motor: which one.
        play_mm: hole less screw diameter, ``MOTOR_CLEARANCE_HOLE_MM`` or ``MOTOR_TAPPED_HOLE_MM``.
    """
    holes = motor.mount_holes
    assert holes is not None
    return Pattern(
        radius_mm=0.5 * (holes.diameter_mm + play_mm), pitch_radius_mm=0.5 * holes.pitch_circle_mm, count=holes.count
    )


def vents(inner_mm: Numbers, outer_mm: Numbers, wall_mm: float) -> tuple[Pattern, ...]:
    """As many round holes as fit between two radii, with ``wall_mm`` around each; none if they would be below M3."""
    radius, middle = 0.5 * (outer_mm - inner_mm) - wall_mm, 0.5 * (outer_mm + inner_mm)
    count = np.floor(np.pi / np.arcsin(np.clip((radius + wall_mm) / middle, 0.01, 1.0)))
    count = np.where(radius >= M3.hole, count, 0.0)[()]
    if np.ndim(count) == 0 and count == 0.0:
        return ()
    return (Pattern(radius_mm=radius, pitch_radius_mm=middle, count=count),)


def spigot(z_plate_mm: Numbers, at: Layout, settings: ActuatorSettings) -> tuple[Prism, ...]:
    """The backplate's step that centres it in the casing."""
    return tube(z_plate_mm, z_plate_mm + SPIGOT_MM, at.r_casing, at.r_casing - settings.parts.casing.vent_wall_mm)


def bought_bearing(
    name: str,
    material: Material,
    bearing: Bearing,
    z_front_mm: Numbers,
    group: Group,
    note: str,
    joint: Joint | None = None,
) -> Part:
    """A ball bearing as the ring it fills, with its catalogue mass."""
    inner, outer = 0.5 * bearing.inner_diameter_mm, 0.5 * bearing.outer_diameter_mm
    return Part(
        name=name,
        role=Role.BEARING,
        visibility=Visibility.INSIDE,
        material=material,
        prisms=tube(z_front_mm - bearing.width_mm, z_front_mm, outer, inner),
        process="bought",
        group=group,
        catalogue_mass_kg=bearing.mass_kg,
        note=note_with(
            "{} x {} x {} mm (ISO 15), " + note, bearing.inner_diameter_mm, bearing.outer_diameter_mm, bearing.width_mm
        ),
        joint=joint,
    )
