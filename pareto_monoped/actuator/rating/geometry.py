"""Factors that follow from the teeth alone: zone, contact ratio, single pair contact, tooth form, notch, rim.

Spur gears with or without profile shift, basic rack ISO 53. Every number may be an array of shape (n,).
"""

from dataclasses import dataclass

import numpy as np

from pareto_monoped.geometry.gears import (
    ADDENDUM,
    DEDENDUM,
    FILLET,
    PRESSURE_ANGLE_RAD,
    ExternalGear,
    InternalGear,
    half_angle,
    rounding_off_middle,
)
from pareto_monoped.geometry.shapes import Numbers

_NEWTON_STEPS = 5
"""From the start used, four steps reach rounding for 12 teeth or more; one is spare."""
TOOTH_DEPTH = ADDENDUM + DEDENDUM
_NOWHERE = 1e-9
"""Radius of curvature, over that of the base circles, squared, below which there is no flank."""


def zone_factor(working_angle_rad: Numbers) -> Numbers:
    """Return Z_H = sqrt(2 cos(alpha_w) / (cos(alpha)^2 sin(alpha_w))) of spur gears (ISO 6336-2, clause 6)."""
    factor: Numbers = np.sqrt(2.0 / np.tan(working_angle_rad)) / np.cos(PRESSURE_ANGLE_RAD)
    return factor


def contact_ratio_factor(contact_ratio: Numbers) -> Numbers:
    """Return Z_epsilon of spur gears: sqrt((4 - epsilon_alpha) / 3) (ISO 6336-2, clause 8)."""
    return np.sqrt((4.0 - contact_ratio) / 3.0)


def root_contact_ratio_factor(contact_ratio: Numbers) -> Numbers:
    """Return Y_epsilon, 0.25 + 0.75 / epsilon_alpha (ISO 6336-3:1996, clause 8).

    Method B applies the load at the outer point of single pair contact, and does without Y_epsilon in the stress. The
    factor still bounds K_Falpha (ISO 6336-1, clause 8.3.4).
    """
    return 0.25 + 0.75 / contact_ratio


def _tip_tangent(gear: ExternalGear | InternalGear) -> Numbers:
    return np.sqrt(np.square(gear.tip_radius_mm / gear.base_radius_mm) - 1.0)


def single_contact_factors(
    pinion: ExternalGear, wheel: ExternalGear | InternalGear, contact_ratio: Numbers, working_angle_rad: Numbers
) -> tuple[Numbers, Numbers]:
    """Return Z_B and Z_D: contact stress at the inner point of single pair contact over that at the pitch point.

    ISO 6336-2, clause 6.3; not below 1. For an internal mesh z2 counts as negative and Z_D is 1. At contact ratios
    above 2, the same point, one base pitch before the end of contact, is the inner point of two pair contact. Far below
    1, it may lie inside a base circle: the factor is then next to infinite.
    """
    angle_1, angle_2 = 2.0 * np.pi / pinion.teeth, 2.0 * np.pi / wheel.teeth
    internal = isinstance(wheel, InternalGear)
    side = -1.0 if internal else 1.0
    tip_1, tip_2 = _tip_tangent(pinion), _tip_tangent(wheel)
    beyond, pitch = contact_ratio - 1.0, np.tan(working_angle_rad)
    of_pinion = pitch / np.sqrt(np.maximum((tip_1 - angle_1) * (tip_2 - side * beyond * angle_2), _NOWHERE))
    if internal:
        return np.maximum(of_pinion, 1.0), np.ones(np.shape(of_pinion))[()]
    of_wheel = pitch / np.sqrt(np.maximum((tip_2 - angle_2) * (tip_1 - beyond * angle_1), _NOWHERE))
    return np.maximum(of_pinion, 1.0), np.maximum(of_wheel, 1.0)


@dataclass(frozen=True, slots=True, kw_only=True)
class ToothForm:
    """The root of a tooth loaded at the outer point of single pair contact."""

    form_factor: Numbers  #: Y_F
    stress_correction: Numbers  #: Y_S
    notch: Numbers  #: notch parameter q_s = s_Fn / (2 rho_F)


def tooth_form(gear: ExternalGear | InternalGear, contact_ratio: Numbers) -> ToothForm:
    """Return Y_F and Y_S by method B (ISO 6336-3:2006, clauses 6.2 and 7.2).

    The critical section lies where the fillet's tangent makes 30 degrees with the tooth's centre line, 60 degrees in an
    internal gear, whose root is an arc. Lengths in modules. At contact ratios above 2, the point of loading, one base
    pitch after the beginning of contact, is the inner point of triple pair contact, as the standard asks.

    Thinned teeth are those of the generating profile shift x_E, which also makes their roots deeper. ISO 6336-3 lets
    one take x instead up to a thinning of 0.05 modules (clause 6.2; cited from memory). Here x_E is taken always.
    """
    internal = isinstance(gear, InternalGear)
    radius, load_angle = _load_point(gear, contact_ratio)
    half_tooth = half_angle(gear, radius)
    if internal:
        half_tooth = half_tooth - np.pi / gear.teeth  # the flank leans the other way
    half_mm, height_mm, fillet_mm = _arc_section(gear) if isinstance(gear, InternalGear) else _rack_section(gear)
    # Angle between the force and the normal to the tooth's centre line: alpha_Fen. The force's line touches the base
    # circle, so that it crosses the centre line at base radius / cos(alpha_Fen).
    force_angle = load_angle - half_tooth
    crossing_mm = gear.base_radius_mm / np.cos(force_angle)
    arm_mm = height_mm - crossing_mm if internal else crossing_mm - height_mm
    notch, slenderness = half_mm / fillet_mm, 2.0 * half_mm / arm_mm
    bent = 1.5 * arm_mm * gear.module_mm / np.square(half_mm)
    return ToothForm(
        form_factor=bent * np.cos(force_angle) / np.cos(PRESSURE_ANGLE_RAD),
        stress_correction=(1.2 + 0.13 * slenderness) * np.power(notch, 1.0 / (1.21 + 2.3 / slenderness)),
        notch=notch,
    )


def _arc_section(gear: InternalGear) -> tuple[Numbers, Numbers, Numbers]:
    """Return half the thickness of a ring's tooth at its root, how far that is from the axis, and its radius."""
    centre, angle = gear.root_radius_mm - gear.fillet_mm, np.pi / gear.teeth - gear.fillet_angle_rad
    return (
        centre * np.sin(angle) - 0.5 * gear.fillet_mm,
        centre * np.cos(angle) + 0.5 * np.sqrt(3.0) * gear.fillet_mm,
        gear.fillet_mm,
    )


def _rack_section(gear: ExternalGear) -> tuple[Numbers, Numbers, Numbers]:
    """Return the same of a tooth that the rack cuts (ISO 6336-3, equations of clause 6.2)."""
    z = np.asarray(gear.teeth, dtype=np.float64)
    # Where the centre of the rack's tip rounding is: off the middle of the rack's tooth, and below the pitch line (G).
    depth = FILLET - DEDENDUM + gear.generating_shift
    theta = _tangent_angle(z, depth, 2.0 / z * (0.5 * np.pi - rounding_off_middle(gear.pressure_angle_rad)))
    root = depth / np.cos(theta) - FILLET
    radius = FILLET + 2.0 * depth**2 / (np.cos(theta) * (z * np.square(np.cos(theta)) - 2.0 * depth))
    half = 0.5 * (z * np.sin(np.pi / 3.0 - theta) + np.sqrt(3.0) * root)
    height = 0.5 * (z * np.cos(np.pi / 3.0 - theta) + root)
    return half * gear.module_mm, height * gear.module_mm, radius * gear.module_mm


def _tangent_angle(z: Numbers, depth: Numbers, turned: Numbers) -> Numbers:
    """Return the auxiliary angle theta: theta = (2 G / z) tan(theta) - H, by Newton's method."""
    constant = turned - np.pi / 3.0
    theta = np.full(np.shape(z), np.pi / 6.0)[()]
    for _ in range(_NEWTON_STEPS):
        miss = theta - 2.0 * depth / z * np.tan(theta) + constant
        theta = theta - miss / (1.0 - 2.0 * depth / z / np.square(np.cos(theta)))
    return theta


def _load_point(gear: ExternalGear | InternalGear, contact_ratio: Numbers) -> tuple[Numbers, Numbers]:
    """Return the radius in mm of the outer point of single pair contact, and the pressure angle there."""
    sign = -1.0 if isinstance(gear, InternalGear) else 1.0
    base, pitch = gear.base_radius_mm, np.pi * gear.module_mm * np.cos(PRESSURE_ANGLE_RAD)
    along = np.sqrt(np.square(gear.tip_radius_mm) - np.square(base)) - sign * pitch * (contact_ratio - 1.0)
    return np.hypot(along, base), np.arctan(along / base)


def external_rim_factor(rim_over_depth: Numbers) -> Numbers:
    """Return Y_B of sun or planet (ISO 6336-3, clause 9.2), below the standard's 0.5 tooth depths by the same curve."""
    thin = 1.6 * np.log(2.242 / np.maximum(rim_over_depth, 0.1))
    return np.where(rim_over_depth < 1.2, np.maximum(thin, 1.0), 1.0)[()]


def internal_rim_factor(rim_over_module: Numbers) -> Numbers:
    """Return Y_B of a ring by the rim's thickness over the module (ISO 6336-3, clause 9.3), also below 1.75."""
    thin = 1.15 * np.log(8.324 / np.maximum(rim_over_module, 0.1))
    return np.where(rim_over_module < 3.5, np.maximum(thin, 1.0), 1.0)[()]
