"""The exhaustive search of stage 1: every gear set, both families, the lightest in every ratio interval."""

from collections.abc import Mapping
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.actuator.actuator import Actuator, build_actuator
from pareto_monoped.actuator.gearset import COUNTED, MEASURED, GearSet, joined
from pareto_monoped.actuator.judge import Judge, candidates, rank
from pareto_monoped.actuator.layout import FAMILIES, Family, radial_room_mm
from pareto_monoped.actuator.motor import Motor
from pareto_monoped.actuator.motors import load_motor, motor_source
from pareto_monoped.actuator.rating.build import build_stage
from pareto_monoped.actuator.rating.sheet import ratings
from pareto_monoped.actuator.ratiomap import RATIO_HIGH, RATIO_LOW, ActuatorMap, Candidate, FamilyResult, MapEntry
from pareto_monoped.actuator.settings import ActuatorSettings
from pareto_monoped.design import DEFAULT_RULES, RuleSet
from pareto_monoped.files import kept


def _search(motor: Motor, family: Family, settings: ActuatorSettings) -> dict[str, NDArray[Any]]:
    """Return, as arrays, the two lightest sets of every interval (in tenths), and what stands in the way of better.

    Where an interval has fewer sets, their numbers are NaN.
    """
    gears = candidates(radial_room_mm(motor, family, settings), settings)
    judged = Judge(motor=motor, family=family, settings=settings).judge(gears)
    tenths, broken, mass, nearness = judged.tenths, judged.broken, judged.mass_kg, judged.nearness
    count = broken.sum(axis=0)
    low = np.arange(10 * RATIO_LOW, 10 * RATIO_HIGH)
    numbers = np.full((len(low), 2, len(COUNTED + MEASURED) + 3), np.nan)
    allowed = np.flatnonzero(judged.considered & (count == 0) & np.isfinite(mass))
    place = rank(tenths[allowed], mass[allowed])
    best, place = allowed[place < 2], place[place < 2]
    numbers[tenths[best] - low[0], place] = np.stack(
        [
            *(np.broadcast_to(getattr(gears, name), mass.shape)[best] for name in COUNTED + MEASURED),
            np.full(len(best), gears.tips_fitted),
            judged.width_mm[best],
            mass[best],
        ],
        axis=-1,
    )
    lightest, nearest = np.full((2, 10 * RATIO_HIGH), np.inf)
    lightest[low] = numbers[:, 0, -1]
    np.minimum.at(nearest, tenths, nearness)
    solved = np.isfinite(lightest)[tenths]
    rivals = np.where(solved, judged.considered & (count == 1) & (mass < lightest[tenths]), nearness == nearest[tenths])
    in_the_way = np.zeros((10 * RATIO_HIGH, len(judged.names)), dtype=bool)
    for name, row in enumerate(broken):
        in_the_way[tenths[rivals & row], name] = True
    words = [" ".join(np.array(judged.names)[each]) for each in in_the_way[low]]
    return {"low": low, "numbers": numbers, "in_the_way": np.array(words)}


def _from_arrays(stored: Mapping[str, NDArray[Any]], family: Family) -> dict[int, FamilyResult]:
    """Return what ``_search`` found from its arrays."""
    numbers = stored["numbers"]
    places = np.argwhere(np.isfinite(numbers[..., 0]))
    found: dict[tuple[int, int], Candidate] = {}
    if len(places):
        *gears, fitted, width_mm, mass_kg = numbers[tuple(places.T)].T
        sets = GearSet(**dict(zip(COUNTED + MEASURED, gears, strict=True)), tips_fitted=bool(fitted[0]))
        for index, (row, place) in enumerate(places.tolist()):
            found[row, place] = Candidate(
                family=family,
                gears=sets.chosen(index),
                face_width_mm=float(width_mm[index]),
                mass_kg=float(mass_kg[index]),
            )
    return {
        low: FamilyResult(best=found.get((row, 0)), runner_up=found.get((row, 1)), in_the_way=tuple(names.split()))
        for row, (low, names) in enumerate(zip(stored["low"].tolist(), stored["in_the_way"].tolist(), strict=True))
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
        stored = kept(key, lambda family=family: _search(motor, family, settings))  # type: ignore[misc]  # a default
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
