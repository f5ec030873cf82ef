"""The registry of search algorithms: settings in, algorithm out. Each implementation is imported only when used."""

import numpy as np

from pareto_monoped.design import NAMES, PAPER_CASES
from pareto_monoped.study.algorithm_settings import EvolutionSettings, OptunaSettings, RandomSettings, WeightedSettings
from pareto_monoped.study.definition import Study
from pareto_monoped.study.protocol import Algorithm, Space


def make_algorithm(study: Study) -> Algorithm:
    """The search algorithm that the study's settings name, before its first ``ask``."""
    free = np.array([name in study.free for name in NAMES])
    space = Space(names=study.free, lower=study.lower[free], upper=study.upper[free], objectives=study.objectives)
    match study.algorithm:
        case EvolutionSettings() as settings:
            from pareto_monoped.study.evolution import Evolution

            return Evolution(space, settings, study.seed)
        case OptunaSettings() as settings:
            from pareto_monoped.study.optuna_samplers import OptunaSampler

            return OptunaSampler(space, settings, study.seed)
        case WeightedSettings() as settings:
            from pareto_monoped.study.weighted import WeightedSearch

            nominal = PAPER_CASES["nominal"].design
            start = np.array([settings.start.get(name, getattr(nominal, name)) for name in space.names])
            return WeightedSearch(space, settings, start, study.seed, study.reference_point)
        case RandomSettings() as settings:
            from pareto_monoped.study.random_search import RandomSearch

            return RandomSearch(space, settings, study.seed)
