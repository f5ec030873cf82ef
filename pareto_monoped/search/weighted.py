"""Search as the paper does: by CMA-ES on a weighted cost of two objectives, one run per weight."""

from collections.abc import Iterable
from itertools import islice
from typing import Any

import numpy as np

from pareto_monoped.definition.algorithms import WeightedSettings
from pareto_monoped.pareto.objectives import HEIGHT_AND_ENERGY, ReferencePoint
from pareto_monoped.search.algorithm import Algorithm, Floats, Proposal, Scores, Space


def weighted_cost(values: Floats, weight: float, corner: ReferencePoint, height_scale_j: float) -> Floats:
    """Return the cost of n designs by two objectives, shape (n, 2) -> (n,); less is better.

    For the paper's objectives lambda1 Kh exp(-h) + lambda2 E, with lambda2 = 1 - lambda1 (paper, section III-B, and the
    commented-out passage on C_h in its source). For any other two the sum of w f1 / s1 and (1 - w) f2 / s2, where each
    f is the measure with the sign that makes less better, and its scale s is its value at the study's reference point:
    a number of the size of its values, which does not change while the search runs. Our own choice.
    """
    if corner.objectives == HEIGHT_AND_ENERGY:
        return weight * height_scale_j * np.exp(-values[:, 0]) + (1.0 - weight) * values[:, 1]
    scaled = corner.objectives.minimised(values) / np.array(corner.values)
    cost: Floats = weight * scaled[:, 0] + (1.0 - weight) * scaled[:, 1]
    return cost


class WeightedSearch(Algorithm):
    """Runs CMA-ES (Hansen's ``cma``) on ``weighted_cost``, for one weight after the other.

    A run ends after ``iterations``, or earlier when CMA-ES has converged. To restore, the current run is replayed from
    its history, which is exact because each run has its own random generator.
    """

    def __init__(
        self, space: Space, settings: WeightedSettings, start: Floats, seed: int, corner: ReferencePoint
    ) -> None:
        """Begin with the first weight at ``start``, a point of the space, shape (d,)."""
        self._space = space
        self._settings = settings
        self._seed = seed
        self._corner = corner
        lower, upper = space.edges
        self._start = np.clip((start - lower) / (upper - lower), 0.0, 1.0)
        self._run = 0
        self._iteration = 0
        self._strategy = self._fresh()
        self._asked: list[Floats] = []

    def ask(self) -> Proposal | None:
        """Return the next designs of the current run; None after the last run."""
        if self._run == len(self._settings.height_weights):
            return None
        self._asked = self._strategy.ask()
        unit = np.clip(np.array(self._asked), 0.0, 1.0)
        lower, upper = self._space.edges
        return Proposal(
            values=self._space.snap(np.minimum(lower + unit * (upper - lower), upper)),
            height_weight=self._settings.height_weights[self._run],
        )

    def tell(self, scores: Scores) -> None:
        """Update the distribution of the current run; when this run has ended, start the next one."""
        self._strategy.tell(self._asked, self.cost(scores).tolist())
        self._iteration += 1
        if self._iteration == self._settings.iterations or self._strategy.stop():
            self._run += 1
            self._iteration = 0
            if self._run < len(self._settings.height_weights):
                self._strategy = self._fresh()

    def cost(self, scores: Scores) -> Floats:
        """Return the cost of each design, shape (n,); infeasible ones cost more than all feasible ones."""
        weight, scale = self._settings.height_weights[self._run], self._settings.height_scale_j
        feasible = weighted_cost(scores.values, weight, self._corner, scale)
        return np.where(scores.violation > 0.0, 1e6 * scale * (1.0 + scores.violation), feasible)

    def state(self) -> dict[str, Any]:
        """Return the numbers of the current run and of its iterations; designs and scores are in the database."""
        return {"run": self._run, "iteration": self._iteration}

    def restore(self, state: dict[str, Any], history: Iterable[tuple[Floats, Scores]]) -> None:
        """Replay the history of the current run."""
        generations = list(history)
        self._run = int(state["run"])
        self._iteration = 0
        if self._run == len(self._settings.height_weights):
            return
        self._strategy = self._fresh()
        iterations = int(state["iteration"])
        for _, scores in islice(generations, len(generations) - iterations, None):
            self.ask()
            self.tell(scores)

    def _fresh(self) -> Any:
        generator = np.random.default_rng([self._seed, self._run])
        return cma_es(self._start, self._settings.sigma, self._settings.population, generator)


def cma_es(start: Floats, sigma: float, population: int, generator: np.random.Generator) -> Any:
    """Return Hansen's CMA-ES in the unit cube around ``start``, shape (d,), with deviates of the generator alone."""
    import cma  # and with it Matplotlib: a report, which needs the cost only, would wait for them

    return cma.CMAEvolutionStrategy(
        start,
        sigma,
        {
            "popsize": population,
            "bounds": [[0.0] * len(start), [1.0] * len(start)],
            # With these normal deviates and no seed, cma does not touch NumPy's global generator.
            "randn": lambda *shape: generator.standard_normal(shape),
            "seed": np.nan,
            "verbose": -9,
            "verb_log": 0,
        },
    )
