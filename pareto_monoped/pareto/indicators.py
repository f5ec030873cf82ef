"""How good a front is: hypervolume, additive epsilon and IGD+, computed by moocore for two or three objectives.

All functions take the objectives' values in stored units and with their natural sign. moocore minimises, so the signs
change here.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.pareto.objectives import HEIGHT_AND_ENERGY, Objectives

Points = NDArray[np.float64]
"""Designs in objective space, shape (n, m)."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ReferencePoint:
    """The corner from which the hypervolume is measured: designs that are worse in any objective add nothing."""

    objectives: Objectives  #: of the search
    values: tuple[float, ...]  #: of each objective, in their order and stored units

    def as_dict(self) -> dict[str, float]:
        """The values by the names of their measures."""
        return dict(zip(self.objectives.names, self.values, strict=True))

    def text(self) -> str:
        """The values with their units, such as "0.55 m, 100 J"."""
        pairs = zip(self.objectives.measures, self.values, strict=True)
        return ", ".join(f"{value:g} {entry.unit}" if entry.unit != "1" else f"{value:g}" for entry, value in pairs)


def reference_point(objectives: Objectives, given: Mapping[str, float] | None = None) -> ReferencePoint:
    """The corner for some objectives: the values ``given`` by name, for the others those of the table of measures."""
    given = given or {}
    values = (given.get(entry.name, entry.reference) for entry in objectives.measures)
    return ReferencePoint(objectives=objectives, values=tuple(0.0 if value is None else value for value in values))


def hypervolume(points: Points, reference: ReferencePoint) -> float:
    """Area or volume that ``points`` dominate, bounded by ``reference``, in the product of units; larger is better.

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
    """Area between points, shape (n, 2), and a corner that is worse than all; equal to moocore's to the last bit.

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


def epsilon(points: Points, reference_front: Points, objectives: Objectives = HEIGHT_AND_ENERGY) -> float:
    """Smallest shift after which ``points`` weakly dominate the whole reference front, as a share of its extent.

    Additive epsilon indicator (Zitzler et al. 2003) on objectives normalised to the reference front; 0 is best.
    """
    import moocore

    return float(moocore.epsilon_additive(*_normalised(points, reference_front, objectives)))


def igd_plus(points: Points, reference_front: Points, objectives: Objectives = HEIGHT_AND_ENERGY) -> float:
    """Mean distance by which ``points`` fall short of the reference front, as a share of its extent; 0 is best.

    IGD+ (Ishibuchi et al. 2015) on objectives normalised to the reference front.
    """
    import moocore

    return float(moocore.igd_plus(*_normalised(points, reference_front, objectives)))


def _normalised(points: Points, reference_front: Points, objectives: Objectives) -> tuple[Points, Points]:
    reference = objectives.minimised(reference_front)
    low, high = reference.min(axis=0), reference.max(axis=0)
    # A reference front of a single point has no extent; distances then stay in the stored units.
    extent = np.where(high > low, high - low, 1.0)
    return (objectives.minimised(points) - low) / extent, (reference - low) / extent
