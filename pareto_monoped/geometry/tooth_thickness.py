"""How much thinner than drawn the drawings let teeth become. Millimetres."""

import numpy as np

from pareto_monoped.geometry.shapes import Numbers

# DIN 3967: largest pitch diameter, and the tolerance of the tooth thickness by series.
_LARGEST_MM = np.array([10.0, 50.0, 125.0, 280.0])
_TOLERANCE_MM = {
    23: np.array([0.008, 0.012, 0.016, 0.020]),
    24: np.array([0.012, 0.020, 0.025, 0.030]),
}
RATED_SERIES = 23
"""Of rated gears: our own choice, the finest that suits teeth of ISO 1328-1 class 6; thinner roots are weaker."""
GENERAL_SERIES = 24
"""Of all other teeth: gears of the rules ``paper``, and splines."""
LARGEST_PITCH_DIAMETER_MM = float(_LARGEST_MM[-1])
"""Where the table ends."""


def thickness_tolerance_mm(pitch_diameter_mm: Numbers, series: int) -> Numbers:
    """By how much a tooth may be thinner than drawn (ring: a space wider), along the pitch circle.

    Args:
        pitch_diameter_mm: one or an array; beyond the table, its last value counts.
        series: of DIN 3967.
    """
    place = np.minimum(np.searchsorted(_LARGEST_MM, pitch_diameter_mm), len(_LARGEST_MM) - 1)
    return _TOLERANCE_MM[series][place]
