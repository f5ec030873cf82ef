"""Planetary gear sets: teeth, module, planets, and what follows from them alone, with how evenly planets share the
load.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field, fields, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.actuator.settings import ActuatorSettings
from pareto_monoped.geometry.gears import DEDENDUM, PRESSURE_ANGLE_RAD, ExternalGear, InternalGear, involute
from pareto_monoped.geometry.shapes import Floats, Numbers


class _Shifts(NamedTuple):
    """What follows from shifts: working pressure angles of both meshes, shifts of planets and ring."""

    working_angle_rad: Numbers
    ring_working_angle_rad: Numbers
    planet: Numbers
    ring: Numbers


_COUNTS, _SHIFTS = ("sun_teeth", "planet_teeth", "ring_teeth", "module_mm", "planets"), ("centre_shift", "sun_shift")
_UNSHIFTED = _Shifts(PRESSURE_ANGLE_RAD, PRESSURE_ANGLE_RAD, 0.0, 0.0)


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
    _shifts: _Shifts = field(init=False, repr=False, compare=False)

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
        """Work out once what follows from the shifts; arrays ask for it many times."""
        object.__setattr__(self, "_shifts", _shifts(self) if self.is_shifted else _UNSHIFTED)

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
    def tip_shortening(self) -> Numbers:
        """By how much the tips of sun and planets are cut short, to keep the clearance of the basic rack."""
        return self.sun_shift + self.planet_shift - self.centre_shift

    @property
    def ring_root_radius_mm(self) -> Numbers:
        """Radius of the bottoms of the ring's tooth spaces."""
        return self.module_mm * (0.5 * self.ring_teeth + DEDENDUM + self.ring_shift)

    @property
    def ring_pitch_radius_mm(self) -> Numbers:
        """Radius of the ring's pitch circle."""
        return 0.5 * self.module_mm * self.ring_teeth

    def sun(self, backlash_mm: Numbers = 0.0) -> ExternalGear:
        """Return the cross-section of the sun, a tooth on the x axis."""
        return ExternalGear(
            teeth=self.sun_teeth,
            module_mm=self.module_mm,
            backlash_mm=backlash_mm,
            shift=self.sun_shift,
            tip_shortening=self.tip_shortening,
        )

    def planet(self, backlash_mm: Numbers = 0.0) -> ExternalGear:
        """Return the cross-section of the planet that sits on the x axis, with a tooth space towards the sun."""
        return ExternalGear(
            teeth=self.planet_teeth,
            module_mm=self.module_mm,
            backlash_mm=backlash_mm,
            phase_rad=np.pi - np.pi / self.planet_teeth,
            shift=self.planet_shift,
            tip_shortening=self.tip_shortening,
        )

    def ring(self, backlash_mm: Numbers = 0.0) -> InternalGear:
        """Return the toothed hole of the ring, with a space where the first planet has a tooth."""
        return InternalGear(
            teeth=self.ring_teeth,
            module_mm=self.module_mm,
            backlash_mm=backlash_mm,
            phase_rad=np.pi * (self.planet_teeth - 1.0) / self.ring_teeth,
            shift=self.ring_shift,
        )

    def chosen(self, index: int) -> "GearSet":
        """Return one set out of arrays, with plain numbers."""
        return GearSet(
            sun_teeth=int(np.asarray(self.sun_teeth)[index]),
            planet_teeth=int(np.asarray(self.planet_teeth)[index]),
            ring_teeth=int(np.asarray(self.ring_teeth)[index]),
            module_mm=float(np.asarray(self.module_mm)[index]),
            planets=int(np.asarray(self.planets)[index]),
            **{name: float(self._spread(getattr(self, name))[index]) for name in _SHIFTS},
        )

    def where(self, mask: NDArray[np.bool_] | NDArray[np.intp]) -> "GearSet":
        """Return the sets at a mask or at indices."""
        teeth = {name: np.asarray(getattr(self, name))[mask] for name in _COUNTS}
        shifts = {name: self._spread(getattr(self, name))[mask] if self.is_shifted else 0.0 for name in _SHIFTS}
        return GearSet(**teeth, **shifts)

    def _spread(self, value: Numbers) -> Floats:
        """Return a shift as an array of the sets' shape."""
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
    columns = {
        each.name: np.concatenate(
            [np.atleast_1d(np.broadcast_to(getattr(one, each.name), np.shape(one.sun_teeth))) for one in sets]
        ).astype(np.float64)
        for each in fields(GearSet)
        if each.init
    }
    return GearSet(**columns)


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
    length_mm: Numbers = np.sqrt(np.maximum(np.square(gear.tip_radius_mm) - np.square(gear.base_radius_mm), 0.0))
    return length_mm


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
