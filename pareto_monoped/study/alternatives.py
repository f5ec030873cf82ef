"""Alternatives to a picked design: trials that cost about as much and are quite different robots."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd

from pareto_monoped.errors import SelectionError
from pareto_monoped.pareto.alternatives import distances, most_different, prices
from pareto_monoped.pareto.conditions import fitting
from pareto_monoped.pareto.objectives import Objectives
from pareto_monoped.pareto.selectors import Condition
from pareto_monoped.study.differences import differences, scale_of
from pareto_monoped.study.reader import StudyData

TOLERANCE = 0.02
"""Share by which an alternative may be worse in an objective, unless another is asked for. Our own choice: the seeds of
a search differ by a percent."""
_TOLD = 0.0005
"""Least relative change of an objective that is told: half a unit of what is printed."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Alternative:
    """A design that costs about as much as the picked one.

    Attributes:
        trial: its number.
        objectives: of the study.
        values: of the objectives, in stored units.
        changes: of the objectives from the picked design, as shares of its values.
        price: the greatest loss in any objective, as a share of the picked design's value; at most 0 if there is none.
        distance: from the picked design, see ``pareto.alternatives.distances``.
        differs: how it differs, in phrases.
        audited: whether it has an audit. Audits are for the front; an alternative is often just behind it.
    """

    trial: int
    objectives: Objectives
    values: tuple[float, ...]
    changes: tuple[float, ...]
    price: float
    distance: float
    differs: tuple[str, ...]
    audited: bool

    def text(self) -> str:
        """How it differs and its price, such as "shank-long, 0.306 and 0.401 m; 0.8 percent more energy"."""
        changed = [
            f"{100.0 * abs(change):.1f} percent {'more' if change > 0.0 else 'less'} {entry.words}"
            for entry, change in zip(self.objectives.measures, self.changes, strict=True)
            if abs(change) >= _TOLD
        ]
        return "; ".join([*self.differs, ", ".join(changed) or "the same price"])

    def as_dict(self) -> dict[str, object]:
        """As JSON values."""
        return {
            "trial": self.trial,
            **dict(zip(self.objectives.names, self.values, strict=True)),
            "changes": dict(zip(self.objectives.names, map(_finite, self.changes), strict=True)),
            "price": _finite(self.price),
            "distance": self.distance,
            "differs": list(self.differs),
            "audited": self.audited,
        }


def alternatives(
    data: StudyData,
    trial: int,
    *,
    count: int = 5,
    tolerance: float = TOLERANCE,
    conditions: Sequence[Condition] = (),
    rows: pd.DataFrame | None = None,
) -> tuple[Alternative, ...]:
    """The designs of a study that cost about as much as one of its trials and differ most in their variables.

    All feasible trials that have not failed an audit count, not only the front, because a different robot that is worse
    by half a percent is never on it.

    Args:
        data: the study.
        trial: the picked one.
        count: how many at most.
        tolerance: share of the picked design's value by which each objective may be worse.
        conditions: which alternatives must meet, too.
        rows: the trials to compare, with the measures to compare them by, such as those under uncertainty; the study's
            trials if None.

    Returns:
        By ``pareto.alternatives.most_different``, the most different first.

    Raises:
        SelectionError: no such trial, or one without a jump.
    """
    objectives = data.study.objectives
    names = list(objectives.names)
    known = data.trials if rows is None else rows
    picked = known[known["trial"] == trial]
    values = picked[names].to_numpy(dtype=np.float64)
    if len(picked) == 0 or not np.isfinite(values).all():
        raise SelectionError(f"trial = {trial}: must be a trial of the study that jumped; give another number")
    near = _within(data, known, trial, values[0], tolerance, conditions)
    table = pd.concat([picked, near], ignore_index=True)
    scale = scale_of(data, table)
    chosen = most_different(scale.points, 0, count, scale.categories)
    apart = distances(scale.points, scale.points[0], scale.categories)
    cost = prices(table[names].to_numpy(dtype=np.float64), values[0], objectives)
    audited = table["trial"].isin(data.audits["trial"]).to_numpy()
    return tuple(
        Alternative(
            trial=int(table["trial"].iloc[row]),
            objectives=objectives,
            values=tuple(table[names].iloc[row].astype(float).tolist()),
            changes=_changes(table[names].iloc[row].to_numpy(dtype=np.float64), values[0]),
            price=float(cost[row]),
            distance=float(apart[row]),
            differs=differences(scale, table, row, 0),
            audited=bool(audited[row]),
        )
        for row in chosen
    )


def _within(
    data: StudyData,
    trials: pd.DataFrame,
    trial: int,
    of: np.ndarray,
    tolerance: float,
    conditions: Sequence[Condition],
) -> pd.DataFrame:
    """The other feasible trials whose price is within the tolerance, the cheapest first."""
    able = (trials["state"] == "feasible").to_numpy() & (trials["trial"] != trial).to_numpy()
    able &= ~trials["trial"].isin(data.ill_conditioned).to_numpy()
    able &= fitting(trials, conditions)
    rows = trials[able]
    cost = prices(rows[list(data.study.objectives.names)].to_numpy(dtype=np.float64), of, data.study.objectives)
    order = np.argsort(cost, kind="stable")
    return rows.iloc[order[cost[order] <= tolerance]]


def _changes(values: np.ndarray, of: np.ndarray) -> tuple[float, ...]:
    """Changes as shares; a change from 0 is infinite."""
    with np.errstate(divide="ignore", invalid="ignore"):
        shares = np.where(values == of, 0.0, (values - of) / np.abs(of))
    return tuple(shares.tolist())


def _finite(value: float) -> float | None:
    """A number for JSON, which knows no infinity."""
    return value if np.isfinite(value) else None
