"""How a front still grows: what a search would gain by going on, from how much it gained so far."""

import numpy as np
from numpy.typing import ArrayLike

AHEAD = 4
"""How many times as many evaluations ``left_to_gain`` looks ahead to."""
_DOUBLING = 0.42
"""What a doubling of the evaluations gains, as a share of what the doubling before it gained. Our own choice, by
measurement: benchmarks/search_landscapes.md says how near the estimates come."""


def left_to_gain(evaluations: ArrayLike, volumes: ArrayLike) -> float | None:
    """Estimate what ``AHEAD`` times the evaluations would add to the hypervolume, as a share of today's.

    Each of the next two doublings is expected to gain ``_DOUBLING`` of what the doubling before it gained. A fitted
    curve has one more number to find in the same noise, and came less near.

    Args:
        evaluations: number of evaluations after each generation, shape (k,), ascending.
        volumes: the front's hypervolume then, shape (k,).

    Returns:
        None where nothing was known after half of the evaluations, so that nothing can be said.
    """
    done, volume = np.asarray(evaluations, dtype=np.float64), np.asarray(volumes, dtype=np.float64)
    if len(done) == 0 or done[0] > 0.5 * done[-1]:
        return None
    before = float(np.interp(0.5 * done[-1], done, volume))
    if before <= 0.0:
        return None
    return float((volume[-1] - before) / volume[-1] * (_DOUBLING + _DOUBLING**2))
