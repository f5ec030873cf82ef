"""Predict the scores of designs by a polynomial corrected by its errors near by, and rank what is worth simulating."""

from collections.abc import Callable
from concurrent.futures import Executor
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree
from scipy.spatial.distance import cdist

from pareto_monoped.search.algorithm import Floats
from pareto_monoped.search.archive import Archive, Standing, shortfall
from pareto_monoped.search.kriging import kriging_factors, kriging_shares, kriging_values
from pareto_monoped.search.response_surface import Features, cubic_values, fitted

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
_SCALE = 3.0 / _REACH**2
"""Of squared distances in the kernel (Rasmussen and Williams 2006, equation 4.17)."""
_NUGGET = 1e-4
"""Share of an error that its neighbours do not have: jumps are smooth to that degree, and equations stay regular."""

_NEIGHBOURS = 4
"""Designs whose failures are counted around one. Our own choice: one failure among them keeps a design from promising a
gain, which of 4 to 12 neighbours and shares of 0.2 to 0.5 wasted the fewest jumps, at the same hypervolume."""
_FAIL_OFTEN = 0.02
"""Share of failed jumps from which on they are learned; our own choice: below, looking for neighbours costs more time
than the jumps that it saves."""
_SHARED = 100
"""Designs of half a table that are worth a thread of their own: they take it a tenth of a millisecond. Our own choice.
"""


class Prediction:
    """Expected costs and missed constraints of designs, from all that have been simulated.

    A weighted cubic follows the course of the measures. In each part of the front, its errors at the latest designs
    there are interpolated by simple kriging with the Matérn kernel of smoothness 3/2 (Rasmussen and Williams 2006,
    equations 2.25 and 4.17), so that predictions close to simulated designs are as good as exact.
    """

    def __init__(
        self, archive: Archive, standing: Standing, features: Features, helper: Executor | None = None
    ) -> None:
        """Make a model of an archive; ``helper``, idle when it is asked, takes half of the designs to predict."""
        self._features, self._helper = features, helper
        self._points = archive.points
        missed = archive.constraints
        # In the order of the trials, whatever the weights: a sum in another order has other last digits.
        self._rows = np.sort(_training(standing.order))
        missed = np.clip(missed[:, (missed[self._rows] > 0.0).any(axis=0)], -_WORST_SHARE, _WORST_SHARE)
        self._targets = np.hstack((standing.costs, missed))
        self._mean = self._targets[self._rows].mean(axis=0)
        self._objectives = standing.costs.shape[1]
        self._standing = standing

    def fit(self) -> None:
        """Fit the cubic, which otherwise is done when it is first needed."""
        _ = self._coefficients

    def look_around(self) -> None:
        """Find the designs that correct the cubic; otherwise done when they are first needed."""
        _ = self._neighbours

    @cached_property
    def _coefficients(self) -> Floats:
        rows = self._rows
        weights = np.exp(-self._standing.behind / _NEARNESS) + _LEAST_WEIGHT
        return fitted(self._points[rows], self._targets[rows] - self._mean, weights[rows])

    @property
    def determined(self) -> bool:
        """Whether the cubic is fitted to at least as many designs as it has terms; far from them it guesses if not."""
        return len(self._standing.order) >= len(self._coefficients)

    def rough(self, values: Floats) -> tuple[Floats, Floats]:
        """Return costs, shape (n, m), as ``Standing`` has them, and sums of missed constraints, (n,), by the cubic."""
        return self._split(self._halved(self._cubic, values))

    def fine(self, values: Floats) -> tuple[Floats, Floats]:
        """Return the same with the cubic's errors corrected in the part of the front that a design seems to be in."""
        _ = self._shares, self._tree  # which both threads need
        return self._split(self._halved(self._corrected, values))

    def _halved(self, predict: Callable[[Floats], Floats], values: Floats) -> Floats:
        """Return ``predict`` of the features of designs, shape (n, d); the helper does half if there are many."""
        points, half = self._features.scaled(values), len(values) // 2

        def whole(some: Floats) -> Floats:
            return np.column_stack((predict(some), self._failing(some)))

        if self._helper is None or half < _SHARED:
            return whole(points)
        later = self._helper.submit(whole, points[half:])
        return np.vstack((whole(points[:half]), later.result()))

    def _failing(self, points: Floats) -> Floats:
        """Return the share of failed jumps among the nearest designs, shape (n,); a violation like any other."""
        if self._tree is None:
            return np.zeros(len(points))
        share: Floats = self._failed[self._tree.query(points, k=_NEIGHBOURS)[1]].mean(axis=1)
        return share

    @cached_property
    def _failed(self) -> NDArray[np.bool_]:
        return np.asarray(~np.isfinite(self._standing.costs).all(axis=1))

    @cached_property
    def _tree(self) -> cKDTree | None:
        """All designs by their features; None where hardly any jump fails, or there are few."""
        often = np.count_nonzero(self._failed) > _FAIL_OFTEN * len(self._failed)
        return cKDTree(self._points) if often and len(self._points) >= _NEIGHBOURS else None

    def _corrected(self, points: Floats) -> Floats:
        predicted = self._cubic(points)
        parts = self._standing.parts(predicted[:, : self._objectives])
        known = self._neighbours
        predicted += kriging_values(points, parts, known.points, self._shares, known.ends, _SCALE)
        return predicted

    def _cubic(self, points: Floats) -> Floats:
        predicted: Floats = cubic_values(points, self._coefficients) + self._mean
        return predicted

    def _split(self, predicted: Floats) -> tuple[Floats, Floats]:
        costs, missed = predicted[:, : self._objectives], predicted[:, self._objectives :]
        return costs, np.maximum(missed, 0.0).sum(axis=1)  # the last column is ``_failing``

    @cached_property
    def _neighbours(self) -> "_Neighbours":
        """What corrects the cubic in each part of the front; without a front, there is one part."""
        groups = [np.sort(self._latest(part)) for part in range(max(len(self._standing.posts), 1))]
        rows, ends = np.concatenate(groups), np.cumsum([len(group) for group in groups])
        points = self._points[rows]
        return _Neighbours(rows, points, ends, kriging_factors(points, ends, _SCALE, _NUGGET))

    @cached_property
    def _shares(self) -> Floats:
        """How much the error of each of ``_neighbours`` counts, shape (n, targets)."""
        known = self._neighbours
        return kriging_shares(known.factors, self._targets[known.rows] - self._cubic(known.points), known.ends)

    def _latest(self, part: int) -> NDArray[np.intp]:
        """Return rows of the latest designs in or close behind a part of the front, the nearest others if too few."""
        standing, known = self._standing, self._known
        if len(standing.posts) == 0:
            return standing.order[:_CORRECTING]
        near = self._near == part
        latest: NDArray[np.intp] = known[near][-_CORRECTING:]
        if len(latest) == _CORRECTING:
            return latest
        others = np.flatnonzero(~near)
        nearest = _least(self._away(part)[others], _CORRECTING - len(latest))
        return np.concatenate((latest, known[others[nearest]]))

    @cached_property
    def _known(self) -> NDArray[np.intp]:
        """Rows of the designs that jumped, in the order of the trials."""
        return np.flatnonzero(np.isfinite(self._standing.costs).all(axis=1))

    @cached_property
    def _places(self) -> Floats:
        """Costs of these designs as shares of the front's extent, shape (designs, m)."""
        return self._standing.scaled(self._standing.costs[self._known])

    def _away(self, part: int) -> Floats:
        """Return the squared distance of these designs from a post, shape (designs,)."""
        away: Floats = cdist(self._standing.stands[part : part + 1], self._places, "sqeuclidean")[0]
        return away

    @cached_property
    def _near(self) -> NDArray[np.intp]:
        """Part of the front that each of these designs is in or close behind; -1 if it is far behind."""
        nearest = self._standing.parts(self._standing.costs[self._known])
        return np.where(self._standing.behind[self._known] < _CORRECTED, nearest, -1)


def _training(order: NDArray[np.intp]) -> NDArray[np.intp]:
    """Return rows to fit: the nearest the front, and others spread evenly over all behind them."""
    if len(order) <= _TRAINING:
        return order
    spread_out = round(_SPREAD_SHARE * _TRAINING)
    nearest, others = np.split(order, [_TRAINING - spread_out])
    return np.concatenate((nearest, others[np.linspace(0, len(others) - 1, spread_out).astype(np.intp)]))


def _least(values: Floats, count: int) -> NDArray[np.intp]:
    """Return places of the ``count`` least values, shape (n,) -> (count,), the least first; ties in their order."""
    if count >= len(values):
        return np.argsort(values, kind="stable")
    candidates = np.flatnonzero(values <= np.partition(values, count - 1)[count - 1])
    return candidates[np.argsort(values[candidates], kind="stable")[:count]]


class _Neighbours(NamedTuple):
    """Designs in all parts of a front, one part after the other."""

    rows: NDArray[np.intp]  #: of the archive, shape (n,)
    points: Floats  #: their features, shape (n, f)
    ends: NDArray[np.intp]  #: number of points up to the end of each part, shape (parts,)
    factors: Floats  #: of the parts' equations, see ``kriging_factors``


_PENALTY = 10.0
"""Gain that an expected violation costs: a limit missed by a percent outweighs a gain of a tenth of the front."""
MISSED = 0.01
"""Expected violation from which on a design gains nothing. Our own choice: many fronts lie on a limit, which the model
knows to about a percent; with 0, twice the volume of such a front was missed."""
LENIENT_PENALTY = 1.0
"""The same far from all simulated designs, where the model knows little of constraints. Our own choice."""
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
    if len(standing.front) == 0:
        return np.argsort(violation, kind="stable")
    gain = gains(costs, violation, standing)
    order = np.argsort(-gain, kind="stable")
    return order[_in_turns(standing.parts(costs)[order])]


def _in_turns(parts: NDArray[np.intp]) -> NDArray[np.intp]:
    """Return the first row of each part, then the second of each, and so on, shape (n,) -> (n,)."""
    order = np.argsort(parts, kind="stable")
    turns = np.empty_like(order)
    turns[order] = np.arange(len(parts)) - np.searchsorted(parts[order], parts[order])
    return np.argsort(turns, kind="stable")


def unlike(
    costs: Floats, violation: Floats, standing: Standing, points: Floats, known: Floats, count: int
) -> list[int]:
    """Choose rows of ``count`` of n designs that promise much and are far from ``known`` features and each other."""
    gain = gains(costs, violation, standing, LENIENT_PENALTY)
    looked_at = np.argsort(-gain, kind="stable")[: count * _LOOKED_AT]
    points, gain = points[looked_at], gain[looked_at]
    away = cdist(points, known).min(axis=1)
    chosen: list[int] = []
    for _ in range(min(count, len(points))):
        worth = gain + CURIOSITY * np.minimum(away, 1.0)
        worth[chosen] = -np.inf
        chosen.append(int(worth.argmax()))
        away = np.minimum(away, cdist(points, points[chosen[-1:]])[:, 0])
    best: list[int] = looked_at[chosen].tolist()
    return best


def gains(costs: Floats, violation: Floats, standing: Standing, penalty: float = _PENALTY) -> Floats:
    """Return how far n designs are ahead of the front, as a share of its extent, less what violations cost: (n,)."""
    gain = -shortfall(standing.scaled(costs), standing.line)
    return np.where(violation > MISSED, np.minimum(gain, 0.0), gain) - penalty * violation
