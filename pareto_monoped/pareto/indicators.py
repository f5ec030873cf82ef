"""How good a front is: hypervolume, additive epsilon and IGD+, computed by moocore.

All functions take height and energy as they are. moocore minimises, so the sign of the height changes here.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Points = NDArray[np.float64]
"""Designs in objective space, shape (n, 2): height in metres (maximised), energy in joules (minimised)."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ReferencePoint:
    """The corner from which the hypervolume is measured: designs with less height or more energy add nothing."""

    height_m: float
    energy_j: float


def hypervolume(points: Points, reference: ReferencePoint) -> float:
    """Area that ``points`` dominate, bounded by ``reference``, in m J; larger is better.

    Source: Zitzler and Thiele 1998; exact algorithm of moocore.
    """
    import moocore

    inside = points[(points[:, 0] > reference.height_m) & (points[:, 1] < reference.energy_j)]
    if len(inside) == 0:
        return 0.0
    return float(moocore.hypervolume(_minimised(inside), ref=[-reference.height_m, reference.energy_j]))


def epsilon(points: Points, reference_front: Points) -> float:
    """Smallest shift after which ``points`` weakly dominate the whole reference front, as a share of its extent.

    Additive epsilon indicator (Zitzler et al. 2003) on objectives normalised to the reference front; 0 is best.
    """
    import moocore

    return float(moocore.epsilon_additive(*_normalised(points, reference_front)))


def igd_plus(points: Points, reference_front: Points) -> float:
    """Mean distance by which ``points`` fall short of the reference front, as a share of its extent; 0 is best.

    IGD+ (Ishibuchi et al. 2015) on objectives normalised to the reference front.
    """
    import moocore

    return float(moocore.igd_plus(*_normalised(points, reference_front)))


def _minimised(points: Points) -> Points:
    return np.ascontiguousarray(np.column_stack((-points[:, 0], points[:, 1])))


def _normalised(points: Points, reference_front: Points) -> tuple[Points, Points]:
    reference = _minimised(reference_front)
    low, high = reference.min(axis=0), reference.max(axis=0)
    # A reference front of a single point has no extent; distances then stay in metres and joules.
    extent = np.where(high > low, high - low, 1.0)
    return (_minimised(points) - low) / extent, (reference - low) / extent
