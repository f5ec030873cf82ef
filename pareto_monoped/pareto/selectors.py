"""What can be asked of a front: one of its designs, under conditions; which designs meet these, and their wording."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
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


@dataclass(frozen=True, slots=True, kw_only=True)
class Extreme:
    """The design with the least or the most of a measure or variable, also where no objective is about it."""

    name: str
    most: bool


Chooser = Knee | Tradeoff | Weights | Compromise | Nearest | Trial | Extreme
"""What chooses, and is not itself a condition."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Among:
    """A choice among the designs that meet all conditions.

    Without ``chooser`` it is the best design in the first objective that no condition is about, or, if they are about
    all objectives, in the second one.
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
    fits = fitting(rows, conditions)
    if not fits.any():
        for condition in conditions:
            if np.isnan(column(rows, condition.name)).all():
                raise SelectionError(f"{asked(condition)}: no design has a value of it; limit another measure")
        raise SelectionError(_unmet(rows, conditions, objectives))
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
    return f"have at {side} {_valued(condition)} of {words_of(condition.name)}"


def _unmet(rows: "DataFrame", conditions: Sequence[Condition], objectives: Objectives) -> str:
    """Return the message on conditions that no design meets: the nearest one, and which of them would have to give."""
    found = rows.iloc[nearest_row(rows, conditions)]
    missed = ", ".join(
        f"{words_of(one.name)} {value_text(one.name, float(found[one.name]))}"
        for one in conditions
        if not meets(np.array([float(found[one.name])]), one)[0]
    )
    values = found[list(objectives.names)].to_numpy(dtype=np.float64).tolist()
    cures = " or ".join(f"{asked(given)} ({by} {give})" for given, by, give in _giving(rows, conditions))
    every = "it" if len(conditions) == 1 else "all"
    return (
        f"{', '.join(map(asked, conditions))}: no stored design meets {every}; the nearest is trial "
        f"{int(found['trial'])} ({objectives.text(values)}) with {missed}; "
        f"{f'met with {cures}' if cures else 'no single one is in the way: relax two'}, or run the study longer"
    )


def _giving(rows: "DataFrame", conditions: Sequence[Condition]) -> list[tuple[Condition, str, str]]:
    """Return each condition as it can be met with all others as they are, by how much it gives, and which way."""
    found = []
    for k, one in enumerate(conditions):
        values = column(rows, one.name)[fitting(rows, [*conditions[:k], *conditions[k + 1 :]])]
        values = values[np.isfinite(values)]
        if len(values):
            value = _enough(float(values.max() if one.side == "min" else values.min()), one.side)
            by = f"{abs(value - one.value):.3g}{_unit(one.name)}"
            found.append((replace(one, value=value), by, "less" if one.side == "min" else "more"))
    return found


def _enough(value: float, side: Side) -> float:
    """Return a number of five digits that a value still meets as a condition."""
    rounded = float(f"{value:.5g}")
    if (rounded > value) if side == "min" else (rounded < value):
        step = 10.0 ** (math.floor(math.log10(abs(value))) - 4)
        rounded = float(f"{rounded - step if side == 'min' else rounded + step:.5g}")
    return rounded


def nearest_row(rows: "DataFrame", conditions: Sequence[Condition]) -> int:
    """Return the position of the design that misses the conditions by least.

    A miss counts as a share of the designs' extent in that quantity. The design with the least greatest share comes
    first, of equal ones that with the least sum.
    """
    missed = np.stack([_shortfall(rows[one.name].to_numpy(dtype=np.float64), one) for one in conditions])
    return int(np.lexsort((missed.sum(axis=0), missed.max(axis=0)))[0])


def _shortfall(values: Floats, condition: Condition) -> Floats:
    """Return by how much each value misses a condition, as a share of the values' extent; infinite without a value."""
    extent = float(np.nanmax(values) - np.nanmin(values))
    beyond = condition.value - values if condition.side == "min" else values - condition.value
    return np.nan_to_num(np.maximum(beyond, 0.0), nan=np.inf) / (extent or 1.0)


def words_of(name: str) -> str:
    """Return what a measure or a variable is called in a sentence."""
    return name if name in _VARIABLES else measure(name).words


def _unit(name: str) -> str:
    """Return its stored unit behind a number; empty for shares and ratios."""
    unit = _VARIABLES[name].unit if name in _VARIABLES else measure(name).unit
    return "" if unit == "1" else f" {unit}"


def value_text(name: str, value: float) -> str:
    """Return a value of a measure or a variable in five digits, with its stored unit."""
    return f"{value:.5g}{_unit(name)}"


def _valued(condition: Condition) -> str:
    return f"{condition.value:g}{_unit(condition.name)}"
