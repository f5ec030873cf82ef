"""Ball bearings and retaining rings (DIN 471, DIN 472): catalogues, choice of the main bearing, mass over bore.

Rings with inverted lugs (makers' V-rings) fit the grooves of the standards. They are used here, because thin-section
bearings leave no room for the others: the eyes of DIN 471 - 40 x 1.75 reach to 24.75 mm and those of DIN 472 - 52 x 2
to 20.8 mm, but the shoulder of the outer ring begins at 24.5 mm and that of the inner ring ends at 21 mm.
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
from pareto_monoped.geometry.making import Length, limits
from pareto_monoped.geometry.roles import Purchase
from pareto_monoped.geometry.shapes import Floats, Numbers


@dataclass(frozen=True, slots=True, kw_only=True)
class Bearing:
    """One bearing, or an array of them."""

    inner_diameter_mm: Numbers
    outer_diameter_mm: Numbers
    width_mm: Numbers
    mass_kg: Numbers


@dataclass(frozen=True, slots=True, kw_only=True)
class RatedBearing:
    """One deep groove ball bearing of the catalogue with its load ratings."""

    designation: str  #: of the maker
    inner_diameter_mm: float
    outer_diameter_mm: float
    width_mm: float
    mass_kg: float
    dynamic_rating_n: float  #: C
    static_rating_n: float  #: C0
    balls: int  #: in its row
    ball_diameter_mm: float

    def __post_init__(self) -> None:
        """Refuse ratings that do not belong to these balls.

        C follows from the balls by ISO 281. C0 is f0 Z Dw^2 by ISO 76, with f0 within the range of its table.
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
    """Return the dynamic rating C of a single row of balls up to 25.4 mm in deep grooves of 0.52 ball diameters.

    C = b_m f_c Z^(2/3) Dw^1.8 with b_m = 1.3 (ISO 281, clause 5.1). f_c is that of the formula behind the standard's
    table (ISO/TR 1281-1; Harris, Rolling Bearing Analysis, ch. 11), which it meets to 1 percent.
    """
    gamma = ball_diameter_mm / pitch_diameter_mm
    rings = (1.04 * ((1.0 - gamma) / (1.0 + gamma)) ** 1.72) ** (10.0 / 3.0)
    groove = (2.0 * 0.52 / (2.0 * 0.52 - 1.0)) ** 0.41
    factor = 37.91 * (1.0 + rings) ** -0.3 * gamma**0.3 * (1.0 - gamma) ** 1.39 / (1.0 + gamma) ** (1.0 / 3.0) * groove
    return float(1.3 * factor * balls ** (2.0 / 3.0) * ball_diameter_mm**1.8)


def read_bearings(text: str) -> tuple[RatedBearing, ...]:
    """Return the bearings of a table in CSV with ``#`` comments.

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
    """Return the shipped catalogue; bores increase."""
    return read_bearings((resources.files("pareto_monoped") / "data" / "bearings.csv").read_text(encoding="utf-8"))


def rated_bearing(inner_diameter_mm: float) -> RatedBearing:
    """Return the catalogue's bearing with exactly this bore, with its ratings."""
    (found,) = (bearing for bearing in rated_bearings() if bearing.inner_diameter_mm == inner_diameter_mm)
    return found


_SKF = {
    "6800": "61800-2RZ", "6801": "61801-2RZ", "6802": "61802-2RZ", "6803": "61803-2RZ", "6804": "61804-2RZ",
    "6805": "61805-2RZ", "6806": "61806-2RZ", "6807": "61807-2RZ", "6808": "61808-2RZ", "6809": "61809-2RZ",
    "6810": "61810-2RZ", "6811": "61811-2RZ", "6812": "61812-2RZ", "6813": "61813-2RZ", "6814": "61814-2RZ",
    "6815": "61815-2RZ", "6816": "61816-2RZ", "6817": "61817-2RZ", "6818": "61818-2RZ", "6819": "61819-2RZ",
    "6820": "61820-2RZ",
}  # fmt: skip
"""SKF's bearings of the same size by the catalogue's designation."""
_EXTRA_SMALL_MM = 10.0
"""Below this bore the maker has clearances of its own: MC5, 13 to 20 um, lies within the 8 to 23 um of C3."""


def ordered_bearing(bore_mm: Numbers) -> tuple[Purchase, ...]:
    """Return the order of the catalogue's bearing with this bore: sealed, greased for life, of group C3; () for arrays.

    The seals do not rub. Suffixes after the catalogues of NSK (VV), NTN (LLB) and SKF (2RZ).
    """
    if np.ndim(bore_mm):
        return ()
    bearing, bore = rated_bearing(float(bore_mm)), float(bore_mm)
    name = bearing.designation
    size = f"{bore:g} x {bearing.outer_diameter_mm:g} x {bearing.width_mm:g} mm"
    small, others = bore < _EXTRA_SMALL_MM, [f"NTN {name}LLB/{CLEARANCE_GROUP}"]
    if name in _SKF:
        others.append(f"SKF {_SKF[name]}/{CLEARANCE_GROUP}")
    return (
        Purchase(
            kind="bearing",
            designation=f"NSK {name}VV{'MC5' if small else CLEARANCE_GROUP}, {size}",
            standard="ISO 15",
            alternatives=tuple(others),
        ),
    )


@lru_cache(maxsize=1)
def catalogue() -> Floats:
    """Return the shipped catalogue, shape (k, 4): bore, outer diameter, width in mm, mass in kg; bores increase."""
    table = np.array([[getattr(bearing, name) for name in _DIMENSIONS] for bearing in rated_bearings()])
    table.flags.writeable = False
    return table


def small_bearing(inner_diameter_mm: float) -> Bearing:
    """Return the catalogue's bearing with exactly this bore."""
    (row,) = (row for row in catalogue() if row[0] == inner_diameter_mm)
    return Bearing(
        inner_diameter_mm=float(row[0]), outer_diameter_mm=float(row[1]), width_mm=float(row[2]), mass_kg=float(row[3])
    )


@lru_cache(maxsize=1)
def _regression() -> Floats:
    """Return the least-squares quadratic of catalogue mass over bore, of bores from 10 mm (the authors' table)."""
    table = catalogue()[catalogue()[:, 0] >= 10.0]
    return np.polyfit(table[:, 0], table[:, 3], 2)


@lru_cache(maxsize=1)
def _lightest_from() -> NDArray[np.intp]:
    """Return for each row of the catalogue that of the lightest bearing from there on; 0 beyond the last."""
    mass = catalogue()[:, 3]
    # Of equals, argmin takes the first, the smallest.
    return np.array([start + int(np.argmin(mass[start:])) for start in range(len(mass))] + [0], dtype=np.intp)


def main_bearing(bore_mm: Numbers, model: Literal["catalogue", "regression"] = "catalogue") -> Bearing:
    """Return the lightest catalogue bearing with at least this bore; NaN beyond the catalogue.

    ``model``: ``regression`` keeps the bearing's dimensions and takes its mass from the quadratic fit (the paper's
    "regression-based function ... using the bearing's internal diameter").
    """
    table = catalogue()
    start = np.searchsorted(table[:, 0], np.asarray(bore_mm) - 1e-9, side="left")
    row = np.where((start < len(table))[..., None], table[_lightest_from()[start]], np.nan)
    inner, outer, width, mass = (row[..., column] for column in range(4))
    if model == "regression":
        mass = np.polyval(_regression(), inner)
    return Bearing(inner_diameter_mm=inner, outer_diameter_mm=outer, width_mm=width, mass_kg=mass)


_WIDTH_BORES_MM = np.array([50.0, 80.0, 120.0, 180.0])
_WIDTH_LESS_MM = np.array([0.12, 0.15, 0.2, 0.25])
"""By how much a ring may be narrower, up to these bores (ISO 492, normal class)."""
_BORES_MM = np.array([18.0, 30.0, 50.0, 80.0, 120.0, 180.0])
_BORE_LESS_MM = np.array([0.008, 0.010, 0.012, 0.015, 0.020, 0.025])
"""By how much the mean bore may be smaller, up to these bores (ISO 492, normal class)."""
_CLEARANCE_BORES_MM = np.array([10.0, 18.0, 24.0, 30.0, 40.0, 50.0, 65.0, 80.0, 100.0, 120.0, 140.0, 160.0])
_CLEARANCE_UM = np.array(
    [
        *((8, 23), (11, 25), (13, 28), (13, 28), (15, 33), (18, 36)),
        *((23, 43), (25, 51), (30, 58), (36, 66), (41, 81), (46, 91)),
    ]
)
"""Radial internal clearance of deep groove ball bearings of group C3, up to these bores (ISO 5753-1)."""
CLEARANCE_GROUP = "C3"
"""Of all ball bearings of the robot: in group N, the tightest fits could take more clearance than there is."""
_GROOVE = 0.04
"""Radii of both grooves, 0.52 ball diameters each, less the diameter, over the diameter; as for the ratings above."""


def width_less_mm(bore_mm: Numbers) -> Numbers:
    """Return by how much a ball bearing may be narrower than its nominal width (ISO 492, normal class)."""
    less: Numbers = _WIDTH_LESS_MM[np.minimum(np.searchsorted(_WIDTH_BORES_MM, bore_mm), len(_WIDTH_LESS_MM) - 1)]
    return less


def bore_less_mm(bore_mm: float) -> float:
    """Return by how much the mean bore of a ball bearing may be smaller than nominal (ISO 492, normal class)."""
    return float(_BORE_LESS_MM[min(int(np.searchsorted(_BORES_MM, bore_mm)), len(_BORE_LESS_MM) - 1)])


def clearance_mm(bore_mm: float) -> tuple[float, float]:
    """Return the least and greatest radial internal clearance of group C3, unmounted (ISO 5753-1)."""
    low, high = _CLEARANCE_UM[min(int(np.searchsorted(_CLEARANCE_BORES_MM, bore_mm)), len(_CLEARANCE_UM) - 1)]
    return 1e-3 * float(low), 1e-3 * float(high)


def axial_play_mm(bearing: RatedBearing) -> float:
    """Return how far one ring moves along the axis between both sides, unmounted, at the greatest clearance.

    With the distance A of the grooves' centres, the balls touch both rings at an angle a with cos(a) = 1 - G_r / (2 A),
    and the play is 2 A sin(a) (Harris, Rolling Bearing Analysis, ch. 2).
    """
    centres = _GROOVE * bearing.ball_diameter_mm
    cosine = 1.0 - clearance_mm(bearing.inner_diameter_mm)[1] / (2.0 * centres)
    return float(2.0 * centres * np.sqrt(1.0 - cosine**2))


Standard = Literal["DIN 471", "DIN 472"]
_LEAST_COLLAR_MM = 0.75
"""Thinner collars give way to the tool; our own choice."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RetainingRing:
    """One retaining ring in its groove, or an array of them."""

    standard: Standard  #: ``DIN 471`` for shafts, ``DIN 472`` for bores
    size_mm: Numbers  #: d1, diameter of shaft or bore
    thickness_mm: Numbers  #: s
    radial_width_mm: Numbers  #: b, opposite the gap
    groove_diameter_mm: Numbers  #: d2
    groove_zone: str  #: tolerance class of d2 (ISO 286); '' for arrays
    groove_width_mm: Numbers  #: m, with the tolerance H13
    mass_kg: Numbers  #: of the ring, which is narrower towards its ends

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
    def collar_mm(self) -> Numbers:
        """Thickness of what is left beside the groove, on the side to which the ring is pushed.

        DIN 471 and 472 ask for three depths of the groove, with which it carries the ring's full load, some 20 kN here.
        What it has to carry, the strength factors show; half a depth can be turned.
        """
        return np.maximum(_LEAST_COLLAR_MM, 0.25 * np.abs(self.size_mm - self.groove_diameter_mm))[()]

    @property
    def purchases(self) -> tuple[Purchase, ...]:
        """Its order, such as ``V-ring with inverted lugs, DIN 471 - 40 x 1.75``; () for arrays."""
        if np.ndim(self.size_mm):
            return ()
        size = f"{self.size_mm:g} x {self.thickness_mm:g}"
        designation = f"V-ring with inverted lugs, for grooves of {self.standard} - {size}"
        maker = f"Seeger {'AV' if self.standard == 'DIN 471' else 'JV'} {self.size_mm:g}"
        return (
            Purchase(kind="retaining ring", designation=designation, standard=self.standard, alternatives=(maker,)),
        )

    @property
    def groove_note(self) -> str:
        """What a drawing must say of the groove besides its diameter; '' for arrays."""
        return "" if np.ndim(self.size_mm) else f"groove of the retaining ring {self.groove_width_mm:g} H13 wide"


_NUMBERS = ("size_mm", "thickness_mm", "radial_width_mm", "groove_diameter_mm", "groove_width_mm", "mass_kg")


def read_retaining_rings(text: str) -> dict[str, tuple[Floats, tuple[str, ...]]]:
    """Return the rings of a table in CSV with ``#`` comments: by standard, numbers of shape (n, 6) and zones of the
    grooves.

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
def _catalogue() -> dict[str, tuple[Floats, tuple[str, ...]]]:
    path = resources.files("pareto_monoped") / "data" / "retaining_rings.csv"
    return read_retaining_rings(path.read_text(encoding="utf-8"))


def retaining_ring(standard: Standard, size_mm: Numbers) -> RetainingRing:
    """Return the ring of a shaft (DIN 471) or of a bore (DIN 472); NaN where the catalogue has none."""
    table, zones = _catalogue()[standard]
    place = np.minimum(np.searchsorted(table[:, 0], np.asarray(size_mm) - 1e-9), len(table) - 1)
    row = np.where((np.abs(table[place, 0] - size_mm) < 1e-6)[..., None], table[place], np.nan)
    values = dict(zip(_NUMBERS, (row[..., column][()] for column in range(len(_NUMBERS))), strict=True))
    return RetainingRing(standard=standard, groove_zone="" if np.ndim(place) else zones[int(place)], **values)


def bearing_width(bearing: Bearing, z_front_mm: Numbers) -> Length:
    """Return the width of a ball bearing with its limits."""
    less_mm = width_less_mm(bearing.inner_diameter_mm)
    return Length(name="width", z0_mm=z_front_mm - bearing.width_mm, z1_mm=z_front_mm, lower_mm=-less_mm, upper_mm=0.0)


def ring_thickness(ring: RetainingRing, z0_mm: Numbers) -> Length:
    """Return the thickness of a retaining ring with its limits (h11, DIN 471 and DIN 472)."""
    less_mm = np.where(ring.thickness_mm <= 1.75, 0.06, np.where(ring.thickness_mm <= 2.5, 0.07, 0.08))[()]
    return Length(name="thickness", z0_mm=z0_mm, z1_mm=z0_mm + ring.thickness_mm, lower_mm=-less_mm, upper_mm=0.0)


def groove(z0_mm: Numbers, ring: RetainingRing) -> Length:
    """Return the width of a retaining ring's groove with its limits (H13)."""
    return Length(
        name="groove",
        z0_mm=z0_mm,
        z1_mm=z0_mm + ring.groove_width_mm,
        lower_mm=0.0,
        upper_mm=limits(2.0, "H13").upper_mm,  # all are 1 to 3 mm wide
    )
