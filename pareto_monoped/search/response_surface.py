"""A cheap model of a design's scores: weighted polynomial ridge regression on its features."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from scipy.linalg import solve

from pareto_monoped.search.algorithm import MOTOR_OF, Floats, MotorChoice, Space


def terms(points: Floats, degree: int) -> Floats:
    """Compute all products of ``degree`` of (1, features), shape (n, f) -> (n, t)."""
    factors = np.vstack((np.ones(len(points)), points.T))
    products, starts = factors, np.arange(len(factors))
    for _ in range(degree - 1):
        # Each factor times the products that begin with it or a later one, so that none is there twice.
        blocks = [factor * products[start:] for factor, start in zip(factors, starts, strict=True)]
        products, starts = np.vstack(blocks), np.cumsum([0, *map(len, blocks[:-1])])
    return products.T


_RIDGE = 1e-4
"""Ridge as a share of the mean square of a term: enough for fewer points than terms, small beside 1. Our own choice."""
_LOGARITHMIC = ("stiffness_n_per_m", "torsional_stiffness_n_m_per_rad")
"""Gains that act by their order of magnitude: designs on one front have K from 5 to 200 N/m."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Features:
    """What the model sees of a point of the space: features scaled to -1 to 1.

    A gearbox counts by its real ratio and its mass, a stiffness by log(1 + x), any other variable as it is. Where
    designs choose from several motors, an actuator counts by its mass and by the logarithms of its greatest torque and
    speed at the joint, which mean the same with every motor. Trials with one motor thus tell of designs with another.
    """

    space: Space  #: that is searched
    #: lower, extent: of each feature before scaling, shape (f,)
    lower: Floats
    extent: Floats
    #: The features that each of a variable's or a choice's whole numbers stands for, shape (n, features)
    tables: Mapping[str, Floats]

    def scaled(self, values: Floats) -> Floats:
        """Return features of n points from -1 to 1, shape (n, d) -> (n, f)."""
        scaled = _raw(self.space, self.tables, values)
        scaled -= self.lower
        scaled *= 2.0
        scaled /= self.extent
        scaled -= 1.0
        return scaled


def features_of(space: Space) -> Features:
    """Return the features of a space."""
    tables = _tables(space)
    raw = _raw(space, tables, _extremes(space))
    lower, upper = raw.min(axis=0), raw.max(axis=0)
    return Features(space=space, lower=lower, extent=np.where(upper > lower, upper - lower, 1.0), tables=tables)


def _extremes(space: Space) -> Floats:
    """Return points of a space among which every feature has its least and its greatest value, shape (n, d)."""
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


def _tables(space: Space) -> dict[str, Floats]:
    """Return features of every gearbox of a list and of every motor of a choice; see ``Features.tables``."""
    tables = {name: np.array([[gear.ratio, gear.mass_kg] for gear in gears]) for name, gears in space.gears.items()}
    for choice in space.choices:
        tables[choice.name] = _motors(choice)
        for name in choice.motors[0].gears:
            gears = [gear for motor in choice.motors for gear in motor.gears[name]]
            tables[name] = np.array([[np.log(gear.ratio), gear.mass_kg] for gear in gears])
    return tables


def _raw(space: Space, tables: Mapping[str, Floats], values: Floats) -> Floats:
    """Return features before scaling, shape (n, d) -> (n, f)."""
    columns, listed = [], space.listed
    for name, column in zip(space.names, values.T, strict=True):
        if name in space.gears:
            columns += list(tables[name].T[:, column.astype(np.intp)])
        elif name in listed:
            columns += list(_actuators(space, tables, name, values).T)
        elif name in MOTOR_OF:
            # The actuators tell the motors apart, unless all their ratios are fixed.
            choice = space.choices[space.choice_columns.index(space.names.index(name))]
            columns += [] if choice.motors[0].gears else list(tables[name][space.picked(choice, values)].T)
        else:
            columns.append(np.log1p(column) if name in _LOGARITHMIC else column)
    return np.column_stack(columns)


def _motors(choice: MotorChoice) -> Floats:
    """Return logarithms of greatest torque and speed of each motor, shape (number of motors, 2)."""
    return np.log([[motor.peak_torque_n_m, motor.no_load_speed_rad_per_s] for motor in choice.motors])


def _actuators(space: Space, tables: Mapping[str, Floats], name: str, values: Floats) -> Floats:
    """Return features of the actuators that ``name`` chooses, shape (n, d) -> (n, 3)."""
    choice = space.choice_for(name)
    first = np.cumsum([0, *(len(motor.gears[name]) for motor in choice.motors[:-1])])
    motors = space.picked(choice, values)
    ratio, mass = tables[name][first[motors] + space.gear_of(name, values)].T
    torque, speed = tables[choice.name][motors].T
    return np.column_stack((torque + ratio, speed - ratio, mass))


def fitted(products: Floats, targets: Floats, weights: Floats) -> Floats:
    """Return coefficients, (t, k), of ``terms`` of n points, (n, t), from targets, (n, k), and weights, (n,)."""
    weighted = (products * weights[:, None]).T
    gram = weighted @ products
    # The first term is the constant, whose mean square is the sum of the weights; it is not held back.
    ridge = np.full(len(gram), _RIDGE * weights.sum())
    ridge[0] = 1e-9 * weights.sum()
    gram[np.diag_indices_from(gram)] += ridge
    coefficients: Floats = solve(gram, weighted @ targets, assume_a="pos")
    return coefficients
