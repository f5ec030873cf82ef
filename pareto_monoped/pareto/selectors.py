"""What can be asked of a front: which one of its designs, and under which conditions."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

Side = Literal["min", "max"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Condition:
    """A limit on a stored measure or a design variable.

    Attributes:
        name: of the measure or variable.
        side: whether it is at least (``min``) or at most (``max``) ``value``.
        value: in the stored unit.
        asked: how the user wrote it, such as "min-height", for messages; side and name if empty.
    """

    name: str
    side: Side
    value: float
    asked: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class MinHeight:
    """The design that jumps at least ``height_m`` and is best in the first other objective: the least energy."""

    height_m: float


@dataclass(frozen=True, slots=True, kw_only=True)
class MaxEnergy:
    """The design that needs at most ``energy_j`` and is best in the first other objective: the highest jump."""

    energy_j: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Within:
    """The design whose measure is at ``value`` or better, and that is best in the first other objective.

    ``value`` is in the measure's stored unit.
    """

    measure: str
    value: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Knee:
    """The knee of the front: the design farthest from the line, or the plane, through its ends."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Tradeoff:
    """The design whose neighbours on the front are all poor bargains: they gain least for what they give up."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Weights:
    """The design with the best weighted sum of the objectives, each scaled to the extent of the front."""

    values: tuple[float, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Compromise:
    """The design with the least weighted distance from the best of every objective.

    Unlike ``Weights`` it also finds designs where the front is bent the other way.
    """

    values: tuple[float, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Nearest:
    """The design nearest to a wish: its greatest shortfall in any of the named measures is least."""

    wish: Mapping[str, float]


@dataclass(frozen=True, slots=True, kw_only=True)
class Trial:
    """The trial with this number."""

    number: int


Chooser = Knee | Tradeoff | Weights | Compromise | Nearest | Trial
"""What chooses by the shape of the front, and is not itself a condition."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Among:
    """A choice among the designs that meet all conditions.

    Without ``chooser`` it is the best design in the first objective that no condition is about, or, if they are about
    all objectives, in the first one besides that of the first condition.
    """

    conditions: tuple[Condition | MaxEnergy, ...]
    chooser: Chooser | None = None


Selector = MinHeight | MaxEnergy | Within | Chooser | Among
