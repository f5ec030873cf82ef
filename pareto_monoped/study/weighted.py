"""The paper's search: CMA-ES on a weighted cost of two objectives, one run per weight."""

from collections.abc import Iterable
from itertools import islice
from typing import Any

import cma
import numpy as np

from pareto_monoped.pareto.indicators import ReferencePoint
from pareto_monoped.study.algorithm_settings import WeightedSettings
from pareto_monoped.study.protocol import Floats, Proposal, Scores, Space
from pareto_monoped.study.weighted_cost import weighted_cost


class WeightedSearch:
    """CMA-ES (Hansen's ``cma``) on ``weighted_cost``.

    The runs follow one another. A run
    ends after ``iterations``, or earlier when CMA-ES detects that it has converged. To restore, the current run is
    replayed from its history. This is exact because each run has its own random generator, and it takes a fraction of
    a second.
    """

    def __init__(
        self, space: Space, settings: WeightedSettings, start: Floats, seed: int, corner: ReferencePoint
    ) -> None:
        """Begin with the first weight.

        Args:
            space: the free variables and two objectives.
            settings: weights, population and the like.
            start: where each run starts, a point of the space, shape (d,).
            seed: of the study.
            corner: the study's reference point, which scales other objectives than the paper's.
        """
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
        """The next designs of the current run; None after the last run."""
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
        """Cost of each design, shape (n,).

        An infeasible design costs more than any feasible one, and more the larger its violation. CMA-ES uses only the
        ranks.
        """
        weight, scale = self._settings.height_weights[self._run], self._settings.height_scale_j
        feasible = weighted_cost(scores.values, weight, self._corner, scale)
        return np.where(scores.violation > 0.0, 1e6 * scale * (1.0 + scores.violation), feasible)

    def state(self) -> dict[str, Any]:
        """Number of the current run and of its iterations; the designs and scores are in the database."""
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

    def _fresh(self) -> cma.CMAEvolutionStrategy:
        generator = np.random.default_rng([self._seed, self._run])
        dimensions = len(self._start)
        return cma.CMAEvolutionStrategy(
            self._start,
            self._settings.sigma,
            {
                "popsize": self._settings.population,
                "bounds": [[0.0] * dimensions, [1.0] * dimensions],
                # With these normal deviates and no seed, cma does not touch NumPy's global generator.
                "randn": lambda *shape: generator.standard_normal(shape),
                "seed": np.nan,
                "verbose": -9,
                "verb_log": 0,
            },
        )
