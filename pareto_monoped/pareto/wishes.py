"""Choices by what a person wants: weights of the objectives, or a point that the design should come near to."""

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from pareto_monoped.errors import SelectionError
from pareto_monoped.measures import measure
from pareto_monoped.pareto.conditions import column
from pareto_monoped.pareto.objectives import Objectives
from pareto_monoped.pareto.scores import Floats, Scored, losses, scaled

if TYPE_CHECKING:
    from pandas import DataFrame


def weighted(values: Floats, weights: tuple[float, ...], objectives: Objectives) -> Scored:
    """The weighted sum of the objectives, each scaled to the extent of the front.

    Raises:
        SelectionError: not one weight of at least 0 per objective.
    """
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
    """Zeleny 1973 (Compromise programming): the distance from the best of every objective.

    Each difference is scaled to the extent of the front and weighted, the distance is Euclidean.

    Raises:
        SelectionError: not one weight of at least 0 per objective.
    """
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
    """Wierzbicki 1980 (The use of reference objectives): the greatest shortfall from the wish in any measure.

    Shortfalls are scaled to the extent of the front. A wish that several designs surpass goes to the one that surpasses
    it most. Of designs with the same greatest shortfall, the one with the least sum of them comes first.

    Raises:
        SelectionError: no design on the front has a value of a measure.
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
    """The weights as an array, shape (m,)."""
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
