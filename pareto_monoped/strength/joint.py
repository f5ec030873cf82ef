"""One row of the table of joints: what may fail, under which loads of a jump, by which formula, and what is
required.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from pareto_monoped.actuator.actuator import Actuator
from pareto_monoped.actuator.settings import ActuatorSettings
from pareto_monoped.design import LENGTHS
from pareto_monoped.geometry.shapes import Floats
from pareto_monoped.leg.dimensions import LegDimensions
from pareto_monoped.strength.groups import INFORMING, Group

Loads = Mapping[str, Floats]
"""Loads of n jumps, each of shape (n,), by ``LOAD_NAMES``; NaN where unknown. The end stops and the foot's impact are
in the torque through a gearbox; a housing reacts to no more than that."""
_OF_SIDES = ("peak_torque_{}_n_m", "peak_gear_torque_{}_n_m", "peak_stop_torque_{}_n_m", "stop_compression_{}")
LOAD_NAMES: tuple[str, ...] = (
    *(name.format(side) for name in _OF_SIDES for side in ("hip", "knee")),
    *("peak_chain_tension_n", "stop_energy_j", "peak_foot_force_n", "peak_knee_force_n", *LENGTHS),
)
"""Names that a row of the table may read: measures of the jump, and the lengths of the links."""


def loads_of(columns: Mapping[str, Any]) -> Loads:
    """Return the loads from the columns of stored trials or of evaluations.

    Args:
        columns: name -> values of shape (n,), such as a data frame of trials; others than ``LOAD_NAMES`` are ignored,
            and measures that a study of an earlier version lacks are unknown.
    """
    n = len(columns["thigh_length_m"])
    unknown = np.full(n, np.nan)
    return {name: np.asarray(columns.get(name, unknown), dtype=np.float64) for name in LOAD_NAMES}


Side = Literal["hip", "knee"]
SIDES: tuple[Side, ...] = ("hip", "knee")
"""The joints of the robot, each with its actuator."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Structure:
    """What a capacity may depend on."""

    actuator: Actuator  #: of the row's side; for a row of the leg that of the hip, which must not matter
    leg: LegDimensions  #: the leg that all actuators of the maps share
    settings: ActuatorSettings  #: of stage 1: rules, materials, safety factors of the rating


@dataclass(frozen=True, slots=True, kw_only=True)
class Together:
    """A capacity that is computed for many structures at once, which saves time."""

    of: Callable[[Sequence[Structure]], Sequence[float]]  #: the capacities of some structures of one actuator map

    def __call__(self, s: Structure) -> float:
        """The capacity of one structure."""
        return self.of([s])[0]


def over(capacity: Any, load: Any) -> Any:
    """Return the common safety factor: what a joint carries over what it has to carry."""
    return capacity / load


@dataclass(frozen=True, slots=True, kw_only=True)
class Joint:
    """A row."""

    name: str  #: unique; in ``strength.csv``, in messages and in the report
    group: Group  #: by which measure it counts
    formula: str  #: of the factor, in a line
    source: str  #: of the formula
    required: float  #: least factor allowed
    required_source: str  #: why that much
    loads: tuple[str, ...]  #: fields of ``Loads`` that ``factor`` gets
    #: What the joint carries, one number or several. Rows may share it: it is computed once then.
    capacity: Callable[[Structure], float | tuple[float, ...]]
    #: The safety factor from the numbers of ``capacity``, then the ``loads``; all of shape (n,), elementwise, warnings
    #: off (0 N make an infinite factor)
    factor: Callable[..., Any] = over
    parts: tuple[str, ...]  #: names of the parts that it is about, for the parts list
    cure: str  #: what a designer can do, such as "a lower knee_ratio"

    @property
    def informs(self) -> bool:
        """Whether the row only informs, see ``INFORMING``."""
        return self.group in INFORMING

    def __post_init__(self) -> None:
        """Refuse loads that do not exist."""
        if unknown := set(self.loads) - set(LOAD_NAMES):
            raise ValueError(f"{self.name}: loads {sorted(unknown)}: must be of {', '.join(LOAD_NAMES)}")


@dataclass(frozen=True, slots=True, kw_only=True)
class ActuatorJoint(Joint):
    """A row whose capacity depends on the actuator of one side."""

    side: Side  #: which


@dataclass(frozen=True, slots=True, kw_only=True)
class LegJoint(Joint):
    """A row whose capacity is the same for all robots of an actuator map."""


def link_row(source: str, required: float, why: str) -> Callable[..., LegJoint]:
    """Return what makes rows of the links with one source and one required factor."""

    def row(
        name: str, formula: str, loads: tuple[str, ...], capacity: Any, factor: Any, parts: tuple[str, ...]
    ) -> LegJoint:
        return LegJoint(
            name=name,
            group="links",
            formula=formula,
            source=source,
            required=required,
            required_source=why,
            loads=loads,
            capacity=capacity,
            factor=factor,
            parts=parts,
            cure="release the knee's torque before its stop, or jump lower",
        )

    return row
