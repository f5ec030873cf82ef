"""New designs for a surrogate-assisted search: spread over the space, or varied from the designs near the front."""

import numpy as np
from pymoo.operators.crossover.sbx import cross_sbx
from pymoo.operators.mutation.pm import mut_pm

from pareto_monoped.definition.algorithms import SurrogateSettings
from pareto_monoped.search.algorithm import MOTOR_OF, Floats, Space
from pareto_monoped.search.archive import Archive, Standing
from pareto_monoped.search.space import exchanged, mutated

_NEIGHBOURS = 3
"""How many places on the front lie between two parents at most where neighbours are crossed. Our own choice."""
_STEP = (1e-3, 0.1)
"""Least and greatest length of a small step, as a share of a variable's range. Our own choice."""
_EXCHANGED = 0.5
"""Probability that a variable is crossed, and that it changes sides; pymoo's own numbers."""
_SCANNED = 3
"""Values that a scan tries of each variable. Our own choice: both bounds and one between."""


def spread(space: Space, count: int, generator: np.random.Generator, on_bound: float = 0.0) -> Floats:
    """Spread designs over the space, shape (n, d): a Latin hypercube (McKay, Beckman, Conover 1979).

    A share ``on_bound`` of each variable's values is on its lower bound, and as many are on its upper bound.
    """
    lower, upper = space.edges
    strata = np.argsort(generator.random((count, len(lower))), axis=0)
    place = (strata + generator.random(strata.shape)) / count
    # The first motor of a list and the last are no bounds.
    share = np.where([name in MOTOR_OF for name in space.names], 0.0, on_bound)
    inside = space.snap(lower + np.clip((place - share) / (1.0 - 2.0 * share), 0.0, 1.0) * (upper - lower))
    spread_out = np.where(place < share, space.lower, np.where(place > 1.0 - share, space.upper, inside))
    return space.snap(spread_out) if space.choices else spread_out


def offspring(
    archive: Archive, standing: Standing, settings: SurrogateSettings, generator: np.random.Generator
) -> Floats:
    """Vary designs, of which one at least has jumped, to ``settings.offspring`` times the population, shape (n, d).

    Half have any two parents, which keeps the search broad, half two neighbours on the front, which refines it.
    """
    front = standing.front
    # A small front is filled up with the designs nearest to it.
    parents = front if len(front) >= settings.population else standing.order[: settings.population]
    line = front if len(front) > 1 else parents
    count = max(1, settings.offspring * settings.population // 4)
    first = generator.integers(0, len(line), count)
    second = np.minimum(first + generator.integers(1, 1 + _NEIGHBOURS, count), len(line) - 1)
    pairs = np.vstack((generator.choice(parents, (count, 2)), np.column_stack((line[first], line[second]))))
    lower, upper = archive.space.edges
    each = np.ones((len(pairs), 1))
    parents_of = archive.values[pairs.T]
    children = cross_sbx(
        parents_of,
        lower,
        upper,
        settings.crossover_eta * each,
        _EXCHANGED * each,
        _EXCHANGED * each,
        random_state=generator,
    )
    for place in archive.space.choice_columns:
        children[:, :, place] = exchanged(parents_of[:, :, place], generator)
    children = children.reshape(-1, len(lower))
    varied = mut_pm(
        children,
        lower,
        upper,
        np.full(len(children), settings.mutation_eta),
        np.full(len(children), 1.0 / len(lower)),
        at_least_once=False,
        random_state=generator,
    )
    for place, choice in zip(archive.space.choice_columns, archive.space.choices, strict=True):
        varied[:, place] = mutated(children[:, place], len(choice.motors), 1.0 / len(lower), generator)
    return archive.space.snap(varied)


def small_steps(space: Space, values: Floats, count: int, generator: np.random.Generator) -> Floats:
    """Return ``count`` designs near each of n, shape (n, d) -> (n * count, d).

    Each step has a length of its own, from fine to coarse, and moves about half of the variables. One of d steps takes
    another gearbox of a list: half of these the next one, half any. Steps beyond a bound end on it.
    """
    lower, upper = space.lower, space.upper
    start = np.repeat(values, count, axis=0)
    least, greatest = _STEP
    length = least * (greatest / least) ** generator.random((len(start), 1))
    steps = length * generator.standard_normal(start.shape) * (upper - lower)
    steps[generator.random(start.shape) < _EXCHANGED] = 0.0
    if space.whole.any():
        steps = np.where(space.whole, _other_gears(start, lower, upper, len(lower), generator), steps)
    near = np.asarray(np.clip(start + steps, lower, upper))
    return _other_choices(space, start, near, generator) if space.choices else near


def scans(space: Space, values: Floats, generator: np.random.Generator) -> Floats:
    """Return k designs for each of n with one variable elsewhere, all else equal, shape (n, d) -> (n * k, d).

    A number goes to both its bounds and to one place between them. A gearbox or a motor becomes any, as often.
    """
    dimensions = len(space.names)
    lower, upper = space.edges
    share = generator.random((len(values), dimensions, _SCANNED))
    scanned = np.repeat(values[:, None], _SCANNED * dimensions, axis=1)
    for column, name in enumerate(space.names):
        if not (space.whole[column] or name in space.listed):
            share[:, column, :2] = 0.0, 1.0
        # Written so that a share of 0 or 1 is a bound to the last bit.
        here = (1.0 - share[:, column]) * lower[column] + share[:, column] * upper[column]
        scanned[:, _SCANNED * column : _SCANNED * (column + 1), column] = here
    return space.snap(scanned.reshape(-1, dimensions))


def _other_choices(space: Space, start: Floats, near: Floats, generator: np.random.Generator) -> Floats:
    """Return ``near`` with gearboxes and motors chosen from ``start``, where each motor has its own lists."""
    dimensions = len(space.names)
    for name in space.listed:
        gear = space.gear_of(name, start).astype(np.float64)
        last = space.last_gears(name)[space.motor_of(name, start)].astype(np.float64)
        step = _other_gears(gear, np.zeros(len(gear)), last, dimensions, generator)
        near[:, space.names.index(name)] = np.clip(gear + step, 0.0, last) / np.maximum(last, 1.0)
    for place, choice in zip(space.choice_columns, space.choices, strict=True):
        near[:, place] = mutated(start[:, place], len(choice.motors), 1.0 / dimensions, generator)
    return space.snap(near)


def _other_gears(
    start: Floats, lower: Floats, upper: Floats, dimensions: int, generator: np.random.Generator
) -> Floats:
    """Return steps to other whole numbers, 0 for most, in the shape of ``start``; one of ``dimensions`` moves."""
    chance = generator.random(start.shape) * dimensions
    any_one = np.floor(lower + generator.random(start.shape) * (upper - lower + 1.0)) - start
    # ``np.select`` takes three times as long.
    return np.where(chance < 0.25, -1.0, np.where(chance < 0.5, 1.0, np.where(chance < 1.0, any_one, 0.0)))
