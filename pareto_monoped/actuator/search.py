"""The exhaustive search of stage 1: every gear set, both families, the lightest in every ratio interval."""

from collections.abc import Mapping
from functools import lru_cache
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.actuator.actuator import Actuator, actuator_mass_kg, build_actuator
from pareto_monoped.actuator.face import face_width_mm
from pareto_monoped.actuator.gearset import GearSet
from pareto_monoped.actuator.layout import FAMILIES, Family, layout, radial_room_mm
from pareto_monoped.actuator.motors import Motor, load_motor, motor_source
from pareto_monoped.actuator.rating.width import STRENGTH_RULES
from pareto_monoped.actuator.ratiomap import (
    RATIO_HIGH,
    RATIO_LOW,
    ActuatorMap,
    Candidate,
    FamilyResult,
    MapEntry,
)
from pareto_monoped.actuator.rules import CandidateSets, violations
from pareto_monoped.actuator.settings import ActuatorSettings, ConstraintName
from pareto_monoped.design import DEFAULT_RULES, RuleSet
from pareto_monoped.geometry.shapes import Numbers

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
    width, names, broken = _judged(gears, motor, family, settings)
    count = broken.sum(axis=0)
    # A set that fits and is too weak is nearest: steel and safety can be chosen, whole numbers cannot.
    weak = np.isin(names, list(STRENGTH_RULES))
    nearness = np.where(broken[~weak].any(axis=0), count, np.minimum(count, 0.5))
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
            rivals = inside[nearness[inside] == nearness[inside].min()] if len(inside) else inside
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


def _judged(
    gears: GearSet, motor: Motor, family: Family, settings: ActuatorSettings
) -> tuple[NDArray[np.float64], tuple[ConstraintName, ...], NDArray[np.bool_]]:
    """Face widths, and which rule each set breaks, as ``violations`` returns them.

    To rate a gear set costs more than all other rules together. Under ``iso6336``, sets that break more than one of
    the others at the least face width are neither solutions nor kept out by a single rule, and are not rated.
    """
    if settings.rules == "paper":
        width = np.asarray(face_width_mm(gears, motor, family, settings))
        return width, *_rules_broken(gears, width, motor, family, settings)
    unrated = dict.fromkeys(STRENGTH_RULES, np.zeros(np.shape(gears.sun_teeth)))
    width = settings.parts.rating.face_width_min_mm + unrated["flank_strength"]
    names, broken = _rules_broken(gears, width, motor, family, settings, unrated)
    near = np.flatnonzero(broken.sum(axis=0) <= 1)
    chosen = gears.where(near)
    width[near] = face_width_mm(chosen, motor, family, settings)
    broken[:, near] = _rules_broken(chosen, width[near], motor, family, settings)[1]
    return width, names, broken


def _rules_broken(
    gears: GearSet,
    width: NDArray[np.float64],
    motor: Motor,
    family: Family,
    settings: ActuatorSettings,
    strength: Mapping[str, Numbers] | None = None,
) -> tuple[tuple[ConstraintName, ...], NDArray[np.bool_]]:
    sets = CandidateSets(
        gears=gears,
        face_width_mm=width,
        at=layout(motor, family, gears, width, settings),
        motor=motor,
        family=family,
        settings=settings,
        strength=strength,
    )
    return violations(sets)


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
                actuator=_built(motor, pool[0], settings) if pool else None,
                runner_up=pool[1] if len(pool) > 1 else None,
                families=families,
            )
        )
    return ActuatorMap(motor=motor, settings=settings, entries=tuple(entries))


def _built(motor: Motor, found: Candidate, settings: ActuatorSettings) -> Actuator:
    """The actuator of a candidate. A width after Lewis may differ in its last bit between one gear set and many."""
    width = None if settings.rules == "paper" else found.face_width_mm
    return build_actuator(motor, found.family, found.gears, settings, width)


def map_of(motor: Motor, rules: RuleSet = DEFAULT_RULES, *, source: str | None = None) -> ActuatorMap:
    """The map of a motor under a set of rules, with default settings otherwise; kept for the next call.

    Args:
        motor: the motor.
        rules: the set of rules.
        source: where the motor comes from, for the message; default its name.

    Raises:
        MotorError: the motor has no gearbox at any ratio.
    """
    found = _kept_map(motor, rules)
    found.require_gearbox(source or f"motor {motor.name}")
    return found


# Without defaults, so that one map is kept however its rules were named.
@lru_cache(maxsize=16)
def _kept_map(motor: Motor, rules: RuleSet) -> ActuatorMap:
    return build_map(motor, ActuatorSettings(rules=rules))


def map_for(motor_name_or_path: str, rules: RuleSet = DEFAULT_RULES) -> ActuatorMap:
    """The map of a shipped motor or of one in a TOML file under a set of rules; cached.

    Raises:
        MotorError: see ``load_motor`` and ``map_of``.
    """
    return map_of(load_motor(motor_name_or_path), rules, source=motor_source(motor_name_or_path))
