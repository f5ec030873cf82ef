"""Pick one design from the front and say why."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.errors import SelectionError
from pareto_monoped.measures import Measure, measure
from pareto_monoped.pareto.objectives import HEIGHT_AND_ENERGY, Objectives

if TYPE_CHECKING:
    # Not at run time: importing pandas takes longer than to pick, and ``export --case`` needs none.
    from pandas import DataFrame

Floats = NDArray[np.float64]

_ENERGIES = ("energy_j", "electrical_energy_j")
"""The measures that ``MaxEnergy`` may mean; it takes the first that is an objective."""


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
    """The design whose measure is at ``value`` or better, and that is best in the first other objective.

    ``value`` is in the measure's stored unit.
    """

    measure: str
    value: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Knee:
    """The knee of the front: the design farthest from the line, or the plane, through its ends."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Weights:
    """The design with the best weighted sum of the objectives, each scaled to the extent of the front."""

    values: tuple[float, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Trial:
    """The trial with this number."""

    number: int


Selector = MinHeight | MaxEnergy | Within | Knee | Weights | Trial


@dataclass(frozen=True, slots=True, kw_only=True)
class Pick:
    """A picked trial and the reason in one sentence."""

    trial: int
    why: str


def pick(front: "DataFrame", selector: Selector, objectives: Objectives = HEIGHT_AND_ENERGY) -> Pick:
    """Pick the design of ``front`` that ``selector`` asks for.

    Args:
        front: one row per design, in any order, with the column ``trial`` and one per objective; for ``Within`` also
            that of its measure.
        selector: which design.
        objectives: under which the designs do not dominate each other.

    Raises:
        SelectionError: the front is empty, none of its designs fits, or the selector does not suit the objectives.
    """
    if len(front) == 0:
        raise SelectionError(
            "front: has 0 designs, at least 1 is needed to pick from; run the study longer or relax its constraints"
        )
    rows = front.sort_values(objectives.names[0], kind="stable")
    trials = rows["trial"].to_numpy()
    values = rows[list(objectives.names)].to_numpy(dtype=np.float64)
    match selector:
        case MinHeight(height_m=wanted):
            row, why = _within(rows, Within(measure="height_m", value=wanted), objectives, "min-height")
        case MaxEnergy(energy_j=allowed):
            row, why = _within(rows, Within(measure=_energy(objectives), value=allowed), objectives, "max-energy")
        case Within(measure=name):
            row, why = _within(rows, selector, objectives, name)
        case Knee():
            row, why = _knee(values, objectives)
        case Weights():
            row, why = _weights(values, selector, objectives)
        case Trial(number=number):
            found = np.flatnonzero(trials == number)
            if len(found) == 0:
                raise SelectionError(
                    f"trial = {number}: must be on the front, which has trials {_listed(trials)}; pick one of them"
                )
            row, why = int(found[0]), "asked for by its number"
    return Pick(trial=int(trials[row]), why=f"trial {int(trials[row])} ({objectives.text(values[row])}): {why}")


def _energy(objectives: Objectives) -> str:
    for name in _ENERGIES:
        if name in objectives.names:
            return name
    raise SelectionError(
        f"max-energy: no objective is an energy, they are {', '.join(objectives.names)}; limit another measure"
    )


def _within(rows: "DataFrame", asked: Within, objectives: Objectives, name: str) -> tuple[int, str]:
    limited, other = measure(asked.measure), objectives.other_than(asked.measure)
    more_is_better = limited.direction == "maximise"
    column = rows[asked.measure].to_numpy(dtype=np.float64)
    fits = np.flatnonzero(column >= asked.value if more_is_better else column <= asked.value)
    unit = "" if limited.unit == "1" else f" {limited.unit}"
    wanted = f"{asked.value:g}{unit}"
    if np.isnan(column).all():
        raise SelectionError(f"{name} = {wanted}: no design on the front has a value of it; limit another measure")
    if len(fits) == 0:
        best = np.nanmax(column) if more_is_better else np.nanmin(column)
        side, what, cure = ("most", "highest", "ask for less") if more_is_better else ("least", "lowest", "allow more")
        raise SelectionError(
            f"{name} = {wanted}: must be at {side} {best:.4f}{unit}, the front's {what} {limited.words}; "
            f"{cure}, or run the study longer"
        )
    values = rows[other.name].to_numpy(dtype=np.float64)[fits]
    row = int(fits[np.argmax(values) if other.direction == "maximise" else np.argmin(values)])
    return row, (
        f"the {_superlative(other)} of the {len(fits)} designs on the front that "
        f"{_condition(limited, wanted, more_is_better)}"
    )


def _superlative(entry: Measure) -> str:
    if entry.name == "height_m":
        return "highest jump"
    return f"{'most' if entry.direction == 'maximise' else 'least'} {entry.words}"


def _condition(limited: Measure, wanted: str, more_is_better: bool) -> str:
    if limited.name == "height_m":
        return f"reach {wanted}"
    if limited.name == "energy_j":
        return f"need at most {wanted}"
    return f"have at {'least' if more_is_better else 'most'} {wanted} of {limited.words}"


def _knee(values: Floats, objectives: Objectives) -> tuple[int, str]:
    """Das 1999 (On characterizing the "knee" of the Pareto curve): the greatest distance from the chord.

    With each objective scaled to the extent of the front and its better end at 1, the ends of a front of two objectives
    are (0, 1) and (1, 0), and a point's distance from the chord between them is (sum of the scaled objectives - 1) /
    sqrt(2). For three objectives the chord becomes the plane through (1, 0, 0), (0, 1, 0) and (0, 0, 1), and the
    divisor sqrt(3).
    """
    n, m = values.shape
    # The better end of a minimised objective lies at 1 - scaled. The ones are added last: with the paper's objectives
    # nothing is left of them, so that no digit is lost.
    ones = (objectives.signs > 0.0).sum() - 1
    distance = (-(_scaled(values) * objectives.signs).sum(axis=1) + ones) / np.sqrt(float(m))
    row = int(np.argmax(distance))
    if n < m + 1:
        return row, f"the front has only {n} design(s), so its knee is an end of it"
    if m == 2:
        first, last = values[0], values[-1]
        if objectives == HEIGHT_AND_ENERGY:
            ends = [f"{height:.3f} m at {energy:.2f} J" for height, energy in (first, last)]
        else:
            ends = [objectives.text(end) for end in (first, last)]
        where = f"the chord between the front's ends {ends[0]} and {ends[1]}"
    else:
        where = "the plane through the best of each objective"
    return row, f"the knee, farthest ({distance[row]:.3f} of the scaled front) from {where}"


def _weights(values: Floats, asked: Weights, objectives: Objectives) -> tuple[int, str]:
    weights, given = np.array(asked.values, dtype=np.float64), ",".join(f"{value:g}" for value in asked.values)
    count = {2: "two", 3: "three"}[len(objectives.names)]
    if len(weights) != len(objectives.names) or not (
        np.isfinite(weights).all() and weights.min() >= 0.0 and weights.sum() > 0.0
    ):
        raise SelectionError(
            f"weights = {given}: must be {count} finite numbers of at least 0, one per objective, not all 0; "
            f"give for example {','.join('1' * len(objectives.names))}"
        )
    value = -(_scaled(values) * objectives.signs) @ weights
    row = int(np.argmax(value))
    terms = "".join(
        f"{' + ' if entry.direction == 'maximise' else ' - '}{weight:g} x {entry.words}"
        for entry, weight in zip(objectives.measures, weights, strict=True)
    )
    return (
        row,
        f"the best weighted sum, {terms.removeprefix(' + ').strip()} = {value[row]:.3f}, scaled to the front's extent",
    )


def _scaled(values: Floats) -> Floats:
    """Each column scaled to its extent, from 0 at its least to 1 at its greatest value; zeros where all are equal."""
    least, extent = values.min(axis=0), np.ptp(values, axis=0)
    return np.where(extent > 0.0, (values - least) / np.where(extent > 0.0, extent, 1.0), 0.0)


def _listed(trials: NDArray[np.int64], most: int = 8) -> str:
    shown = ", ".join(str(int(trial)) for trial in sorted(trials)[:most])
    return shown if len(trials) <= most else f"{shown}, ... ({len(trials)} in all)"
