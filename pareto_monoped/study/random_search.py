"""Random search: the yardstick that every other algorithm must beat."""

from collections.abc import Iterable
from typing import Any

import numpy as np

from pareto_monoped.study.algorithm_settings import RandomSettings
from pareto_monoped.study.protocol import Floats, Proposal, Scores, Space
from pareto_monoped.study.random_state import generator_state, set_generator_state


class RandomSearch:
    """Draws designs uniformly within the bounds."""

    def __init__(self, space: Space, settings: RandomSettings, seed: int) -> None:
        self._space = space
        self._batch = settings.population
        self._generator = np.random.default_rng(seed)

    def ask(self) -> Proposal:
        """``population`` designs, independent of each other and of all scores."""
        unit = self._generator.random((self._batch, len(self._space.names)))
        return Proposal(values=self._space.lower + unit * (self._space.upper - self._space.lower))

    def tell(self, scores: Scores) -> None:
        """Ignore the scores: random search does not learn."""

    def state(self) -> dict[str, Any]:
        """State of the random generator."""
        return {"generator": generator_state(self._generator)}

    def restore(self, state: dict[str, Any], history: Iterable[tuple[Floats, Scores]]) -> None:
        """Set the random generator; the history is not needed."""
        set_generator_state(self._generator, state["generator"])
