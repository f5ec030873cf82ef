"""NSGA-II (Deb et al. 2002) on whole arrays: the trials of pymoo's, to the last bit, in a quarter of its time.

pymoo keeps one object per design, and takes longer to ask these for their values than to compute. Here are its steps in
its order with its random numbers; variation, non-dominated sorting and crowding distances are its own functions.
"""

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pymoo.core.problem import Problem
from pymoo.core.variable import get
from pymoo.operators.survival.rank_and_crowding.metrics import get_crowding_function
from pymoo.util.misc import random_permutations
from pymoo.util.nds.non_dominated_sorting import NonDominatedSorting
from pymoo.util.randomized_argsort import randomized_argsort
from scipy.spatial.distance import cdist

from pareto_monoped.definition.algorithms import EvolutionSettings
from pareto_monoped.search.algorithm import Floats, Proposal, Scores, Space, generator_state, set_generator_state
from pareto_monoped.search.evolution import jsonable, varying
from pareto_monoped.search.seen import TRIES, Seen, drawn

_APART = 1e-16
"""Designs that are no farther from each other are duplicates; pymoo's own number."""


@dataclass(frozen=True, slots=True, kw_only=True)
class _Population:
    """n designs: variables (n, d), minimised objectives (n, m), violation, rank and crowding distance (n,).

    Infeasible designs have neither rank nor crowding distance, NaN.
    """

    values: Floats
    costs: Floats
    violation: Floats
    rank: Floats
    crowding: Floats

    def of(self, rows: NDArray[np.intp]) -> "_Population":
        """Some of the designs."""
        return _Population(
            values=self.values[rows],
            costs=self.costs[rows],
            violation=self.violation[rows],
            rank=self.rank[rows],
            crowding=self.crowding[rows],
        )


class Nsga2:
    """NSGA-II that asks for no design twice. Its state is that of ``Evolution``."""

    def __init__(self, space: Space, settings: EvolutionSettings, seed: int) -> None:
        self._space, self._size = space, settings.population
        self._seen = Seen()
        self._lower, self._upper = space.edges
        self._problem = Problem(
            n_var=len(space.names), n_obj=len(space.objectives.names), n_ieq_constr=1, xl=self._lower, xu=self._upper
        )
        self._crossover, self._mutation = varying(space, settings)
        self._crowding = get_crowding_function("cd")
        self._sorting = NonDominatedSorting()
        self._generator = np.random.default_rng(seed)
        self._iteration = 1
        self._population: _Population | None = None
        self._asked: Floats = np.zeros((0, len(space.names)))

    def ask(self) -> Proposal | None:
        """The first population, later new offspring of the current one; new random designs if all offspring are known.

        None if there are no new designs left.
        """
        self._asked = self._first() if self._population is None else self._offspring(self._population)
        if len(self._asked) == 0:
            self._asked = drawn(self._space, self._seen, self._generator, self._size)
        return Proposal(values=self._asked.copy()) if len(self._asked) else None

    def tell(self, scores: Scores) -> None:
        """Select the survivors. Infeasible designs rank behind all feasible ones, in the order of their violation."""
        self._seen.add(self._asked)
        values, costs, violation, size = self._asked, scores.minimised(), scores.violation, len(self._asked)
        if (before := self._population) is not None:
            values, costs = np.vstack((before.values, values)), np.vstack((before.costs, costs))
            violation, size = np.concatenate((before.violation, violation)), self._size
        self._population = self._survivors(values, costs, violation, min(size, len(values)))
        self._iteration += 1

    def state(self) -> dict[str, Any]:
        """Population, ranks, crowding distances, number of generations, random generator."""
        state: dict[str, Any] = {"generator": generator_state(self._generator)}
        if (population := self._population) is not None:
            state["iteration"] = self._iteration
            state["X"], state["F"] = population.values.tolist(), population.costs.tolist()
            state["G"] = population.violation[:, None].tolist()
            for key, values in (("rank", population.rank), ("crowding", population.crowding)):
                state[key] = [None if math.isnan(value) else jsonable(value) for value in values.tolist()]
        return state

    def restore(self, state: dict[str, Any], history: Iterable[tuple[Floats, Scores]]) -> None:
        """Set the whole state, and remember the designs of the history."""
        for values, _ in history:
            self._seen.add(values)
        set_generator_state(self._generator, state["generator"])
        if "X" not in state:
            return
        arrays = {key: np.array(state[key], dtype=np.float64) for key in ("X", "F", "G", "rank", "crowding")}
        n, space = len(state["rank"]), self._space
        for key, width in (("X", len(space.names)), ("F", len(space.objectives.names)), ("G", 1)):
            if arrays[key].shape != (n, width):
                raise ValueError(f"{key} of the population has the shape {arrays[key].shape}, must be {(n, width)}")
        self._population = _Population(
            values=arrays["X"],
            costs=arrays["F"],
            violation=arrays["G"][:, 0],
            rank=arrays["rank"],
            crowding=arrays["crowding"],
        )
        self._iteration = int(state["iteration"])

    def _first(self) -> Floats:
        uniform = self._generator.random((self._size, len(self._lower)))
        return self._new(self._space.snap(self._lower + (self._upper - self._lower) * uniform))

    def _offspring(self, population: _Population) -> Floats:
        """Up to as many new designs as the population has; fewer or none in a space that is nearly used up."""
        asked = self._asked[:0]
        for _ in range(TRIES):
            children = self._space.snap(self._children(population, self._size - len(asked)))
            asked = np.vstack((asked, self._new(children, population.values, asked)))[: self._size]
            if len(asked) == self._size:
                break
        return asked

    def _children(self, population: _Population, count: int) -> Floats:
        """Children of parents that won tournaments, ``count`` or one more, shape (n, d)."""
        problem, generator = self._problem, self._generator
        pairs = math.ceil(count / 2)
        parents = np.swapaxes(population.values[self._winners(population, pairs)], 0, 1)
        crossed = generator.random(pairs) < get(self._crossover.prob, size=pairs)
        if crossed.any():
            children = self._crossover._do(problem, parents, random_state=generator)
            parents = np.where(crossed[None, :, None], children, parents)
        values = parents.reshape(-1, parents.shape[-1])
        varied = self._mutation._do(problem, values, random_state=generator)
        mutates = generator.random(len(values)) <= get(self._mutation.prob, size=len(values))
        return np.where(mutates[:, None], varied, values)

    def _winners(self, population: _Population, pairs: int) -> NDArray[np.intp]:
        """Rows of the parents of ``pairs`` pairs, shape (pairs, 2): each won a binary tournament.

        The design that misses less wins; of two feasible ones that which dominates, else that which is less crowded. A
        draw is decided by lot.
        """
        n, count = len(population.values), 4 * pairs
        drawn = random_permutations(math.ceil(count / n), n, random_state=self._generator)[:count].reshape(-1, 2)
        (first, second), costs = drawn.T, population.costs
        missed = np.maximum(population.violation, 0.0)
        feasible = (missed[first] <= 0.0) & (missed[second] <= 0.0)
        lead = np.sign(missed[second] - missed[first])
        less, more = (costs[first] < costs[second]).any(axis=1), (costs[first] > costs[second]).any(axis=1)
        dominance = np.where(less == more, 0.0, np.where(less, 1.0, -1.0))
        crowding = population.crowding
        roomier = (crowding[first] > crowding[second]) * 1.0 - (crowding[first] < crowding[second])
        lead = np.where(feasible, np.where(dominance != 0.0, dominance, roomier), lead)
        winners = np.where(lead > 0.0, first, second)
        for row in np.flatnonzero(lead == 0.0):
            winners[row] = self._generator.choice(drawn[row])
        rows: NDArray[np.intp] = winners.reshape(-1, 2)
        return rows

    def _new(self, values: Floats, *known: Floats) -> Floats:
        """Those of n designs that no other before them, none of ``known`` and none that was ever asked for equals."""
        near = np.tril(cdist(values, values) <= _APART, -1).any(axis=1)
        values = values[~near & self._seen.new(values)]
        for others in known:
            if len(values) and len(others):
                values = values[~(cdist(values, others) <= _APART).any(axis=1)]
        return values

    def _survivors(self, values: Floats, costs: Floats, violation: Floats, count: int) -> _Population:
        """The best ``count`` designs: by front, the last front that has room by crowding distance."""
        rank, crowding = np.full(len(values), np.nan), np.full(len(values), np.nan)
        missed = np.maximum(violation, 0.0)
        feasible, infeasible = np.flatnonzero(missed <= 0.0), np.flatnonzero(missed > 0.0)
        infeasible = infeasible[np.argsort(missed[infeasible])]
        room = min(len(feasible), count)
        chosen: list[NDArray[np.intp]] = []
        for k, places in enumerate(self._sorting.do(costs[feasible], n_stop_if_ranked=room)):
            front = feasible[places]
            surplus = max(0, sum(map(len, chosen)) + len(front) - room)
            rank[front], crowding[front] = k, self._crowding.do(costs[front], n_remove=surplus)
            if surplus:
                order = randomized_argsort(crowding[front], order="descending", random_state=self._generator)
                front = front[order[:-surplus]]
            chosen.append(front)
        rows = np.concatenate((*chosen, infeasible[: count - room]))
        everyone = _Population(values=values, costs=costs, violation=violation, rank=rank, crowding=crowding)
        return everyone.of(rows)
