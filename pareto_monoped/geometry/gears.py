"""Cross-sections of spur gears with involute flanks, with exact areas and polar moments.

Millimetres. Proportions of the basic rack ISO 53: addendum 1.0 m, dedendum 1.25 m, fillet 0.38 m, pressure angle 20
degrees. Every number may be an array of shape (n,), so the same formula weighs one gear or all candidates.

The half angle of a tooth at radius r is psi(r) = pi/(2z) + inv(alpha) - inv(alpha_r) with cos(alpha_r) = r_b / r (any
textbook on involute gears, e.g. Shigley, ch. 13); below the base circle the flanks are radial. Integrated by parts,
with t = tan(alpha_r) and d(inv) = tan^2 d(alpha), the tooth's area and polar moment between two radii are

    area   = [psi r^2]     + r_b^2 [t^3 / 3]
    polar  = [psi r^4 / 2] + r_b^4 / 2 [t^3 / 3 + t^5 / 5]

A profile shift of x modules moves the teeth outwards by x m, in an internal gear too; psi grows by 2 x tan(alpha) / z
(ISO 21771).
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.geometry.shapes import Moments, Numbers

ADDENDUM = 1.0
DEDENDUM = 1.25
FILLET = 0.38
PRESSURE_ANGLE_RAD = float(np.radians(20.0))


def _array(value: Numbers) -> NDArray[np.float64]:
    return np.asarray(value, dtype=np.float64)


def involute(angle_rad: Numbers) -> Numbers:
    """inv(alpha) = tan(alpha) - alpha."""
    return np.tan(angle_rad) - angle_rad


def half_angle(gear: "ExternalGear | InternalGear", radius_mm: Numbers, thinning_mm: Numbers) -> NDArray[np.float64]:
    """Half angle psi in rad of a tooth at a radius; teeth are thinner by ``thinning_mm`` on the reference circle."""
    module, teeth, angle = _array(gear.module_mm), _array(gear.teeth), gear.pressure_angle_rad
    base = 0.5 * module * teeth * np.cos(angle)
    tangent = np.sqrt(np.maximum(np.square(radius_mm / base) - 1.0, 0.0))
    unwound = tangent - np.arctan(tangent)
    pitch = np.pi / (2.0 * teeth) - _array(thinning_mm) / (module * teeth)
    pitch = pitch + 2.0 * _array(gear.shift) * np.tan(angle) / teeth
    return np.asarray(pitch + np.tan(angle) - angle - unwound)


def _teeth_area_mm2(
    gear: "ExternalGear | InternalGear", low_mm: Numbers, high_mm: Numbers, thinning_mm: Numbers
) -> Numbers:
    """Area of all teeth between two radii."""
    area: Numbers = 0.0
    for sign, radius in ((1.0, _array(high_mm)), (-1.0, _array(low_mm))):
        psi, t, base = _flank(gear, radius, thinning_mm)
        area = area + sign * (psi * radius**2 + base**2 * t**3 / 3.0)
    return gear.teeth * area


def _teeth_polar_mm4(
    gear: "ExternalGear | InternalGear", low_mm: Numbers, high_mm: Numbers, thinning_mm: Numbers
) -> Numbers:
    """Polar moment of all teeth between two radii."""
    polar: Numbers = 0.0
    for sign, radius in ((1.0, _array(high_mm)), (-1.0, _array(low_mm))):
        psi, t, base = _flank(gear, radius, thinning_mm)
        polar = polar + sign * (0.5 * psi * radius**4 + 0.5 * base**4 * (t**3 / 3.0 + t**5 / 5.0))
    return gear.teeth * polar


def _flank(
    gear: "ExternalGear | InternalGear", radius_mm: NDArray[np.float64], thinning_mm: Numbers
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Half angle of a tooth at a radius, the tangent of the pressure angle there, and the base circle's radius."""
    base = _array(gear.base_radius_mm)
    psi = half_angle(gear, radius_mm, thinning_mm)
    # Below the base circle psi stays what it is there, so psi r^2 is right and the tangent terms vanish.
    return psi, np.sqrt(np.maximum(np.square(radius_mm / base) - 1.0, 0.0)), base


def _fillets_mm2(gear: "ExternalGear | InternalGear", root_mm: Numbers, outwards: float) -> Numbers:
    """Area of the rounded corners between flanks and root circle, two per tooth.

    Exact for radial flanks: the fillet's centre lies rho off the root circle, and rho off the flank. Where the flank is
    an involute it leans by the pressure angle there; a corner of angle theta with straight sides keeps
    rho^2 (cot(theta/2) - (pi - theta)/2) filled, and the exact area is scaled by the proportion of that to the right
    angle's, with the lean taken half way up the fillet. Within 6 percent of a drawn fillet, 2e-4 of a gear's area.

    Args:
        gear: which gear.
        root_mm: radius of the root circle.
        outwards: 1 if the spaces lie outside the root circle (external gear), -1 if inside.
    """
    rho, root = FILLET * _array(gear.module_mm), _array(root_mm)
    centre = root + outwards * rho
    beta = np.arcsin(rho / centre)
    triangle = 0.5 * rho * np.sqrt(centre**2 - rho**2)
    radial = outwards * (triangle - 0.5 * root**2 * beta) - 0.5 * rho**2 * (0.5 * np.pi - outwards * beta)

    def straight(theta: Numbers) -> Numbers:
        return 1.0 / np.tan(0.5 * theta) - 0.5 * (np.pi - theta)

    half_way = root + 0.5 * outwards * rho
    lean = np.arccos(np.minimum(_array(gear.base_radius_mm) / half_way, 1.0))
    return 2.0 * gear.teeth * radial * straight(0.5 * np.pi + lean) / straight(0.5 * np.pi)


def fillet_room_rad(gear: "ExternalGear | InternalGear") -> Numbers:
    """Half the angle that is left of the root circle between two fillets; negative where they do not fit."""
    rho, base = FILLET * _array(gear.module_mm), _array(gear.base_radius_mm)
    inner = isinstance(gear, InternalGear)
    centre = gear.root_radius_mm - rho if inner else gear.root_radius_mm + rho
    psi = half_angle(gear, centre, -_array(gear.backlash_mm) if inner else gear.backlash_mm)
    if inner:
        return psi - rho / base
    # A fillet that ends below the base circle touches a radial line there.
    on_involute = np.square(centre) >= np.square(base) + np.square(rho)
    return np.pi / _array(gear.teeth) - psi - np.where(on_involute, rho / base, np.arcsin(rho / centre))


def _round_moments(area: Numbers, polar: Numbers) -> Moments:
    return Moments(area, 0.0, 0.0, 0.5 * polar, 0.5 * polar, 0.0)


@dataclass(frozen=True, slots=True, kw_only=True)
class _Teeth:
    """What a spur gear and the toothed hole of a ring gear have in common."""

    teeth: Numbers
    module_mm: Numbers  # reference module
    backlash_mm: Numbers = 0.0  # how much thinner each tooth, or wider each space of a ring, is on the pitch circle
    phase_rad: Numbers = 0.0  # angle of the middle of one tooth, or of one space of a ring, from the x axis
    pressure_angle_rad: float = PRESSURE_ANGLE_RAD
    shift: Numbers = 0.0  # profile shift x over module, positive outwards

    @property
    def pitch_radius_mm(self) -> Numbers:
        """Reference circle."""
        return 0.5 * self.module_mm * self.teeth

    @property
    def base_radius_mm(self) -> Numbers:
        """Circle the involutes start from."""
        radius_mm: Numbers = self.pitch_radius_mm * np.cos(self.pressure_angle_rad)
        return radius_mm


@dataclass(frozen=True, slots=True, kw_only=True)
class ExternalGear(_Teeth):
    """A spur gear without its bore: sun or planet."""

    tip_shortening: Numbers = 0.0  # by how much the tips are cut short, over module

    @property
    def tip_radius_mm(self) -> Numbers:
        """Outermost circle."""
        return self.pitch_radius_mm + (ADDENDUM + self.shift - self.tip_shortening) * self.module_mm

    @property
    def root_radius_mm(self) -> Numbers:
        """Circle at the bottom of the tooth spaces."""
        return self.pitch_radius_mm - (DEDENDUM - self.shift) * self.module_mm

    @property
    def tip_thickness_mm(self) -> Numbers:
        """Thickness of a tooth on the tip circle, along the arc."""
        tip = self.tip_radius_mm
        return 2.0 * tip * half_angle(self, tip, self.backlash_mm)

    def area_mm2(self) -> Numbers:
        """The first of ``moments``."""
        return _area_mm2(self)

    def moments(self) -> Moments:
        """Exact for the teeth and the root disc; for the fillets see ``_fillets_mm2``."""
        root = self.root_radius_mm
        polar = _teeth_polar_mm4(self, root, self.tip_radius_mm, self.backlash_mm)
        fillets = _fillets_mm2(self, root, 1.0)
        return _round_moments(self.area_mm2(), 0.5 * np.pi * np.square(root) ** 2 + polar + fillets * np.square(root))


@dataclass(frozen=True, slots=True, kw_only=True)
class InternalGear(_Teeth):
    """The toothed hole of a ring gear: to be taken out of the ring's disc.

    The hole has the outline of an external gear whose teeth are the ring's spaces: tip and root change places. The
    profile shift is that of this gear; ISO 21771 counts it negative.
    """

    @property
    def tip_radius_mm(self) -> Numbers:
        """Innermost circle, of the ring's teeth."""
        return self.pitch_radius_mm - (ADDENDUM - self.shift) * self.module_mm

    @property
    def root_radius_mm(self) -> Numbers:
        """Outermost circle, at the bottom of the spaces."""
        return self.pitch_radius_mm + (DEDENDUM + self.shift) * self.module_mm

    @property
    def tip_thickness_mm(self) -> Numbers:
        """Thickness of a tooth on the tip circle, along the arc: what the space leaves of the pitch."""
        tip = self.tip_radius_mm
        space = half_angle(self, tip, -_array(self.backlash_mm))
        return 2.0 * tip * (np.pi / _array(self.teeth) - space)

    def area_mm2(self) -> Numbers:
        """The first of ``moments``."""
        return _area_mm2(self)

    def moments(self) -> Moments:
        """As of ``ExternalGear``; the fillets at the root make the hole smaller."""
        tip, root = self.tip_radius_mm, self.root_radius_mm
        polar = _teeth_polar_mm4(self, tip, root, -_array(self.backlash_mm))
        fillets = _fillets_mm2(self, root, -1.0)
        return _round_moments(self.area_mm2(), 0.5 * np.pi * np.square(tip) ** 2 + polar - fillets * np.square(root))


def _area_mm2(gear: ExternalGear | InternalGear) -> Numbers:
    """Area of a gear, or of the hole of a ring; kept for single gears, which several prisms have in common."""
    try:
        return _remembered_area_mm2(gear)
    except TypeError:  # arrays have no hash
        return _outline_area_mm2(gear)


def _outline_area_mm2(gear: ExternalGear | InternalGear) -> Numbers:
    root, tip = gear.root_radius_mm, gear.tip_radius_mm
    if isinstance(gear, InternalGear):
        area = _teeth_area_mm2(gear, tip, root, -_array(gear.backlash_mm))
        return np.pi * np.square(tip) + area - _fillets_mm2(gear, root, -1.0)
    area = _teeth_area_mm2(gear, root, tip, gear.backlash_mm)
    return np.pi * np.square(root) + area + _fillets_mm2(gear, root, 1.0)


_remembered_area_mm2 = lru_cache(maxsize=1024)(_outline_area_mm2)
