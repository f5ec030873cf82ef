"""Boxes pulled apart along one axis, for exploded views."""

import numpy as np
from numpy.typing import NDArray

_APART_MM = 6.0


def pulled_apart(boxes_mm: NDArray[np.float64], axis: int) -> list[float]:
    """How far each box moves along an axis so that boxes that lie behind each other come apart.

    Args:
        boxes_mm: low and high corners, shape (n, 6).
        axis: 0, 1 or 2.
    """
    low, high = boxes_mm[:, axis], boxes_mm[:, axis + 3]
    order = np.argsort(0.5 * (low + high), kind="stable")
    moved = np.zeros(len(boxes_mm))
    middle = float(np.median(0.5 * (low + high)))
    right = [k for k in order.tolist() if 0.5 * (low[k] + high[k]) >= middle]
    left = [k for k in reversed(order.tolist()) if 0.5 * (low[k] + high[k]) < middle]
    done: list[int] = []  # of both sides: a screw may lie on the other side of the middle than what it is in
    for side, sign in ((right, 1.0), (left, -1.0)):
        for k in side:
            front = float(low[k] if sign > 0.0 else high[k])
            for other in done:
                if _beside(boxes_mm[k], boxes_mm[other], axis):
                    continue
                back = float((high if sign > 0.0 else low)[other] + moved[other])
                moved[k] = sign * max(sign * moved[k], sign * (back - front) + _APART_MM)
            done.append(k)
    return [float(move) for move in moved]


def _beside(one: NDArray[np.float64], other: NDArray[np.float64], axis: int) -> bool:
    """Whether two boxes do not lie behind each other along the axis."""
    across = [k for k in range(3) if k != axis]
    return any(one[k] >= other[k + 3] or other[k] >= one[k + 3] for k in across)
