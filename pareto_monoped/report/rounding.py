"""Rounding: how many digits of a number the page keeps."""

from typing import Any

import numpy as np

from pareto_monoped.report.schema import Column, Number

DIGITS = 5
"""Significant digits of numbers on the page: more than any of them is good for."""


def column(values: Any, digits: int = DIGITS) -> Column:
    """Numbers, shape (n,), to ``digits`` significant digits; None where they are not finite."""
    array = np.asarray(values, dtype=np.float64)
    finite = np.isfinite(array)
    exponent = np.zeros_like(array)
    nonzero = finite & (array != 0.0)
    exponent[nonzero] = np.floor(np.log10(np.abs(array[nonzero])))
    decimals = (digits - 1 - exponent).astype(int)
    return [
        round(value, max(places, 0)) if good else None
        for value, places, good in zip(array.tolist(), decimals.tolist(), finite.tolist(), strict=True)
    ]


def number(value: float) -> Number:
    """A number to four decimals, None if it is not finite."""
    return round(float(value), 4) if np.isfinite(value) else None
