"""How designs of a front are scored, and the objectives on one scale."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.pareto.objectives import Objectives

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class Scored:
    """How good each of n designs is for a choice.

    Attributes:
        score: more is better, shape (n,).
        why: the reason for choosing the design in a row, as a part of a sentence.
    """

    score: Floats
    why: Callable[[int], str]


def scaled(values: Floats) -> Floats:
    """Each column scaled to its extent, from 0 at its least to 1 at its greatest value; zeros where all are equal."""
    least, extent = values.min(axis=0), np.ptp(values, axis=0)
    return np.where(extent > 0.0, (values - least) / np.where(extent > 0.0, extent, 1.0), 0.0)


def losses(values: Floats, objectives: Objectives) -> Floats:
    """Objectives scaled to the extent of the front, shape (n, m): 0 is the best of each, 1 the worst."""
    return scaled(objectives.minimised(values))
