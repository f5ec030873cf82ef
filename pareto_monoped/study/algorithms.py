"""The one face of all search algorithms: ask for designs, tell their scores, save and restore the state as data.

An algorithm never simulates and never stores. It works in the free variables only, in their own units.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.design import NAMES, PAPER_CASES
from pareto_monoped.study.definition import Study
from pareto_monoped.study.settings import EvolutionSettings, OptunaSettings, RandomSettings, WeightedSettings

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class Space:
    """The free variables' names and bounds, each of length d."""

    names: tuple[str, ...]
    lower: Floats
    upper: Floats


@dataclass(frozen=True, slots=True, kw_only=True)
class Proposal:
    """Designs to evaluate.

    Attributes:
        values: the free variables, shape (n, d).
        height_weight: lambda1 of a weighted search, None for others; stored with each of these trials.
    """

    values: Floats
    height_weight: float | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Scores:
    """What a search may know of n evaluated designs.

    Attributes:
        height_m, energy_j: the objectives, shape (n,); NaN where the jump failed.
        violation: how far the constraints are missed, shape (n,); 0 where all hold, large where the jump failed.
    """

    height_m: Floats
    energy_j: Floats
    violation: Floats

    def minimised(self) -> Floats:
        """Both objectives to be minimised, shape (n, 2); failed jumps, told apart by their violation, get zeros."""
        return np.nan_to_num(np.column_stack((-self.height_m, self.energy_j)), nan=0.0)


class Algorithm(Protocol):
    """What the run loop asks of a search algorithm.

    ``state`` is called after ``tell`` (or before the first ``ask``) and gives plain JSON values. A fresh algorithm of
    the same settings and seed that is restored from it goes on exactly as the saved one would have.
    """

    def ask(self) -> Proposal | None:
        """The next designs to evaluate, or None if the search has come to its own end."""

    def tell(self, scores: Scores) -> None:
        """Take the scores of all the designs asked for last, in their order."""

    def state(self) -> dict[str, Any]:
        """What is needed to go on, as plain JSON values."""

    def restore(self, state: dict[str, Any], told: Iterable[tuple[Floats, Scores]]) -> None:
        """Go on from ``state``.

        Args:
            state: what ``state`` gave.
            told: the values and scores of every ``tell`` so far, in order, for algorithms that rebuild themselves
                from their history; others leave it untouched.
        """


def create(study: Study) -> Algorithm:
    """A fresh algorithm as the study's settings ask for."""
    free = np.array([name in study.free for name in NAMES])
    space = Space(names=study.free, lower=study.lower[free], upper=study.upper[free])
    match study.algorithm:
        case EvolutionSettings() as settings:
            from pareto_monoped.study.evolution import Evolution

            return Evolution(space, settings, study.seed)
        case OptunaSettings() as settings:
            from pareto_monoped.study.optuna_samplers import OptunaSampler

            return OptunaSampler(space, settings, study.seed)
        case WeightedSettings() as settings:
            from pareto_monoped.study.weighted import WeightedSearch

            nominal = PAPER_CASES["nominal"].design.as_dict()
            start = np.array([settings.start.get(name, nominal[name]) for name in space.names])
            return WeightedSearch(space, settings, start, study.seed)
        case RandomSettings() as settings:
            return RandomSearch(space, settings, study.seed)


class RandomSearch:
    """Designs drawn evenly over the bounds."""

    def __init__(self, space: Space, settings: RandomSettings, seed: int) -> None:
        self._space = space
        self._batch = settings.population
        self._generator = np.random.default_rng(seed)

    def ask(self) -> Proposal:
        """``population`` designs, each independent of all others."""
        unit = self._generator.random((self._batch, len(self._space.names)))
        return Proposal(values=self._space.lower + unit * (self._space.upper - self._space.lower))

    def tell(self, scores: Scores) -> None:
        """Nothing is learned."""

    def state(self) -> dict[str, Any]:
        """The random generator's state."""
        return {"generator": generator_state(self._generator)}

    def restore(self, state: dict[str, Any], told: Iterable[tuple[Floats, Scores]]) -> None:
        """Set the random generator."""
        set_generator_state(self._generator, state["generator"])


def generator_state(generator: np.random.Generator) -> dict[str, Any]:
    """State of a PCG64 generator as plain JSON values."""
    state = dict(generator.bit_generator.state)
    return {**state, "state": dict(state["state"])}


def set_generator_state(generator: np.random.Generator, state: dict[str, Any]) -> None:
    """Set a generator to a state that ``generator_state`` gave; NumPy checks it."""
    generator.bit_generator.state = state
