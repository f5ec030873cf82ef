"""Alternatives to a picked design: trials that cost about as much and are quite different robots."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from pareto_monoped.definition.variables import Bounds
from pareto_monoped.design import KNOTS, LENGTHS, RATIOS, VARIABLES
from pareto_monoped.errors import SelectionError
from pareto_monoped.pareto.objectives import Floats, Objectives
from pareto_monoped.pareto.selectors import Condition, fitting
from pareto_monoped.search.algorithm import MOTOR_OF
from pareto_monoped.storage.reader import StudyData

LEAST_DISTANCE = 0.02
"""Distance below which two designs count as the same. Our own choice: 2 percent of one variable's range, which is 4 mm
of a link, is less than anybody would call another robot."""
_VARIABLES = {variable.name: variable for variable in (*VARIABLES, *KNOTS)}
_WORTH_TELLING = 0.05
"""Least difference of a number that is told, as a share of its range. Our own choice: 1 cm of a link."""
_MOST_TOLD = 3
"""Differences told of one design, the greatest first; more make a list instead of a sentence."""
_LONGER = 1.02
"""From this ratio of the links on, one of them is called long."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Scale:
    """Designs as points whose distances say how much they differ."""

    names: tuple[str, ...]  #: of the d free variables, and of the choices of a motor (``MOTOR_OF``)
    #: Shape (n, d): numbers as shares of their ranges, gearboxes by their place in the list of those that the study's
    #: trials have, motors by number
    points: Floats
    categories: NDArray[np.bool_]  #: which of them have no order, shape (d,)


def scale_of(data: StudyData, trials: pd.DataFrame) -> Scale:
    """Return the scale of some trials of a study."""
    names, columns = list(data.study.free), []
    for name in names:
        values = trials[name].to_numpy(dtype=np.float64)
        bounds = data.study.variables[name]
        assert isinstance(bounds, Bounds)
        if name in RATIOS and data.study.gear_list:
            listed = np.unique(data.trials[name].to_numpy(dtype=np.float64))
            columns.append(np.searchsorted(listed, values) / max(len(listed) - 1, 1))
        else:
            columns.append((values - bounds.lower) / (bounds.upper - bounds.lower))
    for choice in data.study.motor_choices:
        names.append(choice)
        known = np.unique(data.trials[choice].to_numpy(dtype=np.str_))
        columns.append(np.searchsorted(known, trials[choice].to_numpy(dtype=np.str_)).astype(np.float64))
    return Scale(
        names=tuple(names),
        points=np.stack(columns, axis=1),
        categories=np.array([name in MOTOR_OF for name in names]),
    )


def differences(scale: Scale, trials: pd.DataFrame, row: int, given: int) -> tuple[str, ...]:
    """Return how the designs in two rows differ, in at most ``_MOST_TOLD`` phrases, the greatest difference first."""
    apart = np.abs(scale.points[row] - scale.points[given])
    apart[scale.categories] = apart[scale.categories] != 0.0
    design, other = trials.iloc[row], trials.iloc[given]
    told: list[str] = []
    for place in np.argsort(-apart, kind="stable"):
        name = scale.names[place]
        always = name in MOTOR_OF or name in RATIOS
        if apart[place] == 0.0 or (apart[place] < _WORTH_TELLING and told and not always):
            continue
        phrase = _phrase(name, design, other)
        if phrase not in told:
            told.append(phrase)
    return tuple(told[:_MOST_TOLD])


def _phrase(name: str, design: pd.Series, other: pd.Series) -> str:
    if name in MOTOR_OF:
        return f"{name.replace('_', ' ')} {design[name]} instead of {other[name]}"
    if name in RATIOS:
        return f"{name.removesuffix('_ratio')} gearbox {design[name]:.3g} instead of {other[name]:.3g}"
    if name in LENGTHS:
        if (shape := _proportions(design)) != _proportions(other):
            thigh, shank = (float(design[length]) for length in LENGTHS)
            return f"{shape}, {thigh:.3f} and {shank:.3f} m"
        change = 1000.0 * (float(design[name]) - float(other[name]))
        return f"{name.removesuffix('_length_m')} {abs(change):.0f} mm {'longer' if change > 0.0 else 'shorter'}"
    variable = _VARIABLES[name]
    return f"{variable.symbol} {design[name]:.3g} instead of {other[name]:.3g} {variable.unit}"


def _proportions(design: pd.Series) -> str:
    """Return which link is the long one."""
    thigh, shank = (float(design[length]) for length in LENGTHS)
    if shank > _LONGER * thigh:
        return "shank-long"
    return "thigh-long" if thigh > _LONGER * shank else "equal links"


TOLERANCE = 0.02
"""Share by which an alternative may be worse in an objective, unless another is asked for. Our own choice: the seeds of
a search differ by a percent."""
_TOLD = 0.0005
"""Least relative change of an objective that is told: half a unit of what is printed."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Alternative:
    """A design that costs about as much as the picked one."""

    trial: int  #: its number
    objectives: Objectives  #: of the study
    values: tuple[float, ...]  #: of the objectives, in stored units
    changes: tuple[float, ...]  #: of the objectives from the picked design, as shares of its values
    #: The greatest loss in any objective, as a share of the picked design's value; at most 0 if there is none
    price: float
    distance: float  #: from the picked design, see ``distances``
    differs: tuple[str, ...]  #: how it differs, in phrases
    audited: bool  #: whether it has an audit. Audits are for the front; an alternative is often just behind it.

    def text(self) -> str:
        """Return how it differs and its price, such as "shank-long, 0.306 and 0.401 m; 0.8 percent more energy"."""
        changed = [
            f"{100.0 * abs(change):.1f} percent {'more' if change > 0.0 else 'less'} {entry.words}"
            for entry, change in zip(self.objectives.measures, self.changes, strict=True)
            if abs(change) >= _TOLD
        ]
        return "; ".join([*self.differs, ", ".join(changed) or "the same price"])

    def as_dict(self) -> dict[str, object]:
        """Return JSON values."""
        return {
            "trial": self.trial,
            **dict(zip(self.objectives.names, self.values, strict=True)),
            "changes": dict(zip(self.objectives.names, map(_finite, self.changes), strict=True)),
            "price": _finite(self.price),
            "distance": self.distance,
            "differs": list(self.differs),
            "audited": self.audited,
        }


def prices(values: Floats, of: Floats, objectives: Objectives) -> Floats:
    """Return what designs, (n, m), cost against one, (m,): the greatest loss as a share of its value, (n,).

    A design that is worse in no objective costs at most 0. Where the given value is 0, any loss is infinite.
    """
    lost = objectives.minimised(values) - objectives.minimised(of)
    with np.errstate(divide="ignore", invalid="ignore"):
        shares = np.where(lost == 0.0, 0.0, lost / np.abs(of))
    return np.asarray(shares.max(axis=1))


def distances(points: Floats, to: Floats, categories: NDArray[np.bool_]) -> Floats:
    """Return distances of designs, shape (n, d), from one design, shape (d,), as shares of the variables' ranges, (n,).

    Numbers are scaled so that their range is 1; different values of ``categories``, without an order, are 1 apart.
    """
    apart = np.abs(points - to)
    apart[:, categories] = apart[:, categories] != 0.0
    return np.asarray(np.linalg.norm(apart, axis=1))


def most_different(points: Floats, given: int, count: int, categories: NDArray[np.bool_]) -> list[int]:
    """Return up to ``count`` rows of designs that differ most from a given one and from each other.

    Greedy: each next design is the one whose nearest design among those taken is farthest, of equals the first
    (Gonzalez 1985, who shows that the least distance is at least half of the best possible). It ends where that is
    below ``LEAST_DISTANCE``.
    """
    taken: list[int] = []
    nearest = distances(points, points[given], categories)
    while len(taken) < count:
        row = int(np.argmax(nearest))
        if nearest[row] < LEAST_DISTANCE:
            break
        taken.append(row)
        nearest = np.minimum(nearest, distances(points, points[row], categories))
    return taken


def alternatives(
    data: StudyData,
    trial: int,
    *,
    count: int = 5,
    tolerance: float = TOLERANCE,
    conditions: Sequence[Condition] = (),
    rows: pd.DataFrame | None = None,
) -> tuple[Alternative, ...]:
    """Return the designs that cost about as much as a trial and differ most in their variables, these first.

    All feasible trials that have not failed an audit count, not only the front, because a different robot that is worse
    by half a percent is never on it. Each objective may be worse by the share ``tolerance``. ``rows`` are the trials to
    compare, such as those with measures under uncertainty; the study's if None.

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
    of: Floats,
    tolerance: float,
    conditions: Sequence[Condition],
) -> pd.DataFrame:
    """Return the other feasible trials whose price is within the tolerance, the cheapest first."""
    able = (trials["state"] == "feasible").to_numpy() & (trials["trial"] != trial).to_numpy()
    able &= ~trials["trial"].isin(data.ill_conditioned).to_numpy()
    able &= fitting(trials, conditions)
    rows = np.flatnonzero(able)
    values = trials[list(data.study.objectives.names)].to_numpy(dtype=np.float64)[rows]
    cost = prices(values, of, data.study.objectives)
    order = np.argsort(cost, kind="stable")
    return trials.iloc[rows[order[cost[order] <= tolerance]]]


def _changes(values: Floats, of: Floats) -> tuple[float, ...]:
    """Return changes as shares; a change from 0 is infinite."""
    with np.errstate(divide="ignore", invalid="ignore"):
        shares = np.where(values == of, 0.0, (values - of) / np.abs(of))
    return tuple(shares.tolist())


def _finite(value: float) -> float | None:
    """Return a number for JSON, which knows no infinity."""
    return value if np.isfinite(value) else None
