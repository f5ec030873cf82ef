"""Tables on a drawing: what a gear's teeth are cut and measured by, and the toleranced faces. Millimetres, radians.

Base tangent length and dimension between pins after ISO 21771-2; x = 0 unless the gear is shifted:

    W_k = m cos a [pi (k - 1/2) + z inv a] + 2 x m sin a + A cos a
    inv a_M = inv a - d / (z m cos a) + (pi / 2 + 2 x tan a + A / m) / z,   M = z m cos a / cos a_M - d  (even z, ring)

with the allowance A of the tooth's thickness (external) or of the space's width (internal) along the pitch circle.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from pareto_monoped.cad.drawing.bores import number
from pareto_monoped.cad.drawing.dimension import DATUM, FRAME_MM, SECOND, datum, datum_fit, datum_letters, frame
from pareto_monoped.cad.drawing.paper import LETTER_MM, Paper, width_mm
from pareto_monoped.geometry.chains import deviations
from pareto_monoped.geometry.gears import DEDENDUM, FILLET, ExternalGear, InternalGear
from pareto_monoped.geometry.making import (
    GENERAL_SERIES,
    LARGEST_PITCH_DIAMETER_MM,
    RACEWAY_RA_UM,
    RATED_SERIES,
    Fit,
    Length,
    ToothMaking,
    limits,
    thickness_tolerance_mm,
)
from pareto_monoped.geometry.shapes import Numbers

_PIN_MODULES = 1.68  # diameter of measuring pins over module, so that they touch near the pitch circle (DIN 3960)
_SEAT_RA, _FIT_RA, _RACEWAY_RA = "0.8", "1.6", f"{RACEWAY_RA_UM:g}"
"""Arithmetical mean height in micrometres: bearing makers ask 0.8 of seats up to 80 mm, and 1.6 suffices elsewhere."""
_COAXIAL = "Ø0.02"
"""Zone of the axes of seats: about one tolerance of grade 6 at 30 to 50 mm, 16 micrometres (our own choice)."""
_SQUARE = "0.02"
"""Zone of the faces that locate a part along its axis. Makers of bearings ask run-out of shoulders of IT5 to IT6:
13 to 19 micrometres at 50 to 80 mm."""
_SHOULDERS = "shoulders"
_TIP_EDGE = "-0.05 / 0"
"""The general edges of the title block would take half of a small tooth's tip: ours is a tenth of the least module."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Span:
    """A measure of the teeth with its limits."""

    count: int  #: teeth that it spans; 0 for a measure between pins
    pin_mm: float  #: diameter of the pins; 0 for a base tangent
    least_mm: float
    greatest_mm: float


def spanned_teeth(teeth: int, pressure_angle_rad: float, shift: float = 0.0) -> int:
    """Return over how many teeth the base tangent touches x modules off the pitch circle.

    z (tan a_v - inv a - 2 x tan a / z) / pi + 1/2, rounded, with cos(a_v) = z cos(a) / (z + 2 x) (ISO 21771).
    """
    a = pressure_angle_rad
    touch = float(np.arccos(teeth * np.cos(a) / (teeth + 2.0 * shift))) if shift else a
    turned = np.tan(touch) - (np.tan(a) - a) - 2.0 * shift * np.tan(a) / teeth
    return max(int(np.floor(teeth * turned / np.pi + 1.0)), 2)


def base_tangent_mm(gear: ExternalGear, count: int, *, allowance_mm: float) -> float:
    """Return the length over ``count`` teeth whose thickness differs from half the pitch by ``allowance_mm``."""
    m, z, a = float(gear.module_mm), int(gear.teeth), gear.pressure_angle_rad
    along = m * np.cos(a) * (np.pi * (count - 0.5) + z * (np.tan(a) - a)) + 2.0 * float(gear.shift) * m * np.sin(a)
    return float(along + allowance_mm * np.cos(a))


def between_pins_mm(gear: InternalGear, pin_mm: float, *, allowance_mm: float) -> float:
    """Return the distance of two pins in opposite spaces (or nearly so) that are wider by ``allowance_mm``."""
    m, z, a = float(gear.module_mm), int(gear.teeth), gear.pressure_angle_rad
    width = 0.5 * np.pi + 2.0 * float(gear.shift) * np.tan(a) + allowance_mm / m
    angle = _inverse_involute(np.tan(a) - a - pin_mm / (z * m * np.cos(a)) + width / z)
    centres = z * m * np.cos(a) / np.cos(angle)
    return float(centres * (np.cos(0.5 * np.pi / z) if z % 2 else 1.0) - pin_mm)


def measure(
    gear: ExternalGear | InternalGear, *, series: int = GENERAL_SERIES, hole: bool = False, play_mm: float = 0.0
) -> Span:
    """Return what to measure; the drawn teeth have the most material, so backlash is at least as drawn.

    ``series`` is that of the tooth thickness tolerance (DIN 3967), which ends at some diameter (``ValueError``). With
    ``hole`` the outline is that of a hole for a plug of these measures, with ``play_mm`` wider spaces at least.
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
    """Return the rows of the table; ``accuracy_class`` (ISO 1328-1) counts where ``making`` says nothing."""
    spline = hole and isinstance(gear, ExternalGear)
    play = 2.0 * float(gear.backlash_mm) if making is None or making.play_mm is None else making.play_mm
    grade = accuracy_class if making is None else making.accuracy_class
    series = RATED_SERIES if (accuracy_class if making is None else making.quality) else GENERAL_SERIES
    loss = 0.0
    if making:  # at most, where all thicknesses are at the end of their tolerance
        mates = (thickness_tolerance_mm(diameter, series) for diameter in making.mates_mm)
        loss = float(thickness_tolerance_mm(2.0 * float(gear.pitch_radius_mm), series) + max(mates))
    span = measure(gear, series=series, hole=spline, play_mm=play)
    kind = "internal" if isinstance(gear, InternalGear) else "hole of a splined shaft" if spline else "external"
    limits = f"{span.least_mm:.3f} to {span.greatest_mm:.3f}"
    over = f"Base tangent length W over {span.count} teeth{' of a plug' if spline else ''}"
    measured = (f"Between pins of Ø{number(span.pin_mm)}" if span.pin_mm else over, limits)
    return [
        (f"Teeth, {kind}", f"{int(gear.teeth)}"),
        ("Module", number(float(gear.module_mm))),
        ("Pressure angle", f"{number(round(float(np.degrees(gear.pressure_angle_rad)), 3))}°"),
        ("Helix angle", "0°"),
        (
            ("Roots", f"wire-cut along the drawing, R {number(round(float(gear.fillet_mm), 3))}")
            if isinstance(gear, InternalGear)
            else ("Basic rack", f"ISO 53, h {DEDENDUM:g} m, fillet {FILLET:g} m")
        ),
        ("Profile shift x, outwards", number(round(float(gear.shift), 4))),
        ("Pitch diameter", number(2.0 * float(gear.pitch_radius_mm))),
        *(_hole_circles(gear) if spline else _circles(gear)),
        measured,
        ("Tooth thickness tolerance", f"DIN 3967, series {series}"),
        ("Accuracy of the teeth", f"ISO 1328-1 class {grade or 8}"),
        # The dimension chains of tips take no more.
        *([("Radial runout of the tips", "at most that of the teeth")] if making is None or making.quality else ()),
        ("Backlash of the pair, at least", number(play)),
        *([("Backlash of the pair, at most", number(round(play + loss, 3)))] if making else ()),
        *(_making_rows(making, hardness) if making is not None else ()),
    ]


def _circles(gear: ExternalGear | InternalGear) -> list[tuple[str, str]]:
    """Return tip, form and root diameter: a tip may be lower, but never reach farther into its mate."""
    return [
        ("Tip diameter", _toleranced(gear.tip_radius_mm, "H9" if isinstance(gear, InternalGear) else "h9")),
        ("Form diameter, involute from there", number(round(2.0 * float(gear.form_radius_mm), 3))),
        ("Root diameter", number(round(2.0 * float(gear.root_radius_mm), 3))),
    ]


def _hole_circles(shaft: ExternalGear | InternalGear) -> list[tuple[str, str]]:
    """Return the same of a hole that has a splined shaft's outline: it may be wider on both circles, never narrower."""
    return [
        ("Outer diameter, clear of the shaft's tips", _toleranced(shaft.tip_radius_mm, "H9")),
        ("Inner diameter, clear of the shaft's roots", _toleranced(shaft.root_radius_mm, "H9")),
        ("Involute from the diameter", number(round(2.0 * float(shaft.form_radius_mm), 3))),
        ("Fit and gap of the adhesive", "on the flanks"),
    ]


def _toleranced(radius_mm: Numbers, zone: str) -> str:
    """Return a diameter with its class and limits."""
    diameter = 2.0 * float(radius_mm)
    return f"{number(round(diameter, 3))} {zone} ({_limits(Fit(diameter_mm=diameter, zone=zone))})"


def _making_rows(making: ToothMaking, hardness: str) -> list[tuple[str, str]]:
    """Return what the rating of the teeth takes for granted; of splines, only how they are made."""
    if not making.quality:
        return [("Making", making.making)]
    layer = {"CHD": "Case depth CHD (ISO 18203), finished", "NHD": "Nitriding depth NHD (ISO 18203)"}
    return [
        ("Making", making.making),
        ("Quality of material and treatment", f"ISO 6336-5 {making.quality}"),
        ("Hardness of flanks", hardness),
        ("Hardness of the core", making.core_hardness),
        *([(layer[making.layer], making.layer_text)] if making.layer else []),
        *([("Active diameters", _from_to(making.active_mm))] if making.active_mm else []),
        ("Tip relief", "none"),
        ("Tip edges (ISO 13715)", _TIP_EDGE),
        ("Crowning of the flanks", f"{making.crowning_um:g} µm" if making.crowning_um else "none"),
        ("Roughness of flanks, fillets", f"Rz {making.flank_rz_um:g}, {making.root_rz_um:g} µm at most"),
        ("Radial runout to the datum axis", f"{making.runout_mm:.3f} at most"),
    ]


def _from_to(ends_mm: tuple[float, float]) -> str:
    return " to ".join(number(round(end, 3)) for end in ends_mm)


@lru_cache(maxsize=256)
def _inverse_involute(value: float) -> float:
    """Return the angle whose involute function is ``value``, by Newton's method."""
    angle = float(np.cbrt(3.0 * value))  # inv a = a^3 / 3 + ...
    for _ in range(30):
        step = (np.tan(angle) - angle - value) / np.tan(angle) ** 2
        angle -= float(step)
        if abs(step) < 1e-15:
            break
    return angle


def fit_table(fits: Sequence[Fit], alone: Sequence[bool]) -> Paper | None:
    """Return a row per fit, and one for the faces square to the datum's axis if it carries a bearing.

    ``alone`` tells of each fit whether its face stands around the part's axis; patterns have their place in their
    callouts. Without fits there is no table.
    """
    if not fits:
        return None
    first = datum_fit(fits)
    located = any(fit is first and fit.seat and single for fit, single in zip(fits, alone, strict=True))
    letters = datum_letters(fits, alone)
    second = SECOND in letters
    axis = f"{DATUM}-{SECOND}" if second else DATUM
    names = [*(f"Ø{fit.text}" for fit in fits), *([_SHOULDERS] if located else [])]
    widths = [max(width_mm(name, LETTER_MM) for name in names) + 3.0, 30.0, 16.0, 44.0 if second else 34.0]
    high = FRAME_MM + 2.0
    paper = Paper()
    top = high * (len(names) + 1)
    paper.text("Fits (ISO 286-2)", 0.0, top + 1.6)
    rows = [("Face", "Limits", "Ra, µm", "Geometry"), *((f"Ø{fit.text}", _limits(fit), "", "") for fit in fits)]
    for k, cells in enumerate([*rows, *([(_SHOULDERS, "", _FIT_RA, "")] if located else [])]):
        y, x = top - (k + 1) * high, 0.0
        for cell, width in zip(cells, widths, strict=True):
            paper.text(cell, x + 1.5, y + 0.5 * (high - LETTER_MM))
            x += width
        paper.line([(0.0, y), (x, y)])
    for k, (fit, single) in enumerate(zip(fits, alone, strict=True)):
        y = top - (k + 2) * high
        finish = _RACEWAY_RA if fit.raceway else _SEAT_RA if fit.seat else _FIT_RA
        paper.text(finish, sum(widths[:2]) + 1.5, y + 0.5 * (high - LETTER_MM))
        x = sum(widths[:3]) + 1.5
        letter = letters[k]
        if letter:
            datum(paper, letter, x, y + 1.0)
            x += FRAME_MM + 1.0
        if single and axis != letter:
            frame(paper, ["coaxial", _COAXIAL, axis], x, y + 1.0)
        elif not single:
            paper.text("see view", x, y + 0.5 * (high - LETTER_MM))
    if located:
        frame(paper, ["square", _SQUARE, axis], sum(widths[:3]) + 1.5, 1.0)
    x = 0.0
    for width in (*widths, 0.0):
        paper.line([(x, 0.0), (x, top)])
        x += width
    paper.line([(0.0, top), (sum(widths), top)])
    return paper


def length_rows(lengths: Sequence[Length], datum_mm: float) -> list[tuple[str, str]]:
    """Return a row per length with limits: where its faces are on the running dimensions, and length with limits."""
    rows = []
    for one in sorted(lengths, key=lambda one: (abs(float(one.z0_mm) - datum_mm), one.nominal_mm)):
        near, far = sorted(abs(float(z) - datum_mm) for z in (one.z0_mm, one.z1_mm))
        off = deviations(float(one.lower_mm), float(one.upper_mm))
        rows.append(
            (f"{one.name.capitalize()}, from {number(near)} to {number(far)}", f"{number(one.nominal_mm)} {off}")
        )
    return rows


def _limits(fit: Fit) -> str:
    found = limits(float(fit.diameter_mm), fit.zone)
    return " / ".join(f"{deviation:+.3f}" if deviation else "0" for deviation in (found.upper_mm, found.lower_mm))
