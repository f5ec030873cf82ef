"""The data table of a gear: what its teeth are cut and measured by. Millimetres, radians.

Base tangent length and dimension between pins after ISO 21771-2; x = 0 unless the gear is shifted:

    W_k = m cos a [pi (k - 1/2) + z inv a] + 2 x m sin a + A cos a
    inv a_M = inv a - d / (z m cos a) + (pi / 2 + 2 x tan a + A / m) / z,   M = z m cos a / cos a_M - d  (even z, ring)

with the allowance A of the tooth's thickness (external) or of the space's width (internal) along the pitch circle.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from pareto_monoped.cad.drawing.bores import number
from pareto_monoped.geometry.gears import DEDENDUM, FILLET, ExternalGear, InternalGear
from pareto_monoped.geometry.making import ToothMaking
from pareto_monoped.geometry.tooth_thickness import (
    GENERAL_SERIES,
    LARGEST_PITCH_DIAMETER_MM,
    RATED_SERIES,
    thickness_tolerance_mm,
)

_PIN_MODULES = 1.68
"""Diameter of measuring pins over module, so that they touch near the pitch circle (DIN 3960)."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Span:
    """A measure of the teeth with its limits.

    Attributes:
        count: teeth that it spans; 0 for a measure between pins.
        pin_mm: diameter of the pins; 0 for a base tangent.
        least_mm, greatest_mm: limits.
    """

    count: int
    pin_mm: float
    least_mm: float
    greatest_mm: float


def spanned_teeth(teeth: int, pressure_angle_rad: float, shift: float = 0.0) -> int:
    """Teeth over which the base tangent touches x modules off the pitch circle.

    z (tan a_v - inv a - 2 x tan a / z) / pi + 1/2, rounded, with cos(a_v) = z cos(a) / (z + 2 x) (ISO 21771).
    """
    a = pressure_angle_rad
    touch = float(np.arccos(teeth * np.cos(a) / (teeth + 2.0 * shift))) if shift else a
    turned = np.tan(touch) - (np.tan(a) - a) - 2.0 * shift * np.tan(a) / teeth
    return max(int(np.floor(teeth * turned / np.pi + 1.0)), 2)


def base_tangent_mm(gear: ExternalGear, count: int, *, allowance_mm: float) -> float:
    """Length over ``count`` teeth whose thickness differs from half the pitch by ``allowance_mm``."""
    m, z, a = float(gear.module_mm), int(gear.teeth), gear.pressure_angle_rad
    along = m * np.cos(a) * (np.pi * (count - 0.5) + z * (np.tan(a) - a)) + 2.0 * float(gear.shift) * m * np.sin(a)
    return float(along + allowance_mm * np.cos(a))


def between_pins_mm(gear: InternalGear, pin_mm: float, *, allowance_mm: float) -> float:
    """Distance between two pins in opposite spaces (or nearly so) that are wider by ``allowance_mm``."""
    m, z, a = float(gear.module_mm), int(gear.teeth), gear.pressure_angle_rad
    width = 0.5 * np.pi + 2.0 * float(gear.shift) * np.tan(a) + allowance_mm / m
    angle = _inverse_involute(np.tan(a) - a - pin_mm / (z * m * np.cos(a)) + width / z)
    centres = z * m * np.cos(a) / np.cos(angle)
    return float(centres * (np.cos(0.5 * np.pi / z) if z % 2 else 1.0) - pin_mm)


def measure(
    gear: ExternalGear | InternalGear, *, series: int = GENERAL_SERIES, hole: bool = False, play_mm: float = 0.0
) -> Span:
    """What to measure, with its limits: the drawn teeth have the most material, so backlash is at least as drawn.

    Args:
        gear: its teeth.
        series: of the tolerance of their thickness, DIN 3967.
        hole: whether an external gear's outline is that of a hole, which a plug of these measures fits.
        play_mm: by how much the spaces of such a hole are at least wider than drawn.

    Raises:
        ValueError: a gear larger than the table of tolerances.
    """
    diameter = 2.0 * float(gear.pitch_radius_mm)
    if diameter > LARGEST_PITCH_DIAMETER_MM:
        raise ValueError(f"pitch diameter {diameter:g} mm: must be at most {LARGEST_PITCH_DIAMETER_MM:g} mm")
    tolerance = float(thickness_tolerance_mm(diameter, series))
    play = float(gear.backlash_mm)
    if isinstance(gear, ExternalGear):
        count = spanned_teeth(int(gear.teeth), gear.pressure_angle_rad, float(gear.shift))
        slack = (play_mm, play_mm + tolerance) if hole else (-tolerance, 0.0)
        least, greatest = (base_tangent_mm(gear, count, allowance_mm=-play + t) for t in slack)
        return Span(count=count, pin_mm=0.0, least_mm=least, greatest_mm=greatest)
    pin = round(_PIN_MODULES * float(gear.module_mm), 2)
    least, greatest = (between_pins_mm(gear, pin, allowance_mm=play + t) for t in (0.0, tolerance))
    return Span(count=0, pin_mm=pin, least_mm=least, greatest_mm=greatest)


def gear_rows(
    gear: ExternalGear | InternalGear,
    *,
    accuracy_class: int | None,
    hole: bool = False,
    making: ToothMaking | None = None,
    hardness: str = "",
) -> list[tuple[str, str]]:
    """The rows of the table: what, and its value.

    Args:
        gear: its teeth.
        accuracy_class: ISO 1328-1, where ``making`` says nothing.
        hole: see ``measure``.
        making: how the teeth are made, if that is known.
        hardness: of their flanks.
    """
    spline = hole and isinstance(gear, ExternalGear)
    play = 2.0 * float(gear.backlash_mm) if making is None or making.play_mm is None else making.play_mm
    grade = accuracy_class if making is None else making.accuracy_class
    series = RATED_SERIES if (accuracy_class if making is None else making.quality) else GENERAL_SERIES
    loss = _loss_mm(gear, making, series) if making else 0.0
    span = measure(gear, series=series, hole=spline, play_mm=play)
    kind = "internal" if isinstance(gear, InternalGear) else "hole of a splined shaft" if spline else "external"
    limits = f"{span.least_mm:.3f} to {span.greatest_mm:.3f}"
    measured = (
        (f"Between pins of Ø{number(span.pin_mm)}", limits)
        if span.pin_mm
        else (f"Base tangent length W over {span.count} teeth{' of a plug' if spline else ''}", limits)
    )
    return [
        (f"Teeth, {kind}", f"{int(gear.teeth)}"),
        ("Module", number(float(gear.module_mm))),
        ("Pressure angle", f"{number(round(float(np.degrees(gear.pressure_angle_rad)), 3))}°"),
        ("Helix angle", "0°"),
        ("Basic rack", f"ISO 53, h {DEDENDUM:g} m, fillet {FILLET:g} m"),
        ("Profile shift x, outwards", number(round(float(gear.shift), 4))),
        ("Pitch diameter", number(2.0 * float(gear.pitch_radius_mm))),
        ("Tip diameter", number(2.0 * float(gear.tip_radius_mm))),
        ("Root diameter", number(2.0 * float(gear.root_radius_mm))),
        measured,
        ("Tooth thickness tolerance", f"DIN 3967, series {series}"),
        ("Accuracy of the teeth", f"ISO 1328-1 class {grade or 8}"),
        ("Backlash of the pair, at least", number(play)),
        *([("Backlash of the pair, at most", number(round(play + loss, 3)))] if making else ()),
        *(_making_rows(making, hardness) if making is not None else ()),
    ]


def _loss_mm(gear: ExternalGear | InternalGear, making: ToothMaking, series: int) -> float:
    """By how much a pair's backlash grows where both thicknesses are at the end of their tolerance; the worst mate."""
    mates = (thickness_tolerance_mm(diameter, series) for diameter in making.mates_mm)
    return float(thickness_tolerance_mm(2.0 * float(gear.pitch_radius_mm), series) + max(mates))


def _making_rows(making: ToothMaking, hardness: str) -> list[tuple[str, str]]:
    """What the rating of the teeth takes for granted; of splines, only how they are made."""
    if not making.quality:
        return [("Making", making.making)]
    layer = {"CHD": "Case depth CHD (ISO 18203), finished", "NHD": "Nitriding depth NHD (ISO 18203)"}
    return [
        ("Making", making.making),
        ("Quality of material and treatment", f"ISO 6336-5 {making.quality}"),
        ("Hardness of flanks", hardness),
        ("Hardness of the core", making.core_hardness),
        *([(layer[making.layer], making.layer_text)] if making.layer else []),
        ("Roughness of flanks, fillets", f"Rz {making.flank_rz_um:g}, {making.root_rz_um:g} µm at most"),
        ("Radial runout to the datum axis", f"{making.runout_mm:.3f} at most"),
    ]


@lru_cache(maxsize=256)
def _inverse_involute(value: float) -> float:
    """The angle whose involute function is ``value``, by Newton's method."""
    angle = float(np.cbrt(3.0 * value))  # inv a = a^3 / 3 + ...
    for _ in range(30):
        step = (np.tan(angle) - angle - value) / np.tan(angle) ** 2
        angle -= float(step)
        if abs(step) < 1e-15:
            break
    return angle
