"""A study's jumps as a function for optimisers outside: points of its search space in, objectives and constraints out.

Nothing is stored. ``pymoo_problem`` and ``optuna_objective`` dress it for these libraries.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.design import NAMES
from pareto_monoped.errors import StudyError, complaint
from pareto_monoped.study.definition import Study
from pareto_monoped.study.motor_choice import MotorCoordinates
from pareto_monoped.study.own_functions import Jumps, OwnFunction, called, listed, name_of
from pareto_monoped.study.protocol import Floats, Space
from pareto_monoped.study.scoring import FAILED_VIOLATION, judge, scores
from pareto_monoped.study.simulator import evaluation_of, load_simulator


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Judged:
    """What n points came to.

    Attributes:
        table: variables and measures by name, each of shape (n,), with ``status`` and ``reason``.
        failed: which jumps failed, shape (n,).
        objectives: as minimisation, first the study's, then the own ones, shape (n, m); 0 where the jump failed.
        constraints: first the study's as shares of their limits, then the own ones, shape (n, k); they hold at <= 0. A
            failed jump has ``FAILED_VIOLATION``.
    """

    table: Mapping[str, NDArray[Any]]
    failed: NDArray[np.bool_]
    objectives: Floats
    constraints: Floats


class JumpFunction:
    """Points of a study's search space to their objectives and constraints.

    Args:
        study: what is varied, simulated, wanted and allowed; its algorithm, budget and seed play no part.
        objectives: own objectives besides the study's; less is better.
        constraints: own constraints besides the study's; they hold at <= 0.
        workers: threads that simulate.

    Raises:
        MotorError, CalibrationError: an unknown name or an unusable file.
        StudyError: no study, or no function.

    Attributes:
        space: what is searched. Gearboxes and motors are whole numbers, positions in their lists.
        names: of the objectives, first the study's, then the own ones.
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
        self.space: Space = self._coordinates.space
        self.names = (*study.objectives.names, *map(name_of, self._own))

    @property
    def constraint_names(self) -> tuple[str, ...]:
        """Of the constraints, first the study's, then the own ones."""
        return (*(limit.key for limit in self._study.constraints.limits), *map(name_of, self._own_limits))

    def __call__(self, values: Floats) -> Judged:
        """Let the designs at ``values`` jump, shape (n, d); whole numbers may be any numbers that round to them.

        Raises:
            StudyError: an own function returned something else than n numbers.
        """
        points = self.space.snap(np.atleast_2d(np.asarray(values, dtype=np.float64)))
        where = self._coordinates
        designs = where.designs(points)
        if isinstance(where, MotorCoordinates):
            evaluations = self._evaluate(designs, where.kits(where.motors_of(points)))
        else:
            evaluations = self._evaluate(designs)
        judgement = judge(evaluations, self._study.constraints, self._study.objectives)
        known = scores(evaluations, judgement, self._study.objectives)
        table = Jumps(dict(zip(NAMES, designs.T, strict=True)) | evaluations.as_columns())
        failed = judgement.state == "failed"
        own = [np.where(failed, 0.0, called(one, table, failed)) for one in self._own]
        limits = [np.where(failed, FAILED_VIOLATION, called(one, table, failed)) for one in self._own_limits]
        return Judged(
            table=table,
            failed=failed,
            objectives=np.column_stack((known.minimised(), *own)),
            constraints=np.column_stack((judgement.constraints, *limits)),
        )
