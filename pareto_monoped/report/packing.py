"""Columns of numbers as text that a browser reads without parsing: short, and any value can be read by itself."""

import base64
from typing import Any

import numpy as np
from numpy.typing import NDArray


def packed(values: Any) -> str:
    """Numbers, shape (n,), as four letters each: base64 of the upper three bytes of single precision, low byte first.

    Three bytes keep 16 significant bits, so a value is off by at most 2^-16 of itself (1.5e-5), less than the rounding
    of columns written as text. Three bytes are exactly four letters, so the value of a row can be read alone. What is
    not finite, or beyond single precision, becomes not a number.
    """
    with np.errstate(over="ignore"):
        single = np.asarray(values, dtype=np.float64).astype("<f4")
    single = np.where(np.isfinite(single), single, np.float32(np.nan)).astype("<f4")
    words = single.view("<u4").astype(np.uint64)
    # Half of the last bit that is kept, so that the cut rounds; what is not a number stays as it is.
    words = np.where(np.isnan(single), words, words + 0x80).astype("<u4")
    return base64.b64encode(words.view(np.uint8).reshape(-1, 4)[:, 1:].tobytes()).decode("ascii")


def unpacked(text: str) -> NDArray[np.float64]:
    """The numbers of ``packed``, shape (n,); NaN where there is none."""
    upper = np.frombuffer(base64.b64decode(text), dtype=np.uint8).reshape(-1, 3)
    words = np.zeros((len(upper), 4), dtype=np.uint8)
    words[:, 1:] = upper
    return words.view("<f4")[:, 0].astype(np.float64)
