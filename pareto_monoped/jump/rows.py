"""Rows of a struct of arrays."""

from dataclasses import fields, replace
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

T = TypeVar("T")


def take(record: T, rows: NDArray[np.intp]) -> T:
    """The chosen rows of every array or tuple of a frozen dataclass that holds a row an item."""
    kept: dict[str, Any] = {}
    for field in fields(record):  # type: ignore[arg-type]
        values = getattr(record, field.name)
        kept[field.name] = tuple(values[i] for i in rows) if isinstance(values, tuple) else values[rows]
    return replace(record, **kept)  # type: ignore[type-var]
