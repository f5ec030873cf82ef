"""What a study asks for, as in its file: the objectives, the constraints on measures, the hypervolume's corner."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.design import BASE_START_HEIGHT_M
from pareto_monoped.errors import StudyError, complaint, unknown_name
from pareto_monoped.measures import GOAL_NAMES, STATISTICS, is_goal, is_own, is_robust, measure, near_measures
from pareto_monoped.pareto.objectives import (
    FEWEST,
    HEIGHT_AND_ENERGY,
    MOST,
    Objectives,
    ReferencePoint,
    reference_point,
)
from pareto_monoped.strength.groups import REQUIRED_MEASURES
from pareto_monoped.uncertainty.settings import MOST_FAILED

Side = Literal["min", "max"]

MIN_HEIGHT_M = 0.55
"""Least height of a study that names none: a jump of 5 cm. It keeps robots that only stand, and therefore spend no
energy, off the front."""
LEAST_SAFETY = 1.0
"""Least value of every measure of strength where strength is asked for: each joint has its required factor."""
_ALWAYS_STORED = ("min_height_m", "max_energy_j", "max_mass_kg", "min_foot_clearance_m")
"""Limits that every stored study names, also where they are off, in this order; 0.1.0 had no others."""
_ALLOWED = {("min", "height_m"): (BASE_START_HEIGHT_M, 10.0), ("min", "foot_clearance_m"): (0.0, 10.0)}
"""Ranges of limits that are narrower than all numbers above 0."""
_DIRECTED = [name for name in GOAL_NAMES if measure(name).direction is not None]
"""What can be an objective."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Limit:
    """One constraint: ``measure`` is at least (``min``) or at most (``max``) ``value``, in its stored unit."""

    measure: str
    side: Side
    value: float

    @property
    def key(self) -> str:
        """Its key in a stored study, such as "max_mass_kg"."""
        return f"{self.side}_{self.measure}"

    @property
    def violated(self) -> str:
        """On which side of the limit a value violates it."""
        return "above" if self.side == "max" else "below"

    def shares(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return how far values are beyond the limit, as shares of it or, for a limit of 0, as they are; <= 0 holds."""
        sign = 1.0 if self.side == "max" else -1.0
        return sign * (values - self.value) / (abs(self.value) or 1.0)


@dataclass(frozen=True, slots=True, kw_only=True)
class Constraints:
    """The limits that a feasible design keeps, in the order in which they are judged and stored."""

    limits: tuple[Limit, ...]

    @property
    def measures(self) -> tuple[str, ...]:
        """The measures that are limited, each once."""
        return tuple(dict.fromkeys(limit.measure for limit in self.limits))

    def value(self, key: str) -> float | None:
        """Return the limit with a key such as "max_mass_kg"; None where there is none."""
        return next((limit.value for limit in self.limits if limit.key == key), None)

    def as_dict(self) -> dict[str, float | None]:
        """Return the stored form: a number per key, None for the limits that are off and always stored."""
        return dict.fromkeys(_ALWAYS_STORED) | {limit.key: limit.value for limit in self.limits}


def constraints_of(
    table: Mapping[str, Any], *, strength: bool = False, robust: bool = False, source: str = "constraints"
) -> Constraints:
    """Return the limits of a table of ``measure = { min = a, max = b }``, or of keys such as ``max_mass_kg``.

    A value of None switches a limit off. With ``strength``, every measure of strength is at least ``LEAST_SAFETY``. If
    an objective or a limit is of jumps under uncertainty, at most ``MOST_FAILED`` of them fail, unless the table says
    otherwise.

    Raises:
        StudyError: an unknown measure or key, a limit given twice, a value out of range, or less than strength asks.
    """
    given: set[tuple[Side, str]] = set()
    chosen: dict[tuple[Side, str], float] = {}
    for key, value in flattened(table).items():
        for side, name, limit in _entries(key, value, source):
            if (side, name) in given:
                raise StudyError(f"{source}: constraints.{name}: its {side} is given twice; drop one")
            given.add((side, name))
            if limit is not None:
                typed = f"constraints.{key}.{side}" if key == name else f"constraints.{key}"
                chosen[side, name] = _value((side, name), limit, f"{source}: {typed}")
    chosen.setdefault(("min", "height_m"), MIN_HEIGHT_M)
    if robust or any(is_robust(name) for _, name in chosen):
        chosen.setdefault(("max", "failed_share"), MOST_FAILED)
    for name in REQUIRED_MEASURES if strength else ():
        least = chosen.setdefault(("min", name), LEAST_SAFETY)
        if least < LEAST_SAFETY:
            allowed = f"at least {LEAST_SAFETY:g} with strength = true"
            problem = complaint(f"constraints.{name}.min", least, allowed, "raise it, or set strength = false")
            raise StudyError(f"{source}: {problem}")
    for name in {name for _, name in chosen}:
        low, high = chosen.get(("min", name)), chosen.get(("max", name))
        if low is not None and high is not None and low > high:
            raise StudyError(
                f"{source}: constraints.{name}: min = {low:g}, max = {high:g}: min must not exceed max; swap them"
            )
    limits = [Limit(measure=name, side=side, value=value) for (side, name), value in chosen.items()]
    return Constraints(limits=tuple(sorted(limits, key=_place)))


def _entries(key: str, value: Any, source: str) -> list[tuple[Side, str, Any]]:
    """Return side, measure and value of each limit that one key of the table sets."""
    for side in ("min", "max"):
        name = key.removeprefix(f"{side}_")
        if name != key and is_goal(name):
            return [(side, name, value)]
    if not is_goal(key):
        near = near_measures(key.removeprefix("min_").removeprefix("max_"), GOAL_NAMES)
        raise StudyError(f"{source}: constraints.{key}: must be the name of a measure; {near}")
    if not isinstance(value, Mapping) or not value or not set(value) <= {"min", "max"}:
        allowed = "a table with min, max or both, such as { max = 4.0 }"
        raise StudyError(f"{source}: {complaint(f'constraints.{key}', value, allowed, 'correct it')}")
    return [(side, key, value[side]) for side in ("min", "max") if side in value]


def _value(place: tuple[Side, str], value: Any, typed: str) -> float:
    """Return the value of a limit; ``typed`` is its key as in the file, for the message."""
    low, high = _ALLOWED.get(place, (0.0, math.inf))
    number = not isinstance(value, bool) and isinstance(value, int | float) and _is_finite(value)
    if is_own(place[1]):
        if not number:
            raise StudyError(complaint(typed, value, "a finite number", "correct it"))
        return float(value)
    if not number or value <= 0.0 or not low <= value <= high:
        allowed = "a number above 0" if high == math.inf else f"a number from {low:g} to {high:g}"
        allowed += ", above 0" if low == 0.0 < high < math.inf else ""
        raise StudyError(complaint(typed, value, allowed, "correct it"))
    return float(value)


def _is_finite(number: int | float) -> bool:
    """Return whether a number is one as floating point has it."""
    try:
        return math.isfinite(number)
    except OverflowError:  # a whole number beyond the greatest float
        return False


def _place(limit: Limit) -> tuple[int, int, bool]:
    """Return a limit's place: those of 0.1.0 first in their old order, so that its studies go on; own ones last."""
    if limit.key in _ALWAYS_STORED:
        return _ALWAYS_STORED.index(limit.key), 0, False
    if is_own(limit.measure):
        return len(_ALWAYS_STORED) + 1, 0, False
    return len(_ALWAYS_STORED), GOAL_NAMES.index(limit.measure), limit.side == "max"


def objectives_of(given: Any, *, source: str = "objectives") -> Objectives:
    """Return objectives from a list of measures, from a table of measure and direction, or, for None, the paper's.

    Raises:
        StudyError: an unknown measure, one without a direction, one named twice, or not two or three of them.
    """
    if given is None:
        return HEIGHT_AND_ENERGY
    if isinstance(given, str) or not isinstance(given, Sequence | Mapping):
        allowed = 'a list of two or three measures, such as ["height_m", "energy_j"]'
        raise StudyError(f"{source}: {complaint('objectives', given, allowed, 'correct it')}")
    # The order of a table means nothing; that of a list decides which objective charts and tables show first.
    names = tuple(sorted(given, key=_rank) if isinstance(given, Mapping) else given)
    for name in names:
        if not is_goal(name):
            raise StudyError(f"{source}: objective {name!r} is not a measure; {near_measures(name, _DIRECTED)}")
        direction = measure(name).direction
        if direction is None:
            raise StudyError(f"{source}: objective {name!r} has no direction, neither way is better; take another")
        if isinstance(given, Mapping) and given[name] != direction:
            raise StudyError(f"{source}: {complaint(f'objectives.{name}', given[name], repr(direction), 'correct it')}")
    if twice := [name for name in names if names.count(name) > 1]:
        raise StudyError(f"{source}: objective {twice[0]!r} is named twice; drop one")
    if not FEWEST <= len(names) <= MOST:
        raise StudyError(
            f"{source}: {complaint('number of objectives', len(names), 'two or three', 'correct the list')}"
        )
    return Objectives(names=names)


def names_of(text: str) -> list[str]:
    """Return the measures that an option names, such as "height_m,energy_j"."""
    return [name.strip() for name in text.split(",")]


def stored_objectives(objectives: Objectives) -> dict[str, str] | list[str]:
    """Return the stored form: for the paper's objectives the table that 0.1.0 stored, for others the list of names.

    The order of a list is kept, because a search depends on it; a table's order is not part of a study's hash.
    """
    return objectives.directions if objectives == HEIGHT_AND_ENERGY else list(objectives.names)


def corner_of(table: Mapping[str, Any], objectives: Objectives, *, source: str) -> ReferencePoint:
    """Return the reference point from its table; what is left out is as in the table of measures."""
    for name, value in flattened(table).items():
        if name not in objectives.names:
            raise StudyError(f"{source}: {unknown_name('measure in reference_point', name, objectives.names)}")
        number = not isinstance(value, bool) and isinstance(value, int | float) and _is_finite(value)
        least = 0.0 if measure(name).direction == "maximise" else 1e-9
        if not number or (value < least and not is_own(name)):
            allowed = "a number of at least 0" if least == 0.0 else "a number above 0"
            allowed = "a finite number" if is_own(name) else allowed
            raise StudyError(f"{source}: {complaint(f'reference_point.{name}', value, allowed, 'correct it')}")
    return reference_point(objectives, {name: float(value) for name, value in flattened(table).items()})


def flattened(table: Mapping[str, Any]) -> dict[str, Any]:
    """Return a table with the key "height_m.p05" for ``height_m.p05 = x``, which TOML reads as a nested table."""
    flat: dict[str, Any] = {}
    for key, value in table.items():
        inner = {name: value[name] for name in STATISTICS if name in value} if isinstance(value, Mapping) else {}
        new = {f"{key}.{name}": given for name, given in inner.items()}
        if not inner or len(inner) < len(value):
            new[key] = {name: given for name, given in value.items() if name not in inner} if inner else value
        if twice := [name for name in new if name in flat]:
            raise StudyError(f"{twice[0]}: is given twice, once with a dot and once as a table; drop one")
        flat |= new
    return flat


def _rank(name: object) -> int:
    return GOAL_NAMES.index(name) if name in GOAL_NAMES else -1
