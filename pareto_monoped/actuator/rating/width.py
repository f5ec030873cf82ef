"""The least face width at which a stage keeps all its safety factors, for thousands of gear sets at once."""

from collections.abc import Collection
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

    def margin(steps: NDArray[np.float64]) -> NDArray[np.float64]:
        margins = strength_margins(stage.safeties(steps * step), stage)
        kept = [value for rule, value in margins.items() if rule not in off]
        return np.asarray(reduce(np.minimum, kept)) if kept else np.full(low.shape, np.inf)

    tried = np.round(low + np.linspace(0.0, 1.0, _SCAN)[:, None] * (high - low))
    margins = np.array([margin(widths) for widths in tried])
    enough = margins >= 0.0
    first, best = np.argmax(enough, axis=0), np.argmax(margins, axis=0)
    columns = np.arange(len(low))
    good = tried[first, columns]
    bad = np.where(first > 0, tried[np.maximum(first - 1, 0), columns], low - 1.0)
    # Invariant: enough at good, not enough at bad (or below the limit), if there is any good width at all.
    while np.any(good - bad > 1.0):
        middle = np.floor(0.5 * (good + bad))
        fits = (margin(middle) >= 0.0) & (middle >= low)
        good, bad = np.where(fits, middle, good), np.where(fits, bad, middle)
    found = np.where(enough.any(axis=0), good, tried[best, columns])
    # Divided by a whole number where there is one: 123 steps of 0.1 mm are then 12.3 mm to the last bit.
    return (found / round(1.0 / step) if round(1.0 / step) * step == 1.0 else found * step).reshape(shape)
