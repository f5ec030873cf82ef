"""Random search: the yardstick that every other algorithm must beat."""

from collections.abc import Iterable
from typing import Any

import numpy as np

from pareto_monoped.definition.algorithms import RandomSettings
from pareto_monoped.search.algorithm import Algorithm, Floats, Proposal, Scores, Space
from pareto_monoped.search.seen import Seen, drawn


class RandomSearch(Algorithm):
    """Draws designs uniformly within the bounds, none of them twice: the yardstick of every other algorithm."""

    def __init__(self, space: Space, settings: RandomSettings, seed: int) -> None:
        self._space = space
        self._batch = settings.population
        self._generator = np.random.default_rng(seed)
        self._seen = Seen()
        self._asked = np.zeros((0, len(space.names)))

    def ask(self) -> Proposal | None:
        """Return ``population`` designs, independent of all scores; fewer or None if nearly all have been drawn."""
        self._asked = drawn(self._space, self._seen, self._generator, self._batch)
        return Proposal(values=self._asked) if len(self._asked) else None

    def tell(self, scores: Scores) -> None:
        """Remember which designs there were; random search does not learn from scores."""
        self._seen.add(self._asked)

    def state(self) -> dict[str, Any]:
        """Return the state of the random generator."""
        return {"generator": self._generator.bit_generator.state}

    def restore(self, state: dict[str, Any], history: Iterable[tuple[Floats, Scores]]) -> None:
        """Set the random generator, and remember the designs of the history."""
        self._generator.bit_generator.state = state["generator"]
        for values, _ in history:
            self._seen.add(values)
