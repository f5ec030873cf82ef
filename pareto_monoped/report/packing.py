"""Numbers as text for the page: rounded, columns that a browser reads without parsing, and packed jumps.

A jump is small enough that a page can hold one for every design of its fronts. Each of its columns is rounded to whole
counts. Each count is predicted from those before it, and how far the prediction is off is written in a Rice code (R. F.
Rice, "Some practical universal noiseless coding techniques", JPL Publication 79-22, 1979), which is short for small
numbers. ``assets/jumps.js`` reads it; ``unpacked`` does the same.
"""

import base64
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.jump.frames import Recording, frame_steps
from pareto_monoped.report.schema import Column, JumpColumn, Jumps, Number

Ints = NDArray[np.int64]

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

LAST, LINE = "last", "line"
"""Predictions: the count before, or the line through the two counts before. Any other text is the name of a column that
is the rate of this one: the count before and the integral of the rate by the trapezoidal rule."""
_RATES = {"hip_rad": "hip_rad_per_s", "knee_rad": "knee_rad_per_s"}

_HEAD_BITS = 16  # of the numbers of a jump's lift-off step and last step
_LONG, _LONG_BITS = 20, 28  # a code of so many ones is followed by the number itself, in so many bits
_MOST_RICE = 12
_FAR = 4  # a line is not drawn on over so many times the distance of the two points that it goes through
DIGITS = 5  #: Significant digits of numbers on the page: more than any of them is good for.


def packed(recordings: Mapping[int, Recording], frames: int) -> Jumps:
    """Return the jumps as text, by keys such as numbers of trials; each has ``frames`` frames, or fewer if short."""
    jumps = list(recordings.values())
    sizes = np.array([len(jump.steps) for jump in jumps], dtype=np.int64)
    step_s = jumps[0].step_s if jumps else 0.0
    frame = _Frames.of([jump.steps for jump in jumps], step_s)
    counts = {name: _joined([jump.columns[name] for jump in jumps], size) for name, size in COUNTS.items()}
    columns: list[JumpColumn] = []
    codes: list[Ints] = []
    for name, size in COUNTS.items():
        by = _RATES.get(name)
        rate = None if by is None else frame.integral(counts[by], COUNTS[by] / size)
        predictor, rice, zigzag = _shortest(counts[name], frame, by, rate)
        columns.append(JumpColumn(name=name, count=size, predictor=predictor, rice=rice))
        codes.append(zigzag)
    ends = np.array([(jump.lift_off_step, int(jump.steps[-1])) for jump in jumps], dtype=np.int64).reshape(-1, 2)
    lengths, raw = _bytes(sizes, ends, codes, [column.rice for column in columns])
    data = base64.b64encode(raw).decode("ascii")
    return Jumps(keys=list(recordings), lengths=lengths, step_s=step_s, frames=frames, columns=columns, data=data)


def _joined(columns: Sequence[NDArray[np.float64]], size: float) -> Ints:
    row = np.concatenate(columns) if columns else np.zeros(0)
    return np.asarray(np.floor(row / size + 0.5), dtype=np.int64)


@dataclass(frozen=True, slots=True, kw_only=True)
class _Frames:
    """The frames of all jumps in a row: which are a jump's first and second, and the steps since the one before."""

    first: NDArray[np.bool_]
    second: NDArray[np.bool_]
    since: Ints
    step_s: float

    @classmethod
    def of(cls, steps: Sequence[Ints], step_s: float) -> "_Frames":
        place = np.concatenate([np.arange(len(one)) for one in steps]) if steps else np.zeros(0, dtype=np.int64)
        row = np.concatenate(steps) if steps else place
        return cls(first=place == 0, second=place == 1, since=np.diff(row, prepend=0), step_s=step_s)

    def last(self, counts: Ints) -> Ints:
        return np.where(self.first, 0, np.roll(counts, 1))

    def line(self, counts: Ints) -> Ints:
        last = self.last(counts)
        rise, before = np.roll(counts, 1) - np.roll(counts, 2), np.maximum(np.roll(self.since, 1), 1)
        ahead = (2 * rise * self.since + before) // (2 * before)
        return np.where(self.first | self.second | (self.since > _FAR * before), last, last + ahead)

    def integral(self, rate: Ints, factor: float) -> Ints:
        """Return the rounded rise of a column since the frame before; ``factor`` is rate count over own count."""
        both = 0.5 * (np.roll(rate, 1) + rate) * factor
        return np.where(self.first, 0, np.floor(both * (self.since * self.step_s) + 0.5).astype(np.int64))


def _shortest(counts: Ints, frame: _Frames, by: str | None, rise: Ints | None) -> tuple[str, int, Ints]:
    """Return predictor and Rice parameter that give the shortest text, and the codes."""
    guesses = {LAST: frame.last(counts), LINE: frame.line(counts)}
    if by is not None and rise is not None:
        guesses[by] = frame.last(counts) + rise
    found = []
    for predictor, guess in guesses.items():
        off = counts - guess  # 0, -1, 1, -2, 2 ... become 0, 1, 2, 3, 4 ...
        codes = np.where(off < 0, -2 * off - 1, 2 * off)
        found += [(int(_bits(codes, rice).sum()), predictor, rice, codes) for rice in range(_MOST_RICE + 1)]
    _, predictor, rice, codes = min(found, key=lambda entry: entry[0])
    return predictor, rice, codes


def _bits(codes: Ints, rice: int | Ints) -> Ints:
    ones = codes >> rice
    return np.where(ones < _LONG, ones + 1 + rice, _LONG + _LONG_BITS)


def _bytes(sizes: Ints, ends: Ints, codes: Sequence[Ints], rices: Sequence[int]) -> tuple[list[int], bytes]:
    """Return the length of each jump in bytes, and all jumps in a row: two ends each, then column after column."""
    n, width = len(sizes), len(codes)
    # The row of all numbers in the order of writing, sorted by jump, then column, then frame.
    owner = np.concatenate([np.repeat(np.arange(n), 2), *(np.repeat(np.arange(n), sizes) for _ in codes)])
    columns = [np.full(2 * n, -1), *(np.full(len(row), k) for k, row in enumerate(codes))]
    column = np.concatenate(columns, dtype=np.int64)
    number = np.concatenate([ends.ravel(), *codes])
    order = np.lexsort((column, owner))  # stable, so the frames keep their order
    owner, column, number = owner[order], column[order], number[order]
    head = column < 0
    rice = np.where(head, 0, np.array(rices, dtype=np.int64)[np.clip(column, 0, width - 1)])
    ones = np.where(head, 0, number >> rice)
    long = ~head & (ones >= _LONG)
    ones = np.where(long, _LONG, ones)
    tail = np.where(head, _HEAD_BITS, np.where(long, _LONG_BITS, rice))
    stop = np.where(head | long, 0, 1)  # the zero that ends the ones
    size = ones + stop + tail
    lengths = -(-np.bincount(owner, weights=size, minlength=n).astype(np.int64) // 8)
    first_bit = np.concatenate(([0], np.cumsum(8 * lengths)[:-1])) if n else np.zeros(0, dtype=np.int64)
    within = np.cumsum(size) - size
    start_of = np.searchsorted(owner, np.arange(n))
    start = first_bit[owner] + within - within[start_of][owner] if n else within
    bits = np.zeros(8 * int(lengths.sum()) + 1, dtype=np.int8)
    np.add.at(bits, start, (ones > 0).astype(np.int8))
    np.add.at(bits, start + ones, -(ones > 0).astype(np.int8))
    bits = np.cumsum(bits, dtype=np.int8)
    for place in range(int(tail.max(initial=0))):
        has = tail > place
        bits[(start + ones + stop + place)[has]] = (number >> np.maximum(tail - 1 - place, 0))[has] & 1
    return lengths.tolist(), np.packbits(bits[:-1].astype(np.uint8)).tobytes()


def unpacked(jumps: Jumps, key: int) -> dict[str, NDArray[np.float64]]:
    """Return ``time_s`` and the columns of one jump in stored units, each of shape (frames,)."""
    at = list(jumps.keys).index(key)
    start = sum(jumps.lengths[:at])
    data = base64.b64decode(jumps.data)[start : start + jumps.lengths[at]]
    bits = np.unpackbits(np.frombuffer(data, dtype=np.uint8)).tolist()
    place = 0

    def number(count: int) -> int:
        nonlocal place
        place += count
        return int("".join(map(str, bits[place - count : place])) or "0", 2)

    lift_off, last = number(_HEAD_BITS), number(_HEAD_BITS)
    steps = frame_steps(lift_off, last, jumps.frames)
    result = {"time_s": steps.astype(np.float64) * jumps.step_s}
    counts: dict[str, list[int]] = {}
    for column in jumps.columns:
        values: list[int] = []
        for i in range(len(steps)):
            ones = 0
            while ones < _LONG and bits[place]:
                ones += 1
                place += 1
            if ones < _LONG:
                place += 1
            code = number(_LONG_BITS) if ones == _LONG else (ones << column.rice) | number(column.rice)
            off = -((code + 1) // 2) if code & 1 else code // 2
            values.append(off + _guess(column, counts, values, steps.tolist(), i, jumps.step_s))
        counts[column.name] = values
    sizes = {column.name: column.count for column in jumps.columns}
    return result | {name: np.array(values, dtype=np.float64) * sizes[name] for name, values in counts.items()}


def _guess(
    column: JumpColumn,
    counts: Mapping[str, Sequence[int]],
    values: Sequence[int],
    steps: Sequence[int],
    i: int,
    step_s: float,
) -> int:
    """Return the predicted count of frame ``i``, with steps of ``s`` seconds."""
    if i == 0:
        return 0
    since = steps[i] - steps[i - 1]
    if column.predictor == LAST or (column.predictor == LINE and i == 1):
        return values[-1]
    if column.predictor == LINE:
        before = steps[i - 1] - steps[i - 2]
        if since > _FAR * before:
            return values[-1]
        return values[-1] + (2 * (values[-1] - values[-2]) * since + before) // (2 * before)
    rate = counts[column.predictor]
    both = 0.5 * (rate[i - 1] + rate[i]) * (COUNTS[column.predictor] / column.count)
    return values[-1] + int(np.floor(both * (since * step_s) + 0.5))


def lift_off_s(jumps: Jumps, key: int) -> float:
    """Return the time of the last contact in one jump."""
    at = list(jumps.keys).index(key)
    start = sum(jumps.lengths[:at])
    high, low = base64.b64decode(jumps.data)[start : start + 2]
    return (256 * high + low) * jumps.step_s


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
