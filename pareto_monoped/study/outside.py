"""A study's jumps as a function for optimisers outside: points of its search space in, objectives and constraints out.

Nothing is stored. ``pymoo_problem`` dresses it for pymoo, ``OptunaObjective`` for Optuna.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.definition.study import Study
from pareto_monoped.design import ALL_NAMES
from pareto_monoped.errors import StudyError, complaint
from pareto_monoped.measures import MEASURE_NAMES
from pareto_monoped.search.algorithm import Floats, Space
from pareto_monoped.search.scoring import FAILED_VIOLATION, judge, scores
from pareto_monoped.study.own_functions import Jumps, OwnFunction, called, listed, name_of
from pareto_monoped.study.simulator import evaluation_of, load_simulator

if TYPE_CHECKING:
    import optuna


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Judged:
    """What n points came to."""

    #: Variables and measures by name, each of shape (n,), with ``status`` and ``reason``
    table: Mapping[str, NDArray[Any]]
    failed: NDArray[np.bool_]  #: which jumps failed, shape (n,)
    objectives: Floats  #: as minimisation, first the study's, then the own ones, shape (n, m); 0 where the jump failed
    #: First the study's as shares of their limits, then the own ones, shape (n, k); they hold at <= 0. A failed jump
    #: has ``FAILED_VIOLATION``.
    constraints: Floats


class JumpFunction:
    """Points of a study's search space to their objectives and constraints.

    Own objectives are minimised, and own constraints hold at <= 0; both come after the study's. The study's algorithm,
    budget and seed play no part.

    Raises:
        MotorError, CalibrationError: an unknown name or an unusable file.
        StudyError: no study, or no function.
    """

    def __init__(
        self,
        study: Study,
        *,
        objectives: OwnFunction | Sequence[OwnFunction] = (),
        constraints: OwnFunction | Sequence[OwnFunction] = (),
        workers: int = 1,
    ) -> None:
        if not isinstance(study, Study):
            raise StudyError(complaint("study", study, "a Study", "define one, or read it: Study.from_toml(path)"))
        if study.own_names:
            raise StudyError(
                f"study {study.name!r}: names the own function {study.own_names[0]!r}; leave it out there, and give "
                "the function here"
            )
        own, own_limits = listed("objectives", objectives), listed("constraints", constraints)
        for function in (*own, *own_limits):
            if not callable(function):
                raise StudyError(complaint("own function", function, "a function of the jumps", "give one"))
        simulator = load_simulator(study, workers=workers)
        self._study = study
        self._evaluate = evaluation_of(study, simulator.evaluator)
        self._coordinates = simulator.coordinates(study)
        self._own = tuple(own)
        self._own_limits = tuple(own_limits)
        self.space: Space = self._coordinates.space  #: what is searched; gearboxes and motors by their position
        self.names = (*study.objectives.names, *map(name_of, self._own))  #: of the objectives

    @property
    def constraint_names(self) -> tuple[str, ...]:
        """Of the constraints, first the study's, then the own ones."""
        return (*(limit.key for limit in self._study.constraints.limits), *map(name_of, self._own_limits))

    def __call__(self, values: Floats) -> Judged:
        """Let the designs at ``values`` jump, shape (n, d); whole numbers may be any numbers that round to them."""
        points = self.space.snap(np.atleast_2d(np.asarray(values, dtype=np.float64)))
        where = self._coordinates
        designs = where.designs(points)
        evaluations = self._evaluate(designs, where.kits(where.motors_of(points)))
        judgement = judge(evaluations, self._study.constraints, self._study.objectives)
        known = scores(evaluations, judgement, self._study.objectives)
        table = Jumps(dict(zip(ALL_NAMES, designs.T, strict=False)) | evaluations.as_columns())
        failed = judgement.state == "failed"
        own = [np.where(failed, 0.0, called(one, table, failed)) for one in self._own]
        limits = [np.where(failed, FAILED_VIOLATION, called(one, table, failed)) for one in self._own_limits]
        return Judged(
            table=table,
            failed=failed,
            objectives=np.column_stack((known.minimised(), *own)),
            constraints=np.column_stack((judgement.constraints, *limits)),
        )


class OptunaObjective:
    """A study as a function for ``optuna.study.Study.optimize``.

    Each trial gets the design and its measures as user attributes, by their stored names. A failed jump is a failed
    trial. Constraints are those of the trial, which Optuna's samplers read.

    Args:
        study: what is varied, simulated, wanted and allowed; its algorithm, budget and seed play no part.
        objectives: own objectives besides the study's: functions of a table of jumps, name of a measure or variable ->
            values of shape (n,), to values of shape (n,). Less is better.
        constraints: own constraints besides the study's, such functions too; they hold at <= 0.

    Raises:
        MotorError, CalibrationError: an unknown name or an unusable file.

    Example:
        >>> import optuna
        >>> from pareto_monoped import OptunaObjective, Study
        >>> objective = OptunaObjective(Study.define(name="mine", evaluations=10))
        >>> study = optuna.create_study(directions=objective.directions, sampler=optuna.samplers.NSGAIISampler(seed=1))
        >>> study.optimize(objective, n_trials=3)
        >>> len(study.trials)
        3
    """

    def __init__(
        self,
        study: Study,
        *,
        objectives: OwnFunction | Sequence[OwnFunction] = (),
        constraints: OwnFunction | Sequence[OwnFunction] = (),
    ) -> None:
        self._jump = JumpFunction(study, objectives=objectives, constraints=constraints)
        own = len(self._jump.names) - len(study.objectives.names)
        self._signs = np.concatenate((study.objectives.signs, np.ones(own)))

    @property
    def directions(self) -> list[str]:
        """Of the objectives, for ``optuna.create_study``."""
        return ["maximize" if sign < 0.0 else "minimize" for sign in self._signs]

    def __call__(self, trial: "optuna.trial.Trial") -> tuple[float, ...]:
        """Let the design that the trial suggests jump."""
        judged = self._jump(np.array([[self._suggested(trial, k) for k in range(len(self._jump.space.names))]]))
        table = judged.table
        for name, missed in zip(self._jump.constraint_names, judged.constraints[0].tolist(), strict=True):
            trial.set_constraint(name, missed)
        trial.set_user_attr("status", str(table["status"][0]))
        for name in (one for one in (*ALL_NAMES, *MEASURE_NAMES) if one in table):
            value = float(table[name][0])
            trial.set_user_attr(name, value if np.isfinite(value) else None)
        if judged.failed[0]:
            return (float("nan"),) * len(self._signs)
        return tuple((judged.objectives[0] * self._signs).tolist())

    def _suggested(self, trial: "optuna.trial.Trial", k: int) -> float:
        space = self._jump.space
        name, lower, upper = space.names[k], float(space.lower[k]), float(space.upper[k])
        for choice in space.choices:
            if choice.name == name:
                motors = [motor.name for motor in choice.motors]
                return float(motors.index(trial.suggest_categorical(name, motors)))
        if space.whole[k]:
            return float(trial.suggest_int(name, int(lower), int(upper)))
        return trial.suggest_float(name, lower, upper)
