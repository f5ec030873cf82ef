"""What a search expects of designs that it has not simulated: a polynomial, corrected by its errors near by."""

from functools import cached_property

import numpy as np
from numpy.typing import NDArray
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

_SPREAD_SHARE = 1.0 / 3.0
"""Share of these points that is spread over all designs instead of being nearest the front. Our own choice: with none,
a long front leaves no point behind it, and the polynomial swings there."""

_CORRECTING = 150
"""Points of each part of the front whose errors are interpolated. Our own choice: with as many, errors above half a
percent of the front's extent are half as frequent as with 600 for the whole front, at the same time per design."""
_CORRECTED = 0.1
"""Distance behind the front, as a share of its extent, up to which a point's error is interpolated first."""
_REACH = 1.0
"""Distance, in features from -1 to 1, over which errors are alike. 0.3 and 0.6 were no better."""
_NUGGET = 1e-4
"""Share of an error that its neighbours do not have: jumps are smooth to that degree, and equations stay regular."""


class Prediction:
    """Expected costs and missed constraints of designs, from all that have been simulated.

    A weighted cubic follows the course of the measures. In each part of the front, its errors at the latest designs
    there are interpolated by simple kriging with the Matérn kernel of smoothness 3/2 (Rasmussen and Williams 2006,
    equations 2.25 and 4.17). Close to simulated designs, a prediction is therefore as good as exact. The latest designs
    tell most: a promise that was not kept is not made again.
    """

    def __init__(self, archive: Archive, standing: Standing, features: Features) -> None:
        self._features = features
        self._values = archive.values
        weights = np.exp(-standing.behind / _NEARNESS) + _LEAST_WEIGHT
        missed = archive.constraints
        # In the order of the trials, whatever the weights: a sum in another order has other last digits.
        rows = np.sort(_training(standing.order))
        missed = np.clip(missed[:, (missed[rows] > 0.0).any(axis=0)], -_WORST_SHARE, _WORST_SHARE)
        self._targets = np.hstack((standing.costs, missed))
        self._mean = self._targets[rows].mean(axis=0)
        self._objectives = standing.costs.shape[1]
        self._coefficients = fitted(
            features.terms(archive.values[rows]), self._targets[rows] - self._mean, weights[rows]
        )
        self._standing = standing
        self._shares: dict[int, tuple[Floats, Floats]] = {}

    def rough(self, values: Floats) -> tuple[Floats, Floats]:
        """Costs, shape (n, m), as ``Standing`` has them, and sum of missed constraints, shape (n,), by the cubic."""
        return self._split(self._cubic(values))

    def fine(self, values: Floats) -> tuple[Floats, Floats]:
        """The same with the cubic's errors corrected, in the part of the front that the cubic sees a design in."""
        predicted, points = self._cubic(values), self._features.scaled(values)
        parts = self._standing.parts(predicted[:, : self._objectives])
        for part in np.unique(parts).tolist():
            rows = np.flatnonzero(parts == part)
            known, shares = self._correction(part)
            predicted[rows] += _kernel(points[rows], known) @ shares
        return self._split(predicted)

    def _cubic(self, values: Floats) -> Floats:
        return self._features.terms(values) @ self._coefficients + self._mean

    def _split(self, predicted: Floats) -> tuple[Floats, Floats]:
        costs, missed = predicted[:, : self._objectives], predicted[:, self._objectives :]
        return costs, np.maximum(missed, 0.0).sum(axis=1)

    def _correction(self, part: int) -> tuple[Floats, Floats]:
        """Points of a part of the front, shape (p, f), and how much the error of each counts, shape (p, targets)."""
        if part not in self._shares:
            rows = np.sort(self._latest(part))
            values = self._values[rows]
            points, errors = self._features.scaled(values), self._targets[rows] - self._cubic(values)
            matrix = _kernel(points, points)
            matrix[np.diag_indices_from(matrix)] += _NUGGET
            self._shares[part] = points, np.asarray(cho_solve(cho_factor(matrix, lower=True), errors))
        return self._shares[part]

    def _latest(self, part: int) -> NDArray[np.intp]:
        """Rows of the latest designs in a part of the front and close behind it; the nearest others if too few."""
        standing, known = self._standing, self._known
        if len(standing.posts) == 0:
            return standing.order[:_CORRECTING]
        near = self._near == part
        latest = known[near][-_CORRECTING:]
        if len(latest) == _CORRECTING:
            return latest
        others = np.flatnonzero(~near)
        nearest = others[np.argsort(self._away[part, others], kind="stable")]
        return np.concatenate((latest, known[nearest[: _CORRECTING - len(latest)]]))

    @cached_property
    def _known(self) -> NDArray[np.intp]:
        """Rows of the designs that jumped, in the order of the trials."""
        return np.sort(self._standing.order)

    @cached_property
    def _away(self) -> Floats:
        """Squared distance of these designs from each post, shape (posts, designs)."""
        return self._standing.away(self._standing.costs[self._known])

    @cached_property
    def _near(self) -> NDArray[np.intp]:
        """Part of the front that each of these designs is in or close behind; -1 if it is far behind."""
        return np.where(self._standing.behind[self._known] < _CORRECTED, self._away.argmin(axis=0), -1)


def _training(order: NDArray[np.intp]) -> NDArray[np.intp]:
    """Rows that the polynomial is fitted to: the nearest the front, and others spread evenly over all behind them."""
    if len(order) <= _TRAINING:
        return order
    spread_out = round(_SPREAD_SHARE * _TRAINING)
    nearest, others = np.split(order, [_TRAINING - spread_out])
    return np.concatenate((nearest, others[np.linspace(0, len(others) - 1, spread_out).astype(np.intp)]))


def _kernel(points: Floats, others: Floats) -> Floats:
    """How alike errors are at n points and k others, shape (n, f) and (k, f) -> (n, k): 1 at the same point."""
    away = np.sqrt(squared_distances(points, others) * (3.0 / _REACH**2))
    return np.asarray((1.0 + away) * np.exp(-away))
