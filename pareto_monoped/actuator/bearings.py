"""Ball bearings: the catalogue, the choice of the main bearing, and the paper's regression of mass over bore."""

import csv
from dataclasses import dataclass
from functools import lru_cache
from importlib import resources
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.geometry.shapes import Numbers


@dataclass(frozen=True, slots=True, kw_only=True)
class Bearing:
    """One bearing, or an array of them."""

    inner_diameter_mm: Numbers
    outer_diameter_mm: Numbers
    width_mm: Numbers
    mass_kg: Numbers


@lru_cache(maxsize=1)
def catalogue() -> NDArray[np.float64]:
    """The shipped catalogue, shape (k, 4): bore, outer diameter, width in mm, mass in kg; bores increase."""
    text = (resources.files("pareto_monoped") / "data" / "bearings.csv").read_text(encoding="utf-8")
    lines = [line for line in text.splitlines() if not line.startswith("#")]
    table = np.array([[float(value) for value in row] for row in list(csv.reader(lines))[1:]])
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


def main_bearing(bore_mm: Numbers, model: Literal["catalogue", "regression"] = "catalogue") -> Bearing:
    """The lightest catalogue bearing with at least this bore; NaN beyond the catalogue.

    Args:
        bore_mm: least bore, float or shape (n,).
        model: ``regression`` keeps the bearing's dimensions and takes its mass from the quadratic fit (the paper's
            "regression-based function ... using the bearing's internal diameter").
    """
    table = catalogue()
    bores = table[:, 0]
    # For each catalogue index, the lightest bearing from there on. Of equals, argmin takes the first, the smallest.
    lightest = np.array([start + int(np.argmin(table[start:, 3])) for start in range(len(table))] + [0])
    start = np.searchsorted(bores, np.asarray(bore_mm) - 1e-9, side="left")
    row = np.where((start < len(table))[..., None], table[lightest[start]], np.nan)
    inner, outer, width, mass = (row[..., column] for column in range(4))
    if model == "regression":
        mass = np.polyval(_regression(), inner)
    return Bearing(inner_diameter_mm=inner, outer_diameter_mm=outer, width_mm=width, mass_kg=mass)
