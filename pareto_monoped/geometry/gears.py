"""Cross-sections of spur gears as their cutters make them, with exact areas and polar moments.

Millimetres. Every number may be an array of shape (n,), so the same formula weighs one gear or all candidates.

Sun and planet are cut by the rack ISO 53: addendum 1.0 m, dedendum 1.25 m, tip rounding 0.38 m, pressure angle 20
degrees. Thinner teeth are cut deeper: the rack is fed by A / (2 tan(alpha)) farther in, which makes the generating
shift x_E = x - A / (2 m tan(alpha)) (ISO 21771). Rings are wire-cut along the drawn curve: roots are arcs of 0.38 m.

The half angle of a tooth at radius r is psi(r) = pi/(2z) + inv(alpha) - inv(alpha_r) with cos(alpha_r) = r_b / r (any
textbook on involute gears, e.g. Shigley, ch. 13). Integrated by parts, with t = tan(alpha_r) and
d(inv) = tan^2 d(alpha), the tooth's area and polar moment between two radii are

    area   = [psi r^2]     + r_b^2 [t^3 / 3]
    polar  = [psi r^4 / 2] + r_b^4 / 2 [t^3 / 3 + t^5 / 5]

A profile shift of x modules moves the teeth outwards by x m, in an internal gear too; psi grows by 2 x tan(alpha) / z
(ISO 21771).

The root of sun and planet is what the rack's rounded tip leaves. The common normal at the point where it cuts goes
through the pitch point. Let theta be its angle from the line of centres, from 0 at the bottom to 90 degrees - alpha,
where the rounding ends and the straight flank begins. With the depth h of the rounding's centre below the pitch line,
the point cut is (h / cos(theta) + rho) (sin(theta), -cos(theta)) from the pitch point. The gear has then turned by
(h tan(theta) - e) / r since the rack's tooth, whose rounding has its centre e off the middle, stood in the middle of
the space (Litvin, Gear Geometry and Applied Theory, ch. 6, has the same curve).
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
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


def half_angle(gear: "ExternalGear | InternalGear", radius_mm: Numbers) -> NDArray[np.float64]:
    """Half angle psi in rad of a tooth, or of a ring's space, at a radius; below the base circle as on it."""
    teeth, tangent = _array(gear.teeth), np.tan(gear.pressure_angle_rad)
    pitch = (0.5 * np.pi + 2.0 * _array(gear.generating_shift) * tangent) / teeth
    roll = _roll(gear, radius_mm)
    return np.asarray(pitch + involute(gear.pressure_angle_rad) - (roll - np.arctan(roll)))


def _roll(gear: "ExternalGear | InternalGear", radius_mm: Numbers) -> NDArray[np.float64]:
    """Tangent of the pressure angle at a radius."""
    return np.asarray(np.sqrt(np.maximum(np.square(radius_mm / _array(gear.base_radius_mm)) - 1.0, 0.0)))


def _between_mm(gear: "ExternalGear | InternalGear", low_mm: Numbers, high_mm: Numbers) -> tuple[Numbers, Numbers]:
    """Area and polar moment of all teeth, or of a ring's spaces, between two radii."""
    area: Numbers = 0.0
    polar: Numbers = 0.0
    base = _array(gear.base_radius_mm)
    for sign, radius in ((1.0, _array(high_mm)), (-1.0, _array(low_mm))):
        psi, t = half_angle(gear, radius), _roll(gear, radius)
        area = area + sign * (psi * radius**2 + base**2 * t**3 / 3.0)
        polar = polar + sign * (0.5 * psi * radius**4 + 0.5 * base**4 * (t**3 / 3.0 + t**5 / 5.0))
    return gear.teeth * area, gear.teeth * polar


def _generated(
    teeth: Numbers, shift: Numbers, theta_rad: Numbers, pressure_angle_rad: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Point of a root that the rack cuts, in modules from the gear's axis: along the middle of the space, and across.

    ``shift`` is the generating one, ``theta_rad`` as in the module's text.
    """
    depth, rolled = DEDENDUM - FILLET - shift, 0.5 * _array(teeth)
    across, along = depth * np.tan(theta_rad) + FILLET * np.sin(theta_rad), rolled - depth - FILLET * np.cos(theta_rad)
    turned = (depth * np.tan(theta_rad) - rounding_off_middle(pressure_angle_rad)) / rolled
    cos, sin = np.cos(turned), np.sin(turned)
    return along * cos + across * sin, across * cos - along * sin


def rounding_off_middle(angle: float) -> float:
    """Distance of the centre of the rack's tip rounding from the middle of its tooth, in modules."""
    return float(0.25 * np.pi - DEDENDUM * np.tan(angle) - FILLET * (1.0 - np.sin(angle)) / np.cos(angle))


def _root_end_rad(teeth: Numbers, shift: Numbers, angle: float) -> NDArray[np.float64]:
    """Angle theta where the root goes over into the involute: the end of the rounding, or before it if undercut."""
    teeth, shift = np.broadcast_arrays(_array(teeth), _array(shift))
    end = np.full(teeth.shape, 0.5 * np.pi - angle)
    straight = DEDENDUM - FILLET * (1.0 - np.sin(angle)) - shift  # depth of the straight flank below the pitch line
    undercut = straight > 0.5 * teeth * np.square(np.sin(angle))
    if undercut.any():
        z, x, low, high = teeth[undercut], shift[undercut], np.zeros(int(undercut.sum())), end[undercut]
        for _ in range(_HALVINGS):
            middle = 0.5 * (low + high)
            along, across = _generated(z, x, middle, angle)
            tangent = np.square(np.hypot(along, across) / (0.5 * z * np.cos(angle))) - 1.0
            flank = np.sqrt(np.maximum(tangent, 0.0))
            space = (0.5 * np.pi - 2.0 * x * np.tan(angle)) / z - (np.tan(angle) - angle) + flank - np.arctan(flank)
            inside = (tangent < 0.0) | (np.arctan2(across, along) > space)
            low, high = np.where(inside, middle, low), np.where(inside, high, middle)
        end[undercut] = low
    return end


_HALVINGS = 30
"""Of the interval in which the root of an undercut tooth meets the flank: to a millionth of a micrometre."""
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(8)
"""Along a root's curve; its integrals then have 10 digits or more for 12 teeth and up."""


def _roots(teeth: Numbers, shift: Numbers, angle: float) -> tuple[Numbers, Numbers, Numbers]:
    """Return area and polar moment of one tooth's share of a gear, inside the lines from its axis to the tooth's points
    on the form circle, and the radius of that circle; all in modules.
    """
    end = _root_end_rad(teeth, shift, angle)
    depth = DEDENDUM - FILLET - shift
    bottom = 0.5 * teeth - DEDENDUM + shift
    area = np.square(bottom) * rounding_off_middle(angle) / (0.5 * teeth)
    polar = area * np.square(bottom) / 2.0
    for node, weight in zip(_NODES, _WEIGHTS, strict=True):
        theta = 0.5 * end * (1.0 + node)
        sin, cos = np.sin(theta), np.cos(theta)
        opened = depth / np.square(cos)
        across = depth * np.tan(theta) + FILLET * sin
        along = 0.5 * teeth - depth - FILLET * cos
        squared = np.square(across) + np.square(along)
        # Of the squared distance times the angle: the point's own motion, less the gear's turn.
        swept = along * (opened + FILLET * cos) - across * FILLET * sin
        swept = swept - squared * opened / (0.5 * teeth)
        area, polar = area + 0.5 * end * weight * swept, polar + 0.25 * end * weight * swept * squared
    along, across = _generated(teeth, shift, end, angle)
    form, half = np.square(along) + np.square(across), np.pi / teeth - np.arctan2(across, along)
    return area + form * half, polar + 0.5 * np.square(form) * half, np.hypot(along, across)


def _roots_of_many(teeth: Numbers, shift: Numbers, angle: float) -> tuple[Numbers, Numbers, Numbers]:
    """Return ``_roots`` of many gears, worked out once for those with the same number of teeth and the same shift."""
    if not np.ndim(teeth) and not np.ndim(shift):
        return _roots(_array(teeth), shift, angle)
    pairs = np.empty(np.broadcast_shapes(np.shape(teeth), np.shape(shift)), dtype=np.complex128)
    pairs.real, pairs.imag = teeth, shift
    some, place = np.unique(pairs, return_inverse=True)
    area, polar, form = map(np.asarray, _roots(some.real.copy(), some.imag.copy(), angle))
    place = place.reshape(pairs.shape)
    return area[place], polar[place], form[place]


def _ring_fillets_mm2(gear: "InternalGear", root_mm: Numbers) -> Numbers:
    """Area of the rounded corners between flanks and root circle of a ring, two per tooth.

    Exact for radial flanks: the fillet's centre lies rho off the root circle, and rho off the flank. Where the flank is
    an involute it leans by the pressure angle there; a corner of angle theta with straight sides keeps
    rho^2 (cot(theta/2) - (pi - theta)/2) filled, and the exact area is scaled by the proportion of that to the right
    angle's, with the lean taken half way up the fillet. Within 6 percent of a drawn fillet, 2e-4 of a gear's area.
    """
    rho, root = FILLET * _array(gear.module_mm), _array(root_mm)
    centre = root - rho
    beta = np.arcsin(rho / centre)
    radial = 0.5 * root**2 * beta - 0.5 * rho * np.sqrt(centre**2 - rho**2) - 0.5 * rho**2 * (0.5 * np.pi + beta)

    def straight(theta: Numbers) -> Numbers:
        return 1.0 / np.tan(0.5 * theta) - 0.5 * (np.pi - theta)

    lean = np.arccos(np.minimum(_array(gear.base_radius_mm) / (root - 0.5 * rho), 1.0))
    return 2.0 * gear.teeth * radial * straight(0.5 * np.pi + lean) / straight(0.5 * np.pi)


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
    tip_shortening: Numbers = 0.0  # by how much the tips are cut short, over module
    _known: tuple[Numbers, Numbers] | None = field(default=None, init=False, repr=False, compare=False)

    @property
    def pitch_radius_mm(self) -> Numbers:
        """Reference circle."""
        return 0.5 * self.module_mm * self.teeth

    @property
    def base_radius_mm(self) -> Numbers:
        """Circle the involutes start from."""
        radius_mm: Numbers = self.pitch_radius_mm * np.cos(self.pressure_angle_rad)
        return radius_mm

    @property
    def _thinning_shift(self) -> Numbers:
        """By how much thinner teeth change the shift: A / (2 m tan(alpha))."""
        shift: Numbers = 0.5 * self.backlash_mm / (self.module_mm * np.tan(self.pressure_angle_rad))
        return shift


@dataclass(frozen=True, slots=True, kw_only=True)
class ExternalGear(_Teeth):
    """A spur gear without its bore: sun or planet."""

    @property
    def generating_shift(self) -> Numbers:
        """Shift x_E at which the rack cuts the teeth, over module."""
        return self.shift - self._thinning_shift

    @property
    def tip_radius_mm(self) -> Numbers:
        """Outermost circle."""
        return self.pitch_radius_mm + (ADDENDUM + self.shift - self.tip_shortening) * self.module_mm

    @property
    def root_radius_mm(self) -> Numbers:
        """Circle at the bottom of the tooth spaces."""
        return self.pitch_radius_mm - (DEDENDUM - self.generating_shift) * self.module_mm

    @property
    def straight_end_mm(self) -> Numbers:
        """Circle on which the end of the rack's straight flank cuts: the form circle, or above it if undercut."""
        sine = np.sin(self.pressure_angle_rad)
        depth = DEDENDUM - FILLET * (1.0 - sine) - self.generating_shift
        radius_mm: Numbers = np.hypot(self.base_radius_mm, self.pitch_radius_mm * sine - depth * self.module_mm / sine)
        return radius_mm

    @property
    def form_radius_mm(self) -> Numbers:
        """Circle on which the involute begins, above the root that the rack's rounding leaves."""
        end = _root_end_rad(self.teeth, self.generating_shift, self.pressure_angle_rad)
        points = _generated(self.teeth, self.generating_shift, end, self.pressure_angle_rad)
        radius_mm: Numbers = self.module_mm * np.hypot(*points)
        return radius_mm

    @property
    def tip_thickness_mm(self) -> Numbers:
        """Thickness of a tooth on the tip circle, along the arc."""
        tip = self.tip_radius_mm
        return 2.0 * tip * half_angle(self, tip)

    def root_curve_mm(self, count: int) -> NDArray[np.float64]:
        """Return points from the bottom of a space to the form circle, shape (count, 2); of a gear of plain numbers.

        The space's middle is the x axis; the root circle goes on to the other side of it. Evenly spaced.
        """
        shift, angle = self.generating_shift, self.pressure_angle_rad
        theta = float(_root_end_rad(self.teeth, shift, angle)) * np.linspace(0.0, 1.0, 50 * count)
        points = np.stack(_generated(self.teeth, shift, theta, angle), axis=1)
        along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))])
        even = np.interp(np.linspace(0.0, along[-1], count), along, theta)
        return float(np.asarray(self.module_mm)) * np.stack(_generated(self.teeth, shift, even, angle), axis=1)

    def area_mm2(self) -> Numbers:
        """The first of ``moments``."""
        return _both_mm(self)[0]

    def moments(self) -> Moments:
        """Exact, roots included."""
        return _round_moments(*_both_mm(self))


@dataclass(frozen=True, slots=True, kw_only=True)
class InternalGear(_Teeth):
    """The toothed hole of a ring gear: to be taken out of the ring's disc.

    The hole has the outline of an external gear whose teeth are the ring's spaces: tip and root change places. The
    profile shift is that of this gear; ISO 21771 counts it negative. The root is an arc between root circle and flank.
    """

    @property
    def generating_shift(self) -> Numbers:
        """Shift of a space that is as wide as with backlash, over module."""
        return self.shift + self._thinning_shift

    @property
    def tip_radius_mm(self) -> Numbers:
        """Innermost circle, of the ring's teeth."""
        return self.pitch_radius_mm - (ADDENDUM - self.shift - self.tip_shortening) * self.module_mm

    @property
    def root_radius_mm(self) -> Numbers:
        """Outermost circle, at the bottom of the spaces."""
        return self.pitch_radius_mm + (DEDENDUM + self.shift) * self.module_mm

    @property
    def fillet_mm(self) -> Numbers:
        """Radius of the root's arcs."""
        return FILLET * self.module_mm

    @property
    def form_radius_mm(self) -> Numbers:
        """Circle on which the involute ends and the root's arc begins."""
        base, centre = _array(self.base_radius_mm), self.root_radius_mm - self.fillet_mm
        radius_mm: Numbers = np.hypot(
            base, np.sqrt(np.maximum(np.square(centre) - np.square(base), 0.0)) + self.fillet_mm
        )
        return radius_mm

    @property
    def fillet_angle_rad(self) -> Numbers:
        """Angle of the centre of a root's arc from the middle of its space; negative where two arcs do not fit."""
        # A curve parallel to an involute is the same involute, turned by the distance over the base radius.
        angle: Numbers = half_angle(self, self.root_radius_mm - self.fillet_mm) - self.fillet_mm / self.base_radius_mm
        return angle

    @property
    def tip_thickness_mm(self) -> Numbers:
        """Thickness of a tooth on the tip circle, along the arc: what the space leaves of the pitch."""
        tip = self.tip_radius_mm
        return 2.0 * tip * (np.pi / _array(self.teeth) - half_angle(self, tip))

    def area_mm2(self) -> Numbers:
        """The first of ``moments``."""
        return _both_mm(self)[0]

    def moments(self) -> Moments:
        """Exact for the teeth and the tip disc; for the fillets, which make the hole smaller, see there."""
        return _round_moments(*_both_mm(self))


def _external_mm(gear: ExternalGear) -> tuple[Numbers, Numbers]:
    teeth, square = _array(gear.teeth), np.square(_array(gear.module_mm))
    low, low_polar, form = _roots_of_many(gear.teeth, gear.generating_shift, gear.pressure_angle_rad)
    high, high_polar = _between_mm(gear, gear.module_mm * form, gear.tip_radius_mm)
    return teeth * low * square + high, teeth * low_polar * np.square(square) + high_polar


def _internal_mm(gear: InternalGear) -> tuple[Numbers, Numbers]:
    tip, root = gear.tip_radius_mm, gear.root_radius_mm
    (area, polar), fillets = _between_mm(gear, tip, root), _ring_fillets_mm2(gear, root)
    return (
        np.pi * np.square(tip) + area - fillets,
        0.5 * np.pi * np.square(np.square(tip)) + polar - fillets * np.square(root),
    )


def _both_mm(gear: ExternalGear | InternalGear) -> tuple[Numbers, Numbers]:
    """Return area and polar moment of a gear, or of the hole of a ring; kept, because several prisms share them."""
    if gear._known is None:
        try:
            known = _remembered_mm(gear)
        except TypeError:  # arrays have no hash
            known = _outline_mm(gear)
        object.__setattr__(gear, "_known", known)
        return known
    return gear._known


def _outline_mm(gear: ExternalGear | InternalGear) -> tuple[Numbers, Numbers]:
    return _internal_mm(gear) if isinstance(gear, InternalGear) else _external_mm(gear)


_remembered_mm = lru_cache(maxsize=1024)(_outline_mm)


def active_diameters_mm(
    gear: ExternalGear | InternalGear, mates: Sequence[ExternalGear | InternalGear], centre_mm: float
) -> tuple[float, float]:
    """Return from which diameter to which the flanks of a gear touch those of its mates (ISO 21771-1).

    On its root's side that is where the mate's tip comes: at a distance from the point in which the line of action
    touches the gear's base circle. On its tip's side it is the tip.
    """
    base, tip = float(gear.base_radius_mm), float(gear.tip_radius_mm)
    inside = isinstance(gear, InternalGear)
    ends = []
    for mate in mates:
        other, hollow = float(mate.base_radius_mm), inside or isinstance(mate, InternalGear)
        between = np.sqrt(centre_mm**2 - (abs(base - other) if hollow else base + other) ** 2)
        reach = np.sqrt(float(mate.tip_radius_mm) ** 2 - other**2)
        along = between + reach if inside else reach - between if hollow else between - reach
        ends.append(float(np.hypot(base, along)))
    end = max(ends) if inside else min(ends)
    low, high = sorted((2.0 * tip, 2.0 * end))
    return low, high
