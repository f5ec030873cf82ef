"""Every gear set that the search looks at: whole tooth numbers, standard modules, planets, profile shifts."""

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.actuator.gearset import GearSet, joined
from pareto_monoped.actuator.ratiomap import RATIO_HIGH, RATIO_LOW
from pareto_monoped.actuator.settings import ActuatorSettings

_BEYOND_MM = 12.0
"""How far beyond the room candidates are enumerated, so that the rules can say why a gearbox is missing."""
_TEETH_LEAST = 12
"""Fewest teeth enumerated, for the same reason and for searches with ``teeth_min`` off."""


def candidates(room_mm: float, settings: ActuatorSettings) -> GearSet:
    """Every gear set with Nr = Ns + 2 Np, a ratio in the map's range, and m Nr not far beyond the room."""
    sets = []
    intervals = (10 * RATIO_LOW, 10 * RATIO_HIGH)
    for module in settings.modules_mm:
        ring_most = int((room_mm + _BEYOND_MM) / module)
        least = min(_TEETH_LEAST, settings.teeth_min)
        sun, planet = np.meshgrid(
            np.arange(least, ring_most, dtype=np.int64),
            np.arange(least, ring_most // 2 + 1, dtype=np.int64),
            indexing="ij",
        )
        ring = sun + 2 * planet
        tenths = interval_tenths(sun, ring)
        keep = (ring <= ring_most) & (tenths >= intervals[0]) & (tenths < intervals[1])
        for planets in range(settings.planets_least, settings.planets_max + 1):
            shape = int(keep.sum())
            sets.append((sun[keep], planet[keep], ring[keep], np.full(shape, module), np.full(shape, planets)))
    columns = [np.concatenate(column).astype(np.float64) for column in zip(*sets, strict=True)]
    gears = GearSet(
        sun_teeth=columns[0],
        planet_teeth=columns[1],
        ring_teeth=columns[2],
        module_mm=columns[3],
        planets=columns[4],
    )
    return _with_shifts(gears, room_mm, settings)


def _with_shifts(gears: GearSet, room_mm: float, settings: ActuatorSettings) -> GearSet:
    """Every gear set with every profile shift of the settings.

    No shift helps planets that do not mesh or a ring beyond the room, so that such sets come with the first shift only.
    """
    first, *others = settings.shift_choices
    everything = gears.shifted(*first) if any(first) else gears
    if not others:
        return everything
    meshing = (gears.sun_teeth + gears.ring_teeth) % gears.planets == 0.0
    hopeful = gears.where(np.asarray(meshing & (2.0 * gears.ring_pitch_radius_mm <= room_mm)))
    return joined([everything, *(hopeful.shifted(*shifts) for shifts in others)])


def interval_tenths(sun_teeth: NDArray[np.int64], ring_teeth: NDArray[np.int64]) -> NDArray[np.int64]:
    """Lower end of the half-open interval [g, g + 0.1) that the ratio lies in, in tenths; exact, in integers."""
    return 10 * (sun_teeth + ring_teeth) // sun_teeth
