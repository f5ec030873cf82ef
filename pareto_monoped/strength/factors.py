"""Safety factors of all joints of many robots at once, from capacities that are tabulated per gearbox and per leg."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pareto_monoped.actuator.ratiomap import ActuatorMap
from pareto_monoped.design import NAMES, complete
from pareto_monoped.leg.dimensions import leg_dimensions
from pareto_monoped.strength.joint import GROUP_MEASURES, SIDES, ActuatorJoint, Side, Structure
from pareto_monoped.strength.loads import Loads
from pareto_monoped.strength.table import TABLE

Floats = NDArray[np.float64]

MOST_FACTOR = 1000.0
"""Factors are cut here, because a joint without load would have an infinite one, which JSON cannot hold."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Capacities:
    """What the joints of a map carry.

    Attributes:
        row: interval of the map -> row of its actuator, shape (intervals,), see ``robot.tables.ActuatorTable.row``.
        values: of each row of ``TABLE``: its capacities, shape (actuators, k), or (1, k) for a row of the leg.
    """

    row: NDArray[np.intp]
    values: tuple[Floats, ...]


@lru_cache(maxsize=16)
def capacities(actuator_map: ActuatorMap) -> Capacities:
    """Compute the capacities of every joint once per gearbox, or once per leg; the result is kept."""
    present = [entry.actuator for entry in actuator_map.entries]
    actuators = [actuator for actuator in present if actuator is not None]
    leg, settings = leg_dimensions(actuator_map), actuator_map.settings
    structures = [Structure(actuator=actuator, leg=leg, settings=settings) for actuator in actuators]
    # Rows that share a capacity, such as those of hip and knee, have it computed once.
    wanted = {(joint.capacity, isinstance(joint, ActuatorJoint)) for joint in TABLE}
    found = {key: np.array([_numbers(key[0](s)) for s in (structures if key[1] else structures[:1])]) for key in wanted}
    return Capacities(
        row=np.maximum(np.cumsum([actuator is not None for actuator in present]) - 1, 0),
        values=tuple(found[joint.capacity, isinstance(joint, ActuatorJoint)] for joint in TABLE),
    )


def _numbers(capacity: float | Sequence[float]) -> tuple[float, ...]:
    values = (capacity,) if isinstance(capacity, int | float) else tuple(capacity)
    return tuple(float(value) for value in values)


def strength_factors(designs: ArrayLike, actuator_map: ActuatorMap, loads: Loads) -> Floats:
    """The safety factor of every joint of every design, shape (n, rows of ``TABLE``).

    Args:
        designs: shape (n, number of variables), see ``design.complete``; the ratios choose the gearboxes.
        actuator_map: the gearboxes.
        loads: of the designs' jumps.

    Returns:
        At most ``MOST_FACTOR``; NaN where a load is unknown. A design without gearbox has NaN loads.
    """
    values, table = np.atleast_2d(complete(designs)), capacities(actuator_map)
    rows: dict[Side, NDArray[np.intp]] = {}
    for side in SIDES:
        intervals = actuator_map.interval_index(values[:, NAMES.index(f"{side}_ratio")])
        rows[side] = table.row[np.maximum(intervals, 0)]
    result = np.empty((len(values), len(TABLE)))
    with np.errstate(divide="ignore", invalid="ignore"):
        for column, (joint, carried) in enumerate(zip(TABLE, table.values, strict=True)):
            own = carried[rows[joint.side]] if isinstance(joint, ActuatorJoint) else carried
            acting = [getattr(loads, name) for name in joint.loads]
            result[:, column] = joint.factor(*own.T, *acting)
    return np.minimum(result, MOST_FACTOR)


_REQUIRED = np.array([joint.required for joint in TABLE])
_MEMBERS = {
    measure: np.array([i for i, joint in enumerate(TABLE) if joint.group == group], dtype=np.intp)
    for group, measure in GROUP_MEASURES.items()
}


def safeties(factors: Floats) -> dict[str, Floats]:
    """Measure of each group: the least factor over required factor of its rows, shape (n,); it holds from 1 up."""
    shares = factors / _REQUIRED
    return {measure: shares[:, members].min(axis=1, initial=MOST_FACTOR) for measure, members in _MEMBERS.items()}
