"""Variation of a choice that has no order: a child takes its parents' choice, a mutation takes any other one.

Operators for numbers would draw a motor between two motors, or prefer the neighbours in the list.
"""

import numpy as np
from pymoo.core.problem import Problem
from pymoo.operators.crossover.sbx import SBX
from pymoo.operators.mutation.pm import PM

from pareto_monoped.study.protocol import Floats, Space

_EXCHANGED = 0.5
"""Probability that two children exchange their choices: uniform crossover (Syswerda 1989)."""


def exchanged(parents: Floats, generator: np.random.Generator) -> Floats:
    """Choices of two children for each pair of parents, shape (2, n) -> (2, n)."""
    swap = generator.random(parents.shape[1]) < _EXCHANGED
    return np.where(swap, parents[::-1], parents)


def mutated(choices: Floats, count: int, probability: float, generator: np.random.Generator) -> Floats:
    """Choices from 0 to ``count`` - 1, shape (n,); with some probability each becomes one of the others."""
    changes = generator.random(len(choices)) < probability
    others = (choices + generator.integers(1, count, len(choices))) % count
    return np.where(changes, others, choices)


class MotorSBX(SBX):  # type: ignore[misc]  # pymoo has no types
    """Simulated binary crossover of the numbers, exchange of the motors."""

    def __init__(self, space: Space, **settings: float) -> None:
        super().__init__(**settings)
        self._places = space.choice_columns

    def _do(
        self, problem: Problem, X: Floats, *more: object, random_state: np.random.Generator, **settings: object
    ) -> Floats:
        children: Floats = super()._do(problem, X, *more, random_state=random_state, **settings)
        for place in self._places:
            children[:, :, place] = exchanged(X[:, :, place], random_state)
        return children


class MotorPM(PM):  # type: ignore[misc]  # pymoo has no types
    """Polynomial mutation of the numbers, another motor with the same probability."""

    def __init__(self, space: Space, **settings: float) -> None:
        super().__init__(**settings)
        self._counts = dict(zip(space.choice_columns, (len(one.motors) for one in space.choices), strict=True))

    def _do(
        self, problem: Problem, X: Floats, *more: object, random_state: np.random.Generator, **settings: object
    ) -> Floats:
        varied: Floats = super()._do(problem, X, *more, random_state=random_state, **settings)
        for place, count in self._counts.items():
            before = X[:, place].astype(np.float64)
            varied[:, place] = mutated(before, count, 1.0 / X.shape[1], random_state)
        return varied
