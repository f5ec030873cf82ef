"""What can be asked of a front: one of its designs, under conditions; which designs meet these, and their wording."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.design import VARIABLES
from pareto_monoped.errors import SelectionError
from pareto_monoped.measures import GOAL_NAMES, measure
from pareto_monoped.pareto.objectives import Floats, Objectives

if TYPE_CHECKING:
    from pandas import DataFrame

Side = Literal["min", "max"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Condition:
    """A limit on a stored measure or a design variable."""

    name: str  #: of the measure or variable
    side: Side  #: whether it is at least (``min``) or at most (``max``) ``value``
    value: float  #: in the stored unit
    asked: str = ""  #: how the user wrote it, such as "min-height", for messages; side and name if empty


@dataclass(frozen=True, slots=True, kw_only=True)
class MinHeight:
    """The design that jumps at least ``height_m`` and is best in the first other objective: the least energy."""

    height_m: float


@dataclass(frozen=True, slots=True, kw_only=True)
class MaxEnergy:
    """The design that needs at most ``energy_j`` and is best in the first other objective: the highest jump."""

    energy_j: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Within:
    """The design whose measure is at ``value`` or better, and that is best in the first other objective."""

    measure: str
    value: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Knee:
    """The knee of the front: the design farthest from the line, or the plane, through its ends."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Tradeoff:
    """The design whose neighbours on the front are all poor bargains: they gain least for what they give up."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Weights:
    """The design with the best weighted sum of the objectives, each scaled to the extent of the front."""

    values: tuple[float, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Compromise:
    """The design with the least weighted distance from the best of every objective, also on bent parts of a front."""

    values: tuple[float, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Nearest:
    """The design nearest to a wish: its greatest shortfall in any of the named measures is least."""

    wish: Mapping[str, float]


@dataclass(frozen=True, slots=True, kw_only=True)
class Trial:
    """The trial with this number."""

    number: int


Chooser = Knee | Tradeoff | Weights | Compromise | Nearest | Trial
"""What chooses by the shape of the front, and is not itself a condition."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Among:
    """A choice among the designs that meet all conditions.

    Without ``chooser`` it is the best design in the first objective that no condition is about, or, if they are about
    all objectives, in the first one besides that of the first condition.
    """

    conditions: tuple[Condition | MaxEnergy, ...]
    chooser: Chooser | None = None


Selector = MinHeight | MaxEnergy | Within | Chooser | Among


_VARIABLES = {variable.name: variable for variable in VARIABLES}
CONDITION_NAMES: tuple[str, ...] = (*GOAL_NAMES, *_VARIABLES)
"""What a condition may be about."""


def column(rows: "DataFrame", name: str) -> Floats:
    """Return a measure or variable, shape (n,); NaN for a measure under uncertainty that a study has not."""
    return rows[name].to_numpy(dtype=np.float64) if name in rows else np.full(len(rows), np.nan)


def fitting(rows: "DataFrame", conditions: Sequence[Condition]) -> NDArray[np.bool_]:
    """Return which designs meet all conditions, shape (n,); a design without a value of a measure does not."""
    fits = np.ones(len(rows), dtype=bool)
    for condition in conditions:
        fits &= meets(column(rows, condition.name), condition)
    return fits


def meets(values: Floats, condition: Condition) -> NDArray[np.bool_]:
    """Return which values of the measure or variable meet a condition, shape (n,)."""
    return np.asarray(values >= condition.value if condition.side == "min" else values <= condition.value)


def required_fits(rows: "DataFrame", conditions: Sequence[Condition], objectives: Objectives) -> NDArray[np.bool_]:
    """Return ``fitting``; if no design meets all conditions, refuse them and name the nearest that can be had."""
    for condition in conditions:
        values = column(rows, condition.name)
        if not meets(values, condition).any():
            raise SelectionError(_unmet(values, condition))
    fits = fitting(rows, conditions)
    if not fits.any():
        raise SelectionError(_unmet_together(rows, conditions, objectives))
    return fits


def phrase(conditions: Sequence[Condition]) -> str:
    """Return the conditions in words after "designs that", such as "reach 0.9 m and have at most 4 kg of mass"."""
    return " and ".join(_phrase(condition) for condition in conditions)


def asked(condition: Condition) -> str:
    """Return a condition as the user wrote it, such as "min-height = 0.9 m"."""
    name = condition.asked or f"{condition.side} {condition.name}"
    return f"{name} = {_valued(condition)}"


def _phrase(condition: Condition) -> str:
    if condition.name == "height_m" and condition.side == "min":
        return f"reach {_valued(condition)}"
    if condition.name == "energy_j" and condition.side == "max":
        return f"need at most {_valued(condition)}"
    side = "least" if condition.side == "min" else "most"
    return f"have at {side} {_valued(condition)} of {_words(condition.name)}"


def _unmet(values: Floats, condition: Condition) -> str:
    """Return what to say of a condition that no design meets."""
    if np.isnan(values).all():
        return f"{asked(condition)}: no design on the front has a value of it; limit another measure"
    at_least = condition.side == "min"
    best = np.nanmax(values) if at_least else np.nanmin(values)
    side, what, cure = ("most", "highest", "ask for less") if at_least else ("least", "lowest", "allow more")
    return (
        f"{asked(condition)}: must be at {side} {best:.4f}{_unit(condition.name)}, the front's {what} "
        f"{_words(condition.name)}; {cure}, or run the study longer"
    )


def _unmet_together(rows: "DataFrame", conditions: Sequence[Condition], objectives: Objectives) -> str:
    """Return the message on conditions that no design meets together: the design that comes nearest."""
    row = nearest_row(rows, conditions)
    found = rows.iloc[row]
    missed = ", ".join(
        f"{_words(condition.name)} {found[condition.name]:.4g}{_unit(condition.name)}"
        for condition in conditions
        if not meets(np.array([float(found[condition.name])]), condition)[0]
    )
    values = found[list(objectives.names)].to_numpy(dtype=np.float64).tolist()
    return (
        f"{', '.join(map(asked, conditions))}: no design on the front meets all; the nearest is trial "
        f"{int(found['trial'])} ({objectives.text(values)}) with {missed}; relax a condition, or run the study longer"
    )


def nearest_row(rows: "DataFrame", conditions: Sequence[Condition]) -> int:
    """Return the position of the design that misses the conditions by least.

    A miss counts as a share of the front's extent in that quantity. The design with the least greatest share comes
    first, of equal ones that with the least sum.
    """
    missed = np.stack([_shortfall(rows[one.name].to_numpy(dtype=np.float64), one) for one in conditions])
    return int(np.lexsort((missed.sum(axis=0), missed.max(axis=0)))[0])


def _shortfall(values: Floats, condition: Condition) -> Floats:
    """Return by how much each value misses a condition, as a share of the values' extent; infinite without a value."""
    extent = float(np.nanmax(values) - np.nanmin(values))
    beyond = condition.value - values if condition.side == "min" else values - condition.value
    return np.nan_to_num(np.maximum(beyond, 0.0), nan=np.inf) / (extent or 1.0)


def _words(name: str) -> str:
    """Return what a measure or a variable is called in a sentence."""
    return name if name in _VARIABLES else measure(name).words


def _unit(name: str) -> str:
    """Return its stored unit behind a number; empty for shares and ratios."""
    unit = _VARIABLES[name].unit if name in _VARIABLES else measure(name).unit
    return "" if unit == "1" else f" {unit}"


def _valued(condition: Condition) -> str:
    return f"{condition.value:g}{_unit(condition.name)}"
