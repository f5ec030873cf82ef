"""What a search expects of designs that it has not simulated: a polynomial, corrected by its errors near by."""

from functools import cached_property

import numpy as np
from scipy.linalg import cho_factor, cho_solve

from pareto_monoped.study.archive import Archive, Standing
from pareto_monoped.study.promise import squared_distances
from pareto_monoped.study.protocol import Floats
from pareto_monoped.study.response_surface import Features, fitted

_TRAINING = 1700
"""Points that the polynomial is fitted to, eight per term of nine features. Our own choice; more takes longer and was
no better."""
_NEARNESS = 0.15
"""Distance behind the front, as a share of its extent, at which a point's weight in the fit has fallen to 1/e."""
_LEAST_WEIGHT = 1e-3
"""Weight of points far from the front, which keep the polynomial from swinging where there are no others."""
_WORST_SHARE = 1.0
"""Constraints count up to this share of their limit, so that safety factors of 1,000 do not rule the fit."""

_CORRECTING = 600
"""Points whose errors are interpolated. Our own choice: with 600 the median error of a prediction is a third of the
polynomial's, and the equations take a quarter of a millisecond per design."""
_REACH = 1.0
"""Distance, in features from -1 to 1, over which errors are alike. 0.3 and 0.6 were no better."""
_NUGGET = 1e-4
"""Share of an error that its neighbours do not have: jumps are smooth to that degree, and equations stay regular."""


class Prediction:
    """Expected costs and missed constraints of designs, from all that have been simulated.

    A weighted cubic follows the course of the measures. Its errors at the simulated designs nearest the front are
    interpolated by simple kriging with the Matérn kernel of smoothness 3/2 (Rasmussen and Williams 2006, equations 2.25
    and 4.17). Close to simulated designs, a prediction is therefore as good as exact.
    """

    def __init__(self, archive: Archive, standing: Standing, features: Features) -> None:
        self._features = features
        self._values = archive.values
        weights = np.exp(-standing.behind / _NEARNESS) + _LEAST_WEIGHT
        missed = archive.constraints
        # In the order of the trials, whatever the weights: a sum in another order has other last digits.
        rows = np.sort(standing.order[:_TRAINING])
        missed = np.clip(missed[:, (missed[rows] > 0.0).any(axis=0)], -_WORST_SHARE, _WORST_SHARE)
        self._targets = np.hstack((standing.costs, missed))
        self._mean = self._targets[rows].mean(axis=0)
        self._objectives = standing.costs.shape[1]
        self._coefficients = fitted(
            features.terms(archive.values[rows]), self._targets[rows] - self._mean, weights[rows]
        )
        self._near = np.sort(standing.order[:_CORRECTING])

    def rough(self, values: Floats) -> tuple[Floats, Floats]:
        """Costs, shape (n, m), as ``Standing`` has them, and sum of missed constraints, shape (n,), by the cubic."""
        return self._split(self._cubic(values))

    def fine(self, values: Floats) -> tuple[Floats, Floats]:
        """The same with the cubic's errors corrected."""
        correction = _kernel(self._features.scaled(values), self._points) @ self._shares
        return self._split(self._cubic(values) + correction)

    def _cubic(self, values: Floats) -> Floats:
        return self._features.terms(values) @ self._coefficients + self._mean

    def _split(self, predicted: Floats) -> tuple[Floats, Floats]:
        costs, missed = predicted[:, : self._objectives], predicted[:, self._objectives :]
        return costs, np.maximum(missed, 0.0).sum(axis=1)

    @cached_property
    def _points(self) -> Floats:
        return self._features.scaled(self._values[self._near])

    @cached_property
    def _shares(self) -> Floats:
        """How much the error of each point counts, shape (points, targets)."""
        errors = self._targets[self._near] - self._cubic(self._values[self._near])
        matrix = _kernel(self._points, self._points)
        matrix[np.diag_indices_from(matrix)] += _NUGGET
        return np.asarray(cho_solve(cho_factor(matrix, lower=True), errors))


def _kernel(points: Floats, others: Floats) -> Floats:
    """How alike errors are at n points and k others, shape (n, f) and (k, f) -> (n, k): 1 at the same point."""
    away = np.sqrt(squared_distances(points, others) * (3.0 / _REACH**2))
    return np.asarray((1.0 + away) * np.exp(-away))
