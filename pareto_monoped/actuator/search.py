"""The exhaustive search of stage 1: every gear set, both families, the lightest in every ratio interval."""

from collections.abc import Mapping, Sequence
from functools import lru_cache
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.actuator.actuator import Actuator, build_actuator
from pareto_monoped.actuator.gearset import GearSet, joined
from pareto_monoped.actuator.judge import Judge, candidates
from pareto_monoped.actuator.layout import FAMILIES, Family, radial_room_mm
from pareto_monoped.actuator.motor import Motor
from pareto_monoped.actuator.motors import load_motor, motor_source
from pareto_monoped.actuator.rating.build import build_stage
from pareto_monoped.actuator.rating.sheet import ratings
from pareto_monoped.actuator.ratiomap import RATIO_HIGH, RATIO_LOW, ActuatorMap, Candidate, FamilyResult, MapEntry
from pareto_monoped.actuator.settings import ActuatorSettings
from pareto_monoped.design import DEFAULT_RULES, RuleSet
from pareto_monoped.files import kept


def _search(motor: Motor, family: Family, settings: ActuatorSettings) -> dict[int, FamilyResult]:
    """Return the two lightest sets of every interval (in tenths), and what stands in the way of better."""
    gears = candidates(radial_room_mm(motor, family, settings), settings)
    judged = Judge(motor=motor, family=family, settings=settings).judge(gears)
    names, broken, mass, nearness = judged.names, judged.broken, judged.mass_kg, judged.nearness
    count = broken.sum(axis=0)
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


_COUNTED = ("sun_teeth", "planet_teeth", "ring_teeth", "planets")
_MEASURED = ("module_mm", "centre_shift", "sun_shift", "backlash_mm")


def _as_arrays(found: Mapping[int, FamilyResult]) -> dict[str, NDArray[Any]]:
    """Return what ``_search`` found as arrays; NaN in place of sets that there are not."""
    numbers = np.full((len(found), 2, len(_COUNTED + _MEASURED) + 3), np.nan)
    for row, result in enumerate(found.values()):
        for place, one in enumerate((result.best, result.runner_up)):
            if one is not None:
                gears = [getattr(one.gears, name) for name in _COUNTED + _MEASURED]
                numbers[row, place] = [*gears, one.gears.tips_fitted, one.face_width_mm, one.mass_kg]
    in_the_way = [" ".join(result.in_the_way) for result in found.values()]
    return {"low": np.array(list(found)), "numbers": numbers, "in_the_way": np.array(in_the_way)}


def _from_arrays(stored: Mapping[str, NDArray[Any]], family: Family) -> dict[int, FamilyResult]:
    """Return what ``_search`` found from its arrays."""

    def candidate(numbers: Sequence[float]) -> Candidate | None:
        if np.isnan(numbers[0]):
            return None
        *gears, fitted, width_mm, mass_kg = numbers
        counted = {name: int(value) for name, value in zip(_COUNTED, gears, strict=False)}
        measured = dict(zip(_MEASURED, gears[len(_COUNTED) :], strict=True))
        found = GearSet(**counted, **measured, tips_fitted=bool(fitted))
        return Candidate(family=family, gears=found, face_width_mm=width_mm, mass_kg=mass_kg)

    rows = zip(*(stored[name].tolist() for name in ("low", "numbers", "in_the_way")), strict=True)
    return {
        low: FamilyResult(best=candidate(best), runner_up=candidate(next_best), in_the_way=tuple(names.split()))
        for low, (best, next_best), names in rows
    }


def build_map(motor: Motor, settings: ActuatorSettings | None = None, *, keep: bool = False) -> ActuatorMap:
    """Search the map of a motor exhaustively, so that every entry is the optimum of its interval.

    With ``keep``, what the search finds and tables of the map's actuators are kept on disk, see ``files.kept``.
    """
    settings = settings or ActuatorSettings()
    present: dict[Family, bool] = {"ISSPG": motor.frameless is not None, "ESSPG": motor.framed is not None}
    searched = {}
    for family in (family for family in FAMILIES if present[family]):
        key = repr(("search", family, motor, settings)) if keep else None
        stored = kept(key, lambda family=family: _as_arrays(_search(motor, family, settings)))  # type: ignore[misc]  # a default
        searched[family] = _from_arrays(stored, family)
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
    return ActuatorMap(motor=motor, settings=settings, entries=entries, kept=keep)


def _built(motor: Motor, winners: Mapping[int, Candidate], settings: ActuatorSettings) -> dict[int, Actuator]:
    """Build the actuators of the winners. Lewis' width may differ in its last bit between one gear set and many."""
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
    """Return the map of a motor under a set of rules, with default settings otherwise; kept for the next call.

    Raises:
        MotorError: the motor has no gearbox at any ratio.
    """
    found = kept_map(motor, ActuatorSettings(rules=rules))
    found.require_gearbox(source or f"motor {motor.name}")
    return found


@lru_cache(maxsize=16)
def kept_map(motor: Motor, settings: ActuatorSettings) -> ActuatorMap:
    """Return what ``build_map`` finds; kept for the next call, and tables of its actuators on disk."""
    return build_map(motor, settings, keep=True)


def map_for(motor_name_or_path: str, rules: RuleSet = DEFAULT_RULES) -> ActuatorMap:
    """Return the map of a shipped motor or of one in a TOML file under a set of rules; cached.

    Raises:
        MotorError: see ``load_motor`` and ``map_of``.
    """
    return map_of(load_motor(motor_name_or_path), rules, source=motor_source(motor_name_or_path))
