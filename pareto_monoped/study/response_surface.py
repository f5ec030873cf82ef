"""A cheap model of what a search needs to know: weighted cubic ridge regression on features of a design."""

from dataclasses import dataclass
from itertools import combinations_with_replacement

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.study.protocol import MOTOR_OF, Floats, MotorChoice, Space

_DEGREE = 3
"""Of the polynomial. Our own choice: the third degree is what 2,000 jumps can determine, 220 terms of nine features."""
_RIDGE = 1e-4
"""Ridge as a share of the mean square of a term: enough for fewer points than terms, small beside 1. Our own choice."""
_LOGARITHMIC = ("stiffness_n_per_m", "torsional_stiffness_n_m_per_rad")
"""Gains that act by their order of magnitude: designs on one front have K from 5 to 200 N/m."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Features:
    """What the model sees of a point of the space: features scaled to -1 to 1, and their products of up to three.

    A gearbox counts by its real ratio and its mass, a stiffness by log(1 + x), any other variable as it is. Where
    designs choose from several motors, an actuator counts by its mass and by the logarithms of its greatest torque and
    speed at the joint, which mean the same with every motor. Trials with one motor thus tell of designs with another.

    Attributes:
        space: that is searched.
        lower, extent: of each feature before scaling, shape (f,).
        factors: for each term the columns of (1, features) that it is the product of, shape (t, 3).
    """

    space: Space
    lower: Floats
    extent: Floats
    factors: NDArray[np.intp]

    def scaled(self, values: Floats) -> Floats:
        """Features of n points from -1 to 1, shape (n, d) -> (n, f)."""
        return 2.0 * (_raw(self.space, values) - self.lower) / self.extent - 1.0

    def terms(self, values: Floats) -> Floats:
        """Terms of n points, shape (n, d) -> (n, t)."""
        columns = np.concatenate((np.ones((1, len(values))), self.scaled(values).T))
        first, second, third = self.factors.T
        return np.ascontiguousarray((columns[first] * columns[second] * columns[third]).T)


def features_of(space: Space) -> Features:
    """The features of a space."""
    raw = _raw(space, _extremes(space))
    lower, upper = raw.min(axis=0), raw.max(axis=0)
    factors = list(combinations_with_replacement(range(len(lower) + 1), _DEGREE))
    return Features(
        space=space,
        lower=lower,
        extent=np.where(upper > lower, upper - lower, 1.0),
        factors=np.array(factors, dtype=np.intp),
    )


def _extremes(space: Space) -> Floats:
    """Points of a space among which every feature has its least and its greatest value, shape (n, d)."""
    corners = np.vstack((space.lower, space.upper))
    blocks = [corners]
    for choice in space.choices:
        most = max((len(gears) for motor in choice.motors for gears in motor.gears.values()), default=1)
        every = np.repeat(corners[:1], most * len(choice.motors), axis=0)
        every[:, space.names.index(choice.name)] = np.repeat(np.arange(len(choice.motors)), most)
        for name in choice.motors[0].gears:
            every[:, space.names.index(name)] = np.tile(np.linspace(0.0, 1.0, most), len(choice.motors))
        blocks.append(every)
    most = max((len(gears) for gears in space.gears.values()), default=1)
    every = np.repeat(corners[:1], most, axis=0)
    for name, gears in space.gears.items():
        every[:, space.names.index(name)] = np.arange(most) % len(gears)
    return np.vstack((*blocks, every))


def _raw(space: Space, values: Floats) -> Floats:
    """Features before scaling, shape (n, d) -> (n, f)."""
    columns = []
    for name, column in zip(space.names, values.T, strict=True):
        if name in space.gears:
            table = np.array([[gear.ratio, gear.mass_kg] for gear in space.gears[name]])
            columns += list(table[column.astype(np.intp)].T)
        elif name in space.listed:
            columns += list(_actuators(space, name, values).T)
        elif name in MOTOR_OF:
            # The actuators tell the motors apart, unless all their ratios are fixed.
            choice = space.choices[space.choice_columns.index(space.names.index(name))]
            columns += [] if choice.motors[0].gears else list(_motors(choice)[space.picked(choice, values)].T)
        else:
            columns.append(np.log1p(column) if name in _LOGARITHMIC else column)
    return np.column_stack(columns)


def _motors(choice: MotorChoice) -> Floats:
    """Logarithms of greatest torque and speed of each motor, shape (number of motors, 2)."""
    return np.log([[motor.peak_torque_n_m, motor.no_load_speed_rad_per_s] for motor in choice.motors])


def _actuators(space: Space, name: str, values: Floats) -> Floats:
    """Features of the actuators that ``name`` chooses, shape (n, d) -> (n, 3)."""
    choice = space.choice_for(name)
    lists = [motor.gears[name] for motor in choice.motors]
    first = np.cumsum([0, *(len(gears) for gears in lists[:-1])])
    table = np.array([[np.log(gear.ratio), gear.mass_kg] for gears in lists for gear in gears])
    motors = space.picked(choice, values)
    ratio, mass = table[first[motors] + space.gear_of(name, values)].T
    torque, speed = _motors(choice)[motors].T
    return np.column_stack((torque + ratio, speed - ratio, mass))


def fitted(terms: Floats, targets: Floats, weights: Floats) -> Floats:
    """Coefficients of the weighted ridge regression.

    Args:
        terms: of n points, shape (n, t).
        targets: shape (n, k).
        weights: of the points' squared errors, at least 0, shape (n,).

    Returns:
        Shape (t, k); ``terms @ coefficients`` are the predictions.
    """
    weighted = terms * weights[:, None]
    gram = weighted.T @ terms
    # The first term is the constant, whose mean square is the sum of the weights; it is not held back.
    ridge = np.full(len(gram), _RIDGE * weights.sum())
    ridge[0] = 1e-9 * weights.sum()
    gram[np.diag_indices_from(gram)] += ridge
    return np.asarray(np.linalg.solve(gram, weighted.T @ targets), dtype=np.float64)
