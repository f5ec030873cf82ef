"""Cheap models of a design's scores on its features: polynomial and logistic regression, and a Gaussian process."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cho_factor, cho_solve, solve, solve_triangular
from scipy.optimize import minimize
from scipy.spatial.distance import cdist
from scipy.special import expit

from pareto_monoped.search.algorithm import MOTOR_OF, Floats, Gear, MotorChoice, Space


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

    Behind all these stand a gearbox's efficiency and the logarithm of its inertia at the motor, which zigzag along the
    list: they tell gearboxes apart where a model asks how alike two designs are, and are no terms of the polynomial.
    """

    space: Space  #: that is searched
    #: lower, extent: of each feature before scaling, shape (f,)
    lower: Floats
    extent: Floats
    smooth: int  #: how many of the first features the polynomial has
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
    extent = np.where(upper > lower, upper - lower, 1.0)
    return Features(space=space, lower=lower, extent=extent, smooth=len(lower) - 2 * len(space.gears), tables=tables)


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
    tables = {name: np.array([_gear(gear) for gear in gears]) for name, gears in space.gears.items()}
    for choice in space.choices:
        tables[choice.name] = _motors(choice)
        for name in choice.motors[0].gears:
            gears = [gear for motor in choice.motors for gear in motor.gears[name]]
            tables[name] = np.array([[np.log(gear.ratio), gear.mass_kg] for gear in gears])
    return tables


def _gear(gear: Gear) -> tuple[float, float, float, float]:
    at_motor = gear.reflected_inertia_kg_m2 / gear.ratio**2
    return gear.ratio, gear.mass_kg, gear.efficiency, float(np.log(at_motor))


def _raw(space: Space, tables: Mapping[str, Floats], values: Floats) -> Floats:
    """Return features before scaling, shape (n, d) -> (n, f)."""
    columns, zigzags, listed = [], [], space.listed
    for name, column in zip(space.names, values.T, strict=True):
        if name in space.gears:
            ratio, mass, efficiency, inertia = tables[name].T[:, column.astype(np.intp)]
            columns += [ratio, mass]
            zigzags += [efficiency, inertia]
        elif name in listed:
            columns += list(_actuators(space, tables, name, values).T)
        elif name in MOTOR_OF:
            # The actuators tell the motors apart, unless all their ratios are fixed.
            choice = space.choices[space.choice_columns.index(space.names.index(name))]
            columns += [] if choice.motors[0].gears else list(tables[name][space.picked(choice, values)].T)
        else:
            columns.append(np.log1p(column) if name in _LOGARITHMIC else column)
    return np.column_stack((*columns, *zigzags))


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


_ODDS_RIDGE = 0.1
"""Half of it times each coefficient's square is taken from the log-likelihood. Our own choice: 0.01 was no better."""
_ODDS_STEPS = 50
"""Steps that find the coefficients. Our own choice: the likelihood hardly grows after them."""


def log_odds(products: Floats, happened: NDArray[np.bool_]) -> Floats:
    """Return coefficients, (t,), of n points' ``terms``, (n, t), for the logarithm of the odds that something happens.

    ``happened``, shape (n,), says where it did, and must be true at some points and false at others. This is logistic
    regression with a ridge (Hastie, Tibshirani and Friedman 2009, section 4.4): the points near the boundary decide
    where it is. A polynomial fitted to 0 and 1 follows all points alike. After 5 failed jumps of 200, it expects
    failures in corners where no jump has failed.
    """
    sign, share = np.where(happened, 1.0, -1.0), happened.mean()
    ridge = np.full(products.shape[1], _ODDS_RIDGE)
    ridge[0] = 0.0  # the constant is not held back

    def loss(coefficients: Floats) -> tuple[float, Floats]:
        """Return the negative logarithm of the likelihood, with the ridge, and its gradient."""
        right = sign * (products @ coefficients)
        value = np.logaddexp(0.0, -right).sum() + 0.5 * (ridge * coefficients) @ coefficients
        return float(value), ridge * coefficients - (sign * expit(-right)) @ products

    start = np.zeros(len(ridge))
    start[0] = np.log(share / (1.0 - share))
    found: Floats = minimize(loss, start, jac=True, method="L-BFGS-B", options={"maxiter": _ODDS_STEPS}).x
    return found


_LENGTH = (2.0, 1.0)
"""Length that is expected of a feature from -1 to 1, its whole range, and standard deviation of its logarithm. Our own
choice: 1 and 4, and half the deviation, were as good."""
_LENGTHS = (0.05, 50.0)
"""Least and greatest length: from one that tells neighbours apart to one at which a feature does not count."""
_NUGGETS = (1e-6, 0.3)
"""Least and greatest share of the variance that neighbours do not have in common."""
_STEPS = 30
"""Steps that fit the lengths. Our own choice: the likelihood hardly grows after them."""


class GaussianProcess:
    """Interpolates measures of n points, with a length of its own for every feature (Rasmussen and Williams 2006).

    The kernel is Matérn's of smoothness 5/2 (equation 4.17). Lengths and nugget are those of all measures together,
    where their marginal likelihood is greatest (equations 5.8 and 5.9), each measure having its best variance, with a
    log-normal prior of lengths. The time grows with n cubed: 0.1 s for 300 points.
    """

    def __init__(self, points: Floats, targets: Floats) -> None:
        """Fit to features, shape (n, f), and measures, shape (n, k)."""
        count, features = points.shape
        spread = targets.std(axis=0)
        self._mean, self._scale = targets.mean(axis=0), np.where(spread > 0.0, spread, 1.0)
        known = (targets - self._mean) / self._scale
        squares = ((points[:, None] - points) ** 2).reshape(-1, features)
        length, deviation = np.log(_LENGTH[0]), _LENGTH[1]

        def loss(fit: Floats) -> tuple[float, Floats]:
            """Return the negative logarithm of likelihood and prior, and its gradient in the logarithms fitted."""
            inverse, nugget = np.exp(-2.0 * fit[:-1]), np.exp(fit[-1])
            distance = np.sqrt(5.0 * (squares @ inverse)).reshape(count, count)
            decay = np.exp(-distance)
            alike = _matern(distance)
            alike[np.diag_indices(count)] += nugget
            factor = cho_factor(alike, lower=True)
            shares = cho_solve(factor, known)
            variance = np.maximum((known * shares).sum(axis=0) / count, np.finfo(float).tiny)
            prior = (fit[:-1] - length) / deviation
            value = 0.5 * count * np.log(variance).sum() + len(variance) * np.log(np.diag(factor[0])).sum()
            slope = len(variance) * cho_solve(factor, np.eye(count)) - (shares / variance) @ shares.T
            by_length = 0.5 * inverse * ((slope * (5.0 / 3.0) * (1.0 + distance) * decay).ravel() @ squares)
            gradient = np.append(by_length + prior / deviation, 0.5 * nugget * np.trace(slope))
            return float(value + 0.5 * prior @ prior), gradient

        bounds = [tuple(np.log(_LENGTHS))] * features + [tuple(np.log(_NUGGETS))]
        start = np.append(np.full(features, length), np.log(1e-3))
        found = minimize(loss, start, jac=True, method="L-BFGS-B", bounds=bounds, options={"maxiter": _STEPS})
        self.fit: Floats = found.x  #: logarithms of the f lengths and of the nugget
        self._inverse = np.exp(-self.fit[:-1])
        self._points = points * self._inverse
        alike = self._alike(points)
        alike[np.diag_indices(count)] += np.exp(self.fit[-1])
        self._factor = cho_factor(alike, lower=True)
        self._shares = cho_solve(self._factor, known)
        self._scatter = np.sqrt((known * self._shares).sum(axis=0) / count) * self._scale

    def mean(self, points: Floats) -> Floats:
        """Return the measures that are expected at points, shape (p, f) -> (p, k)."""
        mean: Floats = self._alike(points) @ self._shares * self._scale + self._mean
        return mean

    def deviation(self, points: Floats) -> Floats:
        """Return the standard deviation of what is expected there, shape (p, f) -> (p, k)."""
        part = solve_triangular(self._factor[0], self._alike(points).T, lower=True)
        deviation: Floats = np.sqrt(np.maximum(1.0 - (part**2).sum(axis=0), 0.0))[:, None] * self._scatter
        return deviation

    def _alike(self, points: Floats) -> Floats:
        distance = np.sqrt(5.0) * cdist(points * self._inverse, self._points)
        return _matern(distance)


def _matern(distance: Floats) -> Floats:
    """Return Matérn's kernel of smoothness 5/2 at distances times the root of 5."""
    return np.asarray((1.0 + distance + distance**2 / 3.0) * np.exp(-distance))
