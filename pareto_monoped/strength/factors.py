"""Safety factors of all joints of many robots at once, from capacities that are tabulated per gearbox and per leg."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pareto_monoped.actuator.ratiomap import ActuatorMap
from pareto_monoped.design import NAMES, complete
from pareto_monoped.leg.dimensions import leg_dimensions
from pareto_monoped.strength.joint import (
    GROUP_MEASURES,
    SIDES,
    ActuatorJoint,
    LegJoint,
    Side,
    Structure,
    Together,
    over,
)
from pareto_monoped.strength.loads import LOAD_NAMES, Loads
from pareto_monoped.strength.table import TABLE

Floats = NDArray[np.float64]

MOST_FACTOR = 1000.0
"""Factors are cut here, because a joint without load would have an infinite one, which JSON cannot hold."""


Of = Side | Literal["leg"]
"""What a capacity belongs to."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Capacities:
    """What the joints of a map carry.

    Attributes:
        row: interval of the map -> row of its actuator, shape (intervals,), see ``robot.tables.ActuatorTable.row``.
        values: of the joints of each side, and of those of the leg: all their capacities side by side, shape
            (actuators, k), or (1, k) for the leg.
        columns: of each row of ``TABLE``: where its capacities stand in ``values``.
    """

    row: NDArray[np.intp]
    values: Mapping[Of, Floats]
    columns: tuple[slice, ...]

    def plain(self, of: Of) -> NDArray[np.intp]:
        """Columns of ``values`` with the capacities of ``_PLAIN``."""
        return np.array([self.columns[k].start for k in _PLAIN[of]], dtype=np.intp)


def _of(joint: ActuatorJoint | LegJoint) -> Of:
    return joint.side if isinstance(joint, ActuatorJoint) else "leg"


_OWNERS: tuple[Of, ...] = (*SIDES, "leg")
_ROWS: dict[Of, tuple[int, ...]] = {of: tuple(k for k, joint in enumerate(TABLE) if _of(joint) == of) for of in _OWNERS}
# Most joints have one capacity over one load. They are computed in one operation, which is several times as fast.
_PLAIN: dict[Of, tuple[int, ...]] = {
    of: tuple(k for k in rows if TABLE[k].factor is over and len(TABLE[k].loads) == 1) for of, rows in _ROWS.items()
}
_PLAIN_LOADS = {
    of: np.array([LOAD_NAMES.index(TABLE[k].loads[0]) for k in rows], dtype=np.intp) for of, rows in _PLAIN.items()
}
_PLAIN_COLUMNS = {of: np.array(rows, dtype=np.intp) for of, rows in _PLAIN.items()}
_OTHERS = {of: tuple(k for k in rows if k not in _PLAIN[of]) for of, rows in _ROWS.items()}


@lru_cache(maxsize=16)
def capacities(actuator_map: ActuatorMap) -> Capacities:
    """Compute the capacities of every joint once per gearbox, or once per leg; the result is kept."""
    present = [entry.actuator for entry in actuator_map.entries]
    leg, settings = leg_dimensions(actuator_map), actuator_map.settings
    structures = [
        Structure(actuator=actuator, leg=leg, settings=settings) for actuator in present if actuator is not None
    ]
    # Rows that share a capacity, such as those of hip and knee, have it computed once.
    wanted = {(joint.capacity, isinstance(joint, ActuatorJoint)) for joint in TABLE}
    found = {key: _all(key[0], structures if key[1] else structures[:1]) for key in wanted}
    columns: list[slice] = [slice(0)] * len(TABLE)
    values: dict[Of, Floats] = {}
    for of, rows in _ROWS.items():
        own = [found[TABLE[k].capacity, of != "leg"] for k in rows]
        ends = np.cumsum([block.shape[1] for block in own]).tolist()
        for k, block, end in zip(rows, own, ends, strict=True):
            columns[k] = slice(end - block.shape[1], end)
        values[of] = np.concatenate(own, axis=1) if own else np.zeros((1, 0))
    return Capacities(
        row=np.maximum(np.cumsum([actuator is not None for actuator in present]) - 1, 0),
        values=values,
        columns=tuple(columns),
    )


def _all(capacity: Callable[[Structure], float | tuple[float, ...]], structures: Sequence[Structure]) -> Floats:
    """Capacities of some structures, shape (structures, numbers of the capacity)."""
    values = capacity.of(structures) if isinstance(capacity, Together) else [capacity(s) for s in structures]
    return np.array([_numbers(value) for value in values])


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
    acting = np.stack([getattr(loads, name) for name in LOAD_NAMES], axis=1)
    result = np.empty((len(values), len(TABLE)))
    with np.errstate(divide="ignore", invalid="ignore"):
        for of in _ROWS:
            carried = table.values[of]
            if of != "leg":
                intervals = actuator_map.interval_index(values[:, NAMES.index(f"{of}_ratio")])
                carried = carried[table.row[np.maximum(intervals, 0)]]
            result[:, _PLAIN_COLUMNS[of]] = carried[:, table.plain(of)] / acting[:, _PLAIN_LOADS[of]]
            for k in _OTHERS[of]:
                joint = TABLE[k]
                own = carried[:, table.columns[k]]
                result[:, k] = joint.factor(*own.T, *(getattr(loads, name) for name in joint.loads))
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
