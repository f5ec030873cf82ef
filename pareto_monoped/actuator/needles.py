"""Rows of loose needle rollers between a planet and its pin: how many, how long, and their ratings.

Full complements have no catalogue rating. It follows from the needles by ISO 281 and ISO 76, as makers tell their
customers to do. Pin and planet are the raceways; planets softer than 58 HRC carry less, by f_H.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from pareto_monoped.actuator.settings import ActuatorSettings
from pareto_monoped.geometry.shapes import Numbers

_ROWS_MOST = 2
_DYNAMIC = 1.1 * 0.83 * 207.9
"""b_m of needle rollers on machined raceways, reduction of line contact, constant of f_c (ISO 281, ISO/TR 1281-1)."""
_STATIC = 44.0
"""ISO 76, clause 5.1, in N and mm."""
_RACEWAY_FACTORS = (
    (200.0, 300.0, 350.0, 400.0, 450.0, 500.0, 550.0, 600.0, 655.0),
    (0.07, 0.18, 0.25, 0.33, 0.42, 0.52, 0.65, 0.78, 1.0),
)
"""Vickers hardness of a raceway and f_H, rounded from the curve in Schaeffler, Rolling bearings; static ratings fall
less, and take the same factor here."""
LIFE_EXPONENT = 10.0 / 3.0
"""Of roller bearings (ISO 281, clause 7.3)."""


@dataclass(frozen=True, slots=True, kw_only=True)
class NeedleRows:
    """The needles of one planet, or of arrays of them; NaN where not even the shortest fits.

    Attributes:
        needles: in one row.
        rows: 1 or 2.
        length_mm: of a needle.
        dynamic_rating_n, static_rating_n: C and C0 of all rows of a planet together.
    """

    needles: int
    rows: Numbers
    length_mm: Numbers
    dynamic_rating_n: Numbers
    static_rating_n: Numbers

    @property
    def total_mm(self) -> Numbers:
        """Length of all rows."""
        return self.rows * self.length_mm


def choices_mm(settings: ActuatorSettings) -> tuple[float, ...]:
    """Lengths that the rows of a planet can have together, from the shortest to the longest."""
    return tuple(total for total, _, _ in _choices(settings.parts.needles.lengths_mm))


@lru_cache(maxsize=8)
def _choices(lengths_mm: tuple[float, ...]) -> tuple[tuple[float, int, float], ...]:
    """Total length, rows and length of a needle of every choice, increasing."""
    return tuple(sorted((rows * length, rows, length) for rows in range(1, _ROWS_MOST + 1) for length in lengths_mm))


def needle_rows(width_mm: Numbers, settings: ActuatorSettings) -> NeedleRows:
    """The rows that fill a planet's bore best, float or shape (n,)."""
    data = settings.parts.needles
    choices = np.array(_choices(data.lengths_mm))
    # Where one long row or two short ones fill the bore alike, the last one stands: two rows tilt less.
    index = np.searchsorted(choices[:, 0], np.asarray(width_mm) + 1e-9, side="right") - 1
    rows, length = (np.where(index >= 0, choices[index, column], np.nan)[()] for column in (1, 2))
    pin, needle = settings.parts.carrier.pin_diameter_mm, data.diameter_mm
    count = needle_count(pin, needle)
    softer = raceway_factor(settings.gear_steels.planet.hardness_hv)
    carries = rows * (length - 2.0 * data.end_mm)
    return NeedleRows(
        needles=count,
        rows=rows,
        length_mm=length,
        dynamic_rating_n=dynamic_rating_n(count, needle, carries, pin + needle) * softer,
        static_rating_n=static_rating_n(count, needle, carries, pin + needle) * softer,
    )


def raceway_factor(hardness_hv: float) -> float:
    """f_H by which raceways softer than 670 HV carry less; SKF and ISO 281 take 58 HRC, 655 HV, as hard enough."""
    return float(np.interp(hardness_hv, *_RACEWAY_FACTORS))


def needle_count(pin_mm: float, needle_mm: float) -> int:
    """How many needles fit around a pin."""
    return int(np.pi / np.arcsin(needle_mm / (pin_mm + needle_mm)))


def dynamic_rating_n(count: int, needle_mm: float, length_mm: Numbers, pitch_mm: float) -> Numbers:
    """C = b_m f_c (i L)^(7/9) Z^(3/4) D^(29/27) (ISO 281, clause 7.1).

    f_c is that of the formula behind the standard's table, which has 88.7 at most.

    Args:
        count: Z, needles of a row.
        needle_mm: D.
        length_mm: i L, what carries, of all rows.
        pitch_mm: diameter of the circle through the needles' axes.
    """
    gamma = needle_mm / pitch_mm
    rings = (1.04 * ((1.0 - gamma) / (1.0 + gamma)) ** (143.0 / 108.0)) ** 4.5
    shape = gamma ** (2.0 / 9.0) * (1.0 - gamma) ** (29.0 / 27.0) / (1.0 + gamma) ** 0.25
    factor = shape * (1.0 + rings) ** (-2.0 / 9.0)
    rating_n: Numbers = _DYNAMIC * factor * length_mm ** (7.0 / 9.0) * count**0.75 * needle_mm ** (29.0 / 27.0)
    return rating_n


def static_rating_n(count: int, needle_mm: float, length_mm: Numbers, pitch_mm: float) -> Numbers:
    """C0 = 44 (1 - D / D_pw) i Z L D (ISO 76, clause 5.1); arguments as of ``dynamic_rating_n``."""
    return _STATIC * (1.0 - needle_mm / pitch_mm) * count * length_mm * needle_mm
