"""Settings of each search algorithm, as in the ``[algorithm]`` table of a study file; cost of a weighted sweep."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Annotated, Literal, get_args

from pydantic import Field

from pareto_monoped.config import Strict
from pareto_monoped.design import PAPER_CASES
from pareto_monoped.errors import StudyError

Population = Annotated[int, Field(ge=2, le=100_000)]
Share = Annotated[float, Field(ge=0.0, le=1.0)]


class AlgorithmSettings(Strict):
    """Base class of the settings of all algorithms."""

    __slots__ = ()
    name: str


@dataclass(frozen=True, slots=True, kw_only=True)
class EvolutionSettings(AlgorithmSettings):
    """NSGA-II, SMS-EMOA and AGE-MOEA2 of pymoo, with simulated binary crossover and polynomial mutation.

    The default population was chosen by measurement on Case C.
    """

    name: Literal["nsga2", "sms_emoa", "age_moea2"]
    population: Annotated[int, Field(ge=4, le=100_000, multiple_of=2)] = 40
    crossover_probability: Share = 0.9
    crossover_eta: Annotated[float, Field(ge=3.0, le=30.0)] = 15.0
    mutation_eta: Annotated[float, Field(ge=3.0, le=30.0)] = 20.0


@dataclass(frozen=True, slots=True, kw_only=True)
class SurrogateSettings(AlgorithmSettings):
    """Evolution that ranks many offspring by a cheap model and simulates the most promising."""

    name: Literal["surrogate"]
    #: designs simulated per generation; half as many at the beginning, twice as many after 50 generations
    population: Annotated[int, Field(ge=4, le=100_000)] = 40
    #: generations that are spread over the space before the model begins
    drawn_generations: Annotated[int, Field(ge=1, le=1000)] = 2
    offspring: Annotated[int, Field(ge=2, le=100)] = 40  #: how many are ranked for each that is simulated
    crossover_eta: Annotated[float, Field(ge=3.0, le=30.0)] = 15.0  #: of simulated binary crossover
    mutation_eta: Annotated[float, Field(ge=3.0, le=30.0)] = 20.0  #: of polynomial mutation


@dataclass(frozen=True, slots=True, kw_only=True)
class OptunaSettings(AlgorithmSettings):
    """Optuna's NSGA-II and TPE samplers, asked for ``population`` designs at a time, by default 50 and 8.

    TPE chooses each design without knowing the scores of the others in its batch, so its batches are small.
    """

    name: Literal["optuna_nsga2", "optuna_tpe"]
    population: Annotated[int, Field(ge=1, le=100_000)] | None = None

    @property
    def batch(self) -> int:
        """Number of designs asked for at a time."""
        return self.population or {"optuna_nsga2": 50, "optuna_tpe": 8}[self.name]


@dataclass(frozen=True, slots=True, kw_only=True)
class RandomSettings(AlgorithmSettings):
    """Designs drawn uniformly within the bounds: the yardstick that every other search must beat."""

    name: Literal["random"]
    population: Annotated[int, Field(ge=1, le=100_000)] = 40


_NOMINAL = PAPER_CASES["nominal"]
PAPER_ITERATIONS = 200
"""Greatest number of iterations per weight (paper: M = 200)."""


@dataclass(frozen=True, slots=True, kw_only=True)
class WeightedSettings(AlgorithmSettings):
    """The paper's weighted CMA-ES: cost lambda1 Kh exp(-h) + lambda2 E, one run per weight, one after the other.

    For other objectives than the paper's, ``weighted_cost`` says what the cost is.
    """

    name: Literal["weighted_cmaes"]
    #: weight of the first objective in each run (lambda1); the other's is 1 - lambda1
    height_weights: Annotated[tuple[Annotated[float, Field(gt=0.0, lt=1.0)], ...], Field(min_length=1)] = (0.5,)
    population: Population = 8  #: designs per iteration (paper: N = 8)
    #: first step size, in variables scaled to their bounds (paper: 0.1)
    sigma: Annotated[float, Field(gt=0.0, le=1.0)] = 0.1
    iterations: Annotated[int, Field(ge=1)] = PAPER_ITERATIONS  #: greatest number of iterations per run
    #: where each run starts, by variable name; other variables start at the paper's nominal design, which is its start
    #: vector [0.4, 0.4, 6, 6, 50, 2.5, 10]
    start: dict[str, float] = field(default_factory=_NOMINAL.design.as_dict)
    #: Kh, for the paper's objectives; the paper chooses it "to ensure that the order of both terms is similar", and the
    #: default makes both terms equal at the published nominal design: E exp(h) = 31.44 J exp(0.887)
    height_scale_j: Annotated[float, Field(gt=0.0, allow_inf_nan=False)] = _NOMINAL.energy_j * math.exp(
        _NOMINAL.height_m
    )


OWN_ALGORITHM = "own:"
"""What the name of a user's own algorithm begins with; the name of its class follows."""


@dataclass(frozen=True, slots=True, kw_only=True)
class OwnSettings(AlgorithmSettings):
    """An algorithm of the user's own, of which a study knows the name alone."""

    name: Annotated[str, Field(pattern=rf"^{OWN_ALGORITHM}[A-Za-z_][A-Za-z0-9_]{{0,99}}$")]


ALGORITHMS: Mapping[str, type[AlgorithmSettings]] = {
    name: kind
    for kind in (EvolutionSettings, OptunaSettings, RandomSettings, SurrogateSettings, WeightedSettings)
    for name in get_args(kind.__annotations__["name"])
}
"""Name of an algorithm in a study file -> its settings. ``algorithms`` makes algorithms of them."""


DEFAULT_ALGORITHM = SurrogateSettings(name="surrogate")
"""The search of a study that names none. Studies stored by earlier versions name theirs."""


def sweep_evaluations(settings: WeightedSettings) -> int:
    """Return the most evaluations that all weights together can take; runs that converge early take fewer."""
    return len(settings.height_weights) * settings.population * settings.iterations


def share_of(settings: WeightedSettings, evaluations: int) -> int:
    """Return the iterations of each weight if all have an equal share of a budget, up to the paper's 200."""
    return min(PAPER_ITERATIONS, evaluations // (len(settings.height_weights) * settings.population))


def within_budget(settings: AlgorithmSettings, evaluations: int, *, given: bool, source: str) -> AlgorithmSettings:
    """Return settings whose weighted sweep reaches its last weight within the budget; others as they are.

    Every weight gets an equal share of the budget unless the file has ``given`` its iterations; a budget that ends
    earlier is refused.
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
