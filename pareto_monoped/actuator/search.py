"""The exhaustive search of stage 1: every gear set, both families, the lightest in every ratio interval."""

from functools import lru_cache
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.actuator.actuator import actuator_mass_kg, build_actuator
from pareto_monoped.actuator.gearset import GearSet
from pareto_monoped.actuator.layout import FAMILIES, Family, layout, radial_room_mm
from pareto_monoped.actuator.motors import Motor, load_motor
from pareto_monoped.actuator.ratiomap import (
    RATIO_HIGH,
    RATIO_LOW,
    ActuatorMap,
    Candidate,
    FamilyResult,
    MapEntry,
)
from pareto_monoped.actuator.rules import CandidateSets, violations
from pareto_monoped.actuator.settings import ActuatorSettings
from pareto_monoped.actuator.strength import face_width_mm

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
        for planets in range(settings.planets_min, settings.planets_max + 1):
            shape = int(keep.sum())
            sets.append((sun[keep], planet[keep], ring[keep], np.full(shape, module), np.full(shape, planets)))
    columns = [np.concatenate(column).astype(np.float64) for column in zip(*sets, strict=True)]
    return GearSet(
        sun_teeth=columns[0],
        planet_teeth=columns[1],
        ring_teeth=columns[2],
        module_mm=columns[3],
        planets=columns[4],
    )


def interval_tenths(sun_teeth: NDArray[np.int64], ring_teeth: NDArray[np.int64]) -> NDArray[np.int64]:
    """Lower end of the half-open interval [g, g + 0.1) that the ratio lies in, in tenths; exact, in integers."""
    return 10 * (sun_teeth + ring_teeth) // sun_teeth


def _search(motor: Motor, family: Family, settings: ActuatorSettings) -> dict[int, FamilyResult]:
    """The lightest and second lightest set of every interval (in tenths), and what stands in the way of better."""
    gears = candidates(radial_room_mm(motor, family, settings), settings)
    width = np.asarray(face_width_mm(gears, motor, settings))
    at = layout(motor, family, gears, width, settings)
    names, broken = violations(
        CandidateSets(gears=gears, face_width_mm=width, at=at, motor=motor, family=family, settings=settings)
    )
    count = broken.sum(axis=0)
    # Only sets that break at most one rule are weighed: others are neither solutions nor kept out by a single rule.
    near = np.flatnonzero(count <= 1)
    mass = np.full(len(count), np.inf)
    chosen = gears.where(near)
    mass[near] = actuator_mass_kg(layout(motor, family, chosen, width[near], settings), motor, family, settings)
    mass[np.isnan(mass)] = np.inf
    tenths = interval_tenths(np.asarray(gears.sun_teeth, dtype=np.int64), np.asarray(gears.ring_teeth, dtype=np.int64))
    found = {}
    order = np.argsort(tenths, kind="stable")
    bounds = np.searchsorted(tenths[order], np.arange(10 * RATIO_LOW, 10 * RATIO_HIGH + 1))
    for low, (start, stop) in enumerate(pairwise(bounds), 10 * RATIO_LOW):
        inside = order[start:stop]
        allowed = inside[(count[inside] == 0) & np.isfinite(mass[inside])]
        ranked = allowed[np.argsort(mass[allowed], kind="stable")][:2]
        if len(ranked):
            rivals = inside[(count[inside] == 1) & (mass[inside] < mass[ranked[0]])]
        else:
            rivals = inside[count[inside] == count[inside].min()] if len(inside) else inside
        in_the_way = tuple(name for name, row in zip(names, broken[:, rivals], strict=True) if row.any())
        best, runner_up = (
            Candidate(
                family=family,
                gears=gears.chosen(ranked[place]),
                face_width_mm=float(width[ranked[place]]),
                mass_kg=float(mass[ranked[place]]),
            )
            if place < len(ranked)
            else None
            for place in range(2)
        )
        found[low] = FamilyResult(best=best, runner_up=runner_up, in_the_way=in_the_way)
    return found


def build_map(motor: Motor, settings: ActuatorSettings | None = None) -> ActuatorMap:
    """The whole map of one motor. The search is exhaustive, so every entry is the optimum of its interval.

    Args:
        motor: the motor; families for which it has no data are left out.
        settings: default ``ActuatorSettings()``.
    """
    settings = settings or ActuatorSettings()
    present: dict[Family, bool] = {"ISSPG": motor.frameless is not None, "ESSPG": motor.framed is not None}
    searched = {family: _search(motor, family, settings) for family in FAMILIES if present[family]}
    entries = []
    for low in range(10 * RATIO_LOW, 10 * RATIO_HIGH):
        families = {family: results[low] for family, results in searched.items()}
        pool = [c for result in families.values() for c in (result.best, result.runner_up) if c is not None]
        pool.sort(key=lambda candidate: candidate.mass_kg)
        entries.append(
            MapEntry(
                ratio_low=low / 10.0,
                actuator=build_actuator(motor, pool[0].family, pool[0].gears, settings) if pool else None,
                runner_up=pool[1] if len(pool) > 1 else None,
                families=families,
            )
        )
    return ActuatorMap(motor=motor, settings=settings, entries=tuple(entries))


@lru_cache(maxsize=16)
def map_of(motor: Motor) -> ActuatorMap:
    """The map of a motor with default settings; kept for the next call."""
    return build_map(motor)


def map_for(motor_name_or_path: str) -> ActuatorMap:
    """The map of a shipped motor or of one in a TOML file, with default settings; cached.

    Raises:
        MotorError: see ``load_motor``.
    """
    return map_of(load_motor(motor_name_or_path))
