"""Rows of a struct of arrays."""

from dataclasses import fields, replace
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

T = TypeVar("T")


def take(record: T, rows: NDArray[np.intp]) -> T:
    """A copy of a frozen dataclass whose fields are arrays or tuples with one row per item, with only some rows.

    Args:
        record: the dataclass; every field has n rows.
        rows: indices of the rows to keep, in this order.
    """
    kept: dict[str, Any] = {}
    for field in fields(record):  # type: ignore[arg-type]
        values = getattr(record, field.name)
        kept[field.name] = tuple(values[i] for i in rows) if isinstance(values, tuple) else values[rows]
    return replace(record, **kept)  # type: ignore[type-var]
