"""The height-energy front: the designs for which no other design jumps as high on as little energy."""

import numpy as np
from numpy.typing import NDArray


def front_mask(
    height_m: NDArray[np.float64], energy_j: NDArray[np.float64], feasible: NDArray[np.bool_]
) -> NDArray[np.bool_]:
    """Find the non-dominated designs of n: height is maximised, energy minimised.

    A design is dominated if another feasible one has at least its height and at most its energy, and is better in at
    least one of them. Of several designs with equal height and energy only the first is on the front.

    Args:
        height_m: greatest height of the base, shape (n,).
        energy_j: energy spent, shape (n,).
        feasible: which designs may be on the front, shape (n,). A design with a non-finite value never is.

    Returns:
        A mask of shape (n,), true for the designs on the front.
    """
    height = np.asarray(height_m, dtype=np.float64)
    energy = np.asarray(energy_j, dtype=np.float64)
    candidates = np.flatnonzero(np.asarray(feasible, dtype=bool) & np.isfinite(height) & np.isfinite(energy))
    mask = np.zeros(height.shape, dtype=bool)
    if len(candidates) == 0:
        return mask
    # Sort from the highest jump down, and at equal height by energy; lexsort is stable, so ties keep their order. Then
    # a design is on the front exactly if it needs less energy than all designs before it.
    order = candidates[np.lexsort((energy[candidates], -height[candidates]))]
    cheapest_before = np.concatenate(([np.inf], np.minimum.accumulate(energy[order])[:-1]))
    mask[order[energy[order] < cheapest_before]] = True
    return mask
