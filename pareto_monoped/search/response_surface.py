"""A cheap model of a design's scores: weighted cubic ridge regression on its features. This imports numba.

A cubic of f features has a coefficient for every product of three of (1, features), repeated ones too, in the order of
``itertools.combinations_with_replacement``.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import combinations_with_replacement

import numpy as np
from scipy.linalg.lapack import dposv

from pareto_monoped.compute.compiled import compiled
from pareto_monoped.search.algorithm import MOTOR_OF, Floats, MotorChoice, Space

_TOGETHER = 64
"""Points whose sums are in the making at once: ten features of so many are 5 KB, well within the first cache. Our own
choice."""


def cubic_terms(points: Floats) -> Floats:
    """Compute all products of three of (1, features), shape (n, f) -> (n, t)."""
    factors = np.column_stack((np.ones(len(points)), points))
    i, j, k = np.array(list(combinations_with_replacement(range(factors.shape[1]), 3))).T
    return np.asarray(np.take(factors, i, axis=1) * np.take(factors, j, axis=1) * np.take(factors, k, axis=1))


@compiled
def cubic_values(points: Floats, coefficients: Floats) -> Floats:
    """Compute ``cubic_terms(points) @ coefficients`` but for rounding, shape (n, f) and (t, k) -> (n, k).

    Nested as by Horner, it takes a multiplication per term and point, stores no terms, and treats each point alone.
    """
    count, width, targets = points.shape[0], points.shape[1] + 1, coefficients.shape[1]
    result = np.empty((count, targets))
    columns = np.ones((width, _TOGETHER))
    third, second, first = np.empty(_TOGETHER), np.empty(_TOGETHER), np.empty(_TOGETHER)
    for start in range(0, count, _TOGETHER):
        size = min(_TOGETHER, count - start)
        for k in range(1, width):
            for n in range(size):
                columns[k, n] = points[start + n, k - 1]
        for target in range(targets):
            t = 0
            first[:] = 0.0
            for i in range(width):
                second[:] = 0.0
                for j in range(i, width):
                    third[:] = 0.0
                    for k in range(j, width):
                        coefficient = coefficients[t, target]
                        for n in range(_TOGETHER):
                            third[n] += coefficient * columns[k, n]
                        t += 1
                    for n in range(_TOGETHER):
                        second[n] += columns[j, n] * third[n]
                for n in range(_TOGETHER):
                    first[n] += columns[i, n] * second[n]
            for n in range(size):
                result[start + n, target] = first[n]
    return result


_RIDGE = 1e-4
"""Ridge as a share of the mean square of a term: enough for fewer points than terms, small beside 1. Our own choice."""
_BLOCK = 256
"""Points whose terms are in memory at once: half a megabyte, which the second cache holds. Our own choice."""
_LOGARITHMIC = ("stiffness_n_per_m", "torsional_stiffness_n_m_per_rad")
"""Gains that act by their order of magnitude: designs on one front have K from 5 to 200 N/m."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Features:
    """What the model sees of a point of the space: features scaled to -1 to 1, and their products of up to three.

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

    def terms(self, values: Floats) -> Floats:
        """Return terms of n points, shape (n, d) -> (n, t); the constant is the first."""
        return cubic_terms(self.scaled(values))


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


def fitted(points: Floats, targets: Floats, weights: Floats) -> Floats:
    """Return coefficients, (t, k), of points, (n, f), targets, (n, k), and weights, (n,), for ``cubic_values``."""
    gram, right = _normal_equations(points, targets, weights)
    # The first term is the constant, whose mean square is the sum of the weights; it is not held back.
    ridge = np.full(len(gram), _RIDGE * weights.sum())
    ridge[0] = 1e-9 * weights.sum()
    gram[np.diag_indices_from(gram)] += ridge
    _, coefficients, failed = dposv(gram, right, lower=True)
    if failed:
        raise np.linalg.LinAlgError(f"the model's equations for {len(points)} points have no solution")
    return np.ascontiguousarray(coefficients)


def _normal_equations(points: Floats, targets: Floats, weights: Floats) -> tuple[Floats, Floats]:
    """Return weighted sums of products of pairs of terms, right below the diagonal, and of terms with targets."""
    first = cubic_terms(points[:1])
    size, half = first.shape[1], first.shape[1] // 2
    gram, right = np.zeros((size, size)), np.zeros((size, targets.shape[1]))
    for start in range(0, len(points), _BLOCK):
        rows = slice(start, start + _BLOCK)
        terms = cubic_terms(points[rows])
        weighted = (terms * weights[rows, None]).T
        gram[:half, :half] += weighted[:half] @ terms[:, :half]
        gram[half:] += weighted[half:] @ terms
        right += weighted @ targets[rows]
    return gram, right
