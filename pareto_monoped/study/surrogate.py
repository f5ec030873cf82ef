"""Surrogate-assisted search: many offspring, ranked by a cheap model; the most promising are simulated."""

from collections.abc import Iterable
from typing import Any

import numpy as np

from pareto_monoped.study.algorithm_settings import SurrogateSettings
from pareto_monoped.study.archive import Archive, Standing, shortfall
from pareto_monoped.study.protocol import Floats, Proposal, Scores, Space
from pareto_monoped.study.response_surface import Features, features_of, fitted
from pareto_monoped.study.seen import Seen, drawn
from pareto_monoped.study.variation import offspring, spread

_TRAINING = 1700
"""Points that the model is fitted to, eight per term of nine features. Our own choice; more takes longer and was no
better."""
_NEARNESS = 0.15
"""Distance behind the front, as a share of its extent, at which a point's weight in the fit has fallen to 1/e."""
_LEAST_WEIGHT = 1e-3
"""Weight of points far from the front, which keep the polynomial from swinging where there are no others."""
_WORST_SHARE = 1.0
"""Constraints count up to this share of their limit, so that safety factors of 1,000 do not rule the fit."""

_PENALTY = 10.0
"""Gain that a predicted violation costs: a limit missed by a percent outweighs a gain of a tenth of the front."""


class SurrogateSearch:
    """Evolution that simulates the most promising of many offspring.

    The first generations are spread over the space. Later, each generation varies the designs on the front so far,
    predicts objectives and constraints of the offspring by a polynomial that is fitted to the simulated designs near
    the front, and asks for those that gain most over the front, the best of each part of it first: the ends of the
    front are parts, too. Every generation has its own random generator, whose seed follows from the study's. The
    simulated designs are therefore the whole state, and a search rebuilt from them continues bit for bit.
    """

    def __init__(self, space: Space, settings: SurrogateSettings, seed: int) -> None:
        self._space = space
        self._settings = settings
        self._seed = seed
        self._generation = 0
        self._seen = Seen()
        self._archive = Archive(space)
        self._features: Features = features_of(space)
        self._asked = np.zeros((0, len(space.names)))

    def ask(self) -> Proposal | None:
        """Designs spread over the space, later the most promising offspring; None if there is no new design."""
        generator = np.random.default_rng([self._seed, self._generation])
        size = self._settings.population
        standing = self._archive.standing()
        if self._generation < self._settings.drawn_generations or len(standing.order) == 0:
            chosen = spread(self._space, size, generator)
        else:
            chosen = offspring(self._archive, standing, self._settings, generator)
        chosen = chosen[self._seen.new(chosen)]
        if len(chosen) > size:
            chosen = chosen[self._most_promising(chosen, standing)[:size]]
        if len(chosen) == 0:
            chosen = drawn(self._space, self._seen, generator, size)
        self._asked = chosen
        return Proposal(values=chosen) if len(chosen) else None

    def tell(self, scores: Scores) -> None:
        """Add the designs to what the model is fitted to."""
        self._add(self._asked, scores)
        self._generation += 1

    def state(self) -> dict[str, Any]:
        """The number of generations; the designs are in the database."""
        return {"generation": self._generation}

    def restore(self, state: dict[str, Any], history: Iterable[tuple[Floats, Scores]]) -> None:
        """Add the designs of the history."""
        for values, scores in history:
            self._add(values, scores)
        self._generation = int(state["generation"])

    def _add(self, values: Floats, scores: Scores) -> None:
        self._seen.add(values)
        self._archive.add(values, scores)

    def _most_promising(self, values: Floats, standing: Standing) -> list[int]:
        """Rows of ``values``, shape (n, d), in the order in which they are worth simulating."""
        costs, violation = self._predicted(values, standing)
        if len(standing.front) == 0:
            return np.argsort(violation, kind="stable").tolist()
        front = standing.scaled(standing.costs[standing.front])
        points = standing.scaled(costs)
        gain = -shortfall(points, front) - _PENALTY * violation
        parts = front[standing.posts]
        part = np.stack([np.square(points - post).sum(axis=1) for post in parts]).argmin(axis=0)
        order = np.argsort(-gain, kind="stable")
        place = np.empty(len(values), dtype=np.intp)
        for k in range(len(parts)):
            members = order[part[order] == k]
            place[members] = np.arange(len(members))
        return np.lexsort((-gain, place)).tolist()

    def _predicted(self, values: Floats, standing: Standing) -> tuple[Floats, Floats]:
        """Predicted costs, shape (n, m), as ``Standing`` has them, and sum of missed constraints, shape (n,)."""
        weights = np.exp(-standing.behind / _NEARNESS) + _LEAST_WEIGHT
        # In the order of the trials, whatever the weights: a sum in another order has other last digits.
        rows = np.sort(standing.order[:_TRAINING])
        costs, missed = standing.costs[rows], self._archive.constraints[rows]
        missed = np.clip(missed[:, (missed > 0.0).any(axis=0)], -_WORST_SHARE, _WORST_SHARE)
        targets = np.hstack((costs, missed))
        mean = targets.mean(axis=0)
        coefficients = fitted(self._features.terms(self._archive.values[rows]), targets - mean, weights[rows])
        predicted = self._features.terms(values) @ coefficients + mean
        objectives = costs.shape[1]
        return predicted[:, :objectives], np.maximum(predicted[:, objectives:], 0.0).sum(axis=1)
