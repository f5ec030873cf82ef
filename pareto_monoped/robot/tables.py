"""Fast weighing and pricing: the units of a map's actuators as arrays, those of links as functions of their length.

A link is one smooth function of its length. Interpolated in Chebyshev points, this function is exact to the last
digits, and evaluating it takes a few operations for any number of lengths (Trefethen, Approximation Theory and
Approximation Practice, chapters 3 and 8), where weighing part by part takes thousands of small array operations.

A part with the moment of inertia J about the joint axis that turns at c times the joint's speed, relative to the body
that carries it, has the absolute speed w_body + c w_joint. Summed over all such parts, the kinetic energy of turning is

    1/2 (S w_body^2 + 2 B w_body w_joint + C w_joint^2),    S = sum J,  B = sum J c,  C = sum J c^2.

S is part of the body's own inertia. C is the reflected inertia, which MuJoCo calls armature. B couples the joint to the
rotation of the body. The base does not rotate, so that the coupling matters for the knee actuator only, which the thigh
carries.
"""

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, fields
from functools import lru_cache, reduce
from typing import Any

import numpy as np
from numpy.polynomial.chebyshev import chebval
from numpy.typing import NDArray

from pareto_monoped.actuator.actuator import Actuator, turning_terms
from pareto_monoped.actuator.ratiomap import ActuatorMap
from pareto_monoped.actuator.service.sheet import service_sheet
from pareto_monoped.files import kept
from pareto_monoped.geometry.parts import MassProperties, Part, total
from pareto_monoped.geometry.roles import Group, Role
from pareto_monoped.geometry.shapes import Floats
from pareto_monoped.leg.dimensions import LegDimensions
from pareto_monoped.leg.thigh import thigh_parts
from pareto_monoped.robot.cost import priced
from pareto_monoped.robot.units import UNITS, ActuatorSized, LinkSized

_LENGTHS_M = (0.3, 0.5)  # two lengths fix a straight line; any two do


def actuator_coupling_kg_m2(actuator: Actuator) -> float:
    """Return B of rotor, planets and carrier of an actuator, against its housing."""
    terms = turning_terms(actuator.parts, actuator.gears, actuator.motor)
    return sum(inertia * speed for part in terms for inertia, speed in part)


def rotor_inertia_kg_m2(actuator: Actuator) -> float:
    """Return the moment of inertia of everything that turns at the motor's speed: rotor, coupling, sun."""
    terms = turning_terms(actuator.parts, actuator.gears, actuator.motor)
    return sum(inertia for part in terms for inertia, speed in part if speed == actuator.ratio)


def rotor_excess_kg_m2(actuator: Actuator) -> float:
    """Return the inertia of the motor's rotor by its data sheet, less that of the envelope among the parts."""
    drawn = sum(
        float(part.mass_properties().inertia_kg_m2[2, 2]) for part in actuator.parts if part.role is Role.MOTOR_ROTOR
    )
    return actuator.motor.rotor_inertia_kg_m2 - drawn


@dataclass(frozen=True, slots=True, kw_only=True)
class DriveTurning:
    """Drive sprocket with its coupling, and the chain, which run against the thigh at the knee's speed."""

    coupling_kg_m2: tuple[float, float]  #: B, as a line over the thigh's length in metres: constant and slope
    reflected_kg_m2: tuple[float, float]  #: C, likewise


@lru_cache(maxsize=64)
def drive_turning(leg: LegDimensions) -> DriveTurning:
    """Return the turning parts of the knee's drive in a leg.

    The chain runs around two equal sprockets of pitch radius r at the speed r w. A closed loop of linear density rho
    that encloses the area A has the angular momentum 2 rho A r w about every axis, and no linear momentum. The
    turnbuckles take the place of some chain in both strands, at the distance r from the axis.
    """
    radius_m = 1e-3 * leg.chain.pitch_radius_mm
    coupling, reflected = [], []
    for length_m in _LENGTHS_M:
        parts = thigh_parts(length_m, leg)
        turning = sum(float(p.mass_properties().inertia_kg_m2[2, 2]) for p in parts if p.group is Group.KNEE_DRIVE)
        running = sum(float(p.mass_kg()) for p in parts if p.role in (Role.CHAIN, Role.TURNBUCKLE)) * radius_m**2
        # The links around the knee have the mean of sin over a half turn, 2 / pi, of their momentum m r w across the
        # thigh, at the thigh's length from the hip.
        links_kg = leg.chain.kg_per_m * 0.5e-3 * leg.chain.teeth * leg.chain.pitch_mm
        around_knee = 2.0 / math.pi * links_kg * radius_m * length_m
        coupling.append(turning + running + around_knee)
        reflected.append(turning + running)
    return DriveTurning(coupling_kg_m2=_line(coupling), reflected_kg_m2=_line(reflected))


def _line(values: list[float]) -> tuple[float, float]:
    """Return the constant and slope of the line through two values at ``_LENGTHS_M``."""
    (low, high), (at_low, at_high) = _LENGTHS_M, values
    slope = (at_high - at_low) / (high - low)
    return at_low - slope * low, slope


Weigh = Callable[[Floats], Sequence[MassProperties]]
"""Lengths in metres, shape (n,) -> the mass properties of each of the m units, one row per length."""
_Values = Callable[[Floats], Floats]
_EXACT = 1e-13  # of the largest mass, first or second moment: a few hundred roundings, which no jump can show
_MOST_NODES = 128
# Upper triangle of the second moments, which are symmetric.
_ROWS, _COLUMNS = np.triu_indices(3)
_WIDTH = 1 + 3 + len(_ROWS)


@dataclass(frozen=True, slots=True, kw_only=True)
class Tabulated:
    """The mass properties of m units over a range of lengths, or other numbers."""

    low_m: float
    high_m: float
    #: Of the Chebyshev series, shape (k, rows); rows are 10 m: mass, first and second moments of each unit
    coefficients: Floats

    def covers(self, lengths_m: Floats) -> NDArray[np.bool_]:
        """Return which lengths are in the range, shape (n,)."""
        return np.asarray((self.low_m <= lengths_m) & (lengths_m <= self.high_m))

    def numbers(self, lengths_m: Floats) -> Floats:
        """Return the series at lengths, shape (rows, n); Clenshaw's recurrence has the same order for each of them."""
        place = (2.0 * lengths_m - (self.low_m + self.high_m)) / (self.high_m - self.low_m)
        return np.asarray(chebval(place, self.coefficients), dtype=np.float64)

    def __call__(self, lengths_m: Floats) -> tuple[MassProperties, ...]:
        """Return the m units for lengths, shape (n,)."""
        values = self.numbers(lengths_m)
        return tuple(_unfolded(values[i : i + _WIDTH]) for i in range(0, len(values), _WIDTH))


def tabulate(weigh: Weigh, low_m: float, high_m: float) -> Tabulated:
    """Tabulate units over a range of lengths, with as many nodes as the precision needs.

    Raises:
        ValueError: the units do not change smoothly with the length.
    """
    return _tabulated("mass properties", lambda lengths_m: _folded(weigh(lengths_m)), _sizes, low_m, high_m)


def _tabulated(what: str, values_of: _Values, sizes_of: _Values, low_m: float, high_m: float) -> Tabulated:
    """Tabulate the rows of ``values_of``, exact to a share of their ``sizes_of``."""
    between = np.linspace(low_m, high_m, 51)
    wanted = values_of(between)
    scale = sizes_of(wanted)
    nodes = 8
    while nodes <= _MOST_NODES:
        table = Tabulated(low_m=low_m, high_m=high_m, coefficients=_series(values_of, low_m, high_m, nodes))
        if np.all(np.abs(table.numbers(between) - wanted) <= _EXACT * scale):
            return table
        nodes += 4
    raise ValueError(
        f"{what} over {low_m} to {high_m} m: not smooth in the length to {_EXACT:g} with {_MOST_NODES} nodes; "
        "let no count or choice depend on the length"
    )


def _series(values_of: _Values, low_m: float, high_m: float, nodes: int) -> Floats:
    """Return the interpolant's coefficients in Chebyshev points of the first kind, summed in a fixed order."""
    angles = np.pi * (np.arange(nodes) + 0.5) / nodes
    values = values_of(0.5 * (low_m + high_m) + 0.5 * (high_m - low_m) * np.cos(angles))
    waves = np.cos(np.outer(np.arange(nodes), angles))
    result = 2.0 / nodes * reduce(np.add, [np.outer(waves[:, k], values[:, k]) for k in range(nodes)])
    result[0] *= 0.5
    return np.asarray(result, dtype=np.float64)


def _folded(units: Sequence[MassProperties]) -> Floats:
    """Return the numbers of m units and n lengths, shape (10 m, n)."""
    rows: list[Floats] = []
    for unit in units:
        rows += [unit.mass_kg, *np.moveaxis(unit.first_kg_m, -1, 0), *unit.second_kg_m2[..., _ROWS, _COLUMNS].T]
    return np.stack(np.broadcast_arrays(*rows))


def _sizes(values: Floats) -> Floats:
    """Return the largest mass, first moment and second moment of each unit, for each of its rows, shape (10 m, 1)."""
    largest = np.abs(values).max(axis=1)
    kinds = [largest[i + j : i + k].max() for i in range(0, len(values), _WIDTH) for j, k in ((0, 1), (1, 4), (4, 10))]
    return np.repeat(kinds, np.tile([1, 3, len(_ROWS)], len(values) // _WIDTH))[:, None]


def _unfolded(values: Floats) -> MassProperties:
    second = np.empty((*values.shape[1:], 3, 3))
    second[..., _ROWS, _COLUMNS] = second[..., _COLUMNS, _ROWS] = values[4:].T
    return MassProperties(mass_kg=values[0], first_kg_m=values[1:4].T, second_kg_m2=second)


_TABULATED_M = (0.25, 0.55)  # the paper's lengths, 0.3 to 0.5 m, and some more


@dataclass(frozen=True, slots=True, kw_only=True)
class ActuatorTable:
    """The k actuators of a map as arrays of shape (k,)."""

    row: NDArray[np.intp]  #: row of each interval's actuator, shape (intervals,); any row where the interval has none
    ratio: Floats  #: real ratio of the gearbox
    armature_kg_m2: Floats  #: reflected inertia at the joint
    coupling_kg_m2: Floats
    rotor_inertia_kg_m2: Floats
    rotor_excess_kg_m2: Floats
    peak_torque_n_m: Floats
    continuous_torque_n_m: Floats
    no_load_speed_rad_per_s: Floats
    efficiency: Floats
    efficiency_total: Floats  #: of the whole gearbox, see ``Losses``
    compliance_rad_per_n_m: Floats  #: of everything between rotor and output, see ``Stiffness``


_OF_ACTUATORS = ("peak_torque_n_m", "continuous_torque_n_m", "no_load_speed_rad_per_s", "efficiency")


@lru_cache(maxsize=16)
def actuator_table(actuator_map: ActuatorMap) -> ActuatorTable:
    """Return the actuators of a map in numbers. The result is kept, as a map is asked for many times."""
    return ActuatorTable(**kept(_key(actuator_map, "actuator_table"), lambda: _numbers_of(actuator_map)))


def _key(actuator_map: ActuatorMap, *more: object) -> str | None:
    """Return the key of a table of a map's actuators, see ``files.kept``."""
    return None if actuator_map.key is None else repr((*more, actuator_map.key))


def _numbers_of(actuator_map: ActuatorMap) -> dict[str, NDArray[Any]]:
    """Return the fields of the ``ActuatorTable`` of a map."""
    actuators = _actuators(actuator_map)
    sheets = [service_sheet(a, actuator_map.settings) for a in actuators]
    row = np.cumsum([entry.actuator is not None for entry in actuator_map.entries]) - 1
    return {
        "row": np.maximum(row, 0),
        "ratio": np.array([a.ratio for a in actuators]),
        "armature_kg_m2": np.array([a.reflected_inertia_kg_m2 for a in actuators]),
        "coupling_kg_m2": np.array([actuator_coupling_kg_m2(a) for a in actuators]),
        "rotor_inertia_kg_m2": np.array([rotor_inertia_kg_m2(a) for a in actuators]),
        "rotor_excess_kg_m2": np.array([rotor_excess_kg_m2(a) for a in actuators]),
        **{name: np.array([getattr(a, name) for a in actuators]) for name in _OF_ACTUATORS},
        "efficiency_total": np.array([sheet.losses.efficiency_total for sheet in sheets]),
        "compliance_rad_per_n_m": np.array([1.0 / sheet.stiffness.stiffness_n_m_per_rad for sheet in sheets]),
    }


def _actuators(actuator_map: ActuatorMap) -> list[Actuator]:
    return [entry.actuator for entry in actuator_map.entries if entry.actuator is not None]


@lru_cache(maxsize=128)
def actuator_units(joint: str, actuator_map: ActuatorMap, leg: LegDimensions) -> Mapping[str, MassProperties]:
    """Weigh the units that depend on the actuator of a joint, with every actuator of a map. The result is kept.

    Returns:
        Name -> mass properties of the joint's ``ActuatorSized`` units in their body frames, one row per actuator.
    """
    kinds = _kinds(joint)

    def weigh() -> dict[str, Floats]:
        actuators = _actuators(actuator_map)
        weighed = [unit.in_body(_stacked(unit.parts(one, leg) for one in actuators), leg) for unit in kinds]
        return {f"{k} {name}": getattr(mass, name) for k, mass in enumerate(weighed) for name in _MOMENTS}

    found = kept(_key(actuator_map, "actuator_units", joint, leg), weigh)
    return {
        unit.name: MassProperties(**{name: found[f"{k} {name}"] for name in _MOMENTS}) for k, unit in enumerate(kinds)
    }


_MOMENTS = tuple(one.name for one in fields(MassProperties))


def _kinds(joint: str) -> list[ActuatorSized]:
    """Return the units that depend on the actuator of a joint."""
    return [unit for unit in UNITS if isinstance(unit, ActuatorSized) and unit.joint == joint]


@lru_cache(maxsize=128)
def actuator_costs(joint: str, actuator_map: ActuatorMap, leg: LegDimensions) -> Floats:
    """Return the rows of ``priced`` for the same units with every actuator of a map, shape (4, k). It is kept."""

    def price() -> dict[str, Floats]:
        rows = [priced(unit.parts(one, leg) for unit in _kinds(joint)) for one in _actuators(actuator_map)]
        return {"costs": np.stack(rows, axis=1)}

    return kept(_key(actuator_map, "actuator_costs", joint, leg), price)["costs"]


def _stacked(units: Iterable[tuple[Part, ...]]) -> MassProperties:
    masses = [total(part.mass_properties() for part in parts) for parts in units]
    return MassProperties(
        mass_kg=np.array([m.mass_kg for m in masses]),
        first_kg_m=np.array([m.first_kg_m for m in masses]),
        second_kg_m2=np.array([m.second_kg_m2 for m in masses]),
    )


def _weigh(length: str, leg: LegDimensions, lengths_m: Floats) -> list[MassProperties]:
    """Return the units of one link length in their body frames, part by part, one row per length."""
    return [
        unit.in_body(total(part.mass_properties() for part in unit.parts(lengths_m, leg)), leg)
        for unit in link_units(length)
    ]


def link_units(length: str) -> list[LinkSized]:
    """Return the units that depend on a link length, in the order of the table."""
    return [unit for unit in UNITS if isinstance(unit, LinkSized) and unit.length == length]


@lru_cache(maxsize=128)
def _link_table(length: str, leg: LegDimensions) -> Tabulated:
    return tabulate(lambda lengths_m: _weigh(length, leg, lengths_m), *_TABULATED_M)


def weighed(length: str, leg: LegDimensions, lengths_m: Floats) -> dict[str, MassProperties]:
    """Return mass properties of the units of a link length by name: interpolated to 12 digits, or exact beyond."""
    table = _link_table(length, leg)
    beyond = ~table.covers(lengths_m)
    masses = table(np.clip(lengths_m, table.low_m, table.high_m))
    if beyond.any():
        for mass, exact in zip(masses, _weigh(length, leg, lengths_m[beyond]), strict=True):
            mass.mass_kg[beyond] = exact.mass_kg
            mass.first_kg_m[beyond] = exact.first_kg_m
            mass.second_kg_m2[beyond] = exact.second_kg_m2
    return dict(zip((unit.name for unit in link_units(length)), masses, strict=True))


def _priced(length: str, leg: LegDimensions, lengths_m: Floats) -> Floats:
    return priced(unit.parts(lengths_m, leg) for unit in link_units(length))


@lru_cache(maxsize=128)
def _cost_table(length: str, leg: LegDimensions) -> Tabulated:
    return _tabulated(
        "costs",
        lambda lengths_m: _priced(length, leg, lengths_m),
        lambda wanted: np.abs(wanted).max(axis=1, keepdims=True),
        *_TABULATED_M,
    )


def link_costs(length: str, leg: LegDimensions, lengths_m: Floats) -> Floats:
    """Return the rows of ``priced`` for the units of a link length, shape (4, n): as exact as ``weighed``."""
    table = _cost_table(length, leg)
    beyond = ~table.covers(lengths_m)
    costs = table.numbers(np.clip(lengths_m, table.low_m, table.high_m))
    if beyond.any():
        costs[:, beyond] = _priced(length, leg, lengths_m[beyond])
    # Pieces are whole numbers, which the series gives to rounding only.
    costs[1:3] = np.round(costs[1:3])
    return costs
