"""Predict the scores of designs from those of simulated ones, and rank what is worth simulating."""

from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import solve
from scipy.spatial.distance import cdist
from scipy.special import expit

from pareto_monoped.search.algorithm import Floats
from pareto_monoped.search.archive import Archive, Standing, shortfall
from pareto_monoped.search.response_surface import Features, GaussianProcess, fitted, log_odds, terms

_TRAINING = 1700
"""Points that the polynomial is fitted to, eight per term of nine features. Our own choice; more takes longer and was
no better."""
_NEARNESS = 0.15
"""Distance behind the front, as a share of its extent, at which a point's weight in the fit has fallen to 1/e."""
_LEAST_WEIGHT = 1e-3
"""Weight of points far from the front, which keep the polynomial from swinging where there are no others."""
_BEST_SHARE = -1.0
"""A constraint that holds counts up to this share of its limit, so that safety factors of 1,000 do not rule the fit."""

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

_RISK = 0.1
"""Chance that a jump fails up to which a design is as good as one that jumps. Our own choice: of 1,500 jumps with wide
bounds, 6 percent fail with 0.1 and 15 percent with 0.3, and the front is as good."""
_CUBIC_UP_TO = 16
"""Features that a cubic has at most; of more, the model is a quadratic. Our own choice: a cubic of 16 has 969 terms, as
many as a search of 1,000 designs can determine, and one of 30 has 5,456."""


class Prediction:
    """Expected costs and missed constraints of designs, from all that have been simulated.

    A Gaussian process makes the most of few designs. For more, a weighted polynomial follows the course of the
    measures. In each part of the front, its errors at the latest designs there are interpolated by simple kriging
    with the Matérn kernel of smoothness 3/2 (Rasmussen and Williams 2006, equations 2.25 and 4.17), so that predictions
    close to simulated designs are as good as exact.
    """

    def __init__(self, archive: Archive, standing: Standing, features: Features) -> None:
        """Fit the model to an archive."""
        self._features, self._points, self._standing = features, archive.points, standing
        # Which jumps fail is learned from all trials, wherever they are.
        jumped: NDArray[np.bool_] = np.asarray(np.isfinite(standing.costs).all(axis=1))
        self._known = np.flatnonzero(jumped)  # in the order of the trials
        self._risk: Floats | None = None
        if not jumped.all():
            self._risk = log_odds(self._terms(self._points, 2), ~jumped)
        # In the order of the trials, whatever the weights: a sum in another order has other last digits.
        rows = np.sort(_training(standing.order))
        missed = archive.constraints
        missed = np.maximum(missed[:, (missed[rows] > 0.0).any(axis=0)], _BEST_SHARE)
        # Far beyond a limit, the order of magnitude says which way to go.
        missed = np.where(missed > 0.0, np.log1p(np.maximum(missed, 0.0)), missed)
        self._targets = np.hstack((standing.costs, missed))
        self._objectives = standing.costs.shape[1]
        self._process: GaussianProcess | None = None
        if archive.few:
            self._process = GaussianProcess(self._points[self._known], self._targets[self._known])
            return
        self._mean = self._targets[rows].mean(axis=0)
        weights = np.exp(-standing.behind[rows] / _NEARNESS) + _LEAST_WEIGHT
        self._degree = 3 if features.smooth <= _CUBIC_UP_TO else 2
        products = self._terms(self._points[rows], self._degree)
        self._coefficients = fitted(products, self._targets[rows] - self._mean, weights)

    @property
    def determined(self) -> bool:
        """Whether climbs may follow the model: a cubic of fewer designs than terms guesses, a quadratic is too coarse.

        Our own choice: with 25 variables, climbs on a quadratic make searches of 1,500 designs 3 percent worse.
        """
        return self._process is not None or (self._degree == 3 and len(self._known) >= len(self._coefficients))

    def rough(self, values: Floats) -> tuple[Floats, Floats]:
        """Return costs, shape (n, m), as ``Standing`` has them, and what they miss, (n,), by the trend."""
        points = self._features.scaled(values)
        return self._split(points, self._trend(points))

    def hoped(self, values: Floats) -> tuple[Floats, Floats]:
        """Return the same, better by a standard deviation where it is known: what exploring may find."""
        points = self._features.scaled(values)
        hoped = self._trend(points)
        if self._process is not None:
            hoped -= self._process.deviation(points)
        return self._split(points, hoped)

    def fine(self, values: Floats) -> tuple[Floats, Floats]:
        """Return the same with the trend's errors corrected in the part of the front that a design seems to be in."""
        points = self._features.scaled(values)
        predicted = self._trend(points)
        if self._process is not None:
            return self._split(points, predicted)
        parts = self._standing.parts(predicted[:, : self._objectives])
        for part in np.unique(parts).tolist():
            known, shares = self._corrections[part]
            predicted[parts == part] += _alike(points[parts == part], known) @ shares
        return self._split(points, predicted)

    def _trend(self, points: Floats) -> Floats:
        if self._process is not None:
            return self._process.mean(points)
        predicted: Floats = self._terms(points, self._degree) @ self._coefficients + self._mean
        return predicted

    def _terms(self, points: Floats, degree: int) -> Floats:
        return terms(points[:, : self._features.smooth], degree)

    def _split(self, points: Floats, predicted: Floats) -> tuple[Floats, Floats]:
        violation = np.maximum(predicted[:, self._objectives :], 0.0).sum(axis=1)
        if self._risk is not None:
            violation += np.maximum(expit(self._terms(points, 2) @ self._risk) - _RISK, 0.0)
        return predicted[:, : self._objectives], violation

    @cached_property
    def _corrections(self) -> list[tuple[Floats, Floats]]:
        """Points near each part of the front, and how much the error of each counts; one part without a front."""
        found = []
        for part in range(max(len(self._standing.posts), 1)):
            rows = np.sort(self._latest(part))
            points = self._points[rows]
            alike = _alike(points, points)
            alike[np.diag_indices_from(alike)] += _NUGGET
            found.append((points, solve(alike, self._targets[rows] - self._trend(points), assume_a="pos")))
        return found

    def _latest(self, part: int) -> NDArray[np.intp]:
        """Return rows of the latest designs in or close behind a part of the front, the nearest others if too few."""
        standing, known = self._standing, self._known
        if len(standing.posts) == 0:
            return standing.order[:_CORRECTING]
        near = self._near == part
        latest: NDArray[np.intp] = known[near][-_CORRECTING:]
        others = known[~near]
        away = cdist(standing.stands[part : part + 1], standing.scaled(standing.costs[others]), "sqeuclidean")[0]
        return np.concatenate((latest, others[np.argsort(away, kind="stable")[: _CORRECTING - len(latest)]]))

    @cached_property
    def _near(self) -> NDArray[np.intp]:
        """Part of the front that each design which jumped is in or close behind; -1 if it is far behind."""
        standing, known = self._standing, self._known
        return np.where(standing.behind[known] < _CORRECTED, standing.parts(standing.costs[known]), -1)


def _alike(points: Floats, others: Floats) -> Floats:
    """Return how alike errors are at points, shapes (n, f) and (k, f) -> (n, k)."""
    distance = cdist(points, others) * (np.sqrt(3.0) / _REACH)
    alike: Floats = (1.0 + distance) * np.exp(-distance)
    return alike


def _training(order: NDArray[np.intp]) -> NDArray[np.intp]:
    """Return rows to fit: the nearest the front, and others spread evenly over all behind them."""
    if len(order) <= _TRAINING:
        return order
    spread_out = round(_SPREAD_SHARE * _TRAINING)
    nearest, others = np.split(order, [_TRAINING - spread_out])
    return np.concatenate((nearest, others[np.linspace(0, len(others) - 1, spread_out).astype(np.intp)]))


PENALTY = 10.0
"""Gain that an expected violation costs: a limit missed by a percent outweighs a gain of a tenth of the front."""
_LOOKED_AT = 25
"""Designs whose distance to the known ones is measured, the most promising, for each that is chosen."""
CURIOSITY = 0.1
"""Gain that a distance of 1, in features from -1 to 1, is worth: errors of the model at that distance have this order.
"""


def ranked(costs: Floats, violation: Floats, standing: Standing) -> NDArray[np.intp]:
    """Sort n designs by what simulating them is worth, from expected costs, (n, m), and violations, (n,).

    The best gain over the front in each of its parts comes first, then the second best, and so on. Without a front, the
    least violation comes first.
    """
    gain = gains(costs, violation, standing)
    order = np.argsort(-gain, kind="stable")
    return order[_in_turns(standing.parts(costs)[order])]


def _in_turns(parts: NDArray[np.intp]) -> NDArray[np.intp]:
    """Return the first row of each part, then the second of each, and so on, shape (n,) -> (n,)."""
    order = np.argsort(parts, kind="stable")
    turns = np.empty_like(order)
    turns[order] = np.arange(len(parts)) - np.searchsorted(parts[order], parts[order])
    return np.argsort(turns, kind="stable")


def unlike(worth: Floats, points: Floats, known: Floats, count: int, curiosity: float = CURIOSITY) -> list[int]:
    """Choose ``count`` of n rows that are worth much and far from ``known`` features and each other.

    ``worth`` has shape (n,), ``points`` and ``known`` are features, shapes (n, f) and (k, f).
    """
    looked_at = np.argsort(-worth, kind="stable")[: count * _LOOKED_AT]
    points, worth = points[looked_at], worth[looked_at]
    away = cdist(points, known).min(axis=1)
    chosen: list[int] = []
    for _ in range(min(count, len(points))):
        attraction = worth + curiosity * away
        attraction[chosen] = -np.inf
        chosen.append(int(attraction.argmax()))
        away = np.minimum(away, cdist(points, points[chosen[-1:]])[:, 0])
    best: list[int] = looked_at[chosen].tolist()
    return best


def gains(costs: Floats, violation: Floats, standing: Standing) -> Floats:
    """Return how far n designs are ahead of the front, as a share of its extent, less what violations cost: (n,).

    Without a front, only violations count.
    """
    if len(standing.front) == 0:
        return -violation
    gain = -shortfall(standing.scaled(costs), standing.line)
    return np.where(violation > standing.tolerated, np.minimum(gain, 0.0), gain) - PENALTY * violation
