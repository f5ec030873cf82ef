"""Search with NSGA-II or TPE of Optuna."""

import warnings
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np
import optuna

from pareto_monoped.definition.algorithms import OptunaSettings
from pareto_monoped.pareto.objectives import Objectives
from pareto_monoped.search.algorithm import MOTOR_OF, Algorithm, Floats, Proposal, Scores, Space
from pareto_monoped.search.seen import Seen, drawn

_KNOWN = 20
"""Known designs in a batch after which uniform ones are drawn; our own choice, a fraction of a second of waiting."""


class OptunaSampler(Algorithm):
    """Asks a sampler of Optuna, on a study in memory.

    Optuna keeps what its samplers learn in the trials of its study. Each generation gets a new sampler, whose seed
    follows from the study's seed and the number of the generation, so the trials are the whole state, and a study
    rebuilt from them continues exactly.
    """

    def __init__(self, space: Space, settings: OptunaSettings, seed: int) -> None:
        self._settings = settings
        self._seed = seed
        self._space = space
        self._generation = 0
        self._distributions = _distributions(space)
        self._motors = {choice.name: [motor.name for motor in choice.motors] for choice in space.choices}
        self._asked: list[optuna.trial.Trial] = []
        self._seen = Seen()
        with _quiet():
            self._study = optuna.create_study(directions=_directions(space.objectives), sampler=self._sampler())

    def ask(self) -> Proposal | None:
        """Return the sampler's next new designs; uniform ones after ``_KNOWN`` known ones; None if there is no other.

        Known designs end as failed trials, which samplers ignore: a study rebuilt without them continues alike.
        """
        batch, known, self._asked = self._settings.batch, 0, []
        with _quiet():
            self._study.sampler = self._sampler()
            while len(self._asked) < batch and known < 2 * _KNOWN:
                if known >= _KNOWN:
                    self._enqueue(batch)
                trial = self._study.ask(self._distributions)
                rows = np.array([self._row(one) for one in [*self._asked, trial]], dtype=np.float64)
                if self._seen.new(rows)[-1]:
                    self._asked.append(trial)
                else:
                    known += 1
                    self._study.tell(trial, state=optuna.trial.TrialState.FAIL)
        return Proposal(values=np.array([self._row(trial) for trial in self._asked])) if self._asked else None

    def _enqueue(self, count: int) -> None:
        """Make the next trial one that is drawn uniformly, if there is a new one; the seed is the sampler's."""
        generator = np.random.default_rng([self._seed, self._generation, len(self._asked)])
        for row in drawn(self._space, self._seen, generator, count)[:1].tolist():
            self._study.enqueue_trial(self._params(row))

    def _params(self, row: list[float]) -> dict[str, Any]:
        values: dict[str, Any] = dict(zip(self._distributions, row, strict=True))
        for name in self._space.gears:
            values[name] = int(values[name])
        for choice, names in self._motors.items():
            values[choice] = names[int(values[choice])]
        return values

    def _row(self, trial: optuna.trial.Trial) -> list[float]:
        if not self._motors:
            return [float(trial.params[name]) for name in self._distributions]
        chosen = {choice: names.index(trial.params[choice]) for choice, names in self._motors.items()}
        numbers = trial.params | chosen
        point: list[float] = self._space.snap(np.array([[float(numbers[name]) for name in self._distributions]]))[
            0
        ].tolist()
        return point

    def tell(self, scores: Scores) -> None:
        """Complete the trials of the last ``ask``; the violation becomes Optuna's constraint."""
        rows = np.array([self._row(trial) for trial in self._asked])
        with _quiet():
            if self._motors:
                # Shares of a list of gearboxes have moved to those of their gearbox, and the sampler must learn from
                # these, as it does after a restore. A trial that was asked for cannot change, so it ends as failed.
                for trial in self._asked:
                    self._study.tell(trial, state=optuna.trial.TrialState.FAIL)
                self._add(self._generation, rows, scores)
            else:
                for trial, values, violation in zip(
                    self._asked, _values(scores), scores.violation.tolist(), strict=True
                ):
                    trial.set_constraint("violation", violation)
                    self._study.tell(trial, values)
        self._seen.add(rows)
        self._generation += 1

    def state(self) -> dict[str, Any]:
        """Return the number of generations; the trials are in the database."""
        return {"generation": self._generation}

    def restore(self, state: dict[str, Any], history: Iterable[tuple[Floats, Scores]]) -> None:
        """Add the trials of the history."""
        self._generation = int(state["generation"])
        with _quiet():
            for generation, (values, scores) in enumerate(history):
                self._add(generation, values, scores)
                self._seen.add(values)
            sampler = self._study.sampler
            if isinstance(sampler, optuna.samplers.NSGAIISampler):
                # Optuna caches the parents of a generation when it first needs them, and derives them from the parents
                # of the generation before. With an empty cache it would recurse through all generations.
                for generation in range(self._generation):
                    sampler.get_parent_population(self._study, generation)

    def _add(self, generation: int, values: Floats, scores: Scores) -> None:
        for row, found, violation in zip(values.tolist(), _values(scores), scores.violation.tolist(), strict=True):
            trial = optuna.trial.create_trial(
                params=self._params(row),
                distributions=self._distributions,
                values=found,
                constraints={"violation": violation},
                # NSGAIISampler reads the generation of a trial here; other samplers ignore it.
                system_attrs={"NSGAIISampler:generation": generation},
            )
            self._study.add_trial(trial)

    def _sampler(self) -> optuna.samplers.BaseSampler:
        seed = int(np.random.SeedSequence([self._seed, self._generation]).generate_state(1)[0])
        if self._settings.name == "optuna_nsga2":
            return optuna.samplers.NSGAIISampler(population_size=self._settings.batch, seed=seed)
        # All designs of a batch are asked for before any score is known. The constant liar counts pending trials as
        # bad, which keeps the designs of a batch apart.
        # Multivariate kernels around the few designs that TPE counts as good hold all variables together: after 300
        # jumps they no longer left the middle of the front, and fell behind random search.
        return optuna.samplers.TPESampler(seed=seed, multivariate=False, constant_liar=True)


def _distributions(space: Space) -> dict[str, optuna.distributions.BaseDistribution]:
    found: dict[str, optuna.distributions.BaseDistribution] = {}
    for name, low, high in zip(space.names, space.lower.tolist(), space.upper.tolist(), strict=True):
        if name in space.gears:
            found[name] = optuna.distributions.IntDistribution(int(low), int(high))
        elif name in MOTOR_OF:
            motors = next(choice.motors for choice in space.choices if choice.name == name)
            found[name] = optuna.distributions.CategoricalDistribution([motor.name for motor in motors])
        else:
            found[name] = optuna.distributions.FloatDistribution(low, high)
    return found


def _directions(objectives: Objectives) -> list[optuna.study.StudyDirection]:
    maximize, minimize = optuna.study.StudyDirection.MAXIMIZE, optuna.study.StudyDirection.MINIMIZE
    return [maximize if sign < 0.0 else minimize for sign in objectives.signs]


def _values(scores: Scores) -> list[list[float]]:
    """Return the objectives with their own signs, as lists of n times m; zeros for a failed jump."""
    values: list[list[float]] = scores.objectives.minimised(scores.minimised()).tolist()
    return values


@contextmanager
def _quiet() -> Iterator[None]:
    """Silence Optuna's log line per trial and its warnings about experimental options, which are used on purpose."""
    verbosity = optuna.logging.get_verbosity()
    optuna.logging.set_verbosity(optuna.logging.WARNING)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", optuna.exceptions.ExperimentalWarning)
            yield
    finally:
        optuna.logging.set_verbosity(verbosity)
