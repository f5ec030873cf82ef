"""How two designs of a study differ: on the scale of the variables' ranges, and in plain words."""

from dataclasses import dataclass

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from pareto_monoped.design import LENGTHS, RATIOS, VARIABLES
from pareto_monoped.study.free_variables import Bounds
from pareto_monoped.study.protocol import MOTOR_OF
from pareto_monoped.study.reader import StudyData

_VARIABLES = {variable.name: variable for variable in VARIABLES}
_WORTH_TELLING = 0.05
"""Least difference of a number that is told, as a share of its range. Our own choice: 1 cm of a link."""
_MOST_TOLD = 3
"""Differences told of one design, the greatest first; more make a list instead of a sentence."""
_LONGER = 1.02
"""From this ratio of the links on, one of them is called long."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Scale:
    """Designs as points whose distances say how much they differ.

    Attributes:
        names: of the d free variables, and of the choices of a motor (``MOTOR_OF``).
        points: shape (n, d): numbers as shares of their ranges, gearboxes by their place in the list of those that the
            study's trials have, motors by number.
        categories: which of them have no order, shape (d,).
    """

    names: tuple[str, ...]
    points: NDArray[np.float64]
    categories: NDArray[np.bool_]


def scale_of(data: StudyData, trials: pd.DataFrame) -> Scale:
    """The scale of some trials of a study."""
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
    """How the design in a row differs from a given one, the greatest difference first.

    Args:
        scale: of the trials.
        trials: the designs.
        row: position of the design.
        given: position of the other one.

    Returns:
        At most ``_MOST_TOLD`` phrases, such as "shank-long, 0.306 and 0.401 m" or "knee gearbox 6.1 instead of 8.4".
    """
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
    """Which link is the long one."""
    thigh, shank = (float(design[length]) for length in LENGTHS)
    if shank > _LONGER * thigh:
        return "shank-long"
    return "thigh-long" if thigh > _LONGER * shank else "equal links"
