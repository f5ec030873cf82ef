"""Judge evaluations by a study's constraints: feasible, infeasible or failed, with a graded violation and a reason."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pareto_monoped.definition.goals import Constraints
from pareto_monoped.pareto.objectives import HEIGHT_AND_ENERGY, Objectives
from pareto_monoped.search.algorithm import Scores

if TYPE_CHECKING:
    from pareto_monoped.jump.evaluate import Evaluations

FAILED_VIOLATION = 100.0
"""Violation of a failed jump in each constraint: so large that it ranks behind jumps that only miss a limit."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Judgement:
    """How well n evaluations keep the constraints."""

    state: NDArray[np.str_]  #: ``feasible``, ``infeasible`` or ``failed``, shape (n,)
    reason: tuple[str, ...]  #: n strings that say why a design is not feasible; empty where it is
    #: How far each of k constraints is missed, as a share of its limit, feasible at <= 0, shape (n, k);
    #: ``FAILED_VIOLATION`` for a failed jump
    constraints: NDArray[np.float64]
    violation: NDArray[np.float64]  #: sum of the positive ``constraints``, shape (n,)


def judge(
    evaluations: "Evaluations", constraints: Constraints, objectives: Objectives = HEIGHT_AND_ENERGY
) -> Judgement:
    """Judge evaluations by a study's constraints.

    A jump failed if its status says so, or if its height, its energy or an objective is not a finite number. The
    violation is graded, so that a search sees which of two infeasible designs is closer. A measure without a value
    misses its limit as a failed jump does.
    """
    failed = evaluations.status != "ok"
    for name in dict.fromkeys((*HEIGHT_AND_ENERGY.names, *objectives.names)):
        failed = failed | ~np.isfinite(evaluations.of(name))
    reasons = list(evaluations.reason)
    measures = {limit.measure: evaluations.of(limit.measure) for limit in constraints.limits}
    table = missed(constraints, measures, failed)
    for limit, shares in zip(constraints.limits, table.T, strict=True):
        for i in np.flatnonzero(~failed & (shares > 0.0)):
            also, value = f"{reasons[i]}; " if reasons[i] else "", measures[limit.measure][i]
            reasons[i] = f"{also}{limit.measure} = {value:.4g} is {limit.violated} the limit of {limit.value:g}"
    violation = np.maximum(table, 0.0).sum(axis=1)
    state = np.where(failed, "failed", np.where(violation > 0.0, "infeasible", "feasible"))
    return Judgement(state=state, reason=tuple(reasons), constraints=table, violation=violation)


def missed(
    constraints: Constraints, measures: Mapping[str, ArrayLike], failed: NDArray[np.bool_]
) -> NDArray[np.float64]:
    """Return how far n designs miss k constraints, as shares of their limits, shape (n, k)."""
    table = np.zeros((len(failed), len(constraints.limits)))
    for column, limit in zip(table.T, constraints.limits, strict=True):
        values = np.asarray(measures[limit.measure], dtype=np.float64)
        column[:] = np.where(failed | np.isnan(values), FAILED_VIOLATION, limit.shares(values))
    return table


def values_of(evaluations: "Evaluations", objectives: Objectives) -> NDArray[np.float64]:
    """Return the objectives' values in stored units, shape (n, m)."""
    return np.column_stack([evaluations.of(name) for name in objectives.names])


def scores(evaluations: "Evaluations", judgement: Judgement, objectives: Objectives = HEIGHT_AND_ENERGY) -> Scores:
    """Return what a search algorithm may know about these evaluations."""
    return Scores(
        objectives=objectives,
        values=values_of(evaluations, objectives),
        violation=judgement.violation,
        constraints=judgement.constraints,
    )
