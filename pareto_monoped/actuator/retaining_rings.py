"""Retaining rings of shafts and bores: catalogue after DIN 471 and DIN 472, with the grooves that they need.

Rings with inverted lugs (makers' V-rings) fit the same grooves. They are used here, because thin-section bearings leave
no room for the others: the eyes of DIN 471 - 40 x 1.75 reach to 24.75 mm and those of DIN 472 - 52 x 2 to 20.8 mm, but
the shoulder of the outer ring begins at 24.5 mm and that of the inner ring ends at 21 mm.
"""

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

Standard = Literal["DIN 471", "DIN 472"]


@dataclass(frozen=True, slots=True, kw_only=True)
class RetainingRing:
    """One retaining ring in its groove, or an array of them.

    Attributes:
        standard: ``DIN 471`` for shafts, ``DIN 472`` for bores.
        size_mm: d1, diameter of shaft or bore.
        thickness_mm: s.
        radial_width_mm: b, opposite the gap.
        groove_diameter_mm: d2.
        groove_zone: tolerance class of d2 (ISO 286); '' for arrays.
        groove_width_mm: m, with the tolerance H13.
        mass_kg: of the ring, which is narrower towards its ends.
    """

    standard: Standard
    size_mm: Numbers
    thickness_mm: Numbers
    radial_width_mm: Numbers
    groove_diameter_mm: Numbers
    groove_zone: str
    groove_width_mm: Numbers
    mass_kg: Numbers

    @property
    def r_groove(self) -> Numbers:
        """Radius of the groove's bottom, in mm, on which the ring sits."""
        return 0.5 * self.groove_diameter_mm

    @property
    def r_free(self) -> Numbers:
        """Radius of the ring's other edge, in mm, opposite the gap."""
        return self.r_groove + (self.radial_width_mm if self.standard == "DIN 471" else -self.radial_width_mm)

    @property
    def play_mm(self) -> Numbers:
        """How much wider the groove is than the ring."""
        return self.groove_width_mm - self.thickness_mm

    @property
    def name(self) -> str:
        """As it is ordered, such as ``V-ring (DIN 471, inverted lugs) 40 x 1.75``; '' for arrays."""
        if np.ndim(self.size_mm):
            return ""
        return f"V-ring ({self.standard}, inverted lugs) {self.size_mm:g} x {self.thickness_mm:g}"

    @property
    def groove_note(self) -> str:
        """What a drawing must say of the groove besides its diameter; '' for arrays."""
        return "" if np.ndim(self.size_mm) else f"groove of the retaining ring {self.groove_width_mm:g} H13 wide"


_NUMBERS = ("size_mm", "thickness_mm", "radial_width_mm", "groove_diameter_mm", "groove_width_mm", "mass_kg")


def read_retaining_rings(text: str) -> dict[str, tuple[NDArray[np.float64], tuple[str, ...]]]:
    """The rings of a table in CSV with ``#`` comments: by standard, numbers of shape (n, 6) and zones of the grooves.

    Raises:
        InputError: a ring does not fit its groove, or the sizes do not increase.
    """
    rows = list(csv.DictReader(line for line in text.splitlines() if not line.startswith("#")))
    found = {}
    for standard, outwards in (("DIN 471", -1.0), ("DIN 472", 1.0)):
        own = [row for row in rows if row["standard"] == standard]
        table = np.array([[float(row[name]) for name in _NUMBERS] for row in own])
        for size, thickness, width, groove, room, _ in table.tolist():
            ring = f"retaining ring {standard} - {size:g}: "
            if not 0.0 < outwards * (groove - size) < 2.0 * width:
                _refuse(ring + "groove_diameter_mm", groove, f"{size:g} {outwards * 2.0 * width:+g} at most")
            if not 0.0 < thickness < room:
                _refuse(ring + "groove_width_mm", room, f"more than the ring's {thickness:g}")
        for before, after in pairwise(table[:, 0].tolist()):
            if after <= before:
                _refuse(f"retaining ring {standard} - {after:g}: size_mm", after, f"more than the {before:g} above it")
        table.flags.writeable = False
        found[standard] = table, tuple(row["groove_zone"] for row in own)
    return found


def _refuse(quantity: str, value: float, allowed: str) -> None:
    raise InputError(complaint(quantity, value, allowed, "correct data/retaining_rings.csv"))


@lru_cache(maxsize=1)
def _catalogue() -> dict[str, tuple[NDArray[np.float64], tuple[str, ...]]]:
    """The shipped catalogue."""
    path = resources.files("pareto_monoped") / "data" / "retaining_rings.csv"
    return read_retaining_rings(path.read_text(encoding="utf-8"))


def retaining_ring(standard: Standard, size_mm: Numbers) -> RetainingRing:
    """The ring of a shaft (DIN 471) or of a bore (DIN 472); NaN where the catalogue has none.

    Args:
        standard: which one.
        size_mm: diameter of shaft or bore, float or shape (n,).
    """
    table, zones = _catalogue()[standard]
    place = np.minimum(np.searchsorted(table[:, 0], np.asarray(size_mm) - 1e-9), len(table) - 1)
    row = np.where((np.abs(table[place, 0] - size_mm) < 1e-6)[..., None], table[place], np.nan)
    values = dict(zip(_NUMBERS, (row[..., column][()] for column in range(len(_NUMBERS))), strict=True))
    return RetainingRing(standard=standard, groove_zone="" if np.ndim(place) else zones[int(place)], **values)
