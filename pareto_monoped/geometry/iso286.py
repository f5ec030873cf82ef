"""Limits of the tolerance classes that the parts use (ISO 286-1 and -2)."""

from bisect import bisect_left
from dataclasses import dataclass

from pareto_monoped.errors import DesignError

_SIZES_MM = (3.0, 6.0, 10.0, 18.0, 30.0, 50.0, 80.0, 120.0)
"""Upper ends of the ranges of nominal sizes (ISO 286-1, table 1)."""
_IT_UM = {
    6: (6, 8, 9, 11, 13, 16, 19, 22),
    7: (10, 12, 15, 18, 21, 25, 30, 35),
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
_COARSE = ("h12", "h13", "H12", "H13")
"""Of the grooves of retaining rings (DIN 471 and DIN 472)."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Limits:
    """Limits of a size as deviations from the nominal one, in mm."""

    lower_mm: float
    upper_mm: float


def limits(diameter_mm: float, zone: str) -> Limits:
    """Limits of a tolerance class, such as ``H7`` for a hole or ``m6`` for a shaft.

    Raises:
        DesignError: the size or the class is not in the tables.
    """
    known = [f"{letter}7" for letter in _HOLES_UM] + [f"{letter}6" for letter in _SHAFTS_UM] + ["R6", *_COARSE]
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
    """Least and greatest interference of a fit; negative where there is clearance."""
    bore, journal = limits(diameter_mm, hole), limits(diameter_mm, shaft)
    return journal.lower_mm - bore.upper_mm, journal.upper_mm - bore.lower_mm
