"""Pick one design from the front and say why.

Every way to choose, such as weights or a wish, is a score of the designs on the whole front. Conditions only say which
designs may be chosen, so a condition that the chosen design meets never changes the choice.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.errors import SelectionError
from pareto_monoped.measures import ENERGIES, Measure, measure, nominal
from pareto_monoped.pareto.objectives import HEIGHT_AND_ENERGY, Floats, Objectives
from pareto_monoped.pareto.selectors import (
    Among,
    Chooser,
    Compromise,
    Condition,
    Knee,
    MaxEnergy,
    MinHeight,
    Nearest,
    Selector,
    Tradeoff,
    Trial,
    Weights,
    Within,
    column,
    phrase,
    required_fits,
)
from pareto_monoped.pareto.trade_offs import Scored, knee, losses, scaled, tradeoff

if TYPE_CHECKING:
    from pandas import DataFrame


def weighted(values: Floats, weights: tuple[float, ...], objectives: Objectives) -> Scored:
    """Compute scores by the weighted sum of the objectives, each scaled to the extent of the front."""
    value = -(scaled(values) * objectives.signs) @ _checked("weights", weights, objectives)
    terms = "".join(
        f"{' + ' if entry.direction == 'maximise' else ' - '}{weight:g} x {entry.words}"
        for entry, weight in zip(objectives.measures, weights, strict=True)
    )
    sum_ = terms.removeprefix(" + ").strip()
    return Scored(
        score=value, why=lambda row: f"the best weighted sum, {sum_} = {value[row]:.3f}, scaled to the front's extent"
    )


def compromise(values: Floats, weights: tuple[float, ...], objectives: Objectives) -> Scored:
    """Compute scores by the weighted Euclidean distance from the best of every objective, scaled (Zeleny 1973)."""
    distance = np.linalg.norm(losses(values, objectives) * _checked("compromise", weights, objectives), axis=1)
    best = objectives.signs * objectives.minimised(values).min(axis=0)
    ideal = objectives.text(best.tolist())
    return Scored(
        score=-distance,
        why=lambda row: (
            f"the compromise, nearest ({distance[row]:.3f}, weighted, scaled to the front's extent) to the best of "
            f"every objective, {ideal}"
        ),
    )


def nearest(rows: "DataFrame", wish: Mapping[str, float]) -> Scored:
    """Compute scores by the greatest shortfall from the wish (Wierzbicki 1980, The use of reference objectives).

    Shortfalls are scaled to the extent of the front. A wish that several designs surpass goes to the one that surpasses
    it most. Of designs with the same greatest shortfall, the one with the least sum of them comes first.
    """
    columns = []
    for name, wanted in wish.items():
        values = column(rows, name)
        if np.isnan(values).all():
            raise SelectionError(f"nearest {name} = {wanted:g}: no design on the front has a value of it; drop it")
        sign = -1.0 if measure(name).direction == "maximise" else 1.0
        extent = float(np.nanmax(values) - np.nanmin(values))
        columns.append(np.nan_to_num(sign * (values - wanted) / (extent or 1.0), nan=np.inf))
    short = np.stack(columns, axis=1)
    worst = short.max(axis=1)
    rank = np.empty(len(rows))
    rank[np.lexsort((short.sum(axis=1), worst))] = -np.arange(len(rows), dtype=np.float64)
    point = ", ".join(f"{measure(name).words} {measure(name).text(value)}" for name, value in wish.items())

    def why(row: int) -> str:
        if worst[row] <= 0.0:
            return f"better than the wish ({point}) in every measure, by {-worst[row]:.3f} of the front's extent"
        return f"nearest to the wish ({point}), at most {worst[row]:.3f} of the front's extent short of it"

    return Scored(score=rank, why=why)


def _checked(option: str, weights: tuple[float, ...], objectives: Objectives) -> Floats:
    """Return the weights as an array, shape (m,); there must be one of at least 0 per objective."""
    values = np.array(weights, dtype=np.float64)
    count = {2: "two", 3: "three"}[len(objectives.names)]
    if len(values) != len(objectives.names) or not (
        np.isfinite(values).all() and values.min() >= 0.0 and values.sum() > 0.0
    ):
        raise SelectionError(
            f"{option} = {','.join(f'{value:g}' for value in weights)}: must be {count} finite numbers of at least 0, "
            f"one per objective, not all 0; give for example {','.join('1' * len(objectives.names))}"
        )
    return values


@dataclass(frozen=True, slots=True, kw_only=True)
class Pick:
    """A picked trial, the reason in one sentence, and the conditions that it was picked under."""

    trial: int
    why: str
    conditions: tuple[Condition, ...] = ()


def pick(front: "DataFrame", selector: Selector, objectives: Objectives = HEIGHT_AND_ENERGY) -> Pick:
    """Pick the design of ``front``, one row per design in any order, that ``selector`` asks for.

    Raises:
        SelectionError: the front is empty, none of its designs fits, or the selector does not suit the objectives.
    """
    if len(front) == 0:
        raise SelectionError(
            "front: has 0 designs, at least 1 is needed to pick from; run the study longer or relax its constraints"
        )
    rows = front.sort_values(objectives.names[0], kind="stable")
    conditions, chooser = _asked(selector, objectives)
    fits = required_fits(rows, conditions, objectives)
    if chooser is None:
        row, why = _best(rows, fits, conditions, objectives)
    else:
        row, why = _chosen(rows, fits, chooser, objectives)
        if conditions:
            why += f", of the {fits.sum()} designs on the front that {phrase(conditions)}"
    found = rows.iloc[row]
    values = found[list(objectives.names)].to_numpy(dtype=np.float64).tolist()
    trial = int(found["trial"])
    return Pick(trial=trial, why=f"trial {trial} ({objectives.text(values)}): {why}", conditions=conditions)


def _asked(selector: Selector, objectives: Objectives) -> tuple[tuple[Condition, ...], Chooser | None]:
    """Return any selector as conditions, and what chooses among the designs that meet them."""
    match selector:
        case Among():
            return tuple(_condition(one, objectives) for one in selector.conditions), selector.chooser
        case MinHeight(height_m=wanted):
            asked = Condition(name="height_m", side="min", value=wanted, asked="min-height")
            return (_condition(asked, objectives),), None
        case MaxEnergy():
            return (_condition(selector, objectives),), None
        case Within(measure=name, value=value):
            return (at_or_better(name, value),), None
        case _:
            return (), selector


def _condition(given: Condition | MaxEnergy, objectives: Objectives) -> Condition:
    """Return a condition as it is; ``MaxEnergy`` as one on the energy that is an objective.

    What is asked of "the height" or "the energy" is asked of the statistic of it that is an objective.
    """
    if isinstance(given, Condition):
        own = _objective(given.name, objectives) if given.asked == "min-height" else None
        return given if own is None else replace(given, name=own)
    for energy in ENERGIES:
        if (name := _objective(energy, objectives)) is not None:
            return Condition(name=name, side="max", value=given.energy_j, asked="max-energy")
    raise SelectionError(
        f"max-energy: no objective is an energy, they are {', '.join(objectives.names)}; limit another measure"
    )


def _objective(name: str, objectives: Objectives) -> str | None:
    """Return the objective that is about a measure: the measure itself, or else one of its statistics."""
    found = [one for one in objectives.names if nominal(one) == name]
    return name if name in found else next(iter(found), None)


def at_or_better(name: str, value: float) -> Condition:
    """Return the condition of ``Within``: a measure at a value or better."""
    return Condition(name=name, side="min" if measure(name).direction == "maximise" else "max", value=value, asked=name)


def _best(
    rows: "DataFrame", fits: NDArray[np.bool_], conditions: Sequence[Condition], objectives: Objectives
) -> tuple[int, str]:
    """Return the best of the designs that fit in the first objective without a condition; ties by the others."""
    limited = {condition.name for condition in conditions}
    free = [entry for entry in objectives.measures if entry.name not in limited]
    other = free[0] if free else objectives.other_than(conditions[0].name)
    order = [other, *(entry for entry in objectives.measures if entry != other)]
    less_is_better = [rows[one.name] * (-1.0 if one.direction == "maximise" else 1.0) for one in reversed(order)]
    places = np.lexsort([*less_is_better, ~fits])
    why = f"the {_superlative(other)} of the {fits.sum()} designs on the front that {phrase(conditions)}"
    return int(places[0]), why


def _superlative(entry: Measure) -> str:
    if entry.name == "height_m":
        return "highest jump"
    return f"{'most' if entry.direction == 'maximise' else 'least'} {entry.words}"


def _chosen(rows: "DataFrame", fits: NDArray[np.bool_], chooser: Chooser, objectives: Objectives) -> tuple[int, str]:
    """Return the design of the greatest score among those that fit, and why."""
    values = rows[list(objectives.names)].to_numpy(dtype=np.float64)
    match chooser:
        case Knee():
            scored = knee(values, objectives)
        case Tradeoff():
            scored = tradeoff(values, objectives)
        case Weights():
            scored = weighted(values, chooser.values, objectives)
        case Compromise():
            scored = compromise(values, chooser.values, objectives)
        case Nearest(wish=wish):
            scored = nearest(rows, wish)
        case Trial(number=number):
            return _numbered(rows, fits, number), "asked for by its number"
    row = int(np.argmax(np.where(fits, scored.score, -np.inf)))
    return row, scored.why(row)


def _numbered(rows: "DataFrame", fits: NDArray[np.bool_], number: int) -> int:
    trials = rows["trial"].to_numpy()
    found = np.flatnonzero((trials == number) & fits)
    if len(found):
        return int(found[0])
    where = "be on the front, which has" if fits.all() else "be on the front and meet the conditions, as do"
    raise SelectionError(f"trial = {number}: must {where} trials {_listed(trials[fits])}; pick one of them")


def _listed(trials: NDArray[np.int64], most: int = 8) -> str:
    shown = ", ".join(str(int(trial)) for trial in sorted(trials)[:most])
    return shown if len(trials) <= most else f"{shown}, ... ({len(trials)} in all)"
