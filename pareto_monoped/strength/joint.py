"""One row of the table of joints: what may fail, under which loads, by which formula, and what is required."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Literal

from pareto_monoped.actuator.actuator import Actuator
from pareto_monoped.actuator.settings import ActuatorSettings
from pareto_monoped.leg.dimensions import LegDimensions
from pareto_monoped.strength.groups import INFORMING, Group
from pareto_monoped.strength.loads import LOAD_NAMES

Side = Literal["hip", "knee"]
SIDES: tuple[Side, ...] = ("hip", "knee")
"""The joints of the robot, each with its actuator."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Structure:
    """What a capacity may depend on.

    Attributes:
        actuator: of the row's side; for a row of the leg that of the hip, which must not matter.
        leg: the leg that all actuators of the maps share.
        settings: of stage 1: rules, materials, safety factors of the rating.
    """

    actuator: Actuator
    leg: LegDimensions
    settings: ActuatorSettings


@dataclass(frozen=True, slots=True, kw_only=True)
class Together:
    """A capacity that is computed for many structures at once, which saves time.

    Attributes:
        of: the capacities of some structures of one actuator map.
    """

    of: Callable[[Sequence[Structure]], Sequence[float]]

    def __call__(self, s: Structure) -> float:
        """The capacity of one structure."""
        return self.of([s])[0]


def over(capacity: Any, load: Any) -> Any:
    """The common safety factor: what a joint carries over what it has to carry."""
    return capacity / load


@dataclass(frozen=True, slots=True, kw_only=True)
class Joint:
    """A row.

    Attributes:
        name: unique; in ``strength.csv``, in messages and in the report.
        group: by which measure it counts.
        formula: of the factor, in a line.
        source: of the formula.
        required: least factor allowed.
        required_source: why that much.
        loads: fields of ``Loads`` that ``factor`` gets.
        capacity: what the joint carries, one number or several. Rows may share it: it is computed once then.
        factor: the safety factor from the numbers of ``capacity``, then the ``loads``; all of shape (n,), elementwise,
            warnings off (0 N make an infinite factor).
        parts: names of the parts that it is about, for the parts list.
        cure: what a designer can do, such as "a lower knee_ratio".
    """

    name: str
    group: Group
    formula: str
    source: str
    required: float
    required_source: str
    loads: tuple[str, ...]
    capacity: Callable[[Structure], float | tuple[float, ...]]
    factor: Callable[..., Any] = over
    parts: tuple[str, ...]
    cure: str

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
    """A row whose capacity depends on the actuator of one side.

    Attributes:
        side: which.
    """

    side: Side


@dataclass(frozen=True, slots=True, kw_only=True)
class LegJoint(Joint):
    """A row whose capacity is the same for all robots of an actuator map."""
