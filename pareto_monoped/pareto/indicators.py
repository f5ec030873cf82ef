"""Measure how good a front is: its hypervolume above a corner."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.pareto.objectives import Objectives

Points = NDArray[np.float64]
"""Designs in objective space, shape (n, m)."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ReferencePoint:
    """The corner from which the hypervolume is measured: designs that are worse in any objective add nothing."""

    objectives: Objectives  #: the search's
    values: tuple[float, ...]  #: a value of each objective, in their order and stored units

    def as_dict(self) -> dict[str, float]:
        """Return the values by the names of their measures."""
        return dict(zip(self.objectives.names, self.values, strict=True))

    def text(self) -> str:
        """Write the values with their units, such as "0.55 m, 100 J"."""
        pairs = zip(self.objectives.measures, self.values, strict=True)
        return ", ".join(f"{value:g} {entry.unit}" if entry.unit != "1" else f"{value:g}" for entry, value in pairs)


def reference_point(objectives: Objectives, given: Mapping[str, float] | None = None) -> ReferencePoint:
    """Make the corner for some objectives: values ``given`` by name, for the others those of the table of measures."""
    given = given or {}
    values = (given.get(entry.name, entry.reference) for entry in objectives.measures)
    return ReferencePoint(objectives=objectives, values=tuple(0.0 if value is None else value for value in values))


def hypervolume(points: Points, reference: ReferencePoint) -> float:
    """Compute the area or volume that ``points`` dominate, bounded by ``reference``; larger is better.

    Points have stored units and their natural sign; the result has the product of the units.

    Source: Zitzler and Thiele 1998; for three objectives the exact algorithm of moocore.
    """
    less_is_better = reference.objectives.minimised(points)
    corner = reference.objectives.minimised(np.array(reference.values))
    inside = less_is_better[(less_is_better < corner).all(axis=1)]
    if len(inside) == 0:
        return 0.0
    if len(corner) == 2:
        return _area(inside, corner)
    import moocore

    return float(moocore.hypervolume(np.ascontiguousarray(inside), ref=corner))


def _area(points: Points, corner: NDArray[np.float64]) -> float:
    """Compute the area between points, shape (n, 2), and a corner that is worse than all: moocore's to the last bit.

    The sum goes over the points by their first objective; each adds the strip that reaches from its own second
    objective to the least one before it. Without moocore, which takes longer to import than a front of 1,000 designs.
    """
    first, second = points[:, 0], points[:, 1]
    if not (first[1:] > first[:-1]).all():  # a front that is followed is sorted, and sorting is most of the time
        order = np.lexsort((second, first))
        first, second = first[order], second[order]
    before = np.concatenate((corner[1:], np.minimum.accumulate(second)[:-1]))
    better = second < before
    # A cumulative sum adds in order, as moocore does; ``np.sum`` adds in pairs.
    return float(np.cumsum((corner[0] - first[better]) * (before[better] - second[better]))[-1])
