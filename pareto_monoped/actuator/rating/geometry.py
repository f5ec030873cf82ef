"""Factors that follow from the teeth alone: zone, contact ratio, single pair contact, tooth form, notch, rim.

Spur gears with or without profile shift, basic rack ISO 53. Every number may be an array of shape (n,).
"""

from dataclasses import dataclass

import numpy as np

from pareto_monoped.geometry.gears import ADDENDUM, DEDENDUM, FILLET, PRESSURE_ANGLE_RAD, ExternalGear, InternalGear
from pareto_monoped.geometry.shapes import Numbers

_TANGENT = np.tan(PRESSURE_ANGLE_RAD)
_INVOLUTE = _TANGENT - PRESSURE_ANGLE_RAD
_NEWTON_STEPS = 5
"""From the start used, four steps reach rounding for 12 teeth or more; one is spare."""
_LEAST_FILLET = 0.02
"""Least fillet radius in modules. A rack cannot make rings of very large shift; such roots count as sharply notched."""
TOOTH_DEPTH = ADDENDUM + DEDENDUM


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
    above 2, the same point, one base pitch before the end of contact, is the inner point of two pair contact.
    """
    angle_1, angle_2 = 2.0 * np.pi / pinion.teeth, 2.0 * np.pi / wheel.teeth
    internal = isinstance(wheel, InternalGear)
    side = -1.0 if internal else 1.0
    tip_1, tip_2 = _tip_tangent(pinion), _tip_tangent(wheel)
    beyond, pitch = contact_ratio - 1.0, np.tan(working_angle_rad)
    of_pinion = pitch / np.sqrt((tip_1 - angle_1) * (tip_2 - side * beyond * angle_2))
    if internal:
        return np.maximum(of_pinion, 1.0), np.ones(np.shape(of_pinion))[()]
    of_wheel = pitch / np.sqrt((tip_2 - angle_2) * (tip_1 - beyond * angle_1))
    return np.maximum(of_pinion, 1.0), np.maximum(of_wheel, 1.0)


@dataclass(frozen=True, slots=True, kw_only=True)
class ToothForm:
    """The root of a tooth loaded at the outer point of single pair contact."""

    form_factor: Numbers  #: Y_F
    stress_correction: Numbers  #: Y_S
    notch: Numbers  #: notch parameter q_s = s_Fn / (2 rho_F)


def thinned_shift(gear: ExternalGear | InternalGear, thinning_mm: Numbers) -> Numbers:
    """Return x_E, the shift at which the rack generates teeth that are thinner by ``thinning_mm`` on the reference
    circle.

    x_E = x - A / (2 m tan(alpha)) (ISO 21771), with x as the standard counts it: in a ring, inwards.
    """
    sign = -1.0 if isinstance(gear, InternalGear) else 1.0
    thinned: Numbers = gear.shift * sign - 0.5 * thinning_mm / (gear.module_mm * _TANGENT)
    return thinned


def tooth_form(gear: ExternalGear | InternalGear, contact_ratio: Numbers, thinning_mm: Numbers = 0.0) -> ToothForm:
    """Return Y_F and Y_S by method B (ISO 6336-3:2006, clauses 6.2 and 7.2).

    The critical section lies where the fillet's tangent makes 30 degrees with the tooth's centre line, 60 degrees in an
    internal gear. An internal gear counts as one with a negative number of teeth. Its fillet is that of the basic rack:
    the ring is cut by wire or with a large cutter. Lengths in modules. At contact ratios above 2, the point of loading,
    one base pitch after the beginning of contact, is the inner point of triple pair contact, as the standard asks.

    Thinned teeth are those of the generating profile shift x_E, which also makes their roots deeper. ISO 6336-3 lets
    one take x instead up to a thinning of 0.05 modules (clause 6.2; cited from memory). Here x_E is taken always.

    ``thinning_mm``: by how much the tooth is thinner than without backlash, on the reference circle.
    """
    internal = isinstance(gear, InternalGear)
    sign = -1.0 if internal else 1.0
    z, shift = np.asarray(gear.teeth, dtype=np.float64) * sign, thinned_shift(gear, thinning_mm)
    # Distance of the centre of the rack's tip rounding from the middle of its tooth (E), and below the pitch line (G).
    distance = (
        0.25 * np.pi - DEDENDUM * _TANGENT - (1.0 - np.sin(PRESSURE_ANGLE_RAD)) * FILLET / np.cos(PRESSURE_ANGLE_RAD)
    )
    depth = FILLET - DEDENDUM + shift
    theta = _tangent_angle(z, depth, 2.0 / z * (0.5 * np.pi - distance), internal=internal)
    root = depth / np.cos(theta) - FILLET
    radius = FILLET + 2.0 * depth**2 / (np.cos(theta) * (z * np.square(np.cos(theta)) - 2.0 * depth))
    radius = np.maximum(radius, _LEAST_FILLET)
    load_diameter, load_angle = _load_point(gear, contact_ratio)
    # Angle between the force and the normal to the tooth's centre line: alpha_Fen.
    half_tooth = (0.5 * np.pi + 2.0 * shift * _TANGENT) / z + _INVOLUTE - (np.tan(load_angle) - load_angle)
    force_angle = load_angle - half_tooth
    lever = (np.cos(half_tooth) - np.sin(half_tooth) * np.tan(force_angle)) * load_diameter
    if internal:
        thickness = z * np.sin(np.pi / 6.0 - theta) + root
        arm = 0.5 * (lever - z * np.cos(np.pi / 6.0 - theta) - np.sqrt(3.0) * root)
    else:
        thickness = z * np.sin(np.pi / 3.0 - theta) + np.sqrt(3.0) * root
        arm = 0.5 * (lever - z * np.cos(np.pi / 3.0 - theta) - root)
    notch = thickness / (2.0 * radius)
    slenderness = thickness / arm
    return ToothForm(
        form_factor=6.0 * arm * np.cos(force_angle) / (np.square(thickness) * np.cos(PRESSURE_ANGLE_RAD)),
        stress_correction=(1.2 + 0.13 * slenderness) * np.power(notch, 1.0 / (1.21 + 2.3 / slenderness)),
        notch=notch,
    )


def _tangent_angle(z: Numbers, depth: Numbers, turned: Numbers, *, internal: bool) -> Numbers:
    """Return the auxiliary angle theta: theta = (2 G / z) tan(theta) - H, by Newton's method."""
    constant = turned - (np.pi / 6.0 if internal else np.pi / 3.0)
    theta = np.full(np.shape(z), np.pi / 6.0)[()]
    for _ in range(_NEWTON_STEPS):
        miss = theta - 2.0 * depth / z * np.tan(theta) + constant
        theta = theta - miss / (1.0 - 2.0 * depth / z / np.square(np.cos(theta)))
    return theta


def _load_point(gear: ExternalGear | InternalGear, contact_ratio: Numbers) -> tuple[Numbers, Numbers]:
    """Return d_en of the outer point of single pair contact, in modules, and the angle there; negative for a ring."""
    sign = -1.0 if isinstance(gear, InternalGear) else 1.0
    base, tip = gear.base_radius_mm / gear.module_mm, gear.tip_radius_mm / gear.module_mm
    pitch = np.pi * np.cos(PRESSURE_ANGLE_RAD)
    along = np.sqrt(np.square(tip) - np.square(base)) - sign * pitch * (contact_ratio - 1.0)
    radius = np.sqrt(np.square(along) + np.square(base))
    return 2.0 * sign * radius, np.arctan(along / base)


def external_rim_factor(rim_over_depth: Numbers) -> Numbers:
    """Return Y_B of sun or planet (ISO 6336-3, clause 9.2), below the standard's 0.5 tooth depths by the same curve."""
    thin = 1.6 * np.log(2.242 / np.maximum(rim_over_depth, 0.1))
    return np.where(rim_over_depth < 1.2, np.maximum(thin, 1.0), 1.0)[()]


def internal_rim_factor(rim_over_module: Numbers) -> Numbers:
    """Return Y_B of a ring by the rim's thickness over the module (ISO 6336-3, clause 9.3), also below 1.75."""
    thin = 1.15 * np.log(8.324 / np.maximum(rim_over_module, 0.1))
    return np.where(rim_over_module < 3.5, np.maximum(thin, 1.0), 1.0)[()]
