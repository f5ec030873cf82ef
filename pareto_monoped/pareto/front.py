"""The front: the designs that no other design betters in one objective without being worse in another."""

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.pareto.objectives import Objectives


def front_mask(
    values: NDArray[np.float64], objectives: Objectives, feasible: NDArray[np.bool_] | None = None
) -> NDArray[np.bool_]:
    """Find the non-dominated designs of n.

    A design is dominated if another feasible one is at least as good in every objective, and better in at least one.
    Of several designs that are equal in all objectives only the first is on the front.

    Args:
        values: of the objectives, in their order and stored units, shape (n, m).
        objectives: which m measures these are.
        feasible: which designs may be on the front, shape (n,); all if None. A design with a non-finite value never is.

    Returns:
        A mask of shape (n,), true for the designs on the front.
    """
    points = objectives.minimised(np.asarray(values, dtype=np.float64).reshape(-1, len(objectives.names)))
    eligible = np.isfinite(points).all(axis=1)
    if feasible is not None:
        eligible &= np.asarray(feasible, dtype=bool)
    candidates = np.flatnonzero(eligible)
    mask = np.zeros(len(points), dtype=bool)
    if len(candidates):
        chosen = _of_two(points[candidates]) if points.shape[1] == 2 else _of_more(points[candidates])
        mask[candidates[chosen]] = True
    return mask


def _of_two(points: NDArray[np.float64]) -> NDArray[np.intp]:
    """Rows of the non-dominated points, shape (n, 2), both minimised."""
    # Sort by the first objective and, where it is equal, by the second; lexsort is stable, so ties keep their order.
    # Then a point is on the front exactly if its second objective is less than that of all points before it.
    order = np.lexsort((points[:, 1], points[:, 0]))
    second = points[order, 1]
    least_before = np.concatenate(([np.inf], np.minimum.accumulate(second)[:-1]))
    front: NDArray[np.intp] = order[second < least_before]
    return front


def _of_more(points: NDArray[np.float64]) -> NDArray[np.intp]:
    """Rows of the non-dominated points, shape (n, m), all minimised; of equal points the first."""
    import moocore

    return np.flatnonzero(moocore.is_nondominated(points, keep_weakly=False))
