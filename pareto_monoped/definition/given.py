"""Values from NumPy and pandas as Python's own lists, tables and numbers; counts that scripts give."""

from collections.abc import Mapping
from numbers import Integral
from os import PathLike, fspath
from typing import Any

import numpy as np

from pareto_monoped.errors import InputError, complaint


def is_series(given: Any) -> bool:
    """Return whether something is a series of pandas, without importing pandas."""
    return getattr(given, "ndim", 0) == 1 and hasattr(given, "items") and hasattr(given, "index")


def as_list(given: Any) -> Any:
    """Return the values of a one-dimensional array, index or series as a list, anything else as it is."""
    values = getattr(given, "tolist", None)
    return values() if getattr(given, "ndim", 0) == 1 and callable(values) else given


def as_table(given: Any) -> Any:
    """Return the values of a series by their labels, anything else as it is."""
    return dict(given.items()) if is_series(given) else given


def as_plain(given: Any) -> Any:
    """Return a value of a study file as TOML has it: tables, lists and numbers of Python, and paths as text."""
    if isinstance(given, PathLike):
        return fspath(given)
    if isinstance(given, np.generic | np.ndarray):
        return given.tolist()
    if is_series(given) and all(isinstance(label, str) for label in given.index):
        given = as_table(given)
    given = as_list(given)
    if isinstance(given, Mapping):
        return {key: as_plain(value) for key, value in given.items()}
    return [as_plain(value) for value in given] if isinstance(given, list | tuple) else given


MOST = 100_000_000
"""Greatest count of anything: as many evaluations as a study file may ask for."""


def count_of(what: str, given: Any) -> int | None:
    """Return a whole number from 1 to ``MOST``, or None where none is given; refuse all else."""
    if given is None:
        return None
    if isinstance(given, bool) or not isinstance(given, Integral) or not 1 <= int(given) <= MOST:
        raise InputError(complaint(what, given, f"a whole number from 1 to {MOST}", "correct it"))
    return int(given)
