"""Rows of a struct of arrays."""

from collections.abc import Sequence
from dataclasses import fields, replace
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

T = TypeVar("T", bound="DataclassInstance")


def take(record: T, rows: NDArray[np.intp]) -> T:
    """A copy of a frozen dataclass whose fields are arrays or tuples with one row per item, with only some rows.

    Args:
        record: the dataclass; every array and tuple has n rows, anything else is the same for all items.
        rows: indices of the rows to keep, in this order.
    """
    kept: dict[str, Any] = {}
    for field in fields(record):
        values = getattr(record, field.name)
        if isinstance(values, tuple):
            kept[field.name] = tuple(values[i] for i in rows)
        elif isinstance(values, np.ndarray):
            kept[field.name] = values[rows]
    return replace(record, **kept)


def joined(records: Sequence[T]) -> T:
    """One record with the rows of all, see ``take``; a single record stays as it is.

    Args:
        records: at least one; what is the same for all items must be the same in all of them.
    """
    if len(records) == 1:
        return records[0]
    together: dict[str, Any] = {}
    for field in fields(records[0]):
        parts = [getattr(record, field.name) for record in records]
        if isinstance(parts[0], tuple):
            together[field.name] = tuple(item for part in parts for item in part)
        elif isinstance(parts[0], np.ndarray):
            together[field.name] = np.concatenate(parts)
    return replace(records[0], **together)
