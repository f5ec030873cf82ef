"""A study as an objective function of Optuna, for samplers and storages that this package does not use."""

from collections.abc import Sequence

import numpy as np
import optuna

from pareto_monoped.design import NAMES
from pareto_monoped.measures import MEASURE_NAMES
from pareto_monoped.study.definition import Study
from pareto_monoped.study.outside import JumpFunction
from pareto_monoped.study.own_functions import OwnFunction


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

    def __call__(self, trial: optuna.trial.Trial) -> tuple[float, ...]:
        """Let the design that the trial suggests jump."""
        judged = self._jump(np.array([[self._suggested(trial, k) for k in range(len(self._jump.space.names))]]))
        table = judged.table
        for name, missed in zip(self._jump.constraint_names, judged.constraints[0].tolist(), strict=True):
            trial.set_constraint(name, missed)
        trial.set_user_attr("status", str(table["status"][0]))
        for name in (*NAMES, *MEASURE_NAMES):
            value = float(table[name][0])
            trial.set_user_attr(name, value if np.isfinite(value) else None)
        if judged.failed[0]:
            return (float("nan"),) * len(self._signs)
        return tuple((judged.objectives[0] * self._signs).tolist())

    def _suggested(self, trial: optuna.trial.Trial, k: int) -> float:
        space = self._jump.space
        name, lower, upper = space.names[k], float(space.lower[k]), float(space.upper[k])
        for choice in space.choices:
            if choice.name == name:
                motors = [motor.name for motor in choice.motors]
                return float(motors.index(trial.suggest_categorical(name, motors)))
        if space.whole[k]:
            return float(trial.suggest_int(name, int(lower), int(upper)))
        return trial.suggest_float(name, lower, upper)
