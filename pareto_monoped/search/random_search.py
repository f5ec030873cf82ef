"""Random search: the yardstick that every other algorithm must beat."""

from collections.abc import Iterable
from typing import Any

import numpy as np

from pareto_monoped.definition.algorithms import RandomSettings
from pareto_monoped.search.algorithm import Floats, Proposal, Scores, Space, generator_state, set_generator_state
from pareto_monoped.search.seen import Seen, drawn


class RandomSearch:
    """Draws designs uniformly within the bounds, none of them twice."""

    def __init__(self, space: Space, settings: RandomSettings, seed: int) -> None:
        self._space = space
        self._batch = settings.population
        self._generator = np.random.default_rng(seed)
        self._seen = Seen()
        self._asked = np.zeros((0, len(space.names)))

    def ask(self) -> Proposal | None:
        """``population`` designs, independent of all scores; fewer or None if nearly all designs have been drawn."""
        self._asked = drawn(self._space, self._seen, self._generator, self._batch)
        return Proposal(values=self._asked) if len(self._asked) else None

    def tell(self, scores: Scores) -> None:
        """Remember which designs there were; random search does not learn from scores."""
        self._seen.add(self._asked)

    def state(self) -> dict[str, Any]:
        """State of the random generator."""
        return {"generator": generator_state(self._generator)}

    def restore(self, state: dict[str, Any], history: Iterable[tuple[Floats, Scores]]) -> None:
        """Set the random generator, and remember the designs of the history."""
        set_generator_state(self._generator, state["generator"])
        for values, _ in history:
            self._seen.add(values)
