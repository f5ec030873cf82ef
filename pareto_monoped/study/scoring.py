"""Judge evaluations by a study's constraints: feasible, infeasible or failed, with a graded violation and a reason."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.jump.evaluate import Evaluations
from pareto_monoped.study.definition import Constraints
from pareto_monoped.study.protocol import Scores

FAILED_VIOLATION = 100.0
"""Violation of a failed jump in each constraint: so large that it ranks behind jumps that only miss a limit."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Constraint:
    """One constraint of a study.

    Attributes:
        key: field of ``definition.Constraints`` with the limit.
        measure: what is limited.
        violated: on which side of the limit a value violates it.
    """

    key: str
    measure: str
    violated: Literal["above", "below"]

    def shares(self, values: NDArray[np.float64], limit: float) -> NDArray[np.float64]:
        """How far values are beyond the limit, as shares of it, shape (n,); they hold it at <= 0."""
        sign = 1.0 if self.violated == "above" else -1.0
        return sign * (values - limit) / limit


CONSTRAINTS: tuple[Constraint, ...] = (
    Constraint(key="min_height_m", measure="height_m", violated="below"),
    Constraint(key="max_energy_j", measure="energy_j", violated="above"),
    Constraint(key="max_mass_kg", measure="mass_kg", violated="above"),
    Constraint(key="min_foot_clearance_m", measure="foot_clearance_m", violated="below"),
    Constraint(key="max_electrical_energy_j", measure="electrical_energy_j", violated="above"),
    Constraint(key="max_peak_gear_torque_hip_n_m", measure="peak_gear_torque_hip_n_m", violated="above"),
    Constraint(key="max_peak_gear_torque_knee_n_m", measure="peak_gear_torque_knee_n_m", violated="above"),
    Constraint(key="max_peak_chain_tension_n", measure="peak_chain_tension_n", violated="above"),
    Constraint(key="max_peak_stop_torque_n_m", measure="peak_stop_torque_n_m", violated="above"),
    Constraint(key="max_stop_energy_j", measure="stop_energy_j", violated="above"),
    Constraint(key="max_peak_foot_force_n", measure="peak_foot_force_n", violated="above"),
    Constraint(key="max_drift_m", measure="drift_m", violated="above"),
    Constraint(key="min_sustained_jumps_per_minute", measure="sustained_jumps_per_minute", violated="below"),
)
"""All constraints that a study may set, in the order in which they are stored and named."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Judgement:
    """How well n evaluations keep the constraints.

    Attributes:
        state: ``feasible``, ``infeasible`` or ``failed``, shape (n,).
        reason: n strings that say why a design is not feasible; empty where it is.
        constraints: how far each of k constraints is missed, as a share of its limit, feasible at <= 0, shape (n, k);
            ``FAILED_VIOLATION`` for a failed jump.
        violation: sum of the positive ``constraints``, shape (n,).
    """

    state: NDArray[np.str_]
    reason: tuple[str, ...]
    constraints: NDArray[np.float64]
    violation: NDArray[np.float64]


def judge(evaluations: Evaluations, constraints: Constraints) -> Judgement:
    """Judge evaluations by a study's constraints.

    The violation is graded: (limit - value) / limit for a lower limit, (value - limit) / limit for an upper one. A
    search can thus see which of two infeasible designs is closer to being feasible.
    """
    n = len(evaluations.height_m)
    failed = (evaluations.status != "ok") | ~np.isfinite(evaluations.height_m) | ~np.isfinite(evaluations.energy_j)
    reasons = list(evaluations.reason)
    columns = []
    for constraint in CONSTRAINTS:
        limit = getattr(constraints, constraint.key)
        if limit is None:
            continue
        values = np.asarray(getattr(evaluations, constraint.measure), dtype=np.float64)
        shares = np.where(failed, FAILED_VIOLATION, constraint.shares(values, limit))
        columns.append(shares)
        for i in np.flatnonzero(~failed & (shares > 0.0)):
            also = f"{reasons[i]}; " if reasons[i] else ""
            reasons[i] = f"{also}{constraint.measure} = {values[i]:.4g} is {constraint.violated} the limit of {limit:g}"
    table = np.column_stack(columns) if columns else np.zeros((n, 0))
    violation = np.maximum(table, 0.0).sum(axis=1)
    state = np.where(failed, "failed", np.where(violation > 0.0, "infeasible", "feasible"))
    return Judgement(state=state, reason=tuple(reasons), constraints=table, violation=violation)


def scores(evaluations: Evaluations, judgement: Judgement) -> Scores:
    """What a search algorithm may know about these evaluations."""
    return Scores(height_m=evaluations.height_m, energy_j=evaluations.energy_j, violation=judgement.violation)
