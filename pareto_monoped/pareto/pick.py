"""Pick one design and say why: conditions make the front, and a score chooses on it.

The front is that of the designs that meet the conditions, not of all. Scores, such as those by weights or by a wish,
are scaled to the front without conditions, and never better for a design that another one dominates. So a condition
that the chosen design meets does not change the choice, except by trade-offs, whose neighbours it takes away.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.errors import SelectionError
from pareto_monoped.measures import ENERGIES, Measure, measure, nominal
from pareto_monoped.pareto.front import front_mask
from pareto_monoped.pareto.objectives import HEIGHT_AND_ENERGY, Floats, Objectives
from pareto_monoped.pareto.selectors import (
    Among,
    Chooser,
    Compromise,
    Condition,
    Extreme,
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
    fitting,
    phrase,
    required_fits,
    value_text,
    words_of,
)
from pareto_monoped.pareto.trade_offs import Scored, knee, losses, scaled, tradeoff

if TYPE_CHECKING:
    from pandas import DataFrame


def front_within(
    rows: "DataFrame", conditions: Sequence[Condition], objectives: Objectives, able: NDArray[np.bool_] | None = None
) -> NDArray[np.bool_]:
    """Find the non-dominated designs of those that meet the conditions, and are at the mask ``able``, shape (n,)."""
    fits = fitting(rows, conditions)
    values = np.stack([column(rows, name) for name in objectives.names], axis=1)
    return front_mask(values, objectives, fits if able is None else fits & able)


def weighted(values: Floats, front: Floats, weights: tuple[float, ...], objectives: Objectives) -> Scored:
    """Compute scores by the weighted sum of the objectives, each scaled to the extent of the front."""
    value = -(scaled(values, front) * objectives.signs) @ _checked("weights", weights, objectives)
    terms = "".join(
        f"{' + ' if entry.direction == 'maximise' else ' - '}{weight:g} x {entry.words}"
        for entry, weight in zip(objectives.measures, weights, strict=True)
    )
    sum_ = terms.removeprefix(" + ").strip()
    return Scored(
        score=value, why=lambda row: f"the best weighted sum, {sum_} = {value[row]:.3f}, scaled to the front's extent"
    )


def compromise(values: Floats, front: Floats, weights: tuple[float, ...], objectives: Objectives) -> Scored:
    """Compute scores by the weighted Euclidean distance from the best of every objective, scaled (Zeleny 1973)."""
    weighed = losses(values, front, objectives) * _checked("compromise", weights, objectives)
    distance = np.linalg.norm(weighed, axis=1)
    best = objectives.signs * objectives.minimised(front).min(axis=0)
    ideal = objectives.text(best.tolist())
    return Scored(
        score=-distance,
        why=lambda row: (
            f"the compromise, nearest ({distance[row]:.3f}, weighted, scaled to the front's extent) to the best of "
            f"every objective, {ideal}"
        ),
    )


def nearest(rows: "DataFrame", front: "DataFrame", everyone: "DataFrame", wish: Mapping[str, float]) -> Scored:
    """Compute scores by the greatest shortfall from the wish (Wierzbicki 1980, The use of reference objectives).

    Shortfalls are scaled to the extent of the front, or of ``everyone`` where the front has none. A wish that several
    designs surpass goes to the one that surpasses it most. Of designs with the same greatest shortfall, the one with
    the least sum of them comes first.
    """
    columns = []
    for name, wanted in wish.items():
        values = column(rows, name)
        if np.isnan(values).all():
            raise SelectionError(f"nearest {name} = {wanted:g}: no design has a value of it; drop it")
        sign = -1.0 if measure(name).direction == "maximise" else 1.0
        extent = _extent(column(front, name)) or _extent(column(everyone, name))
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


def _extent(values: Floats) -> float:
    finite = values[np.isfinite(values)]
    return float(np.ptp(finite)) if len(finite) else 0.0


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


def pick(
    rows: "DataFrame",
    selector: Selector,
    objectives: Objectives = HEIGHT_AND_ENERGY,
    able: NDArray[np.bool_] | None = None,
) -> Pick:
    """Pick the design that ``selector`` asks for of all that may be chosen, one row per design in any order.

    ``needs_front_only`` says which selectors need the front only. ``able`` leaves out designs as a condition does,
    shape (n,).

    Raises:
        SelectionError: there are no designs, none of them fits, or the selector does not suit the objectives.
    """
    if len(rows) == 0:
        raise SelectionError(
            "front: has 0 designs, at least 1 is needed to pick from; run the study longer or relax its constraints"
        )
    order = np.argsort(rows[objectives.names[0]].to_numpy(dtype=np.float64), kind="stable")
    rows, able = rows.iloc[order], None if able is None else able[order]
    conditions, chooser = _asked(selector, objectives)
    fits = required_fits(rows, conditions, objectives)
    inside = front_within(rows, conditions, objectives, able)
    whole = rows[front_within(rows, (), objectives) if conditions or able is not None else inside]
    phrased = f" that {phrase(conditions)}" if conditions else ""
    match chooser:
        case None:
            row, why = _best(rows, inside, conditions, objectives)
        case Trial(number=number):
            row, why = _numbered(rows, fits, inside, number), "asked for by its number"
        case Extreme():
            row, why = _extreme(rows, fits, chooser, objectives)
            why += f" of the {fits.sum()} feasible designs{phrased}"
        case _:
            row, why = _chosen(rows, inside, fits, whole, chooser, objectives)
            if conditions:
                why += f", of the {inside.sum()} designs on the front{phrased}"
    found = rows.iloc[row]
    values = found[list(objectives.names)].to_numpy(dtype=np.float64).tolist()
    trial = int(found["trial"])
    return Pick(trial=trial, why=f"trial {trial} ({objectives.text(values)}): {why}", conditions=conditions)


def needs_front_only(selector: Selector, objectives: Objectives) -> bool:
    """Return whether a design of the front without conditions is sure to be the answer, so that it is all to look at.

    The number of a trial counts, too: whether that is on the front is known only then.
    """
    conditions, chooser = _asked(selector, objectives)
    wish = chooser.wish if isinstance(chooser, Nearest) else ()
    return not conditions and not isinstance(chooser, Extreme) and set(wish) <= set(objectives.names)


def _asked(selector: Selector, objectives: Objectives) -> tuple[tuple[Condition, ...], Chooser | None]:
    """Return any selector as conditions, and what chooses among the designs that meet them."""
    match selector:
        case Among():
            return tuple(condition_on(one, objectives) for one in selector.conditions), selector.chooser
        case MinHeight(height_m=wanted):
            asked = Condition(name="height_m", side="min", value=wanted, asked="min-height")
            return (condition_on(asked, objectives),), None
        case MaxEnergy():
            return (condition_on(selector, objectives),), None
        case Within(measure=name, value=value):
            return (at_or_better(name, value),), None
        case _:
            return (), selector


def condition_on(given: Condition | MaxEnergy, objectives: Objectives) -> Condition:
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
    rows: "DataFrame", inside: NDArray[np.bool_], conditions: Sequence[Condition], objectives: Objectives
) -> tuple[int, str]:
    """Return the best in the first objective without a condition, else in the second; ties by the other ones."""
    limited = {condition.name for condition in conditions}
    free = [entry for entry in objectives.measures if entry.name not in limited]
    other = free[0] if free else objectives.measures[1]
    order = [other, *(entry for entry in objectives.measures if entry != other)]
    less_is_better = [rows[one.name] * (-1.0 if one.direction == "maximise" else 1.0) for one in reversed(order)]
    places = np.lexsort([*less_is_better, ~inside])
    why = f"the {_superlative(other)} of the {inside.sum()} designs on the front that {phrase(conditions)}"
    return int(places[0]), why


def _extreme(rows: "DataFrame", fits: NDArray[np.bool_], asked: Extreme, objectives: Objectives) -> tuple[int, str]:
    """Return the design with the least or the most of a measure or variable; ties by the objectives."""
    values = column(rows, asked.name)
    able = fits & np.isfinite(values)
    word = "most" if asked.most else "least"
    if not able.any():
        raise SelectionError(f"{word} {asked.name}: no design has a value of it; choose another measure")
    loss = objectives.minimised(rows[list(objectives.names)].to_numpy(dtype=np.float64))
    row = int(np.lexsort([*loss.T[::-1], -values if asked.most else values, ~able])[0])
    return row, f"the {word} {words_of(asked.name)}, {value_text(asked.name, float(values[row]))},"


def _superlative(entry: Measure) -> str:
    if entry.name == "height_m":
        return "highest jump"
    return f"{'most' if entry.direction == 'maximise' else 'least'} {entry.words}"


def _chosen(
    rows: "DataFrame",
    inside: NDArray[np.bool_],
    fits: NDArray[np.bool_],
    whole: "DataFrame",
    chooser: Knee | Tradeoff | Weights | Compromise | Nearest,
    objectives: Objectives,
) -> tuple[int, str]:
    """Return the design of the greatest score on the front within the conditions, and why.

    A wish may be about measures that are no objectives, so it is compared with all designs that meet the conditions.
    """
    able = fits if isinstance(chooser, Nearest) else inside
    among, names = rows[able], list(objectives.names)
    values, front = (table[names].to_numpy(dtype=np.float64) for table in (among, whole))
    match chooser:
        case Knee():
            scored = knee(values, front, objectives)
        case Tradeoff():
            scored = tradeoff(values, front, objectives)
        case Weights():
            scored = weighted(values, front, chooser.values, objectives)
        case Compromise():
            scored = compromise(values, front, chooser.values, objectives)
        case Nearest(wish=wish):
            scored = nearest(among, whole, rows, wish)
    row = int(np.argmax(scored.score))
    return int(np.flatnonzero(able)[row]), scored.why(row)


def _numbered(rows: "DataFrame", fits: NDArray[np.bool_], inside: NDArray[np.bool_], number: int) -> int:
    trials = rows["trial"].to_numpy()
    found = np.flatnonzero((trials == number) & fits)
    if len(found):
        return int(found[0])
    meets = "" if fits.all() else " and meets the conditions"
    raise SelectionError(
        f"trial = {number}: must be a feasible design that passes its audit{meets}, such as trials "
        f"{_listed(trials[inside])} on the front; pick one of them"
    )


def _listed(trials: NDArray[np.int64], most: int = 8) -> str:
    shown = ", ".join(str(int(trial)) for trial in sorted(trials)[:most])
    return shown if len(trials) <= most else f"{shown}, ... ({len(trials)} in all)"
