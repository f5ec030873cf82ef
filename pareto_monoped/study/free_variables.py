"""The variables of a study: each is free within bounds or fixed to a number."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from pareto_monoped.design import LENGTHS, NAMES, PAPER_CASES, VARIABLES
from pareto_monoped.errors import StudyError, complaint, unknown_name

_LIMITS = {"m": (0.05, 2.0), "1": (1.0, 100.0), "rad": (0.0, 3.0)}
"""Unit -> allowed range. Values beyond it are typing errors; controller gains may be any number from 0."""
_REST_LENGTHS_M = (0.5, 100.0)  # longer than any leg; a longer spring acts by its product with K alone


@dataclass(frozen=True, slots=True, kw_only=True)
class Bounds:
    """Range of a free variable."""

    lower: float
    upper: float


def variables_of(given: Mapping[str, Any], case: str | None, source: str) -> dict[str, Bounds | float]:
    """What each variable may be: as given, else as in the paper's case, else free within the paper's bounds.

    Args:
        given: the table ``variables`` of a study file.
        case: the paper's case whose fixed variables the study has, if any.
        source: the file, for messages.

    Raises:
        StudyError: an unknown name, impossible bounds, nothing free, or links shorter than the start height.
    """
    for name in given:
        if name not in NAMES:
            raise StudyError(f"{source}: {unknown_name('variable', name, NAMES)}")
    chosen: dict[str, Bounds | float] = {}
    for variable in VARIABLES:
        value = given.get(variable.name)
        if value is not None:
            chosen[variable.name] = _variable(variable.name, value, source)
        elif variable.default is not None:
            chosen[variable.name] = variable.default
        elif case is None or variable.name in PAPER_CASES[case].free:
            chosen[variable.name] = Bounds(lower=variable.lower, upper=variable.upper)
        else:
            chosen[variable.name] = getattr(PAPER_CASES[case].design, variable.name)
    if not any(isinstance(value, Bounds) for value in chosen.values()):
        raise StudyError(f"{source}: variables: all are fixed, at least one must be free; give one bounds")
    longest = sum(v.upper if isinstance(v, Bounds) else v for v in (chosen[name] for name in LENGTHS))
    start = chosen["start_height_m"]
    lowest = start.lower if isinstance(start, Bounds) else start
    if longest <= lowest:
        raise StudyError(
            f"{source}: thigh_length_m + shank_length_m = {longest:g} at most: must exceed the start height of "
            f"{lowest:g} m; allow longer links"
        )
    return chosen


def _variable(name: str, given: Any, source: str) -> Bounds | float:
    key = f"{source}: variables.{name}"
    if isinstance(given, Mapping):
        if set(given) != {"lower", "upper"}:
            raise StudyError(f"{key} has the keys {sorted(map(str, given))}; must be lower and upper; correct them")
        bounds = Bounds(
            lower=number_of(f"{key}.lower", name, given["lower"]), upper=number_of(f"{key}.upper", name, given["upper"])
        )
        if bounds.lower >= bounds.upper:
            raise StudyError(
                f"{key}: lower = {bounds.lower:g}, upper = {bounds.upper:g}: lower must be below upper; "
                "correct them, or fix the variable to a number"
            )
        return bounds
    if not isinstance(given, int | float):
        low, high = _limits(name)
        allowed = f"a number from {low:g} to {high:g}, or a range such as {_range_example(name)}"
        raise StudyError(complaint(key, given, allowed, "correct it"))
    return number_of(key, name, given)


def _range_example(name: str) -> str:
    bounds = next(variable for variable in VARIABLES if variable.name == name)
    return f'{{"lower": {bounds.lower:g}, "upper": {bounds.upper:g}}}'


def _limits(name: str) -> tuple[float, float]:
    """Least and greatest value of a variable."""
    unit = next(variable.unit for variable in VARIABLES if variable.name == name)
    return _REST_LENGTHS_M if name == "rest_length_m" else _LIMITS.get(unit, (0.0, 1e6))


def number_of(key: str, name: str, given: Any) -> float:
    """A value of the variable ``name``, which messages call ``key``.

    Raises:
        StudyError: no number, or one out of range.
    """
    low, high = _limits(name)
    allowed = f"a number from {low:g} to {high:g}"
    if isinstance(given, bool) or not isinstance(given, int | float) or not low <= given <= high:
        raise StudyError(complaint(key, given, allowed, "correct it"))
    return float(given)
