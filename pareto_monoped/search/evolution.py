"""Search with NSGA-II, SMS-EMOA or AGE-MOEA2 of pymoo."""

import time
from collections.abc import Callable, Iterable
from importlib import import_module
from typing import Any

import numpy as np
from pymoo.algorithms.base.genetic import GeneticAlgorithm
from pymoo.core.duplicate import DefaultDuplicateElimination
from pymoo.core.population import Population
from pymoo.core.problem import Problem
from pymoo.core.repair import Repair
from pymoo.core.termination import NoTermination
from pymoo.operators.crossover.sbx import SBX
from pymoo.operators.mutation.pm import PM
from pymoo.operators.sampling.rnd import FloatRandomSampling

from pareto_monoped.definition.algorithms import EvolutionSettings
from pareto_monoped.search.algorithm import Algorithm, Floats, Proposal, Scores, Space
from pareto_monoped.search.seen import Seen, drawn
from pareto_monoped.search.space import MotorPM, MotorSBX


class Evolution(Algorithm):
    """Lets a genetic algorithm of pymoo ask for no design twice.

    Its state is all that pymoo keeps between generations: the population with its ranks and crowding distances, the
    number of generations and the random generator.
    """

    def __init__(self, space: Space, settings: EvolutionSettings, seed: int) -> None:
        self._space = space
        self._seen = Seen()
        self._algorithm = _algorithm(settings, seed, space, self._seen)
        lower, upper = space.edges
        problem = Problem(n_var=len(space.names), n_obj=len(space.objectives.names), n_ieq_constr=1, xl=lower, xu=upper)
        self._algorithm.setup(problem, termination=NoTermination())
        self._asked: Population = Population.empty()

    def ask(self) -> Proposal | None:
        """Return new designs of the algorithm, uniform ones if it finds none; None if there are none left."""
        asked = self._algorithm.ask()
        if asked is None or len(asked) == 0:
            generator, size = self._algorithm.random_state, self._algorithm.pop_size
            values = drawn(self._space, self._seen, generator, size)
            if len(values) == 0:
                return None
            asked = Population.new(X=values)
        self._asked = asked
        return Proposal(values=self._asked.get("X").astype(float))

    def tell(self, scores: Scores) -> None:
        """Select the survivors. Infeasible designs rank behind all feasible ones, in the order of their violation."""
        self._seen.add(self._asked.get("X"))
        self._asked.set("F", scores.minimised())
        self._asked.set("G", scores.violation[:, None])
        self._algorithm.tell(infills=self._asked)

    def state(self) -> dict[str, Any]:
        """Return population, ranks, crowding distances, number of generations, and state of the random generator."""
        state: dict[str, Any] = {"generator": self._algorithm.random_state.bit_generator.state}
        if self._algorithm.is_initialized:
            population = self._algorithm.pop
            state["iteration"] = self._algorithm.n_iter
            for key in ("X", "F", "G"):
                state[key] = population.get(key).astype(float).tolist()
            for key in ("rank", "crowding"):
                # Infeasible survivors have neither rank nor crowding distance. The ends of the front have an infinite
                # crowding distance, which JSON cannot hold as a number.
                numbers = [None if value is None else float(value) for value in population.get(key)]
                # JSON holds an infinite number as text.
                state[key] = [str(n) if n is not None and not np.isfinite(n) else n for n in numbers]
        return state

    def restore(self, state: dict[str, Any], history: Iterable[tuple[Floats, Scores]]) -> None:
        """Set the whole state, and remember the designs of the history."""
        for values, _ in history:
            self._seen.add(values)
        algorithm = self._algorithm
        algorithm.random_state.bit_generator.state = state["generator"]
        if "X" not in state:
            return
        arrays = {key: np.array(state[key], dtype=np.float64) for key in ("X", "F", "G")}
        n = len(state["rank"])
        for key, width in (("X", algorithm.problem.n_var), ("F", algorithm.problem.n_obj), ("G", 1)):
            if arrays[key].shape != (n, width):
                raise ValueError(f"{key} of the population has the shape {arrays[key].shape}, must be {(n, width)}")
        population = Population.new(**arrays)
        for key in ("rank", "crowding"):
            for individual, value in zip(population, state[key], strict=True):
                if value is not None:
                    individual.set(key, int(value) if key == "rank" else float(value))
        algorithm.start_time = time.time()  # pymoo subtracts it where no offspring is new
        algorithm.pop = population
        algorithm.n_iter = int(state["iteration"])
        algorithm.is_initialized = True


class _Snap(Repair):  # type: ignore[misc]  # pymoo has no types
    """Rounds the variables that are whole numbers."""

    def __init__(self, space: Space) -> None:
        super().__init__()
        self._space = space

    def _do(self, problem: Problem, X: Floats, **_: Any) -> Floats:
        return self._space.snap(X)


class _Begin(FloatRandomSampling):  # type: ignore[misc]  # pymoo has no types
    """Begins with points of the space, and draws as many more as are asked for."""

    def __init__(self, begin: Callable[[], Floats]) -> None:
        super().__init__()
        self._begin = begin

    def _do(self, problem: Problem, n_samples: int, *more: object, **settings: object) -> Floats:
        points: Floats = self._begin()[:n_samples]
        return np.vstack((points, super()._do(problem, n_samples, *more, **settings)[len(points) :]))


class _Unseen(DefaultDuplicateElimination):  # type: ignore[misc]  # pymoo has no types
    """Leaves out what is in the population already, as pymoo does, and what was ever asked for."""

    def __init__(self, seen: Seen) -> None:
        super().__init__()
        self._seen = seen

    def do(self, pop: Population, *others: Population, **settings: Any) -> Population:
        """Return those that are new."""
        found = super().do(pop, *others, **settings)
        return found[self._seen.new(found.get("X"))] if len(found) else found


def _varying(space: Space, settings: EvolutionSettings) -> tuple[SBX, PM]:
    """Make the crossover and the mutation of all three; pymoo's defaults would be shared between studies."""
    crossover = {"prob": settings.crossover_probability, "eta": settings.crossover_eta}
    mutation = {"eta": settings.mutation_eta}
    if space.choices:
        return MotorSBX(space, **crossover), MotorPM(space, **mutation)
    return SBX(**crossover), PM(**mutation)


_KINDS = {"nsga2": ("nsga2", "NSGA2"), "sms_emoa": ("sms", "SMSEMOA"), "age_moea2": ("age2", "AGEMOEA2")}
"""Modules and classes of pymoo."""


def _algorithm(settings: EvolutionSettings, seed: int, space: Space, seen: Seen) -> GeneticAlgorithm:
    # Only the one that is asked for is imported: AGE-MOEA2 takes a fifth of a second more than the others.
    module, name = _KINDS[settings.name]
    kind: type[GeneticAlgorithm] = getattr(import_module(f"pymoo.algorithms.moo.{module}"), name)
    crossover, mutation = _varying(space, settings)
    return kind(
        pop_size=settings.population,
        **({} if space.begin is None else {"sampling": _Begin(space.begin)}),
        crossover=crossover,
        mutation=mutation,
        repair=_Snap(space),
        eliminate_duplicates=_Unseen(seen),
        seed=seed,
    )
