"""What a workshop must know of a part besides its shape: fits with their limits (ISO 286), and how teeth are made.

Millimetres.
"""

from bisect import bisect_left
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from pareto_monoped.errors import DesignError
from pareto_monoped.geometry.shapes import Numbers


@dataclass(frozen=True, slots=True, kw_only=True)
class Fit:
    """The tolerance of all round faces of one diameter of a part."""

    diameter_mm: Numbers  #: nominal
    zone: str  #: tolerance class after ISO 286-1, such as ``H7`` for a hole or ``h6`` for a shaft
    seat: bool = False  #: whether the face carries a bearing or a gear, so that its place and finish matter too
    raceway: bool = False  #: whether rolling elements run on the face itself, which is then hard and ground
    together: bool = False  #: whether it is finished in place, together with the parts that it joins

    @property
    def text(self) -> str:
        """Such as ``40 h6``; '' for arrays."""
        return "" if np.ndim(self.diameter_mm) else f"{float(self.diameter_mm):g} {self.zone}"

    def holds(self, diameter_mm: float) -> bool:
        """Return whether a face of this diameter has the tolerance."""
        return bool(np.isclose(float(self.diameter_mm), diameter_mm, rtol=0.0, atol=1e-6))


@dataclass(frozen=True, slots=True, kw_only=True)
class Length:
    """A length along the axis that others depend on, with its limits; all other lengths have general tolerances."""

    name: str  #: unique in the part, such as ``web``
    z0_mm: Numbers  #: heights of its faces in the part's own frame
    z1_mm: Numbers
    lower_mm: Numbers  #: deviations from the length as drawn
    upper_mm: Numbers

    @property
    def nominal_mm(self) -> float:
        """As drawn."""
        return abs(float(self.z1_mm) - float(self.z0_mm))


FINE_MM = 0.05
"""Width of the limits of lengths that a gap depends on: about IT9 at 18 to 50 mm (52 to 62 um), which turning in one
clamping holds without grinding; our own choice."""


def wider(name: str, z0_mm: Numbers, z1_mm: Numbers) -> Length:
    """Return a length that makes its gap wider where it is not as drawn."""
    return Length(name=name, z0_mm=z0_mm, z1_mm=z1_mm, lower_mm=0.0, upper_mm=FINE_MM)


def narrower(name: str, z0_mm: Numbers, z1_mm: Numbers) -> Length:
    """Return a length that is at most as drawn."""
    return Length(name=name, z0_mm=z0_mm, z1_mm=z1_mm, lower_mm=-FINE_MM, upper_mm=0.0)


RELIEF_MM = (1.0, 0.1)
"""Width and depth of the undercut beside a ground seat (DIN 509, E 0.2 x 0.1, for short seats)."""
RACEWAY_RA_UM = 0.2
"""Greatest Ra of raceways (SKF, Raceways on shafts and in housings; Schaeffler has the same up to 80 mm)."""
_RACEWAY_ROUND, _RACEWAY_CYLINDRICAL = 0.25, 0.5
"""Deviations from round and cylindrical form over the diameter's tolerance, at most (SKF, the same page)."""


def raceway_note(tolerance_mm: float) -> str:
    """Return the form of a raceway in words."""
    round_mm, cylindrical_mm = (share * tolerance_mm for share in (_RACEWAY_ROUND, _RACEWAY_CYLINDRICAL))
    return (
        f"raceway of the needles: ground, Ra {RACEWAY_RA_UM:g} um, round within {round_mm:.3f} mm, cylindrical within "
        f"{cylindrical_mm:.3f} mm"
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class ToothMaking:
    """How the teeth of one outline of a part are made, with what their rating takes for granted."""

    teeth: int  #: of the outline
    module_mm: float
    accuracy_class: int  #: ISO 1328-1
    making: str  #: the steps in their order
    mates_mm: tuple[float, ...]  #: reference diameters of the gears that mesh with them
    #: Least backlash of the pair along the pitch circle, where the outlines are drawn without it; None: as they are
    #: drawn
    play_mm: float | None = None
    quality: str = ""  #: of material and treatment (ISO 6336-5), such as ``MQ``; '' for teeth that are not rated
    core_hardness: str = ""  #: with its scale
    layer: str = ""  #: which depth of hardening is meant; '' without one
    layer_mm: tuple[float, float] = (0.0, 0.0)  #: its limits, in the finished tooth
    flank_rz_um: float = 0.0  #: greatest Rz of the flanks
    root_rz_um: float = 0.0  #: greatest Rz of the fillets
    runout_mm: float = 0.0  #: greatest radial runout of the teeth to the datum axis
    #: Diameters between which the flanks touch those of their mates; None for teeth that do not roll
    active_mm: tuple[float, float] | None = None
    crowning_um: float = 0.0  #: by how much the ends of the flanks stand back behind their middle

    @property
    def layer_text(self) -> str:
        """Limits of the layer, such as ``0.09 to 0.24``."""
        return f"{self.layer_mm[0]:.2f} to {self.layer_mm[1]:.2f}"

    @property
    def text(self) -> str:
        """The facts of rated teeth in one line; '' for others."""
        layer = f", {self.layer} {self.layer_text} mm" if self.layer else ""
        return self.quality and f"teeth {self.making}, {self.quality}{layer}, core {self.core_hardness}"


_SIZES_MM = (3.0, 6.0, 10.0, 18.0, 30.0, 50.0, 80.0, 120.0)
"""Upper ends of the ranges of nominal sizes (ISO 286-1, table 1)."""
_IT_UM = {
    6: (6, 8, 9, 11, 13, 16, 19, 22),
    7: (10, 12, 15, 18, 21, 25, 30, 35),
    9: (25, 30, 36, 43, 52, 62, 74, 87),
    12: (100, 120, 150, 180, 210, 250, 300, 350),
    13: (140, 180, 220, 270, 330, 390, 460, 540),
}
"""Standard tolerances (ISO 286-1, table 1)."""
_SHAFTS_UM = {
    "f": (-6, -10, -13, -16, -20, -25, -30, -36),
    "g": (-2, -4, -5, -6, -7, -9, -10, -12),
    "h": (0, 0, 0, 0, 0, 0, 0, 0),
    "k": (0, 1, 1, 1, 2, 2, 2, 3),
    "m": (2, 4, 6, 7, 8, 9, 11, 13),
    "n": (4, 8, 10, 12, 15, 17, 20, 23),
    "p": (6, 12, 15, 18, 22, 26, 32, 37),
}
"""Fundamental deviations of shafts of grade 6: the upper limit up to ``h``, the lower from ``k`` (ISO 286-1)."""
_HOLES_UM = {
    "F": (6, 10, 13, 16, 20, 25, 30, 36),
    "G": (2, 4, 5, 6, 7, 9, 10, 12),
    "H": (0, 0, 0, 0, 0, 0, 0, 0),
    "J": (4, 6, 8, 10, 12, 14, 18, 22),
    "N": (-4, -4, -4, -5, -7, -8, -9, -10),
}
"""Fundamental deviations of holes of grade 7: the lower limit up to ``H``, the upper from ``J`` (ISO 286-1)."""
_R6_UM = (-10, -12, -16, -20, -24, -29)
"""Upper limits of holes R6 up to 50 mm (ISO 286-2), the seats of drawn cups."""
GROOVE_ZONES = ("h12", "h13", "H12", "H13")
"""Of the grooves of retaining rings (DIN 471 and DIN 472)."""
_TIP_ZONES = ("h9", "H9")
"""Of tip diameters."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Limits:
    """Limits of a size as deviations from the nominal one, in mm."""

    lower_mm: float
    upper_mm: float


# A map asks for the same few sizes some thousand times.
@lru_cache(maxsize=1024)
def limits(diameter_mm: float, zone: str) -> Limits:
    """Return the limits of a tolerance class, such as ``H7`` for a hole or ``m6`` for a shaft.

    Raises:
        DesignError: the size or the class is not in the tables.
    """
    known = (
        [f"{letter}7" for letter in _HOLES_UM]
        + [f"{letter}6" for letter in _SHAFTS_UM]
        + ["h7", "R6", *GROOVE_ZONES, *_TIP_ZONES]
    )
    if zone not in known:
        raise DesignError(f"tolerance class = {zone!r}: must be one of {', '.join(known)}; choose one of these")
    largest = _SIZES_MM[len(_R6_UM) - 1] if zone == "R6" else _SIZES_MM[-1]
    if not 0.0 < diameter_mm <= largest:
        raise DesignError(
            f"diameter {diameter_mm:g} mm of {zone}: must be above 0 and at most {largest:g} mm; "
            "extend the tables of ISO 286"
        )
    row = bisect_left(_SIZES_MM, diameter_mm)
    letter, wide = zone[0], _IT_UM[int(zone[1:])][row]
    deviation = _R6_UM[row] if zone == "R6" else (_HOLES_UM if letter.isupper() else _SHAFTS_UM)[letter][row]
    # The fundamental deviation is the limit nearer to the nominal size.
    from_below = letter in "FGHkmnp"
    lower, upper = (deviation, deviation + wide) if from_below else (deviation - wide, deviation)
    return Limits(lower_mm=1e-3 * lower, upper_mm=1e-3 * upper)


def interference_mm(diameter_mm: float, hole: str, shaft: str) -> tuple[float, float]:
    """Return the least and greatest interference of a fit; negative where there is clearance."""
    bore, journal = limits(diameter_mm, hole), limits(diameter_mm, shaft)
    return journal.lower_mm - bore.upper_mm, journal.upper_mm - bore.lower_mm


# DIN 3967: largest pitch diameter, and the tolerance of the tooth thickness by series.
_LARGEST_MM = np.array([10.0, 50.0, 125.0, 280.0])
_TOLERANCE_MM = {23: np.array([0.008, 0.012, 0.016, 0.020]), 24: np.array([0.012, 0.020, 0.025, 0.030])}
RATED_SERIES = 23
"""Of rated gears: our own choice, the finest that suits teeth of ISO 1328-1 class 6; thinner roots are weaker."""
GENERAL_SERIES = 24
"""Of all other teeth: gears of the rules ``paper``, and splines."""
LARGEST_PITCH_DIAMETER_MM = float(_LARGEST_MM[-1])
"""Where the table ends."""


def thickness_tolerance_mm(pitch_diameter_mm: Numbers, series: int) -> Numbers:
    """Return by how much a tooth may be thinner than drawn along the pitch circle; constant beyond the table."""
    place = np.minimum(np.searchsorted(_LARGEST_MM, pitch_diameter_mm), len(_LARGEST_MM) - 1)
    return _TOLERANCE_MM[series][place]
