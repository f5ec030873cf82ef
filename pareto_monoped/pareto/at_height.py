"""What the designs of a front that reach a height cost in another objective."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.design import HEADLINE_HEIGHT_M
from pareto_monoped.measures import Measure
from pareto_monoped.pareto.objectives import Objectives

HEIGHT = "height_m"


@dataclass(frozen=True, slots=True, kw_only=True)
class AtHeight:
    """The best value of a measure among the designs that reach a height; None if none does."""

    height_m: float
    measure: Measure
    value: float | None

    def text(self) -> str:
        """In words, such as "27.01 J at 0.8 m"."""
        if self.value is None:
            return f"{self.height_m:g} m not reached"
        return f"{self.measure.text(self.value)} at {self.height_m:g} m"


def best_at_height(
    values: NDArray[np.float64], objectives: Objectives, height_m: float = HEADLINE_HEIGHT_M
) -> AtHeight | None:
    """The best of the first other objective, at a height or above.

    Args:
        values: of n designs, shape (n, m), in the objectives' order and stored units.
        objectives: what they are; without the height among them there is no answer, None.
        height_m: least height.
    """
    if HEIGHT not in objectives.names:
        return None
    other = objectives.other_than(HEIGHT)
    reached = values[values[:, objectives.names.index(HEIGHT)] >= height_m, objectives.names.index(other.name)]
    best = np.max if other.direction == "maximise" else np.min
    return AtHeight(height_m=height_m, measure=other, value=float(best(reached)) if len(reached) else None)
