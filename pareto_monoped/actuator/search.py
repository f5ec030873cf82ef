"""The exhaustive search of stage 1: every gear set, both families, the lightest in every ratio interval."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.actuator.actuator import Actuator, actuator_mass_kg, build_actuator
from pareto_monoped.actuator.candidates import candidates, interval_tenths
from pareto_monoped.actuator.face import face_width_mm, rated_width_mm
from pareto_monoped.actuator.gearset import GearSet, joined
from pareto_monoped.actuator.layout import FAMILIES, Family, layout, radial_room_mm
from pareto_monoped.actuator.motors import Motor, load_motor, motor_source
from pareto_monoped.actuator.rating.build import build_stage
from pareto_monoped.actuator.rating.sheet import ratings
from pareto_monoped.actuator.rating.width import LOAD_RULES, STRENGTH_RULES
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

_FIRST = 8
"""How many sets of every interval are rated first, the lightest at the least face width."""


@dataclass(frozen=True, slots=True, kw_only=True)
class _Judged:
    """What the rules say of every gear set of a family; arrays of shape (n,).

    Attributes:
        gears: the gear sets.
        tenths: lower end of each set's interval.
        width_mm, mass_kg: face width and mass; infinite mass for sets that cannot be built, or need not be weighed.
        names, broken: rules, and which of them each set breaks, shape (names, n).
        considered: sets that are solutions or are kept out by a single rule, as far as these may be lighter than the
            two lightest of their interval.
    """

    gears: GearSet
    tenths: NDArray[np.int64]
    width_mm: NDArray[np.float64]
    mass_kg: NDArray[np.float64]
    names: tuple[ConstraintName, ...]
    broken: NDArray[np.bool_]
    considered: NDArray[np.bool_]


def _search(motor: Motor, family: Family, settings: ActuatorSettings) -> dict[int, FamilyResult]:
    """The lightest and second lightest set of every interval (in tenths), and what stands in the way of better."""
    judge = _Judge(motor=motor, family=family, settings=settings)
    gears = candidates(radial_room_mm(motor, family, settings), settings)
    judged = judge.by_lewis(gears) if settings.rules == "paper" else judge.by_rating(gears)
    names, broken, mass = judged.names, judged.broken, judged.mass_kg
    count = broken.sum(axis=0)
    # A set that fits and is too weak is nearest: steel and safety can be chosen, whole numbers cannot.
    weak = np.isin(names, list(LOAD_RULES))
    nearness = np.where(broken[~weak].any(axis=0), count, np.minimum(count, 0.5))
    found = {}
    order = np.argsort(judged.tenths, kind="stable")
    bounds = np.searchsorted(judged.tenths[order], np.arange(10 * RATIO_LOW, 10 * RATIO_HIGH + 1))
    for low, (start, stop) in enumerate(pairwise(bounds), 10 * RATIO_LOW):
        inside = order[start:stop]
        allowed = inside[judged.considered[inside] & (count[inside] == 0) & np.isfinite(mass[inside])]
        ranked = allowed[np.argsort(mass[allowed], kind="stable")][:2]
        if len(ranked):
            rivals = inside[judged.considered[inside] & (count[inside] == 1) & (mass[inside] < mass[ranked[0]])]
        else:
            rivals = inside[nearness[inside] == nearness[inside].min()] if len(inside) else inside
        in_the_way = tuple(name for name, row in zip(names, broken[:, rivals], strict=True) if row.any())
        best, runner_up = (
            Candidate(
                family=family,
                gears=gears.chosen(ranked[place]),
                face_width_mm=float(judged.width_mm[ranked[place]]),
                mass_kg=float(mass[ranked[place]]),
            )
            if place < len(ranked)
            else None
            for place in range(2)
        )
        found[low] = FamilyResult(best=best, runner_up=runner_up, in_the_way=in_the_way)
    return found


@dataclass(frozen=True, slots=True, kw_only=True)
class _Judge:
    """Applies the rules to arrays of gear sets of one motor and family."""

    motor: Motor
    family: Family
    settings: ActuatorSettings

    def by_lewis(self, gears: GearSet) -> _Judged:
        """All sets under the rules ``paper``."""
        width = np.asarray(face_width_mm(gears, self.motor, self.family, self.settings))
        names, broken = self._rules_broken(gears, width)
        near = broken.sum(axis=0) <= 1
        mass = np.full(len(width), np.inf)
        mass[near] = self._mass_kg(gears.where(near), width[near])
        return _Judged(
            gears=gears,
            tenths=_tenths_of(gears),
            width_mm=width,
            mass_kg=mass,
            names=names,
            broken=broken,
            considered=near,
        )

    def by_rating(self, gears: GearSet) -> _Judged:
        """All sets under the rules ``iso6336``.

        To rate a gear set costs more than all other rules together. Sets that break more than one of the others at the
        least face width are neither solutions nor kept out by a single rule, and are not rated. Nor are sets that are
        too heavy at the least face width already: first, the lightest of every interval there are rated, then all that
        may still be lighter than the second of them. Sets that break one rule come last, where a lighter set has been
        kept out or no other set is near.
        """
        data, tenths = self.settings.parts.rating, _tenths_of(gears)
        width = np.maximum(data.face_width_min_mm, data.face_modules_min * gears.module_mm)
        unrated = dict.fromkeys((*STRENGTH_RULES, "planet_bearing"), np.zeros(len(width)))
        names, broken = self._rules_broken(gears, width, unrated)
        count = broken.sum(axis=0)
        near = np.flatnonzero(count <= 1)
        least, mass = np.full(len(width), np.inf), np.full(len(width), np.inf)
        least[near] = self._mass_kg(gears.where(near), width[near])
        rated = np.zeros(len(width), dtype=bool)
        fitting, kept_out = near[count[near] == 0], near[count[near] == 1]
        alone = ~np.isin(tenths, tenths[fitting])
        for wanted in (fitting[_rank(tenths[fitting], least[fitting]) < _FIRST], fitting, kept_out):
            # No set is lighter with a wider face, and what a rule keeps out matters only where it is the lightest.
            place = 0 if wanted is kept_out else 1
            bound = _lightest(tenths, np.where(rated & ~broken.any(axis=0), mass, np.inf), place)[tenths[wanted]]
            heavy = least[wanted] > bound
            useless = (count[wanted] == 1) & ~alone[wanted] & np.isinf(bound)
            todo = wanted[~rated[wanted] & ~heavy & ~useless]
            chosen = gears.where(todo)
            width[todo], strength = rated_width_mm(chosen, self.motor, self.family, self.settings)
            broken[:, todo] = self._rules_broken(chosen, width[todo], strength)[1]
            mass[todo] = self._mass_kg(chosen, width[todo])
            rated[todo] = True
        return _Judged(
            gears=gears,
            tenths=tenths,
            width_mm=width,
            mass_kg=mass,
            names=names,
            broken=broken,
            considered=rated,
        )

    def _mass_kg(self, gears: GearSet, width_mm: NDArray[np.float64]) -> NDArray[np.float64]:
        at = layout(self.motor, self.family, gears, width_mm, self.settings)
        mass = np.asarray(actuator_mass_kg(at, self.motor, self.family, self.settings))
        return np.where(np.isnan(mass), np.inf, mass)

    def _rules_broken(
        self,
        gears: GearSet,
        width_mm: NDArray[np.float64],
        strength: Mapping[str, Numbers] | None = None,
    ) -> tuple[tuple[ConstraintName, ...], NDArray[np.bool_]]:
        sets = CandidateSets(
            gears=gears,
            face_width_mm=width_mm,
            at=layout(self.motor, self.family, gears, width_mm, self.settings),
            motor=self.motor,
            family=self.family,
            settings=self.settings,
            strength=strength,
        )
        return violations(sets)


def _tenths_of(gears: GearSet) -> NDArray[np.int64]:
    return interval_tenths(np.asarray(gears.sun_teeth, dtype=np.int64), np.asarray(gears.ring_teeth, dtype=np.int64))


def _rank(groups: NDArray[np.int64], values: NDArray[np.float64]) -> NDArray[np.intp]:
    """Place of each value among those of its group, from 0."""
    order = np.lexsort((values, groups))
    first = np.searchsorted(groups[order], groups[order])
    rank = np.empty(len(order), dtype=np.intp)
    rank[order] = np.arange(len(order)) - first
    return rank


def _lightest(tenths: NDArray[np.int64], mass_kg: NDArray[np.float64], place: int) -> NDArray[np.float64]:
    """For each interval, by its tenths, the lightest mass, or the next by ``place``; infinite where there is none."""
    found = np.full(10 * RATIO_HIGH, np.inf)
    known = np.flatnonzero(np.isfinite(mass_kg))
    chosen = known[_rank(tenths[known], mass_kg[known]) == place]
    found[tenths[chosen]] = mass_kg[chosen]
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
    pools = {}
    for low in range(10 * RATIO_LOW, 10 * RATIO_HIGH):
        found = [each for results in searched.values() for each in (results[low].best, results[low].runner_up)]
        pools[low] = sorted((each for each in found if each is not None), key=lambda candidate: candidate.mass_kg)
    built = _built(motor, {low: pool[0] for low, pool in pools.items() if pool}, settings)
    entries = tuple(
        MapEntry(
            ratio_low=low / 10.0,
            actuator=built.get(low),
            runner_up=pool[1] if len(pool) > 1 else None,
            families={family: results[low] for family, results in searched.items()},
        )
        for low, pool in pools.items()
    )
    return ActuatorMap(motor=motor, settings=settings, entries=entries)


def _built(motor: Motor, winners: Mapping[int, Candidate], settings: ActuatorSettings) -> dict[int, Actuator]:
    """The actuators of the winners. A width after Lewis may differ in its last bit between one gear set and many."""
    if settings.rules == "paper":
        return {low: build_actuator(motor, won.family, won.gears, settings) for low, won in winners.items()}
    built = {}
    for family in FAMILIES:
        own = {low: won for low, won in winners.items() if won.family == family}
        if not own:
            continue
        stage = build_stage(joined([won.gears for won in own.values()]), motor, family, settings)
        rated = ratings(stage, np.array([won.face_width_mm for won in own.values()]))
        for (low, won), rating in zip(own.items(), rated, strict=True):
            built[low] = build_actuator(motor, family, won.gears, settings, won.face_width_mm, rating)
    return built


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
