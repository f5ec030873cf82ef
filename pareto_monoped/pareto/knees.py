"""Two ways to find where a front bends most."""

import numpy as np

from pareto_monoped.pareto.objectives import HEIGHT_AND_ENERGY, Objectives
from pareto_monoped.pareto.scores import Floats, Scored, losses, scaled

NEIGHBOURHOOD = 0.125
"""Distance on the scaled front within which designs are neighbours. Source: pymoo, ``mcdm.high_tradeoff``."""


def knee(values: Floats, objectives: Objectives) -> Scored:
    """Das 1999 (On characterizing the "knee" of the Pareto curve): the distance from the chord.

    With each objective scaled to the extent of the front and its better end at 1, the ends of a front of two objectives
    are (0, 1) and (1, 0), and a point's distance from the chord between them is (sum of the scaled objectives - 1) /
    sqrt(2). For three objectives the chord becomes the plane through (1, 0, 0), (0, 1, 0) and (0, 0, 1), and the
    divisor sqrt(3).

    Args:
        values: shape (n, m), by the first objective.
        objectives: which m measures these are.
    """
    n, m = values.shape
    # The better end of a minimised objective lies at 1 - scaled. The ones are added last: with the paper's objectives
    # nothing is left of them, so that no digit is lost.
    ones = (objectives.signs > 0.0).sum() - 1
    distance = (-(scaled(values) * objectives.signs).sum(axis=1) + ones) / np.sqrt(float(m))

    def why(row: int) -> str:
        if n < m + 1:
            return f"the front has only {n} design(s), so its knee is an end of it"
        return f"the knee, farthest ({distance[row]:.3f} of the scaled front) from {_flat(values, objectives)}"

    return Scored(score=distance, why=why)


def _flat(values: Floats, objectives: Objectives) -> str:
    """What the knee is farthest from."""
    if len(objectives.names) > 2:
        return "the plane through the best of each objective"
    first, last = values[0], values[-1]
    if objectives == HEIGHT_AND_ENERGY:
        ends = [f"{height:.3f} m at {energy:.2f} J" for height, energy in (first, last)]
    else:
        ends = [objectives.text(end.tolist()) for end in (first, last)]
    return f"the chord between the front's ends {ends[0]} and {ends[1]}"


def tradeoff(values: Floats, objectives: Objectives) -> Scored:
    """Rachmawati and Srinivasan 2009: what a step to a neighbour gives up for what it gains, for the best neighbour.

    Both are sums over the objectives, scaled to the extent of the front. Neighbours are the designs within
    ``NEIGHBOURHOOD``, and at least the 2 m nearest ones and all that are as near.

    Args:
        values: shape (n, m).
        objectives: which m measures these are.
    """
    points = losses(values, objectives)
    least = np.array([_least_bargain(points, i) for i in range(len(points))])

    def why(row: int) -> str:
        if len(points) < 2:
            return "the only design on the front"
        return (
            f"the largest trade-off: every neighbour on the front gives up at least {least[row]:.3g} times what it "
            "gains (objectives scaled to the front's extent)"
        )

    return Scored(score=least, why=why)


def _least_bargain(points: Floats, i: int) -> float:
    """The least ratio of sacrifice to gain among the neighbours of one design; infinite if none gains anything."""
    apart = np.linalg.norm(points - points[i], axis=1)
    others = np.arange(len(points)) != i
    nearest = np.sort(apart[others])[: 2 * points.shape[1]]
    # Equally far designs are all neighbours or none, whatever their order and last digits.
    reach = max(NEIGHBOURHOOD, nearest[-1] if len(nearest) else 0.0) + 1e-9
    change = points[others & (apart <= reach)] - points[i]
    sacrifice, gain = np.maximum(change, 0.0).sum(axis=1), np.maximum(-change, 0.0).sum(axis=1)
    gains = gain > 0.0
    return float((sacrifice[gains] / gain[gains]).min()) if gains.any() else np.inf
