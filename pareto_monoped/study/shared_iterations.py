"""Iterations of a weighted search that are each weight's share of the budget: given once, when a database is made."""

from dataclasses import replace

from pareto_monoped.study.algorithm_settings import WeightedSettings
from pareto_monoped.study.definition import Study
from pareto_monoped.study.weighted_budget import share_of


def shared_anew(study: Study, evaluations: int | None) -> Study:
    """The study of a new database: a budget beyond the file's own is shared out, too.

    A smaller one cuts the search short, so that it can go on later.
    """
    settings = study.algorithm
    if not study.shared_iterations or not isinstance(settings, WeightedSettings):
        return study
    budget = max(evaluations or 0, study.evaluations)
    return replace(study, algorithm=replace(settings, iterations=max(1, share_of(settings, budget))))


def shared_as_stored(study: Study, stored: Study) -> Study:
    """The study of a database that there is: a file that gives no iterations takes those that it was made with."""
    settings, before = study.algorithm, stored.algorithm
    if study.shared_iterations and isinstance(settings, WeightedSettings) and isinstance(before, WeightedSettings):
        return replace(study, algorithm=replace(settings, iterations=before.iterations))
    return study
