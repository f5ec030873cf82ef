"""The cost that the weighted search minimises: the paper's for height and energy, a normalised sum for other pairs."""

import numpy as np

from pareto_monoped.pareto.indicators import ReferencePoint
from pareto_monoped.pareto.objectives import HEIGHT_AND_ENERGY
from pareto_monoped.study.protocol import Floats


def weighted_cost(values: Floats, weight: float, corner: ReferencePoint, height_scale_j: float) -> Floats:
    """Cost of n designs by two objectives, shape (n,); less is better.

    For the paper's objectives lambda1 Kh exp(-h) + lambda2 E, with lambda2 = 1 - lambda1 (paper, section III-B, and the
    commented-out passage on C_h in its source). For any other two the sum of w f1 / s1 and (1 - w) f2 / s2, where each
    f is the measure with the sign that makes less better, and its scale s is its value at the study's reference point:
    a number of the size of its values, which does not change while the search runs. Our own choice.

    Args:
        values: of the objectives in stored units, shape (n, 2).
        weight: of the first objective, the paper's lambda1.
        corner: the study's reference point, which names the objectives.
        height_scale_j: the paper's Kh, used for its objectives only.
    """
    if corner.objectives == HEIGHT_AND_ENERGY:
        return weight * height_scale_j * np.exp(-values[:, 0]) + (1.0 - weight) * values[:, 1]
    scaled = corner.objectives.minimised(values) / np.array(corner.values)
    cost: Floats = weight * scaled[:, 0] + (1.0 - weight) * scaled[:, 1]
    return cost
