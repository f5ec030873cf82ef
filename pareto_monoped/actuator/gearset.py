"""Planetary gear sets: teeth, module, planets, and what follows from them alone, with how evenly planets share the
load.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, fields, replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.actuator.settings import ActuatorSettings
from pareto_monoped.geometry.gears import DEDENDUM, PRESSURE_ANGLE_RAD, ExternalGear, InternalGear, involute
from pareto_monoped.geometry.making import RATED_SERIES, thickness_tolerance_mm
from pareto_monoped.geometry.shapes import Floats, Numbers


class _Shifts(NamedTuple):
    """What follows from shifts: working pressure angles of both meshes, shifts of planets and ring."""

    working_angle_rad: Numbers
    ring_working_angle_rad: Numbers
    planet: Numbers
    ring: Numbers


class _Cuts(NamedTuple):
    """By how much tips are cut short, in modules."""

    sun: Numbers
    planet: Numbers
    ring: Numbers


COUNTED, MEASURED = (
    ("sun_teeth", "planet_teeth", "ring_teeth", "planets"),
    ("module_mm", "centre_shift", "sun_shift", "backlash_mm"),
)
"""The whole numbers and the others by which a gear set is told from those of the same search."""
_UNSHIFTED = _Shifts(PRESSURE_ANGLE_RAD, PRESSURE_ANGLE_RAD, 0.0, 0.0)
FORM_MARGIN_MODULES = 0.02
"""From where a flank begins, or ends in a ring, to where its mate's tip reaches, along the radius: our own choice."""
PIN_PLACE_MM = 0.01
"""By how much a pin may be off its place: the zone of the pins' holes on the drawing is Ø0.02."""
NEEDLE_PLAY_MM = 0.012
"""By how much a planet may be off its pin: half the greatest play of needles between F7 and m6."""
CENTRE_TOLERANCE_MM = PIN_PLACE_MM + NEEDLE_PLAY_MM
"""By how much a planet's axis may be off its place along the radius."""


@dataclass(frozen=True, slots=True, kw_only=True)
class GearSet:
    """The paper's design vector X = [Ns, Np, Nr, m, n_p] and its profile shifts; numbers for one set, arrays for many.

    Shifts are in modules, positive outwards. Centre distance and the sun's shift are chosen; those of planets and ring
    follow from meshing without backlash (ISO 21771): the working pressure angle alpha_w from
    cos(alpha_w) = cos(alpha) a / a_w, and sum of shifts = (z1 + z2) (inv(alpha_w) - inv(alpha)) / (2 tan(alpha)), for
    the internal mesh with the differences of teeth and shifts.
    """

    sun_teeth: Numbers  #: Ns
    planet_teeth: Numbers  #: Np
    ring_teeth: Numbers  #: Nr
    module_mm: Numbers  #: m
    planets: Numbers  #: n_p
    centre_shift: Numbers = 0.0  #: y, by how much the centre distance exceeds m (Ns + Np) / 2
    sun_shift: Numbers = 0.0  #: x of the sun
    backlash_mm: Numbers = 0.0  #: by how much every tooth is thinner on its reference circle
    #: Whether tips are cut so short that none reaches into a mate's root, see ``_fitted``; not under ``paper``
    tips_fitted: bool = False
    _shifts: _Shifts = field(init=False, repr=False, compare=False)
    _cuts: _Cuts = field(init=False, repr=False, compare=False)

    @property
    def ratio(self) -> Numbers:
        """Ring fixed, sun in, carrier out: (Ns + Nr) / Ns (paper, eq. 1)."""
        return (self.sun_teeth + self.ring_teeth) / self.sun_teeth

    @property
    def carrier_radius_mm(self) -> Numbers:
        """Centre distance of sun and planet."""
        return self.module_mm * (0.5 * (self.sun_teeth + self.planet_teeth) + self.centre_shift)

    @property
    def is_shifted(self) -> bool:
        """Whether any of the sets has a profile shift."""
        return bool(np.any(self.centre_shift) or np.any(self.sun_shift))

    def __post_init__(self) -> None:
        """Work out once what follows from shifts and backlash; arrays ask for it many times."""
        object.__setattr__(self, "_shifts", _shifts(self) if self.is_shifted else _UNSHIFTED)
        # The tips of sun and planets keep the clearance of the basic rack.
        kept = self.sun_shift + self.planet_shift - self.centre_shift
        object.__setattr__(self, "_cuts", _Cuts(kept, kept, 0.0))
        if self.tips_fitted:
            object.__setattr__(self, "_cuts", _fitted(self))

    @property
    def working_angle_rad(self) -> Numbers:
        """Pressure angle at which sun and planet mesh."""
        return self._shifts.working_angle_rad

    @property
    def ring_working_angle_rad(self) -> Numbers:
        """Pressure angle at which planet and ring mesh."""
        return self._shifts.ring_working_angle_rad

    @property
    def planet_shift(self) -> Numbers:
        """Profile shift of the planets."""
        return self._shifts.planet

    @property
    def ring_shift(self) -> Numbers:
        """Profile shift of the ring."""
        return self._shifts.ring

    @property
    def ring_root_radius_mm(self) -> Numbers:
        """Radius of the bottoms of the ring's tooth spaces."""
        return self.module_mm * (0.5 * self.ring_teeth + DEDENDUM + self.ring_shift)

    @property
    def ring_pitch_radius_mm(self) -> Numbers:
        """Radius of the ring's pitch circle."""
        return 0.5 * self.module_mm * self.ring_teeth

    def sun(self) -> ExternalGear:
        """Return the cross-section of the sun, a tooth on the x axis."""
        return ExternalGear(
            teeth=self.sun_teeth,
            module_mm=self.module_mm,
            backlash_mm=self.backlash_mm,
            shift=self.sun_shift,
            tip_shortening=self._cuts.sun,
        )

    def planet(self) -> ExternalGear:
        """Return the cross-section of the planet that sits on the x axis, with a tooth space towards the sun."""
        return ExternalGear(
            teeth=self.planet_teeth,
            module_mm=self.module_mm,
            backlash_mm=self.backlash_mm,
            phase_rad=np.pi - np.pi / self.planet_teeth,
            shift=self.planet_shift,
            tip_shortening=self._cuts.planet,
        )

    def ring(self) -> InternalGear:
        """Return the toothed hole of the ring, with a space where the first planet has a tooth."""
        return InternalGear(
            teeth=self.ring_teeth,
            module_mm=self.module_mm,
            backlash_mm=self.backlash_mm,
            phase_rad=np.pi * (self.planet_teeth - 1.0) / self.ring_teeth,
            shift=self.ring_shift,
            tip_shortening=self._cuts.ring,
        )

    def chosen(self, index: int) -> "GearSet":
        """Return one set out of arrays, with plain numbers."""
        numbers: dict[str, Any] = {name: float(self._spread(getattr(self, name))[index]) for name in MEASURED}
        teeth: dict[str, Any] = {name: int(np.asarray(getattr(self, name))[index]) for name in COUNTED}
        one = GearSet(**teeth, **numbers)
        # Known already, and dear.
        object.__setattr__(one, "tips_fitted", self.tips_fitted)
        object.__setattr__(one, "_cuts", _Cuts(*(self._spread(cut)[index] for cut in self._cuts)))
        return one

    def where(self, mask: NDArray[np.bool_] | NDArray[np.intp]) -> "GearSet":
        """Return the sets at a mask or at indices."""
        return _combined([self], lambda values: values[0][mask] if np.ndim(values[0]) else values[0])

    def _spread(self, value: Numbers) -> Floats:
        """Return a number as an array of the sets' shape."""
        return np.broadcast_to(np.asarray(value, dtype=np.float64), np.shape(self.sun_teeth))

    def shifted(self, centre_shift: float, sun_shift: float) -> "GearSet":
        """Return the same sets with one pair of shifts for all; see the attributes."""
        shape = np.shape(self.sun_teeth)
        return replace(self, centre_shift=np.full(shape, centre_shift), sun_shift=np.full(shape, sun_shift))

    def __str__(self) -> str:
        text = f"{self.sun_teeth}/{self.planet_teeth}/{self.ring_teeth} m {self.module_mm:g} x{self.planets}"
        if not self.is_shifted:
            return text
        shifts = (self.sun_shift, self.planet_shift, self.ring_shift)
        return f"{text}, shifts {'/'.join(f'{float(shift):+.2f}' for shift in shifts)}"


def joined(sets: Sequence[GearSet]) -> GearSet:
    """Return several arrays of gear sets as one."""
    shapes = [np.shape(one.sun_teeth) for one in sets]

    def columns(values: Sequence[Numbers]) -> Numbers:
        spread = [np.atleast_1d(np.broadcast_to(value, shape)) for value, shape in zip(values, shapes, strict=True)]
        return np.concatenate(spread).astype(np.float64)

    return _combined(sets, columns)


def _combined(sets: Sequence[GearSet], combine: Callable[[Sequence[Any]], Numbers]) -> GearSet:
    """Return gear sets each of whose numbers is a combination of others', also those that are dear to work out."""
    found = object.__new__(GearSet)
    for each in fields(GearSet):
        values = [getattr(one, each.name) for one in sets]
        combined: Any = values[0]
        if isinstance(combined, _Shifts | _Cuts):
            combined = type(combined)(*(combine(numbers) for numbers in zip(*values, strict=True)))
        elif not isinstance(combined, bool):
            combined = combine(values)
        object.__setattr__(found, each.name, combined)
    return found


def _shifts(gears: GearSet) -> _Shifts:
    both, difference = gears.sun_teeth + gears.planet_teeth, gears.ring_teeth - gears.planet_teeth
    centre = 0.5 * both + gears.centre_shift

    def working(teeth: Numbers) -> Numbers:
        share = 0.5 * teeth / centre
        return np.where(share == 1.0, PRESSURE_ANGLE_RAD, np.arccos(np.cos(PRESSURE_ANGLE_RAD) * share))[()]

    angle = working(both)
    ring_angle = angle if np.array_equal(both, difference) else working(difference)
    planet = both * _shift_per_tooth(angle) - gears.sun_shift
    return _Shifts(angle, ring_angle, planet, planet + difference * _shift_per_tooth(ring_angle))


def _fitted(gears: GearSet) -> _Cuts:
    """Return how short tips must be to meet flanks only, at the worst place of a planet's axis.

    Where a tip meets its mate is a length along the tangent to both base circles (ISO 21771). With the lengths from
    each base circle's point to a radius r, t(r) = sqrt(r^2 - r_b^2), and l between both points, which the centre
    distance gives: t1 + t2 <= l for a tip of 1 in the root of 2, and t_planet + l <= t_ring at the ring.
    """
    module, sun, planet, ring = gears.module_mm, gears.sun(), gears.planet(), gears.ring()
    margin = FORM_MARGIN_MODULES * module
    far, near = gears.carrier_radius_mm + CENTRE_TOLERANCE_MM, gears.carrier_radius_mm - CENTRE_TOLERANCE_MM
    outer = _tangent_mm(near, sun.base_radius_mm + planet.base_radius_mm)
    inner = _tangent_mm(far, ring.base_radius_mm - planet.base_radius_mm)
    sun_begins = _tangent_mm(_begins_mm(sun) + margin, sun.base_radius_mm)
    planet_begins = _tangent_mm(_begins_mm(planet) + margin, planet.base_radius_mm)
    ring_ends = _tangent_mm(ring.form_radius_mm - margin, ring.base_radius_mm)
    sun_tip = np.minimum(sun.tip_radius_mm, np.hypot(sun.base_radius_mm, np.maximum(outer - planet_begins, 0.0)))
    reach = np.maximum(np.minimum(outer - sun_begins, ring_ends - inner), 0.0)
    planet_tip = np.minimum(planet.tip_radius_mm, np.hypot(planet.base_radius_mm, reach))
    ring_tip = np.maximum(ring.tip_radius_mm, np.hypot(ring.base_radius_mm, planet_begins + inner))
    return _Cuts(
        sun.tip_shortening + (sun.tip_radius_mm - sun_tip) / module,
        planet.tip_shortening + (planet.tip_radius_mm - planet_tip) / module,
        (ring_tip - ring.tip_radius_mm) / module,
    )


def _begins_mm(gear: ExternalGear) -> Numbers:
    """Return the radius from which on every tooth within its tolerance has a flank.

    A rack that is fed farther in leaves more of the flank, until it cuts it away from below; the end of its straight
    flank then bounds how far.
    """
    tolerance = thickness_tolerance_mm(2.0 * gear.pitch_radius_mm, RATED_SERIES)
    thinnest = replace(gear, backlash_mm=gear.backlash_mm + tolerance)
    return np.maximum(gear.straight_end_mm, thinnest.straight_end_mm)


def _tangent_mm(radius_mm: Numbers, base_mm: Numbers) -> Numbers:
    """Return the length of the tangent to a circle of radius ``base_mm`` that ends at a radius; 0 inside."""
    length_mm: Numbers = np.sqrt(np.maximum(np.square(radius_mm) - np.square(base_mm), 0.0))
    return length_mm


def _shift_per_tooth(working_angle_rad: Numbers) -> Numbers:
    """Return the sum of shifts over the sum of teeth at a working pressure angle."""
    wider = involute(working_angle_rad) - involute(PRESSURE_ANGLE_RAD)
    ratio: Numbers = wider / (2.0 * np.tan(PRESSURE_ANGLE_RAD))
    return ratio


def contact_ratios(gears: GearSet) -> tuple[Numbers, Numbers]:
    """Return the transverse contact ratios of both meshes (Shigley, section 13-6; ISO 21771)."""
    pitch = np.pi * gears.module_mm * np.cos(PRESSURE_ANGLE_RAD)
    distance = gears.carrier_radius_mm * np.sin(gears.working_angle_rad)
    ring_distance = gears.carrier_radius_mm * np.sin(gears.ring_working_angle_rad)
    sun, planet, ring = (_tip_reach_mm(gear) for gear in (gears.sun(), gears.planet(), gears.ring()))
    return (sun + planet - distance) / pitch, (planet - ring + ring_distance) / pitch


def _tip_reach_mm(gear: ExternalGear | InternalGear) -> Numbers:
    """Return the length of the tangent to the base circle that ends on the tip circle."""
    # The tips of a small ring may lie inside its base circle; the rules refuse such a ring.
    return _tangent_mm(gear.tip_radius_mm, gear.base_radius_mm)


def efficiency(gears: GearSet, friction: float) -> Numbers:
    """Return the mesh efficiency of the stage with the ring fixed, the sun as input and the carrier as output.

    The loss of a mesh with the carrier held, per unit of power, is

        pi mu (1/z1 + 1/z2) (1 - e1 - e2 + e1^2 + e2^2),

    for an internal mesh with 1/z1 - 1/z2. The contact ratios e1 and e2 are the parts before and after the pitch point
    (Ohlendorf; Niemann/Winter, Maschinenelemente II). This is the mean of |s| over a base pitch, with all pairs in
    contact sharing the load evenly and s their distance from the pitch point. The same mean for any e1 and e2, which
    may exceed 1 or be negative, has e |e| / 2 + (1 - e) |1 - e| / 2 in place of each 1/2 - e + e^2. With eta0, the
    product over both meshes, and the ratio i, the efficiency is (1 + (i - 1) eta0) / i (Mueller, Die Umlaufgetriebe):
    only the rolling power suffers losses.
    """
    pitch = np.pi * gears.module_mm * np.cos(PRESSURE_ANGLE_RAD)

    def share(gear: ExternalGear | InternalGear, working_angle_rad: Numbers) -> Numbers:
        rolling = gear.pitch_radius_mm * (np.cos(PRESSURE_ANGLE_RAD) / np.cos(working_angle_rad))
        beyond = (_tip_reach_mm(gear) - rolling * np.sin(working_angle_rad)) / pitch
        signed: Numbers = -beyond if isinstance(gear, InternalGear) else beyond
        return signed

    def sliding(part: Numbers) -> Numbers:
        return 0.5 * (part * np.abs(part) + (1.0 - part) * np.abs(1.0 - part))

    def loss(first: Numbers, second: Numbers, curvature: Numbers) -> Numbers:
        return np.pi * friction * curvature * (sliding(first) + sliding(second))

    planet, angle, ring_angle = gears.planet(), gears.working_angle_rad, gears.ring_working_angle_rad
    outer = loss(share(gears.sun(), angle), share(planet, angle), 1.0 / gears.sun_teeth + 1.0 / gears.planet_teeth)
    inner = loss(
        share(planet, ring_angle), share(gears.ring(), ring_angle), 1.0 / gears.planet_teeth - 1.0 / gears.ring_teeth
    )
    basic = (1.0 - outer) * (1.0 - inner)
    return (1.0 + (gears.ratio - 1.0) * basic) / gears.ratio


def load_sharing(planets: Numbers, settings: ActuatorSettings) -> Numbers:
    """Return K_gamma by the number of planets, from the settings' table for the sun's support."""
    data = settings.parts.rating
    table = data.load_sharing_fixed if data.sun_support == "fixed" else data.load_sharing_floating
    factor: Numbers = np.asarray(table)[np.minimum(np.asarray(planets).astype(int) - 2, len(table) - 1)][()]
    return factor
