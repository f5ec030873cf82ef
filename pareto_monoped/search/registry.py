"""The registry of search algorithms: settings in, algorithm out. Each implementation is imported only when used."""

from typing import Any

from pareto_monoped.definition.algorithms import (
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
from pareto_monoped.search.space import AnyCoordinates, Coordinates, plain_coordinates


def make_algorithm(study: Study, coordinates: AnyCoordinates | None = None, own: Any = None) -> Algorithm:
    """The search algorithm that the study's settings name, before its first ``ask``.

    Args:
        study: its settings.
        coordinates: what it searches; every free variable within its bounds if None.
        own: the user's own algorithm, see ``own_algorithm``, where the settings name one.

    Raises:
        StudyError: the settings name the user's own algorithm, and ``own`` is another or None.
    """
    if own is not None and not isinstance(study.algorithm, OwnSettings):
        raise StudyError(
            f"algorithm: an own one is given, but the study's is {study.algorithm.name!r}, which it knows; leave it out"
        )
    coordinates = coordinates or plain_coordinates(study)
    space = coordinates.space
    match study.algorithm:
        case EvolutionSettings() as settings:
            if settings.name == "nsga2":
                from pareto_monoped.search.nsga2 import Nsga2

                return Nsga2(space, settings, study.seed)
            from pareto_monoped.search.evolution import Evolution

            return Evolution(space, settings, study.seed)
        case OptunaSettings() as settings:
            from pareto_monoped.search.optuna_samplers import OptunaSampler

            return OptunaSampler(space, settings, study.seed)
        case SurrogateSettings() as settings:
            from pareto_monoped.search.surrogate import SurrogateSearch

            return SurrogateSearch(space, settings, study.seed)
        case WeightedSettings() as settings:
            from pareto_monoped.search.weighted import WeightedSearch

            start = PAPER_CASES["nominal"].design.replace(settings.start).as_array()
            assert isinstance(coordinates, Coordinates)  # the study file refuses several motors
            first = coordinates.values(start[None])[0]
            return WeightedSearch(space, settings, first, study.seed, study.reference_point)
        case OwnSettings() as settings:
            from pareto_monoped.search.own_algorithm import OwnAlgorithm

            return OwnAlgorithm(space, settings, study.seed, own)
        case RandomSettings() as settings:
            from pareto_monoped.search.random_search import RandomSearch

            return RandomSearch(space, settings, study.seed)
