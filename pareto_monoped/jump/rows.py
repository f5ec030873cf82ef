"""Rows of a struct of arrays."""

from dataclasses import fields, replace
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

T = TypeVar("T")


def take(record: T, rows: NDArray[np.intp]) -> T:
    """A copy of a frozen dataclass whose fields are arrays or tuples with one row per item, with only some rows.

    Args:
        record: the dataclass; every array and tuple has n rows, anything else is the same for all items.
        rows: indices of the rows to keep, in this order.
    """
    kept: dict[str, Any] = {}
    for field in fields(record):  # type: ignore[arg-type]
        values = getattr(record, field.name)
        if isinstance(values, tuple):
            kept[field.name] = tuple(values[i] for i in rows)
        elif isinstance(values, np.ndarray):
            kept[field.name] = values[rows]
    return replace(record, **kept)  # type: ignore[type-var]
