"""Keep the simulated designs of a search; find the front and how far the others are behind it. This imports numba."""

from dataclasses import dataclass

import moocore
import numpy as np
from numpy.typing import NDArray
from scipy.spatial.distance import cdist

from pareto_monoped.compute.compiled import compiled
from pareto_monoped.pareto.front import front_mask
from pareto_monoped.search.algorithm import Floats, Scores, Space
from pareto_monoped.search.response_surface import features_of

_POSTS = 20
"""Parts of a front. Our own choice: with 40 designs per generation, two for each part."""
_LEAST_SHARE = 0.01
"""Values that come nearer to 0 have logarithms that rule over all others. Our own choice: two orders of magnitude."""
_LEAST_EXTENT = 0.1
"""Of a front's extent over that of all designs. Our own choice: a gain over a front of two designs, counted in an
extent of almost nothing, would outweigh any violation."""
_APART = 0.01
"""What the distance from the front adds to being behind it. Our own choice: a design that equals the front in one
objective is not behind it by epsilon, however bad the others are, and evolution would vary nothing else."""
TOLERATED = 0.01
"""Greatest expected violation up to which a design can gain. Our own choice: many fronts lie on a limit, which the
model knows to about a percent; with 0, twice the volume of such a front was missed."""
_FEW_DESIGNS = 300
"""Up to which a Gaussian process predicts. Our own choice: with 500, a search of 1,000 designs takes two and a half
times as long and finds as much."""
_FEW_VALUES = 4_800
"""Designs times features up to which it does. Our own choice: 300 designs of 16 features or 184 of 26, with which a
search of 1,500 torques over time takes four fifths of the time and finds as much."""
_MOST = 12_000
"""Designs that an archive holds at most. Our own choice: half as many again as the longest shipped study of this search
has, so that the time per design stays what it is there, however long a search goes on."""
_KEPT = 8_000
"""Designs that stay when there are more."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Standing:
    """How n designs stand to the front."""

    #: objectives, less is better: logarithms where all values are above 0 and those of feasible designs above
    #: ``_LEAST_SHARE`` of the greatest, so that a percent counts as much at 10 J as at 70 J; shape (n, m), NaN where
    #: the jump failed
    costs: Floats
    front: NDArray[np.intp]  #: rows of the designs on the front, by their first cost
    posts: NDArray[np.intp]  #: places in ``front`` that stand for its parts, the best in each objective first
    #: how far each design is behind the front as a share of its extent, plus ``_APART`` of its distance from the front,
    #: plus its violation, shape (n,)
    behind: Floats
    order: NDArray[np.intp]  #: rows of the designs that jumped, the nearest to the front first
    tolerated: float  #: expected violation up to which a design can gain
    low: Floats  #: least costs of the front, shape (m,)
    extent: Floats  #: extent of its costs, shape (m,)
    line: Floats  #: the front's costs as shares of its extent, shape (k, m)

    def scaled(self, costs: Floats) -> Floats:
        """Return costs as shares of the front's extent, shape (n, m)."""
        return (costs - self.low) / self.extent

    @property
    def stands(self) -> Floats:
        """Where the k posts stand, as shares of the front's extent, shape (k, m)."""
        return self.scaled(self.costs[self.front[self.posts]])

    def parts(self, costs: Floats) -> NDArray[np.intp]:
        """Find which of the posts is nearest each of n designs, shape (n, m) -> (n,); 0 without a front."""
        if len(self.posts) == 0:
            return np.zeros(len(costs), dtype=np.intp)
        return np.asarray(cdist(self.scaled(costs), self.stands, "sqeuclidean").argmin(axis=1))


class Archive:
    """Holds the designs that a search has simulated; of more than ``_MOST``, the ``_KEPT`` that tell it most."""

    def __init__(self, space: Space) -> None:
        self.space = space  #: what is searched
        self._features = features_of(space)
        self.values: Floats = np.zeros((0, len(space.names)))  #: values of the designs' variables, shape (n, d)
        self.points: Floats = np.zeros((0, len(self._features.lower)))  #: their ``Features.scaled``, shape (n, f)
        self.constraints: Floats = np.zeros((0, 0))  #: how far each of k constraints is missed, shape (n, k)
        self._objectives: Floats = np.zeros((0, len(space.objectives.names)))
        self._violation: Floats = np.zeros(0)
        # The front of the first designs, and of how many: what has been dominated once stays so.
        self._front, self._fronted = np.zeros(0, dtype=np.intp), 0

    @property
    def few(self) -> bool:
        """Whether there are so few designs that a Gaussian process makes the most of them."""
        return len(self.points) <= _FEW_DESIGNS and self.points.size <= _FEW_VALUES

    def add(self, values: Floats, scores: Scores) -> None:
        """Add simulated designs: points of the space, shape (n, d), and their scores."""
        missed = scores.constraints if scores.constraints.shape[1] else scores.violation[:, None]
        self.constraints = np.vstack((self.constraints, missed)) if len(self.values) else missed
        self.values = np.vstack((self.values, values))
        self.points = np.vstack((self.points, self._features.scaled(values)))
        self._objectives = np.vstack((self._objectives, scores.values))
        self._violation = np.concatenate((self._violation, scores.violation))
        if len(self.values) > _MOST:
            self._keep(_told_most(self.standing(), _KEPT))

    def _keep(self, rows: NDArray[np.intp]) -> None:
        self.values, self.points, self.constraints = self.values[rows], self.points[rows], self.constraints[rows]
        self._objectives, self._violation = self._objectives[rows], self._violation[rows]
        self._front, self._fronted = self._front[:0], 0

    def gained(self, scores: Scores) -> float:
        """Return the hypervolume that scored designs add to the front, or by how much they miss the limits less.

        The front is that of the last ``standing``. Its corner is a tenth of its extent beyond it, our own choice, so
        that its ends can gain, too; the extent is never less than ``_LEAST_EXTENT`` of all designs', as a front of one
        design could not gain otherwise.
        """
        front = self._objectives[self._front] * self.space.objectives.signs
        if len(front) == 0:
            return float(np.maximum(self._violation.min() - scores.violation, 0.0).sum())
        jumped = self._objectives[np.isfinite(self._objectives).all(axis=1)]
        corner = front.max(axis=0) + 0.1 * np.maximum(np.ptp(front, axis=0), _LEAST_EXTENT * np.ptp(jumped, axis=0))
        both = np.vstack((front, scores.minimised()[scores.violation == 0.0]))
        return float(moocore.hypervolume(both, ref=corner) - moocore.hypervolume(front, ref=corner))

    def standing(self, tolerated: float = TOLERATED) -> Standing:
        """Find how the designs stand now."""
        costs = self._costs()
        jumped = np.asarray(np.isfinite(costs).all(axis=1))
        front = self._feasible_front()
        front = front[np.argsort(costs[front, 0], kind="stable")]
        low, extent = np.zeros(costs.shape[1]), np.ones(costs.shape[1])
        posts, behind = np.zeros(0, dtype=np.intp), self._violation.copy()
        line = np.zeros((0, costs.shape[1]))
        if len(front):
            low = costs[front].min(axis=0)
            span = np.maximum(np.ptp(costs[front], axis=0), _LEAST_EXTENT * np.ptp(costs[jumped], axis=0))
            extent = np.where(span > 0.0, span, 1.0)
            scaled = (costs[front] - low) / extent
            posts = _posts(scaled)
            points = (np.where(jumped[:, None], costs, low) - low) / extent
            away = cdist(points, scaled[posts], "chebyshev").min(axis=1)
            away[front] = 0.0
            behind += np.maximum(shortfall(points, scaled[posts]), 0.0) + _APART * away
            line = scaled
        # Of equals the newest first: a long front is known best where the search is now.
        order = len(behind) - 1 - np.argsort(behind[::-1], kind="stable")
        return Standing(
            costs=costs,
            front=front,
            posts=posts,
            behind=behind,
            order=order[jumped[order]],
            tolerated=tolerated,
            low=low,
            extent=extent,
            line=line,
        )

    def _feasible_front(self) -> NDArray[np.intp]:
        """Return rows of the designs on the front, in their order."""
        rows = np.concatenate((self._front, np.arange(self._fronted, len(self.values))))
        on_it = front_mask(self._objectives[rows], self.space.objectives, self._violation[rows] == 0.0)
        self._front, self._fronted = rows[on_it], len(self.values)
        return self._front

    def _costs(self) -> Floats:
        values, feasible = self._objectives, self._objectives[self._violation == 0.0]
        graded = ~(values <= 0.0).any(axis=0)
        if len(feasible):
            graded &= feasible.min(axis=0) > _LEAST_SHARE * feasible.max(axis=0)
        logarithms = np.log(np.where(graded, values, 1.0))
        return np.where(graded, logarithms, values) * self.space.objectives.signs


def _told_most(standing: Standing, count: int) -> NDArray[np.intp]:
    """Choose rows of up to ``count`` designs that tell a search most, in the order of the trials.

    Half of them may be the front, evenly thinned; three quarters of the others are the nearest behind it, the rest are
    spread evenly over what lies farther.
    """
    front = standing.front
    if len(front) > count // 2:
        front = front[np.linspace(0, len(front) - 1, count // 2).astype(np.intp)]
    behind = standing.order[~np.isin(standing.order, standing.front)]
    nearest, others = np.split(behind, [min(len(behind), (count - len(front)) * 3 // 4)])
    left = min(count - len(front) - len(nearest), len(others))
    spread = others[np.linspace(0, len(others) - 1, left).astype(np.intp)] if left else others[:0]
    return np.sort(np.concatenate((front, nearest, spread)))


def shortfall(points: Floats, front: Floats) -> Floats:
    """Measure how far points are behind a front, shape (n,): the shift in all objectives after which none is dominated.

    The additive epsilon indicator (Zitzler et al. 2003) of the front, shape (k, m), against each point, shape (n, m);
    less is better, and a point that gains over the front is below 0.
    """
    if front.shape[1] > 2:
        return _shortfall_of_more(points, front)
    line = front[np.lexsort((-front[:, 1], front[:, 0]))]
    # The lesser of what is missing in either objective is greatest where the two cross along the front.
    crossing = np.searchsorted(line[:, 0] - line[:, 1], points[:, 0] - points[:, 1])
    either = np.stack((np.maximum(crossing - 1, 0), np.minimum(crossing, len(line) - 1)))
    return np.asarray(np.minimum(points[:, 0] - line[either, 0], points[:, 1] - line[either, 1]).max(axis=0))


@compiled
def _shortfall_of_more(points: Floats, front: Floats) -> Floats:
    """Compute ``shortfall`` for any number of objectives."""
    columns = points.T.copy()
    result, least = np.full(points.shape[0], -np.inf), np.empty(points.shape[0])
    # The points are the innermost loop: a processor takes several of them at once.
    for k in range(front.shape[0]):
        least[:] = np.inf
        for m in range(columns.shape[0]):
            value, column = front[k, m], columns[m]
            for n in range(least.shape[0]):
                least[n] = min(least[n], column[n] - value)
        for n in range(least.shape[0]):
            result[n] = max(result[n], least[n])
    return result


def _posts(front: Floats) -> NDArray[np.intp]:
    """Choose rows that stand for a front's parts: the best in each objective, then always the farthest from them."""
    chosen = list(dict.fromkeys(front.argmin(axis=0).tolist()))
    away = cdist(front, front[chosen], "sqeuclidean").min(axis=1)
    while len(chosen) < _POSTS and away.max() > 0.0:
        chosen.append(int(away.argmax()))
        away = np.minimum(away, cdist(front, front[chosen[-1:]], "sqeuclidean")[:, 0])
    return np.array(chosen, dtype=np.intp)
