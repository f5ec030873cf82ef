"""Needle rollers: rows of loose ones between a planet and its pin, and bearings as bought.

Full complements have no catalogue rating. It follows from the needles by ISO 281 and ISO 76, as makers tell their
customers to do. Pin and planet are the raceways; planets softer than 58 HRC carry less, by f_H.
"""

import csv
from dataclasses import dataclass
from functools import lru_cache
from importlib import resources

import numpy as np

from pareto_monoped.actuator.settings import ActuatorSettings
from pareto_monoped.errors import InputError, complaint, unknown_name
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
    """The needles of one planet, or of arrays of them; NaN where not even the shortest fits."""

    needles: int  #: in one row
    rows: Numbers  #: 1 or 2
    length_mm: Numbers  #: of a needle
    dynamic_rating_n: Numbers  #: C of all rows of a planet together
    static_rating_n: Numbers  #: C0, likewise

    @property
    def total_mm(self) -> Numbers:
        """Length of all rows."""
        return self.rows * self.length_mm


def choices_mm(settings: ActuatorSettings) -> tuple[float, ...]:
    """Return the lengths that the rows of a planet can have together, from the shortest to the longest."""
    return tuple(total for total, _, _ in _choices(settings.parts.needles.lengths_mm))


@lru_cache(maxsize=8)
def _choices(lengths_mm: tuple[float, ...]) -> tuple[tuple[float, int, float], ...]:
    """Return the total length, rows and length of a needle of every choice, increasing."""
    return tuple(sorted((rows * length, rows, length) for rows in range(1, _ROWS_MOST + 1) for length in lengths_mm))


def needle_rows(width_mm: Numbers, settings: ActuatorSettings) -> NeedleRows:
    """Return the rows that fill a planet's bore best, float or shape (n,)."""
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
    """Return f_H by which raceways softer than 670 HV carry less; SKF and ISO 281 are content with 58 HRC, 655 HV."""
    return float(np.interp(hardness_hv, *_RACEWAY_FACTORS))


def needle_count(pin_mm: float, needle_mm: float) -> int:
    """Return how many needles fit around a pin."""
    return int(np.pi / np.arcsin(needle_mm / (pin_mm + needle_mm)))


def dynamic_rating_n(count: int, needle_mm: float, length_mm: Numbers, pitch_mm: float) -> Numbers:
    """Return C = b_m f_c (i L)^(7/9) Z^(3/4) D^(29/27) of Z needles of diameter D in each of i rows (ISO 281, clause
    7.1).

    f_c is that of the formula behind the standard's table, which has 88.7 at most.
    """
    gamma = needle_mm / pitch_mm
    rings = (1.04 * ((1.0 - gamma) / (1.0 + gamma)) ** (143.0 / 108.0)) ** 4.5
    shape = gamma ** (2.0 / 9.0) * (1.0 - gamma) ** (29.0 / 27.0) / (1.0 + gamma) ** 0.25
    factor = shape * (1.0 + rings) ** (-2.0 / 9.0)
    rating_n: Numbers = _DYNAMIC * factor * length_mm ** (7.0 / 9.0) * count**0.75 * needle_mm ** (29.0 / 27.0)
    return rating_n


def static_rating_n(count: int, needle_mm: float, length_mm: Numbers, pitch_mm: float) -> Numbers:
    """Return C0 = 44 (1 - D / D_pw) i Z L D (ISO 76, clause 5.1); arguments as of ``dynamic_rating_n``."""
    return _STATIC * (1.0 - needle_mm / pitch_mm) * count * length_mm * needle_mm


@dataclass(frozen=True, slots=True, kw_only=True)
class RollerBearing:
    """One bearing of rollers with its load ratings."""

    designation: str  #: of the maker
    inner_diameter_mm: float  #: over the rollers inside
    outer_diameter_mm: float  #: over everything outside
    width_mm: float  #: over all
    mass_kg: float  #: of it
    dynamic_rating_n: float  #: C
    static_rating_n: float  #: C0

    def __post_init__(self) -> None:
        """Refuse an inner diameter that is not below the outer one, and numbers that are not positive."""
        cure = "correct data/needle_bearings.csv"
        if not 0.0 < self.inner_diameter_mm < self.outer_diameter_mm:
            quantity = f"bearing {self.designation}: inner_diameter_mm"
            allowed = f"between 0 and {self.outer_diameter_mm:g}"
            raise InputError(complaint(quantity, self.inner_diameter_mm, allowed, cure))
        for name in ("width_mm", "mass_kg", "dynamic_rating_n", "static_rating_n"):
            if not getattr(self, name) > 0.0:
                raise InputError(
                    complaint(f"bearing {self.designation}: {name}", getattr(self, name), "more than 0", cure)
                )


def read_roller_bearings(text: str) -> dict[str, RollerBearing]:
    """Return the bearings of a table in CSV with ``#`` comments, by designation.

    Raises:
        InputError: see ``RollerBearing``.
    """
    lines = [line for line in text.splitlines() if not line.startswith("#")]
    numbers = ("inner_diameter_mm", "outer_diameter_mm", "width_mm", "mass_kg", "dynamic_rating_n", "static_rating_n")
    rows = [
        RollerBearing(designation=row["designation"], **{name: float(row[name]) for name in numbers})
        for row in csv.DictReader(lines)
    ]
    return {row.designation: row for row in rows}


@lru_cache(maxsize=1)
def roller_bearings() -> dict[str, RollerBearing]:
    """Return the shipped catalogue by designation."""
    text = (resources.files("pareto_monoped") / "data" / "needle_bearings.csv").read_text(encoding="utf-8")
    return read_roller_bearings(text)


def roller_bearing(designation: str) -> RollerBearing:
    """Return a bearing of the catalogue.

    Raises:
        InputError: it is not in the catalogue.
    """
    found = roller_bearings().get(designation)
    if found is None:
        raise InputError(unknown_name("needle bearing", designation, roller_bearings()))
    return found


def as_bearing(rows: NeedleRows, *, pin_mm: float, bore_mm: float, mass_kg: float) -> RollerBearing:
    """Return the needles of one planet as one bearing, for plain numbers."""
    across = 0.5 * (bore_mm - pin_mm)
    count = f"{int(rows.rows)} x {rows.needles}" if rows.rows > 1 else f"{rows.needles}"
    return RollerBearing(
        designation=f"{count} needles {across:g}x{float(rows.length_mm):g}",
        inner_diameter_mm=pin_mm,
        outer_diameter_mm=bore_mm,
        width_mm=float(rows.total_mm),
        mass_kg=mass_kg,
        dynamic_rating_n=float(rows.dynamic_rating_n),
        static_rating_n=float(rows.static_rating_n),
    )
