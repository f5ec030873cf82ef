"""Evaluations -> feasible, infeasible or failed, with a graded violation and a reason."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.jump.evaluate import Evaluations
from pareto_monoped.study.algorithms import Scores
from pareto_monoped.study.definition import Constraints

FAILED_VIOLATION = 100.0
"""Violation of a jump that failed: beyond any that a real jump can have, whose limits are missed by shares of them."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Judgement:
    """How n evaluations stand to the constraints.

    Attributes:
        state: ``feasible``, ``infeasible`` or ``failed``, shape (n,).
        reason: why it is not feasible, n strings; empty where it is.
        constraints: each constraint's value as a share of its limit, feasible at <= 0, shape (n, k); a failed jump
            has ``FAILED_VIOLATION`` in all.
        violation: sum of the positive ones, shape (n,).
    """

    state: NDArray[np.str_]
    reason: tuple[str, ...]
    constraints: NDArray[np.float64]
    violation: NDArray[np.float64]


def judge(evaluations: Evaluations, constraints: Constraints) -> Judgement:
    """Judge evaluations by a study's constraints.

    The violation is graded, (limit - value) / limit for a least value and (value - limit) / limit for a greatest one,
    so that a search can see which of two failing designs is nearer.
    """
    n = len(evaluations.height_m)
    failed = (evaluations.status != "ok") | ~np.isfinite(evaluations.height_m) | ~np.isfinite(evaluations.energy_j)
    reasons = list(evaluations.reason)
    columns = []
    for name, limit, sign in _limits(constraints):
        values = np.asarray(getattr(evaluations, name), dtype=np.float64)
        shares = np.where(failed, FAILED_VIOLATION, sign * (values - limit) / limit)
        columns.append(shares)
        for i in np.flatnonzero(~failed & (shares > 0.0)):
            side = "above" if sign > 0.0 else "below"
            also = f"{reasons[i]}; " if reasons[i] else ""
            reasons[i] = f"{also}{name} = {values[i]:.4g} is {side} the limit of {limit:g}"
    table = np.column_stack(columns) if columns else np.zeros((n, 0))
    violation = np.maximum(table, 0.0).sum(axis=1)
    state = np.where(failed, "failed", np.where(violation > 0.0, "infeasible", "feasible"))
    return Judgement(state=state, reason=tuple(reasons), constraints=table, violation=violation)


def scores(evaluations: Evaluations, judgement: Judgement) -> Scores:
    """What a search algorithm may know."""
    return Scores(height_m=evaluations.height_m, energy_j=evaluations.energy_j, violation=judgement.violation)


def _limits(constraints: Constraints) -> list[tuple[str, float, float]]:
    """Measure, limit, and the sign that makes (value - limit) positive when violated."""
    limits = [("height_m", constraints.min_height_m, -1.0)]
    for name, limit, sign in (
        ("energy_j", constraints.max_energy_j, 1.0),
        ("mass_kg", constraints.max_mass_kg, 1.0),
        ("foot_clearance_m", constraints.min_foot_clearance_m, -1.0),
    ):
        if limit is not None:
            limits.append((name, limit, sign))
    return limits
