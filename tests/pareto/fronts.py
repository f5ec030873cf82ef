"""Random fronts for brute force: with ties, duplicates, collinear and single points, and infinite slopes."""

import numpy as np
import pandas as pd
from hypothesis import strategies as st

from pareto_monoped.pareto.objectives import HEIGHT_AND_ENERGY, Objectives

THREE = Objectives(names=("height_m", "electrical_energy_j", "mass_kg"))

# Few different numbers give many ties; hundredths have no exact binary form, which shows rounding.
_numbers = st.integers(0, 6).map(lambda k: 0.55 + 0.07 * k)


SHAPES = ("any", "any", "collinear", "upright", "level", "one point")
"""Shapes of fronts: points on a line, on one of infinite slope, on one of no slope, and many designs at one point."""


@st.composite
def fronts(draw, objectives=HEIGHT_AND_ENERGY):
    """A data frame of 1 to 12 designs, in any order; they may dominate each other, as a caller may give any."""
    n, shape = draw(st.integers(1, 12)), draw(st.sampled_from(SHAPES))
    columns = {
        name: draw(st.lists(_numbers, min_size=n, max_size=n))
        for name in {*objectives.names, "mass_kg", "drift_m", "knee_ratio"}
    }
    first, second = objectives.names[:2]
    if shape == "collinear":
        columns[second] = list(columns[first])
    if shape in ("upright", "one point"):
        columns[second] = columns[second][:1] * n
    if shape in ("level", "one point"):
        columns[first] = columns[first][:1] * n
    trials = draw(st.permutations(range(100, 100 + n)))
    return pd.DataFrame({"trial": trials, **columns})


def not_dominated(designs, objectives):
    """The designs that no other one betters, by the definition; of equal ones the first."""

    def costs(record):
        return [-record[one.name] if one.direction == "maximise" else record[one.name] for one in objectives.measures]

    points = [costs(record) for record in designs.to_dict(orient="records")]
    kept = [
        not any(
            all(a <= b for a, b in zip(other, own, strict=True)) and (other != own or j < i)
            for j, other in enumerate(points)
            if j != i
        )
        for i, own in enumerate(points)
    ]
    return designs[np.array(kept, dtype=bool)]


def losses(front, objectives, whole=None):
    """Rows of losses from 0, the best of the whole front, to 1, its worst, by plain Python."""
    rows = []
    whole = front if whole is None else whole
    for record in front.to_dict(orient="records"):
        row = []
        for entry in objectives.measures:
            column = [float(value) for value in whole[entry.name]]
            low, high = min(column), max(column)
            share = (record[entry.name] - low) / (high - low) if high > low else 0.0
            row.append((1.0 - share if high > low else 0.0) if entry.direction == "maximise" else share)
        rows.append(row)
    return np.array(rows)
