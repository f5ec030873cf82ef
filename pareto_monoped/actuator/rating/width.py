"""The least face width at which a stage keeps all its safety factors, for thousands of gear sets at once."""

from collections.abc import Callable, Collection
from functools import reduce

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.actuator.rating.stage import Safeties, Stage, required
from pareto_monoped.geometry.shapes import Numbers

_SCAN = 12
"""Face widths that are tried first, evenly spread between the limits."""

STRENGTH_RULES = {
    "flank_strength": ("flank",),
    "root_strength": ("root",),
    "overload_strength": ("overload_flank", "overload_root"),
}
"""Rule -> which safety factors it is about."""


LOAD_RULES = frozenset((*STRENGTH_RULES, "output_bearing", "planet_bearing"))
"""Rules that a weaker motor would keep: gear sets that break no other fit, and are too weak."""


def strength_margins(safeties: Safeties, stage: Stage) -> dict[str, Numbers]:
    """For each rule of strength, the least safety factor over the required one, less 1."""
    least = required(stage.settings)
    return {
        rule: reduce(np.minimum, (getattr(safeties, name) / getattr(least, name) for name in names)) - 1.0
        for rule, names in STRENGTH_RULES.items()
    }


def least_width_mm(stage: Stage, off: Collection[str] = ()) -> NDArray[np.float64]:
    """The least multiple of the step at which all safety factors are kept.

    Between the limits of the face width, safety grows with width until the misalignment, which grows too, eats the
    gain. The widths tried first find the part where it grows; bisection then finds the first width that is enough.

    Args:
        stage: one gear set, or arrays of them.
        off: names of rules that need not be kept.

    Returns:
        The shape of the gear sets. Where no width is enough, the best of those tried.
    """
    step = stage.settings.parts.rating.face_step_mm
    shape = np.shape(stage.width_low_mm)
    low = np.atleast_1d(np.ceil(np.round(stage.width_low_mm / step, 6)))
    high = np.maximum(low, np.atleast_1d(np.floor(np.round(stage.width_high_mm / step, 6))))

    def margin(some: Stage, steps: NDArray[np.float64]) -> NDArray[np.float64]:
        margins = strength_margins(some.safeties(steps * step), some)
        kept = [value for rule, value in margins.items() if rule not in off]
        return np.asarray(reduce(np.minimum, kept)) if kept else np.full(steps.shape, np.inf)

    good, bad, best = _scanned(stage, low, high, margin)
    # Invariant: enough at good, not enough at bad (or below the limit). Sets without any good width stay out.
    left = np.flatnonzero(good - bad > 1.0)
    part = stage.rows(left)
    while len(left):
        middle = np.floor(0.5 * (good[left] + bad[left]))
        fits = (margin(part, middle) >= 0.0) & (middle >= low[left])
        good[left], bad[left] = np.where(fits, middle, good[left]), np.where(fits, bad[left], middle)
        wide = good[left] - bad[left] > 1.0
        left, part = left[wide], part if wide.all() else part.rows(wide)
    found = np.where(np.isfinite(good), good, best)
    # Divided by a whole number where there is one: 123 steps of 0.1 mm are then 12.3 mm to the last bit.
    return (found / round(1.0 / step) if round(1.0 / step) * step == 1.0 else found * step).reshape(shape)


def _scanned(
    stage: Stage,
    low: NDArray[np.float64],
    high: NDArray[np.float64],
    margin: Callable[[Stage, NDArray[np.float64]], NDArray[np.float64]],
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """The widths tried first, from ``low`` to ``high``; a set is left alone once a width is enough.

    Returns:
        The first that is enough, NaN where none is; the last before it, or ``low`` less 1; the best one where none is.
    """
    good, bad, best, most = np.full(low.shape, np.nan), low - 1.0, low.copy(), np.full(low.shape, -np.inf)
    left, part = np.arange(len(low)), stage
    for share in np.linspace(0.0, 1.0, _SCAN):
        tried = np.round(low[left] + share * (high[left] - low[left]))
        found = margin(part, tried)
        enough = found >= 0.0
        good[left[enough]] = tried[enough]
        if enough.any():
            left, part = left[~enough], part.rows(~enough)
            tried, found = tried[~enough], found[~enough]
        if not len(left):
            break
        bad[left] = tried
        better = found > most[left]
        best[left[better]], most[left[better]] = tried[better], found[better]
    return good, bad, best
