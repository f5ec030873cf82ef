"""New designs for a surrogate-assisted search: spread over the space, or varied from the designs near the front."""

import numpy as np
from pymoo.operators.crossover.sbx import cross_sbx
from pymoo.operators.mutation.pm import mut_pm

from pareto_monoped.study.algorithm_settings import SurrogateSettings
from pareto_monoped.study.archive import Archive, Standing
from pareto_monoped.study.protocol import Floats, Space

_PARENTS = 100
"""Fewest parents. A small front is filled up with the designs nearest to it. Our own choice: 2.5 populations."""
_NEIGHBOURS = 3
"""How many places on the front lie between two parents at most where neighbours are crossed. Our own choice."""
_EXCHANGED = 0.5
"""Probability that a variable is crossed, and that it changes sides; pymoo's own numbers."""


def spread(space: Space, count: int, generator: np.random.Generator) -> Floats:
    """Designs spread over the space, shape (n, d): a Latin hypercube (McKay, Beckman, Conover 1979)."""
    lower, upper = space.edges
    strata = np.argsort(generator.random((count, len(lower))), axis=0)
    unit = (strata + generator.random(strata.shape)) / count
    return space.snap(lower + unit * (upper - lower))


def offspring(
    archive: Archive, standing: Standing, settings: SurrogateSettings, generator: np.random.Generator
) -> Floats:
    """Varied designs, ``settings.offspring`` times the population, shape (n, d).

    Half of them have any two parents, which keeps the search broad, half have two neighbours on the front, which
    refines it.

    Args:
        archive: the designs so far; at least one has jumped.
        standing: how they stand.
        settings: number of offspring, and the operators.
        generator: source of all choices.
    """
    front = standing.front
    parents = front if len(front) >= _PARENTS else standing.order[:_PARENTS]
    line = front if len(front) > 1 else parents
    count = max(1, settings.offspring * settings.population // 4)
    first = generator.integers(0, len(line), count)
    second = np.minimum(first + generator.integers(1, 1 + _NEIGHBOURS, count), len(line) - 1)
    pairs = np.vstack((generator.choice(parents, (count, 2)), np.column_stack((line[first], line[second]))))
    lower, upper = archive.space.edges
    each = np.ones((len(pairs), 1))
    children = cross_sbx(
        archive.values[pairs.T],
        lower,
        upper,
        settings.crossover_eta * each,
        _EXCHANGED * each,
        _EXCHANGED * each,
        random_state=generator,
    ).reshape(-1, len(lower))
    mutated = mut_pm(
        children,
        lower,
        upper,
        np.full(len(children), settings.mutation_eta),
        np.full(len(children), 1.0 / len(lower)),
        at_least_once=False,
        random_state=generator,
    )
    return archive.space.snap(mutated)
