"""Needle roller bearings as bought: catalogue with ratings."""

import csv
from dataclasses import dataclass
from functools import lru_cache
from importlib import resources

from pareto_monoped.actuator.needles import NeedleRows
from pareto_monoped.errors import InputError, complaint, unknown_name


@dataclass(frozen=True, slots=True, kw_only=True)
class RollerBearing:
    """One bearing of rollers with its load ratings.

    Attributes:
        designation: of the maker.
        inner_diameter_mm, outer_diameter_mm, width_mm: over the rollers inside, over everything outside, over all.
        mass_kg: of it.
        dynamic_rating_n, static_rating_n: C and C0.
    """

    designation: str
    inner_diameter_mm: float
    outer_diameter_mm: float
    width_mm: float
    mass_kg: float
    dynamic_rating_n: float
    static_rating_n: float

    def __post_init__(self) -> None:
        """Refuse impossible dimensions or ratings.

        Raises:
            InputError: an inner diameter is not below the outer one, or a number is not positive.
        """
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
    """The bearings of a table in CSV with ``#`` comments, by designation.

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
    """The shipped catalogue by designation."""
    text = (resources.files("pareto_monoped") / "data" / "needle_bearings.csv").read_text(encoding="utf-8")
    return read_roller_bearings(text)


def roller_bearing(designation: str) -> RollerBearing:
    """A bearing of the catalogue.

    Raises:
        InputError: it is not in the catalogue.
    """
    found = roller_bearings().get(designation)
    if found is None:
        raise InputError(unknown_name("needle bearing", designation, roller_bearings()))
    return found


def as_bearing(rows: NeedleRows, *, pin_mm: float, bore_mm: float, mass_kg: float) -> RollerBearing:
    """The needles of one planet as one bearing, for plain numbers."""
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
