"""Make the search algorithm that a study's settings name. Each implementation is imported only when it is used."""

from functools import singledispatch
from typing import Any

from pareto_monoped.definition.algorithms import (
    OWN_ALGORITHM,
    EvolutionSettings,
    OptunaSettings,
    OwnSettings,
    RandomSettings,
    SurrogateSettings,
    WeightedSettings,
)
from pareto_monoped.definition.study import Study
from pareto_monoped.design import PAPER_CASES
from pareto_monoped.errors import StudyError
from pareto_monoped.search.algorithm import Algorithm
from pareto_monoped.search.space import Coordinates, plain_coordinates


def make_algorithm(study: Study, coordinates: Coordinates | None = None, own: Any = None) -> Algorithm:
    """Make the search algorithm of the study's settings, with every free variable within its bounds by default.

    Raises:
        StudyError: the settings name the user's own algorithm, and ``own`` is another or None.
    """
    settings = study.algorithm
    if own is not None and not settings.name.startswith(OWN_ALGORITHM):
        raise StudyError(
            f"algorithm: an own one is given, but the study's is {settings.name!r}, which it knows; leave it out"
        )
    return _made(settings, study, coordinates or plain_coordinates(study), own)


@singledispatch
def _made(settings: Any, study: Study, where: Coordinates, own: Any) -> Algorithm:
    """Make an algorithm. Each function registered here belongs to the settings that its first argument is of."""
    raise NotImplementedError(f"no algorithm for {settings!r}")


@_made.register
def _(settings: EvolutionSettings, study: Study, where: Coordinates, own: Any) -> Algorithm:
    from pareto_monoped.search.evolution import Evolution

    return Evolution(where.space, settings, study.seed)


@_made.register
def _(settings: OptunaSettings, study: Study, where: Coordinates, own: Any) -> Algorithm:
    from pareto_monoped.search.optuna_samplers import OptunaSampler

    return OptunaSampler(where.space, settings, study.seed)


@_made.register
def _(settings: OwnSettings, study: Study, where: Coordinates, own: Any) -> Algorithm:
    from pareto_monoped.search.own_algorithm import OwnAlgorithm

    return OwnAlgorithm(where.space, settings, study.seed, own)


@_made.register
def _(settings: RandomSettings, study: Study, where: Coordinates, own: Any) -> Algorithm:
    from pareto_monoped.search.random_search import RandomSearch

    return RandomSearch(where.space, settings, study.seed)


@_made.register
def _(settings: SurrogateSettings, study: Study, where: Coordinates, own: Any) -> Algorithm:
    from pareto_monoped.search.surrogate import SurrogateSearch

    return SurrogateSearch(where.space, settings, study.seed)


@_made.register
def _(settings: WeightedSettings, study: Study, where: Coordinates, own: Any) -> Algorithm:
    from pareto_monoped.search.weighted import WeightedSearch

    start = PAPER_CASES["nominal"].design.replace(settings.start).as_array()
    return WeightedSearch(where.space, settings, where.values(start[None])[0], study.seed, study.reference_point)
