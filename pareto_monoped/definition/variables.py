"""The variables of a study, free within bounds or fixed, and its motors: of both joints, or of hip and knee each."""

import json
from collections.abc import Container, Mapping
from dataclasses import dataclass
from itertools import product
from typing import Any

from pareto_monoped.design import (
    ALL_NAMES,
    KNOT_NAMES,
    KNOTS,
    LENGTHS,
    NAMES,
    PAPER_CASES,
    PAPER_CONTROL,
    PAPER_MOTOR,
    VARIABLES,
)
from pareto_monoped.errors import StudyError, complaint, unknown_name
from pareto_monoped.jump.laws import OF_VIRTUAL_LEG, PAPER_LAW, Law

_LIMITS = {"m": (0.05, 2.0), "1": (1.0, 100.0), "rad": (0.0, 3.0)}
"""Unit -> allowed range. Values beyond it are typing errors; controller gains may be any number from 0."""
_PUSH_TIMES_S = (0.01, 3.0)
_REST_LENGTHS_M = (0.5, 100.0)  # longer than any leg; a longer spring acts by its product with K alone


@dataclass(frozen=True, slots=True, kw_only=True)
class Bounds:
    """Range of a free variable."""

    lower: float
    upper: float


OPEN_GAINS = {
    "stiffness_n_per_m": Bounds(lower=0.5, upper=200.0),
    "damping_n_s_per_m": Bounds(lower=0.0, upper=100.0),
    "torsional_stiffness_n_m_per_rad": Bounds(lower=0.0, upper=200.0),
}
"""Bounds of K, C and T where the paper's are opened, as in studies/wide.toml. Our own choice: fronts end at the paper's
least K, with which 10 m of rest length force a jump of 0.75 m, and at its greatest C and T."""
NOT_OPENED = "start_height_m"
"""The optional variable that stays fixed in an opened study. Where it is free, every design of the front starts at its
greatest value, 0.7 m: a base that is put up there has that height for nothing, and the front would tell of little else.
"""
OPENED = (*(one.name for one in VARIABLES if one.default is not None and one.name != NOT_OPENED), *OPEN_GAINS)


def variables_of(
    given: Mapping[str, Any], case: str | None, source: str, law: Law = PAPER_LAW
) -> dict[str, Bounds | float]:
    """Return what each variable may be: as given, else as in the paper's case, else free within the paper's bounds.

    The knots of a torque profile are free within their bounds; what the law does not read is fixed, K, C and T at 0.

    Raises:
        StudyError: an unknown name, impossible bounds, nothing free, or links shorter than the start height.
    """
    known = names_under(law)
    for name, value in given.items():
        if name not in known and not (name in PAPER_CONTROL and value == 0.0):  # which a stored study has
            raise StudyError(f"{source}: {unknown_name('variable', name, known)}")
    chosen: dict[str, Bounds | float] = {}
    for variable in VARIABLES if law == PAPER_LAW else (*VARIABLES, *KNOTS):
        value = given.get(variable.name)
        if variable.name not in known:
            chosen[variable.name] = 0.0 if variable.default is None else variable.default
        elif variable in KNOTS and value is None:
            chosen[variable.name] = Bounds(lower=variable.lower, upper=variable.upper)
        elif value is not None:
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


def opened(
    variables: Mapping[str, Bounds | float], law: Law, kept: Container[str], *, without_stops: bool = False
) -> dict[str, Bounds | float]:
    """Return the variables with those in ``OPENED`` free that are at their defaults, K, C and T within ``OPEN_GAINS``.

    Those that are ``kept`` or have other values or bounds stay. So does what does not act: what the law does not read,
    and a release before the stop of a knee ``without_stops``.
    """
    known = names_under(law)
    changed = dict(variables)
    for variable in VARIABLES:
        name, usual = variable.name, Bounds(lower=variable.lower, upper=variable.upper)
        if name not in OPENED or name in kept or name not in known or (without_stops and name == "knee_release_rad"):
            continue
        if variables[name] == (usual if variable.default is None else variable.default):
            changed[name] = OPEN_GAINS.get(name, usual)
    return changed


def names_under(law: Law) -> tuple[str, ...]:
    """Return the names of the variables that a study has under a law: those of the hardware, and the law's own."""
    own = [variable.name for variable in law.variables]
    return tuple(name for name in ALL_NAMES if name in own or (name in NAMES and name not in OF_VIRTUAL_LEG))


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
        usual = next(variable for variable in (*VARIABLES, *KNOTS) if variable.name == name)
        example = f'{{"lower": {usual.lower:g}, "upper": {usual.upper:g}}}'
        allowed = f"a number from {low:g} to {high:g}, or a range such as {example}"
        raise StudyError(complaint(key, given, allowed, "correct it"))
    return number_of(key, name, given)


def _limits(name: str) -> tuple[float, float]:
    """Return the least and the greatest value of a variable."""
    if name in KNOT_NAMES:
        return (-1.0, 1.0) if "_knot_" in name else _PUSH_TIMES_S
    unit = next(variable.unit for variable in VARIABLES if variable.name == name)
    return _REST_LENGTHS_M if name == "rest_length_m" else _LIMITS.get(unit, (0.0, 1e6))


def number_of(key: str, name: str, given: Any) -> float:
    """Return a value of the variable ``name``, which messages call ``key``; refuse one out of range."""
    low, high = _limits(name)
    allowed = f"a number from {low:g} to {high:g}"
    if isinstance(given, bool) or not isinstance(given, int | float) or not low <= given <= high:
        raise StudyError(complaint(key, given, allowed, "correct it"))
    return float(given)


MOTOR_KEYS = ("motor", "hip_motor", "knee_motor")
"""Keys of a study file that name motors: of both joints, or of either."""
Named = str | tuple[str, ...] | None
"""What a key says: the name or file of a motor, several, or nothing."""

_LONGEST_NAME = 1000
"""Of a motor, or of the path to its file; longer ones are errors of typing."""


def names_of(named: Named) -> tuple[str, ...]:
    """Return the names that a key gives."""
    return (named,) if isinstance(named, str) else named or ()


def all_names(motor: Named, hip: Named, knee: Named) -> tuple[str, ...]:
    """Return every motor once, those of the hip first; capitals do not tell names apart."""
    found: dict[str, str] = {}
    for name in (*names_of(motor), *names_of(hip), *names_of(knee)):
        found.setdefault(name.lower(), name)
    return tuple(found.values())


def kits_of(motor: Named, hip: Named, knee: Named) -> tuple[tuple[str, str], ...]:
    """Return the motors of hip and knee that a design may have, named as in ``all_names``.

    Both joints share each of ``motor``, else each of the hip's is paired with each of the knee's.
    """
    if motor is not None:
        return tuple((name, name) for name in names_of(motor))
    called = {name.lower(): name for name in all_names(motor, hip, knee)}
    return tuple((called[one.lower()], called[other.lower()]) for one, other in product(names_of(hip), names_of(knee)))


def text_of(motor: Named, hip: Named, knee: Named) -> str:
    """Return all motors in one line, with commas between them: of both joints, or of hip and knee."""
    if motor is not None:
        return ", ".join(names_of(motor))
    return f"hip {', '.join(names_of(hip))}; knee {', '.join(names_of(knee))}"


def named_motors(motor: Any, hip: Any, knee: Any, source: str) -> dict[str, Named]:
    """Return the motors as a study keeps them, by ``MOTOR_KEYS``; one motor of both joints stands for both."""
    joints = {"hip_motor": hip, "knee_motor": knee}
    given = [key for key, value in joints.items() if value is not None]
    if not given:
        return {"motor": _motor("motor", PAPER_MOTOR if motor is None else motor, source)}
    if motor is not None:
        raise StudyError(
            f"{source}: motor and {given[0]} are both given: must be motor, which stands for both joints, or hip_motor "
            "and knee_motor; drop one"
        )
    if len(given) == 1:
        missing = next(key for key in joints if key not in given)
        raise StudyError(f"{source}: {given[0]} is given without {missing}; name both, or one motor for both joints")
    one, other = (_motor(key, value, source) for key, value in joints.items())
    if isinstance(one, str) and isinstance(other, str) and one.lower() == other.lower():
        return {"motor": one}
    return {"motor": None, "hip_motor": one, "knee_motor": other}


def _motor(key: str, given: Any, source: str) -> str | tuple[str, ...]:
    names = given if isinstance(given, list | tuple) else [given]
    if not all(isinstance(name, str) and 0 < len(name) <= _LONGEST_NAME for name in names):
        allowed = f"the name of a motor or its TOML file, of at most {_LONGEST_NAME} letters, or a list of such names"
        raise StudyError(f"{source}: {complaint(key, given, allowed, 'correct it')}")
    if isinstance(given, str):
        return given
    if len(names) < 2:
        cure = f"give the name alone: {key} = {json.dumps(names[0])}" if names else "name the motors to choose from"
        raise StudyError(f"{source}: {complaint(key, list(names), 'a list of at least two motors', cure)}")
    for place, name in enumerate(names):
        if name.lower() in [other.lower() for other in names[:place]]:
            allowed = "a list of different motors"
            raise StudyError(f"{source}: {complaint(key, list(names), allowed, f'name {name!r} once')}")
    return tuple(names)
