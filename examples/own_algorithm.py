"""A search algorithm of one's own: differential evolution by ask and tell, in a stored study that goes on."""

import numpy as np

import pareto_monoped as pm


class DifferentialEvolution:
    """Storn and Price 1997, scheme rand/1/bin, on energy per jump; a jump that misses a limit costs more than any."""

    def __init__(self, space, seed):
        self.low, self.high = space.edges  # bounds of the free variables, shape (d,)
        self.random = np.random.default_rng(seed)
        self.points = self.costs = None

    def ask(self):
        """The next designs, shape (n, d)."""
        if self.points is None:
            self.asked = self.random.uniform(self.low, self.high, (20, len(self.low)))
            return self.asked
        a, b, c = (self.points[self.random.permutation(20)] for _ in range(3))
        mixed = np.clip(a + 0.7 * (b - c), self.low, self.high)
        self.asked = np.where(self.random.random(mixed.shape) < 0.9, mixed, self.points)
        return self.asked

    def tell(self, scores):
        """Their scores; see ``pm.Scores``."""
        costs = scores.minimised()[:, 1] + 1000.0 * scores.violation  # of height and energy, less is better
        if self.points is None:
            self.points, self.costs = self.asked.copy(), costs
        better = costs < self.costs
        self.points[better], self.costs[better] = self.asked[better], costs[better]


study = pm.Study.define(name="least", evaluations=120, constraints={"height_m": {"min": 0.8}}, audit=False)
pm.run(study, "least.db", algorithm=DifferentialEvolution)
stored = pm.resume("least.db", evaluations=200, algorithm=DifferentialEvolution)
print(stored.pick(min_height_m=0.8).why)
