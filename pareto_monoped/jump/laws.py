"""What the motors are told, as laws that studies name: the paper's virtual leg, torque profiles, and laws of one's own.

A law says which variables a design has besides its hardware and how they enter the controller's record. Its torques are
computed in ``torques``, compiled, for both engines. Whatever the law, its torques pass the same gate of the foot's
clearance and the same limits, delay and losses of the motors, and end when the foot has left the floor.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass
from functools import cache
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

import numpy as np
from pydantic import Field

from pareto_monoped.config import Strict, checked
from pareto_monoped.design import KNOT_NAMES, KNOTS, MOST_KNOTS, NAMES, PAPER_CONTROL, VARIABLES, Floats, Variable
from pareto_monoped.errors import DesignError, InputError, unknown_name
from pareto_monoped.jump.controller_record import OVER_LENGTH, OVER_TIME, OWN, TRACKING

if TYPE_CHECKING:
    from pareto_monoped.robot.population import RobotArrays

OF_VIRTUAL_LEG = (*PAPER_CONTROL, "knee_release_rad", "rest_length_m")
"""The variables that the virtual leg alone reads."""


class Law(ABC):
    """Base class of what the motors are told during a push."""

    __slots__ = ()
    kind: str  #: its name in study files

    @property
    @abstractmethod
    def variables(self) -> tuple[Variable, ...]:
        """The variables of a design that the law reads, besides those of the hardware."""

    @abstractmethod
    def fill(self, records: Any, given: Mapping[str, Floats], robots: "RobotArrays") -> None:
        """Write the law and its variables, name -> values of shape (n,), into n records of ``RECORD``."""

    def as_dict(self) -> dict[str, Any]:
        """Return the law as the table of a study file."""
        return {"kind": self.kind}

    @property
    def slots(self) -> dict[str, str]:
        """Each variable with a name of its own -> the name of the variable in whose place it travels."""
        return {}

    def record_of(self, record: Any) -> dict[str, Any]:
        """Return what ``replay.py`` needs to know of the law in one filled record, beside the virtual leg's."""
        return {}


@dataclass(frozen=True, slots=True, kw_only=True)
class VirtualLeg(Law, Strict):
    """Spring, damper and torsional spring between base and foot, as the paper has them."""

    kind: Literal["virtual_leg"] = "virtual_leg"

    @property
    def variables(self) -> tuple[Variable, ...]:
        """K, C and T, and the optional variables of the virtual leg."""
        return tuple(one for one in VARIABLES if one.name in OF_VIRTUAL_LEG)

    def fill(self, records: Any, given: Mapping[str, Floats], robots: "RobotArrays") -> None:
        """Leave the records, which have all of its variables already, as they are."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Profile(Law, Strict):
    """Torques of both joints through knots at equal distances, as shares of the motors' peak torques there."""

    kind: str
    knots: Annotated[int, Field(ge=2, le=MOST_KNOTS)] = 8  #: of each joint
    between: Literal["cubic", "linear"] = "cubic"  #: how the torque goes from knot to knot

    number: ClassVar[int]

    @property
    def variables(self) -> tuple[Variable, ...]:
        """The knots of the hip, then those of the knee."""
        return tuple(one for one in KNOTS if "_knot_" in one.name and int(one.name.rpartition("_")[2]) <= self.knots)

    def fill(self, records: Any, given: Mapping[str, Floats], robots: "RobotArrays") -> None:
        """Write the knots."""
        records["law"] = self.number
        records["profile"] = np.column_stack([given[name] for name in KNOT_NAMES])
        records["knots"] = self.knots
        records["cubic"] = self.between == "cubic"

    def record_of(self, record: Any) -> dict[str, Any]:
        """Return kind, knots and where they lie."""
        hip, knee = record["profile"][1:].reshape(2, -1)[:, : self.knots].tolist()
        first, per = float(record["first_knot"]), float(record["per_profile"])
        placed = {"first_knot": first, "per_profile": per, "cubic": self.between == "cubic"}
        return {"law": self.kind, "knots": self.knots, **placed, "hip_knots": hip, "knee_knots": knee}

    def as_dict(self) -> dict[str, Any]:
        """Return the law as the table of a study file."""
        return asdict(self)

    def basis(self, shares: Floats) -> Floats:
        """Return the matrix that makes torques of knots: at n shares of the way, shape (n, knots)."""
        from pareto_monoped.jump.torques import basis

        return np.asarray(basis(shares, self.knots, self.between == "cubic"))

    def beside_knots(self, record: Any, time_s: Floats, leg_m: Floats, lever_m: Floats) -> Floats:
        """Return what the law tells the knee besides the knots in the states of a push, in N m; the hip gets nothing.

        ``lever_m`` says by how much the leg's length changes per angle of the knee.
        """
        return np.zeros(len(time_s))

    @abstractmethod
    def shares(self, time_s: Floats, leg_m: Floats, straight_m: float) -> Floats:
        """Return how far states of a push, from its first to its last, are from the first knot to the last one."""


@dataclass(frozen=True, slots=True, kw_only=True)
class TorqueOverTime(Profile):
    """Knots over time, from the start of the jump to the push time; the last one is held until the foot has left."""

    kind: Literal["torque_over_time"]
    number: ClassVar[int] = OVER_TIME

    @property
    def variables(self) -> tuple[Variable, ...]:
        """The push time and the knots."""
        return (KNOTS[0], *Profile.variables.fget(self))  # type: ignore[attr-defined]  # super() lacks a class here

    def fill(self, records: Any, given: Mapping[str, Floats], robots: "RobotArrays") -> None:
        """Write the knots and the times between which they lie."""
        Profile.fill(self, records, given, robots)
        records["first_knot"], records["per_profile"] = 0.0, 1.0 / given["push_time_s"]

    def shares(self, time_s: Floats, leg_m: Floats, straight_m: float) -> Floats:
        """Return the shares of the push time."""
        return np.asarray(time_s / time_s[-1])


@dataclass(frozen=True, slots=True, kw_only=True)
class TorqueOverLength(Profile):
    """Knots over the leg's length from hip to foot, from that at the start to that of the straight leg."""

    kind: Literal["torque_over_length"]
    number: ClassVar[int] = OVER_LENGTH

    def fill(self, records: Any, given: Mapping[str, Floats], robots: "RobotArrays") -> None:
        """Write the knots and the lengths between which they lie."""
        Profile.fill(self, records, given, robots)
        start_m = robots.start_height_m - robots.foot_radius_m
        records["first_knot"] = start_m
        records["per_profile"] = 1.0 / (robots.thigh_length_m + robots.shank_length_m - start_m)

    def shares(self, time_s: Floats, leg_m: Floats, straight_m: float) -> Floats:
        """Return the shares of the way from the first length to that of the straight leg."""
        return np.asarray(np.clip((leg_m - leg_m[0]) / (straight_m - leg_m[0]), 0.0, 1.0))


@dataclass(frozen=True, slots=True, kw_only=True)
class Tracking(TorqueOverLength):
    """Torque over the leg's length and speed: knots over the length, and the virtual leg's damper against the speed.

    Nothing is told by the clock, so that neither a late command nor a weak motor makes the torques fall behind the leg.
    """

    kind: Literal["tracking"]  # type: ignore[assignment]  # another name
    number: ClassVar[int] = TRACKING

    @property
    def variables(self) -> tuple[Variable, ...]:
        """Return the damping C and the knots."""
        knots: tuple[Variable, ...] = Profile.variables.fget(self)  # type: ignore[attr-defined]  # likewise
        return (VARIABLES["damping_n_s_per_m"], *knots)

    def beside_knots(self, record: Any, time_s: Floats, leg_m: Floats, lever_m: Floats) -> Floats:
        """Return the torques of the damper."""
        return np.asarray(-record["damping_n_s_per_m"] * np.gradient(leg_m, time_s) * lever_m)


AnyLaw = Annotated[VirtualLeg | TorqueOverTime | TorqueOverLength | Tracking, Field(discriminator="kind")]
"""The laws that a study file or a calibration may name."""
_LAWS = {
    "virtual_leg": VirtualLeg,
    "torque_over_time": TorqueOverTime,
    "torque_over_length": TorqueOverLength,
    "tracking": Tracking,
}
KINDS = tuple(_LAWS)
"""Their names."""
PAPER_LAW = VirtualLeg()
"""The law of calibrations and studies that name none."""


def law_of(given: Any, *, source: str, error: type[InputError] = InputError) -> Law:
    """Return a law from its name, from a table of its name and settings, or as it is.

    Raises:
        InputError: (or ``error``) an unknown name, or a setting that is unknown or out of range.
    """
    if isinstance(given, Law):
        return given
    table = {"kind": given} if isinstance(given, str) else given
    kind = table.get("kind") if isinstance(table, Mapping) else table
    if not isinstance(kind, str) or kind not in KINDS:
        raise error(f"{source}: {unknown_name('controller', kind, KINDS)}")
    known: Any = _LAWS[kind]  # each of another class
    law: Law = checked(known, table, source=f"{source}, table [controller]", error=error)
    return law


class OwnLaw(Law):
    """Base class of laws of the user's own, for ``simulate`` and ``trace`` of scripts; no file and no study names one.

    A subclass has ``torques``, a static method that numba can compile, and up to 25 ``own_variables``, which frames of
    designs name beside those of the hardware.

    Example:
        >>> from pareto_monoped import OwnLaw, PAPER_CASES, simulate
        >>> class Ramp(OwnLaw):
        ...     own_variables = ("knee_n_m_per_s",)
        ...
        ...     @staticmethod
        ...     def torques(state, variables):
        ...         return 0.0, variables[0] * state.time_s
        >>> design = PAPER_CASES["C"].design.as_dict() | {"knee_n_m_per_s": -200.0}
        >>> simulate(design, controller=Ramp()).status[0]
        'ok'
    """

    kind = "own"
    own_variables: ClassVar[tuple[str, ...]] = ()

    @staticmethod
    def torques(state: Any, variables: Floats) -> tuple[float, float]:
        """Return the torques of hip and knee in N m that the motors are told.

        ``state`` has ``time_s``, ``hip_rad``, ``knee_rad``, ``hip_rad_per_s``, ``knee_rad_per_s``, ``foot_x_m`` and
        ``foot_z_m``, the place of the foot from the hip; ``variables`` has the design's ``own_variables``, in order.
        """
        raise NotImplementedError

    @property
    def variables(self) -> tuple[Variable, ...]:
        """Return nothing: a script's frames have ``own_variables``."""
        return ()

    @property
    def slots(self) -> dict[str, str]:
        """Each own variable -> the name of the variable of a profile in whose place it travels."""
        if len(self.own_variables) > len(KNOT_NAMES) or set(self.own_variables) & set(NAMES):
            raise DesignError(
                f"controller {type(self).__name__}: own_variables must be at most {len(KNOT_NAMES)} names that no "
                "other variable has; correct them"
            )
        return dict(zip(self.own_variables, KNOT_NAMES, strict=False))

    def record_of(self, record: Any) -> dict[str, Any]:
        """Refuse: a file cannot hold a function.

        Raises:
            DesignError: always.
        """
        raise DesignError(
            f"controller {type(self).__name__}: is your own, which no file holds; export with one of {', '.join(KINDS)}"
        )

    def fill(self, records: Any, given: Mapping[str, Floats], robots: "RobotArrays") -> None:
        """Write the law's address and its variables."""
        records["law"], records["own_address"] = OWN, _address(type(self).torques)
        records["profile"] = np.column_stack([given[name] for name in KNOT_NAMES])


_FIELDS = ("time_s", "hip_rad", "knee_rad", "hip_rad_per_s", "knee_rad_per_s", "foot_x_m", "foot_z_m")
_MADE: list[Any] = []  # compiled functions, which must outlive the jumps that call them


@cache
def _address(torques: Callable[..., Any]) -> float:
    """Return the address of the C function that fills the torques of a law of the user's own."""
    import numba

    state_type = np.dtype([(name, np.float64) for name in _FIELDS])
    law, count = numba.njit(error_model="numpy")(torques), len(KNOT_NAMES)
    pointer = numba.types.CPointer(numba.types.float64)

    @numba.cfunc(numba.types.void(pointer, pointer, pointer), error_model="numpy")  # type: ignore[untyped-decorator]  # likewise
    def act(state: Any, variables: Any, torque: Any) -> None:
        moment = numba.carray(state, (7,)).view(state_type)[0]
        found = law(moment, numba.carray(variables, (count,)))
        wanted = numba.carray(torque, (2,))
        wanted[0], wanted[1] = found[0], found[1]

    _MADE.append(act)
    return float(act.address)
