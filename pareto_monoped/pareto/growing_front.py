"""The front of ever more designs, without looking at those again that are on it."""

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.pareto.front import front_mask
from pareto_monoped.pareto.objectives import Objectives

Numbers = NDArray[np.int64]
Floats = NDArray[np.float64]


class GrowingFront:
    """Follows a front while designs are added; it always holds what ``front_mask`` finds among all of them.

    With two objectives the front stays sorted by the first, in which the second falls. A new design is then compared
    with its neighbours alone: a front of 20,000 designs takes in 80 more in a tenth of the time that sorting all takes.

    Attributes:
        objectives: of the designs.
    """

    def __init__(self, objectives: Objectives) -> None:
        self.objectives = objectives
        # One row per objective, less is better: what is searched lies close together in memory.
        self._points: Floats = np.zeros((len(objectives.names), 0))
        self._numbers: Numbers = np.zeros(0, dtype=np.int64)

    def __len__(self) -> int:
        return len(self._numbers)

    @property
    def numbers(self) -> Numbers:
        """Of the designs on the front, ascending, shape (n,)."""
        return np.sort(self._numbers)

    @property
    def values(self) -> Floats:
        """Of their objectives in stored units, shape (n, m): two by the first of them, three by the numbers."""
        return self.objectives.minimised(self._points.T)  # which is its own inverse

    def add(self, numbers: Numbers, values: Floats) -> None:
        """Add feasible designs.

        Args:
            numbers: greater than all before, ascending, shape (n,): of equal designs the first is on the front.
            values: of the objectives in stored units, shape (n, m); a design with a value that is not finite is never
                on the front.
        """
        if len(self._points) == 2:
            best = front_mask(values, self.objectives)
            self._merge(numbers[best], self.objectives.minimised(values[best]).T)
            return
        mask = front_mask(np.vstack((self.values, values)), self.objectives)
        self._points = np.hstack((self._points, self.objectives.minimised(values).T))[:, mask]
        self._numbers = np.concatenate((self._numbers, numbers))[mask]

    def _merge(self, numbers: Numbers, points: Floats) -> None:
        """Merge points of two objectives, shape (2, n), none of which dominates another, into the front."""
        first, second = self._points
        # The point just before a new one has the least second objective of all that are as good in the first.
        place = np.searchsorted(first, points[0], side="right")
        free = place == 0
        free[~free] = second[place[~free] - 1] > points[1, ~free]
        free = np.flatnonzero(free)
        free = free[np.argsort(points[0, free])]
        points, numbers = points[:, free], numbers[free]
        # Those that a new point dominates follow each other, because the second objective falls along the front.
        begin = np.searchsorted(first, points[0], side="left")
        end = len(second) - np.searchsorted(second[::-1], points[1], side="left")
        kept = np.ones(len(first), dtype=bool)
        for start, stop in zip(begin.tolist(), end.tolist(), strict=True):
            kept[start:stop] = False
        left = self._points[:, kept]
        where = np.searchsorted(left[0], points[0])
        self._points = np.insert(left, where, points, axis=1)
        self._numbers = np.insert(self._numbers[kept], where, numbers)
