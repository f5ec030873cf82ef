"""What a sweep of the paper's weighted search costs, and how a study file's budget is shared out among its weights."""

from dataclasses import replace

from pareto_monoped.errors import StudyError
from pareto_monoped.study.algorithm_settings import PAPER_ITERATIONS, AlgorithmSettings, WeightedSettings


def sweep_evaluations(settings: WeightedSettings) -> int:
    """The most evaluations that all weights together can take; runs that converge early take fewer."""
    return len(settings.height_weights) * settings.population * settings.iterations


def share_of(settings: WeightedSettings, evaluations: int) -> int:
    """Iterations of each weight if all have an equal share of a budget, up to the paper's 200."""
    return min(PAPER_ITERATIONS, evaluations // (len(settings.height_weights) * settings.population))


def within_budget(settings: AlgorithmSettings, evaluations: int, *, given: bool, source: str) -> AlgorithmSettings:
    """Settings with which a weighted sweep comes to its last weight within the budget; those of others as they are.

    Args:
        settings: of any search.
        evaluations: the budget.
        given: whether the file gives ``iterations``; if not, every weight gets an equal share of the budget, up to the
            paper's 200 iterations.
        source: the file, for messages.

    Raises:
        StudyError: the budget ends before the last weight.
    """
    if not isinstance(settings, WeightedSettings):
        return settings
    weights = len(settings.height_weights)
    share = share_of(settings, evaluations)
    if not given:
        settings = replace(settings, iterations=max(1, share))
    needed = sweep_evaluations(settings)
    if needed <= evaluations:
        return settings
    cure = f", set algorithm.iterations = {share}, or leave iterations out" if share else ""
    raise StudyError(
        f"{source}: evaluations = {evaluations}: {weights} weights of {settings.population} designs times "
        f"{settings.iterations} iterations need {needed}; raise it{cure}"
    )
