"""Ball bearings: catalogue with ratings, choice of the main bearing, the paper's regression of mass over bore."""

import csv
from dataclasses import dataclass
from functools import lru_cache
from importlib import resources
from itertools import pairwise
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.errors import InputError, complaint
from pareto_monoped.geometry.shapes import Numbers


@dataclass(frozen=True, slots=True, kw_only=True)
class Bearing:
    """One bearing, or an array of them."""

    inner_diameter_mm: Numbers
    outer_diameter_mm: Numbers
    width_mm: Numbers
    mass_kg: Numbers


@dataclass(frozen=True, slots=True, kw_only=True)
class RatedBearing:
    """One deep groove ball bearing of the catalogue with its load ratings.

    Attributes:
        designation: of the maker.
        inner_diameter_mm, outer_diameter_mm, width_mm, mass_kg: as of ``Bearing``.
        dynamic_rating_n, static_rating_n: C and C0.
        balls, ball_diameter_mm: of its row.
    """

    designation: str
    inner_diameter_mm: float
    outer_diameter_mm: float
    width_mm: float
    mass_kg: float
    dynamic_rating_n: float
    static_rating_n: float
    balls: int
    ball_diameter_mm: float

    def __post_init__(self) -> None:
        """Refuse ratings that do not belong to these balls.

        C follows from the balls by ISO 281. C0 is f0 Z Dw^2 by ISO 76, with f0 within the range of its table.

        Raises:
            InputError: a dimension or a rating is impossible.
        """
        quantity, room = f"bearing {self.designation}: ", 0.5 * (self.outer_diameter_mm - self.inner_diameter_mm)
        cure = "correct data/bearings.csv"
        if not 0.0 < self.ball_diameter_mm < room:
            raise InputError(
                complaint(quantity + "ball_diameter_mm", self.ball_diameter_mm, f"between 0 and {room:g}", cure)
            )
        around = int(np.pi / np.arcsin(self.ball_diameter_mm / self.pitch_diameter_mm))
        if not 5 <= self.balls <= around:
            raise InputError(complaint(quantity + "balls", self.balls, f"5 to {around}", cure))
        dynamic = iso_281_rating_n(self.balls, self.ball_diameter_mm, self.pitch_diameter_mm)
        if not abs(self.dynamic_rating_n / dynamic - 1.0) <= _RATING_TOLERANCE:
            raise InputError(
                complaint(
                    quantity + "dynamic_rating_n",
                    self.dynamic_rating_n,
                    f"within {100.0 * _RATING_TOLERANCE:g} percent of {dynamic:.0f} (ISO 281)",
                    cure,
                )
            )
        low, high = (factor * self.balls * self.ball_diameter_mm**2 for factor in _STATIC_FACTORS)
        if not low <= self.static_rating_n <= high:
            raise InputError(
                complaint(quantity + "static_rating_n", self.static_rating_n, f"{low:.0f} to {high:.0f} (ISO 76)", cure)
            )

    @property
    def pitch_diameter_mm(self) -> float:
        """Diameter of the circle through the balls' centres."""
        return 0.5 * (self.inner_diameter_mm + self.outer_diameter_mm)


_RATING_TOLERANCE = 0.03
"""Catalogues round C, and the balls' diameters here are customary ones: 1.5 percent at most in the shipped table."""
_STATIC_FACTORS = (11.0, 18.0)
"""Range of f0: 12.4 to 17.4 in the makers' tables for the bearings here."""


def iso_281_rating_n(balls: int, ball_diameter_mm: float, pitch_diameter_mm: float) -> float:
    """Dynamic rating C of a single row of balls up to 25.4 mm in deep grooves of 0.52 ball diameters.

    C = b_m f_c Z^(2/3) Dw^1.8 with b_m = 1.3 (ISO 281, clause 5.1). f_c is that of the formula behind the standard's
    table (ISO/TR 1281-1; Harris, Rolling Bearing Analysis, ch. 11), which it meets to 1 percent.
    """
    gamma = ball_diameter_mm / pitch_diameter_mm
    rings = (1.04 * ((1.0 - gamma) / (1.0 + gamma)) ** 1.72) ** (10.0 / 3.0)
    groove = (2.0 * 0.52 / (2.0 * 0.52 - 1.0)) ** 0.41
    factor = 37.91 * (1.0 + rings) ** -0.3 * gamma**0.3 * (1.0 - gamma) ** 1.39 / (1.0 + gamma) ** (1.0 / 3.0) * groove
    return float(1.3 * factor * balls ** (2.0 / 3.0) * ball_diameter_mm**1.8)


def read_bearings(text: str) -> tuple[RatedBearing, ...]:
    """The bearings of a table in CSV with ``#`` comments.

    Raises:
        InputError: a rating does not belong to its bearing, or the bores do not increase.
    """
    lines = [line for line in text.splitlines() if not line.startswith("#")]
    rows = tuple(
        RatedBearing(
            designation=row["designation"],
            balls=int(row["balls"]),
            **{
                name: float(row[name])
                for name in (*_DIMENSIONS, "dynamic_rating_n", "static_rating_n", "ball_diameter_mm")
            },
        )
        for row in csv.DictReader(lines)
    )
    for before, after in pairwise(rows):
        if after.inner_diameter_mm <= before.inner_diameter_mm:
            raise InputError(
                complaint(
                    f"bearing {after.designation}: inner_diameter_mm",
                    after.inner_diameter_mm,
                    f"more than the {before.inner_diameter_mm:g} above it",
                    "sort data/bearings.csv",
                )
            )
    return rows


_DIMENSIONS = ("inner_diameter_mm", "outer_diameter_mm", "width_mm", "mass_kg")


@lru_cache(maxsize=1)
def rated_bearings() -> tuple[RatedBearing, ...]:
    """The shipped catalogue; bores increase."""
    return read_bearings((resources.files("pareto_monoped") / "data" / "bearings.csv").read_text(encoding="utf-8"))


def rated_bearing(inner_diameter_mm: float) -> RatedBearing:
    """The catalogue's bearing with exactly this bore, with its ratings."""
    (found,) = (bearing for bearing in rated_bearings() if bearing.inner_diameter_mm == inner_diameter_mm)
    return found


@lru_cache(maxsize=1)
def catalogue() -> NDArray[np.float64]:
    """The shipped catalogue, shape (k, 4): bore, outer diameter, width in mm, mass in kg; bores increase."""
    table = np.array([[getattr(bearing, name) for name in _DIMENSIONS] for bearing in rated_bearings()])
    table.flags.writeable = False
    return table


def small_bearing(inner_diameter_mm: float) -> Bearing:
    """The catalogue's bearing with exactly this bore."""
    (row,) = (row for row in catalogue() if row[0] == inner_diameter_mm)
    return Bearing(
        inner_diameter_mm=float(row[0]),
        outer_diameter_mm=float(row[1]),
        width_mm=float(row[2]),
        mass_kg=float(row[3]),
    )


@lru_cache(maxsize=1)
def _regression() -> NDArray[np.float64]:
    """Least-squares quadratic of catalogue mass over bore, of bores from 10 mm (the authors' table)."""
    table = catalogue()[catalogue()[:, 0] >= 10.0]
    return np.polyfit(table[:, 0], table[:, 3], 2)


@lru_cache(maxsize=1)
def _lightest_from() -> NDArray[np.intp]:
    """For each row of the catalogue, that of the lightest bearing from there on; 0 beyond the last."""
    mass = catalogue()[:, 3]
    # Of equals, argmin takes the first, the smallest.
    return np.array([start + int(np.argmin(mass[start:])) for start in range(len(mass))] + [0], dtype=np.intp)


def main_bearing(bore_mm: Numbers, model: Literal["catalogue", "regression"] = "catalogue") -> Bearing:
    """The lightest catalogue bearing with at least this bore; NaN beyond the catalogue.

    Args:
        bore_mm: least bore, float or shape (n,).
        model: ``regression`` keeps the bearing's dimensions and takes its mass from the quadratic fit (the paper's
            "regression-based function ... using the bearing's internal diameter").
    """
    table = catalogue()
    start = np.searchsorted(table[:, 0], np.asarray(bore_mm) - 1e-9, side="left")
    row = np.where((start < len(table))[..., None], table[_lightest_from()[start]], np.nan)
    inner, outer, width, mass = (row[..., column] for column in range(4))
    if model == "regression":
        mass = np.polyval(_regression(), inner)
    return Bearing(inner_diameter_mm=inner, outer_diameter_mm=outer, width_mm=width, mass_kg=mass)
