"""Planetary gear sets: teeth, module, planets, and what follows from them alone."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.geometry.gears import DEDENDUM, PRESSURE_ANGLE_RAD, ExternalGear, InternalGear
from pareto_monoped.geometry.shapes import Numbers


@dataclass(frozen=True, slots=True, kw_only=True)
class GearSet:
    """The paper's design vector X = [Ns, Np, Nr, m, n_p]; plain numbers for one set, arrays for many."""

    sun_teeth: Numbers
    planet_teeth: Numbers
    ring_teeth: Numbers
    module_mm: Numbers
    planets: Numbers

    @property
    def ratio(self) -> Numbers:
        """Ring fixed, sun in, carrier out: (Ns + Nr) / Ns (paper, eq. 1)."""
        return (self.sun_teeth + self.ring_teeth) / self.sun_teeth

    @property
    def carrier_radius_mm(self) -> Numbers:
        """Centre distance of sun and planet."""
        return 0.5 * self.module_mm * (self.sun_teeth + self.planet_teeth)

    @property
    def ring_root_radius_mm(self) -> Numbers:
        """Radius of the bottoms of the ring's tooth spaces."""
        return self.module_mm * (0.5 * self.ring_teeth + DEDENDUM)

    @property
    def ring_pitch_radius_mm(self) -> Numbers:
        """Radius of the ring's pitch circle."""
        return 0.5 * self.module_mm * self.ring_teeth

    def sun(self, backlash_mm: float = 0.0) -> ExternalGear:
        """Cross-section of the sun, a tooth on the x axis."""
        return ExternalGear(teeth=self.sun_teeth, module_mm=self.module_mm, backlash_mm=backlash_mm)

    def planet(self, backlash_mm: float = 0.0) -> ExternalGear:
        """Cross-section of the planet that sits on the x axis, with a tooth space towards the sun."""
        return ExternalGear(
            teeth=self.planet_teeth,
            module_mm=self.module_mm,
            backlash_mm=backlash_mm,
            phase_rad=np.pi - np.pi / self.planet_teeth,
        )

    def ring(self, backlash_mm: float = 0.0) -> InternalGear:
        """Toothed hole of the ring, with a space where the first planet has a tooth."""
        return InternalGear(
            teeth=self.ring_teeth,
            module_mm=self.module_mm,
            backlash_mm=backlash_mm,
            phase_rad=np.pi * (self.planet_teeth - 1.0) / self.ring_teeth,
        )

    def chosen(self, index: int) -> "GearSet":
        """One set out of arrays, with plain numbers."""
        return GearSet(
            sun_teeth=int(np.asarray(self.sun_teeth)[index]),
            planet_teeth=int(np.asarray(self.planet_teeth)[index]),
            ring_teeth=int(np.asarray(self.ring_teeth)[index]),
            module_mm=float(np.asarray(self.module_mm)[index]),
            planets=int(np.asarray(self.planets)[index]),
        )

    def where(self, mask: NDArray[np.bool_] | NDArray[np.intp]) -> "GearSet":
        """The sets at a mask or at indices."""
        return GearSet(
            sun_teeth=np.asarray(self.sun_teeth)[mask],
            planet_teeth=np.asarray(self.planet_teeth)[mask],
            ring_teeth=np.asarray(self.ring_teeth)[mask],
            module_mm=np.asarray(self.module_mm)[mask],
            planets=np.asarray(self.planets)[mask],
        )

    def __str__(self) -> str:
        return f"{self.sun_teeth}/{self.planet_teeth}/{self.ring_teeth} m {self.module_mm:g} x{self.planets}"


def contact_ratios(gears: GearSet) -> tuple[Numbers, Numbers]:
    """Transverse contact ratios of sun with planet and of planet with ring (Shigley, section 13-6; ISO 21771)."""
    sun, planet, ring = gears.sun(), gears.planet(), gears.ring()
    pitch = np.pi * gears.module_mm * np.cos(PRESSURE_ANGLE_RAD)
    distance = gears.carrier_radius_mm * np.sin(PRESSURE_ANGLE_RAD)

    def reach(gear: ExternalGear | InternalGear) -> Numbers:
        return np.sqrt(np.square(gear.tip_radius_mm) - np.square(gear.base_radius_mm))

    outer = (reach(sun) + reach(planet) - distance) / pitch
    inner = (reach(planet) - reach(ring) + distance) / pitch
    return outer, inner


def efficiency(gears: GearSet, friction: float) -> Numbers:
    """Mesh efficiency of the stage with the ring fixed, the sun as input and the carrier as output.

    The loss of a mesh with the carrier held, per unit of power, is

        pi mu (1/z1 + 1/z2) (1 - e1 - e2 + e1^2 + e2^2),

    for an internal mesh with 1/z1 - 1/z2. The contact ratios e1 and e2 are the parts before and after the pitch point
    (Ohlendorf; Niemann/Winter, Maschinenelemente II). With eta0, the product over both meshes, and the ratio i, the
    efficiency is (1 + (i - 1) eta0) / i (Mueller, Die Umlaufgetriebe): only the rolling power suffers losses.
    """
    pitch = np.pi * gears.module_mm * np.cos(PRESSURE_ANGLE_RAD)

    def share(gear: ExternalGear | InternalGear) -> Numbers:
        reach = np.sqrt(np.square(gear.tip_radius_mm) - np.square(gear.base_radius_mm))
        return np.abs(reach - gear.pitch_radius_mm * np.sin(PRESSURE_ANGLE_RAD)) / pitch

    sun, planet, ring = share(gears.sun()), share(gears.planet()), share(gears.ring())

    def loss(first: Numbers, second: Numbers, curvature: Numbers) -> Numbers:
        return np.pi * friction * curvature * (1.0 - first - second + np.square(first) + np.square(second))

    outer = loss(sun, planet, 1.0 / gears.sun_teeth + 1.0 / gears.planet_teeth)
    inner = loss(planet, ring, 1.0 / gears.planet_teeth - 1.0 / gears.ring_teeth)
    basic = (1.0 - outer) * (1.0 - inner)
    return (1.0 + (gears.ratio - 1.0) * basic) / gears.ratio
