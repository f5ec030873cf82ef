"""Compare JSON values, numbers to within a tolerance, and say where they differ."""

import math
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True, slots=True, kw_only=True)
class Difference:
    """A place where two values differ.

    Attributes:
        field: its keys from the outside in, with dots between them.
        found, expected: what stands there; ``ABSENT`` where there is nothing.
    """

    field: str
    found: Any
    expected: Any


ABSENT = "nothing"


def difference(found: Any, expected: Any, *, rel_tolerance: float, field: str = "") -> Difference | None:
    """The first place where two JSON values differ, None if there is none."""
    if isinstance(found, dict) and isinstance(expected, dict):
        for key in (*expected, *(key for key in found if key not in expected)):
            inner = difference(
                found.get(key, ABSENT),
                expected.get(key, ABSENT),
                rel_tolerance=rel_tolerance,
                field=f"{field}.{key}" if field else str(key),
            )
            if inner is not None:
                return inner
        return None
    if isinstance(found, list) and isinstance(expected, list) and len(found) == len(expected):
        pairs = enumerate(zip(found, expected, strict=True))
        inside = (difference(a, b, rel_tolerance=rel_tolerance, field=f"{field}.{k}") for k, (a, b) in pairs)
        return next(filter(None, inside), None)
    if isinstance(found, float) and isinstance(expected, float):
        equal = math.isclose(found, expected, rel_tol=rel_tolerance, abs_tol=1e-12)
    else:
        equal = type(found) is type(expected) and bool(found == expected)
    return None if equal else Difference(field=field, found=found, expected=expected)
