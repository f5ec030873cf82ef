"""A study as a problem of pymoo, for algorithms that this package does not have."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from pymoo.core.problem import Problem

from pareto_monoped.compute.chunks import cores
from pareto_monoped.definition.given import count_of
from pareto_monoped.definition.study import Study
from pareto_monoped.search.algorithm import Floats
from pareto_monoped.study.outside import JumpFunction
from pareto_monoped.study.own_functions import OwnFunction


class MonopedProblem(Problem):  # type: ignore[misc]  # pymoo has no types
    """A study as a vectorised problem of pymoo: ``minimize(MonopedProblem(study), NSGA2(pop_size=40), ...)``.

    Variables are the study's free ones, in its order. A gearbox or motor is a position in its list; real numbers round
    to the nearest. Objectives are minimised, so a height has the other sign; ``decode`` gives the designs back.

    Args:
        study: what is varied, simulated, wanted and allowed; its algorithm, budget and seed play no part.
        objectives: own objectives besides the study's: functions of a table of jumps, name of a measure or variable ->
            values of shape (n,), to values of shape (n,). Less is better.
        constraints: own constraints besides the study's, such functions too; they hold at <= 0.
        workers: threads that simulate, all cores if None.

    Raises:
        MotorError, CalibrationError: an unknown name or an unusable file.
        InputError: a number of workers that is none, or own functions that are no functions.

    Example:
        >>> from pareto_monoped import MonopedProblem, Study
        >>> study = Study.define(name="mine", evaluations=40)
        >>> problem = MonopedProblem(study, constraints=[lambda jumps: jumps["mass_kg"] - 5.0])
        >>> problem.n_var, problem.n_obj
        (7, 2)
    """

    def __init__(
        self,
        study: Study,
        *,
        objectives: OwnFunction | Sequence[OwnFunction] = (),
        constraints: OwnFunction | Sequence[OwnFunction] = (),
        workers: int | None = None,
    ) -> None:
        threads = count_of("workers", workers) or cores()
        self.jump = JumpFunction(study, objectives=objectives, constraints=constraints, workers=threads)
        lower, upper = self.jump.space.edges
        super().__init__(
            n_var=len(lower),
            n_obj=len(self.jump.names),
            n_ieq_constr=len(self.jump.constraint_names),
            xl=lower,
            xu=upper,
        )

    def _evaluate(self, x: Floats, out: dict[str, Any], *_: Any, **__: Any) -> None:
        judged = self.jump(x)
        out["F"], out["G"] = judged.objectives, judged.constraints

    def decode(self, x: Floats) -> "dict[str, np.ndarray[Any, Any]]":
        """Return variables, measures and status of the jumps at ``x``, shape (d,) or (n, d); each of shape (n,)."""
        return dict(self.jump(x).table)
