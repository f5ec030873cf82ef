"""Counts that scripts give: of evaluations, threads, samples."""

from numbers import Integral
from typing import Any

from pareto_monoped.errors import InputError, complaint

MOST = 100_000_000
"""Greatest count of anything: as many evaluations as a study file may ask for."""


def count_of(what: str, given: Any) -> int | None:
    """A whole number from 1 to ``MOST``, or None where none is given.

    Raises:
        InputError: something else.
    """
    if given is None:
        return None
    if isinstance(given, bool) or not isinstance(given, Integral) or not 1 <= int(given) <= MOST:
        raise InputError(complaint(what, given, f"a whole number from 1 to {MOST}", "correct it"))
    return int(given)
