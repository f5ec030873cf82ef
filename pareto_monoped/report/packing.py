"""Numbers as text for the page: rounded, columns that a browser reads without parsing, and packed jumps.

A jump is small enough that a page can hold one for every design of its fronts. Each of its columns is rounded to whole
counts. The changes from moment to moment, small numbers that often repeat, are deflated (RFC 1951) all together.
``assets/jumps.js`` reads them as ``page.embedded`` hands them on; ``unpacked`` does the same.
"""

import base64
import zlib
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.jump.frames import Recording
from pareto_monoped.report.schema import Column, Jumps, Number

COUNTS: Mapping[str, float] = {
    "base_x_m": 5e-4,
    "base_z_m": 5e-4,
    "hip_rad_per_s": 0.1,
    "knee_rad_per_s": 0.1,
    "hip_rad": 1e-3,
    "knee_rad": 1e-3,
    "hip_motor_torque_n_m": 0.1,
    "knee_motor_torque_n_m": 0.1,
    "contact_z_n": 1.0,
}
"""The columns in the order in which they are packed, and the value of one count: less than half a pixel of a chart."""

_MOST = 32_767  # counts from one moment to the next in two bytes: 16 m, 32 rad or 32 kN, which no jump has
DIGITS = 5  #: Significant digits of numbers on the page: more than any of them is good for.


def packed(recordings: Mapping[int, Recording], frames: int) -> Jumps:
    """Return the jumps as text, by keys such as numbers of trials; each has ``frames`` frames, or fewer if short."""
    jumps = list(recordings.values())
    changes = np.zeros((len(jumps), 1 + len(COUNTS), frames), dtype="<i2")
    for own, jump in zip(changes, jumps, strict=True):
        counts = [jump.steps, *(np.floor(jump.columns[name] / size + 0.5) for name, size in COUNTS.items())]
        own[:, : len(jump.steps)] = np.clip(np.diff(counts, prepend=0), -_MOST, _MOST)
    step_s = jumps[0].step_s if jumps else 0.0
    return Jumps(
        keys=list(recordings),
        lift_off_s=[jump.lift_off_step * step_s for jump in jumps],
        frames=frames,
        counts={"time_s": step_s} | dict(COUNTS),
        data=base64.b64encode(zlib.compress(changes.tobytes(), 9)).decode("ascii"),
    )


def unpacked(jumps: Jumps, key: int) -> dict[str, NDArray[np.float64]]:
    """Return ``time_s`` and the columns of one jump in stored units, each of shape (frames,)."""
    shape = (len(jumps.keys), len(jumps.counts), jumps.frames)
    changes = np.frombuffer(zlib.decompress(base64.b64decode(jumps.data)), dtype="<i2").reshape(shape)
    own = np.cumsum(changes[list(jumps.keys).index(key)], axis=1, dtype=np.float64)
    # A jump of fewer moments ends where time stands still.
    there = np.append(True, np.diff(own[0]) > 0)
    return {name: own[k, there] * size for k, (name, size) in enumerate(jumps.counts.items())}


def lift_off_s(jumps: Jumps, key: int) -> float:
    """Return the time of the last contact in one jump."""
    return jumps.lift_off_s[list(jumps.keys).index(key)]


def packed_column(values: Any) -> str:
    """Return numbers, shape (n,), in base64 as single precision, low byte first: three numbers are sixteen letters.

    A value is off by at most 2^-24 of itself, so that conditions find the same designs as in the database. What is not
    finite, or beyond single precision, becomes not a number.
    """
    return base64.b64encode(_single(values).tobytes()).decode("ascii")


def _single(values: Any) -> NDArray[np.float32]:
    with np.errstate(over="ignore"):
        single = np.asarray(values, dtype=np.float64).astype("<f4")
    return np.where(np.isfinite(single), single, np.float32(np.nan)).astype("<f4")


def unpacked_column(text: str) -> NDArray[np.float64]:
    """Return the numbers of ``packed_column``, shape (n,); NaN where there is none."""
    return np.frombuffer(base64.b64decode(text), dtype="<f4").astype(np.float64)


def single_column(values: Any) -> Column:
    """Return numbers as the page has them, in single precision; None where they are not finite."""
    return [None if np.isnan(value) else float(value) for value in _single(values)]


def column(values: Any, digits: int = DIGITS) -> Column:
    """Return numbers, shape (n,), to ``digits`` significant digits; None where they are not finite."""
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
    """Return a number to four decimals, None if it is not finite."""
    return round(float(value), 4) if np.isfinite(value) else None
