"""Numbers as the page's JSON has them."""

from typing import Any

import numpy as np

from pareto_monoped.report.records import Column

DIGITS = 5
"""Significant digits of numbers on the page: more than any of them is good for."""


def column(values: Any, digits: int = DIGITS) -> Column:
    """Numbers to that many significant digits, None where they are not finite."""
    array = np.asarray(values, dtype=np.float64)
    finite = np.isfinite(array)
    size = np.zeros_like(array)
    nonzero = finite & (array != 0.0)
    size[nonzero] = np.floor(np.log10(np.abs(array[nonzero])))
    decimals = (digits - 1 - size).astype(int)
    return [
        round(value, max(places, 0)) if good else None
        for value, places, good in zip(array.tolist(), decimals.tolist(), finite.tolist(), strict=True)
    ]
