"""Checks of plain values that scripts give."""

import math
from collections.abc import Mapping, Sequence
from concurrent.futures import Executor
from numbers import Integral, Real
from typing import Any

import numpy as np

from pareto_monoped.errors import InputError, complaint
from pareto_monoped.study.plain import as_list, as_table


def executor_of(given: Any) -> Any:
    """Something that does calls elsewhere, or None where none is given.

    Raises:
        InputError: something else.
    """
    if given is None or isinstance(given, Executor):
        return given
    allowed = "a concurrent.futures.Executor, such as a ProcessPoolExecutor"
    raise InputError(complaint("executor", given, allowed, "give one, or leave it out"))


def seed_of(given: Any) -> int:
    """The seed of a random generator.

    Raises:
        InputError: no whole number from 0 to 2**63 - 1.
    """
    if isinstance(given, bool) or not isinstance(given, Integral) or not 0 <= int(given) < 2**63:
        raise InputError(complaint("seed", given, "a whole number from 0 to 2**63 - 1", "correct it"))
    return int(given)


def trial_of(given: Any) -> int:
    """The number of a trial.

    Raises:
        InputError: no whole number of at least 0.
    """
    if isinstance(given, bool) or not isinstance(given, Integral) or given < 0:
        raise InputError(complaint("trial", given, "the number of a trial, from 0", "give one"))
    return int(given)


def truth_of(what: str, given: Any) -> bool:
    """True or False.

    Raises:
        InputError: something else, which might count as either.
    """
    if not isinstance(given, bool | np.bool_):
        raise InputError(complaint(what, given, "True or False", "give one of them"))
    return bool(given)


def number_of(what: str, given: Any) -> float:
    """A finite number.

    Raises:
        InputError: something else.
    """
    if isinstance(given, Real) and not isinstance(given, bool):
        try:
            number = float(given)
        except OverflowError:  # a whole number beyond the greatest float
            number = math.inf
        if math.isfinite(number):
            return number
    raise InputError(complaint(what, given, "a finite number", "give one"))


def numbers_of(what: str, given: Any) -> tuple[float, ...]:
    """Finite numbers from a list, an array or a series.

    Raises:
        InputError: something else.
    """
    values = as_list(given)
    if isinstance(values, str | bytes | Mapping) or not isinstance(values, Sequence):
        raise InputError(complaint(what, given, "a list of numbers", "give one"))
    return tuple(number_of(what, value) for value in values)


def table_of(what: str, given: Any) -> dict[str, float]:
    """Finite numbers by name, from a mapping or a series.

    Raises:
        InputError: something else.
    """
    values = as_table(given)
    if not isinstance(values, Mapping):
        raise InputError(complaint(what, given, "a mapping of names to numbers", "give one"))
    return {name: number_of(f"{what}[{name!r}]", value) for name, value in values.items()}
