"""Which designs are on the height-energy front: no other jumps at least as high on at most the same energy."""

import numpy as np
from numpy.typing import NDArray


def front_mask(
    height_m: NDArray[np.float64], energy_j: NDArray[np.float64], feasible: NDArray[np.bool_]
) -> NDArray[np.bool_]:
    """Which of n designs are non-dominated: height is maximised, energy minimised.

    A design is dominated if another feasible one has at least its height and at most its energy, and is better in
    one of them. Of designs with equal height and energy the first one stays, so that the front has no duplicates.

    Args:
        height_m: greatest height of the base, shape (n,).
        energy_j: energy spent, shape (n,).
        feasible: which designs may be on the front, shape (n,); non-finite values never are.

    Returns:
        Shape (n,), true for the designs on the front.
    """
    height = np.asarray(height_m, dtype=np.float64)
    energy = np.asarray(energy_j, dtype=np.float64)
    candidates = np.flatnonzero(np.asarray(feasible, dtype=bool) & np.isfinite(height) & np.isfinite(energy))
    mask = np.zeros(height.shape, dtype=bool)
    if len(candidates) == 0:
        return mask
    # From the highest jump down, at equal height the cheapest first (lexsort is stable: ties keep their order);
    # a design is on the front exactly if it is cheaper than all before it.
    order = candidates[np.lexsort((energy[candidates], -height[candidates]))]
    cheapest_before = np.concatenate(([np.inf], np.minimum.accumulate(energy[order])[:-1]))
    mask[order[energy[order] < cheapest_before]] = True
    return mask
