"""Make the search algorithm that a study's settings name. Each implementation is imported only when it is used."""

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
    where = coordinates or plain_coordinates(study)
    match settings:
        case EvolutionSettings():
            from pareto_monoped.search.evolution import Evolution

            return Evolution(where.space, settings, study.seed)
        case OptunaSettings():
            from pareto_monoped.search.optuna_samplers import OptunaSampler

            return OptunaSampler(where.space, settings, study.seed)
        case OwnSettings():
            from pareto_monoped.search.own_algorithm import OwnAlgorithm

            return OwnAlgorithm(where.space, settings, study.seed, own)
        case RandomSettings():
            from pareto_monoped.search.random_search import RandomSearch

            return RandomSearch(where.space, settings, study.seed)
        case SurrogateSettings():
            from pareto_monoped.search.surrogate import SurrogateSearch

            return SurrogateSearch(where.space, settings, study.seed)
        case WeightedSettings():
            from pareto_monoped.search.weighted import WeightedSearch

            if where.space.begin is None:
                start = where.values(PAPER_CASES["nominal"].design.replace(settings.start).as_array()[None])[0]
            else:
                begun = where.space.begin()
                start = begun[len(begun) // 2]
            return WeightedSearch(where.space, settings, start, study.seed, study.reference_point)
    raise NotImplementedError(f"no algorithm for {settings!r}")
