"""The interface of search algorithms: the run loop asks for designs, tells their scores, saves and restores.

An algorithm never simulates and never stores. It sees the free variables only, in their own units, a list of gearboxes
by position and a choice of motor as one more variable, whose values have no order (``search.space``).
"""

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.errors import DatabaseError, InputError
from pareto_monoped.pareto.objectives import HEIGHT_AND_ENERGY, Objectives

Floats = NDArray[np.float64]

MOTOR_OF = {"motor": ("hip", "knee"), "hip_motor": ("hip",), "knee_motor": ("knee",)}
"""Coordinate that chooses a motor -> the joints that it chooses for. Such coordinates stand last."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Gear:
    """What a search knows of a gearbox."""

    ratio: float  #: the real one
    mass_kg: float
    efficiency: float
    reflected_inertia_kg_m2: float  #: at the output


@dataclass(frozen=True, slots=True, kw_only=True)
class MotorKind:
    """What a search knows of a motor that it may choose."""

    name: str
    peak_torque_n_m: float
    no_load_speed_rad_per_s: float
    #: the gearboxes of each variable that chooses one, by ascending ratio
    gears: Mapping[str, tuple[Gear, ...]] = field(default_factory=dict)


@dataclass(frozen=True, slots=True, kw_only=True)
class MotorChoice:
    """A coordinate that chooses a motor."""

    name: str  #: the coordinate's, a key of ``MOTOR_OF``
    motors: tuple[MotorKind, ...]  #: what it chooses from, at least two


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Space:
    """What is searched, and for what.

    Where a joint has one motor, a variable that chooses its gearbox has the whole numbers from 0 to n - 1. Where it has
    several, the variable goes from 0, the first gearbox of whatever motor, to 1, its last one, and the coordinate of
    the choice has the whole numbers from 0 to the number of motors less 1.

    Example:
        >>> from pareto_monoped import MonopedProblem, Study
        >>> space = MonopedProblem(Study.define(name="mine", evaluations=40)).jump.space
        >>> space.names[:3], float(space.lower[0]), float(space.upper[0]), space.whole[:3].tolist()
        (('thigh_length_m', 'shank_length_m', 'knee_ratio'), 0.3, 0.5, [False, False, True])
    """

    names: tuple[str, ...]  #: names of the d free variables
    lower: Floats  #: their lower bounds, shape (d,)
    upper: Floats  #: their upper bounds, shape (d,)
    objectives: Objectives = HEIGHT_AND_ENERGY  #: two or three measures
    #: the gearboxes of each variable that chooses one, for joints with one motor
    gears: Mapping[str, tuple[Gear, ...]] = field(default_factory=dict)
    #: the coordinates that choose a motor, the last of ``names``; empty where every joint has one
    choices: tuple[MotorChoice, ...] = ()
    #: returns points that a search begins with, shape (n, d); None: it begins anywhere
    begin: Callable[[], Floats] | None = None

    def __repr__(self) -> str:
        """Return one line: what is varied, and for what."""
        return f"Space({len(self.names)} variables: {', '.join(self.names)}; for {', '.join(self.objectives.names)})"

    @property
    def whole(self) -> NDArray[np.bool_]:
        """Which variables are whole numbers, shape (d,)."""
        return np.array([name in self.gears or name in MOTOR_OF for name in self.names])

    @property
    def edges(self) -> tuple[Floats, Floats]:
        """Bounds of numbers that ``snap`` rounds, each of shape (d,): every whole number owns an equal share."""
        return self.lower - 0.5 * self.whole, self.upper + 0.5 * self.whole

    def snap(self, values: Floats) -> Floats:
        """Return the nearest points of the space to values within the edges, shape (n, d).

        Whole numbers are rounded, and shares of a list of gearboxes moved to that of their gearbox, so that equal
        designs have equal values.
        """
        snapped = np.where(self.whole, np.clip(np.round(values), self.lower, self.upper), values)
        for name in self.listed:
            last = self.last_gears(name)[self.motor_of(name, snapped)]
            snapped[:, self.names.index(name)] = self.gear_of(name, snapped) / np.maximum(last, 1)
        return snapped

    @property
    def listed(self) -> tuple[str, ...]:
        """The variables that choose a gearbox from the list of the joint's motor, for joints with several."""
        return tuple(name for name in self.names for choice in self.choices if name in choice.motors[0].gears)

    @property
    def choice_columns(self) -> tuple[int, ...]:
        """Places of ``choices`` in ``names``."""
        return tuple(self.names.index(choice.name) for choice in self.choices)

    def picked(self, choice: MotorChoice, values: Floats) -> NDArray[np.intp]:
        """Return which motor of a choice each of n points has, shape (n, d) -> (n,)."""
        return np.asarray(values[:, self.names.index(choice.name)], dtype=np.intp)

    def choice_for(self, name: str) -> MotorChoice:
        """Find the choice of the motor whose gearboxes a variable of ``listed`` chooses from."""
        return next(choice for choice in self.choices if name in choice.motors[0].gears)

    def motor_of(self, name: str, values: Floats) -> NDArray[np.intp]:
        """Return which motor of ``choice_for(name)`` each of n points has, shape (n, d) -> (n,)."""
        return self.picked(self.choice_for(name), values)

    def gear_of(self, name: str, values: Floats) -> NDArray[np.intp]:
        """Return the place of each point's gearbox in its motor's list, shape (n,); all own equal shares of 0 to 1."""
        last = self.last_gears(name)[self.motor_of(name, values)]
        share = values[:, self.names.index(name)]
        return np.minimum(np.floor(share * (last + 1)), last).astype(np.intp)

    def last_gears(self, name: str) -> NDArray[np.intp]:
        """Return the position of the last gearbox of each motor of ``choice_for(name)``, shape (motors,)."""
        return np.array([len(motor.gears[name]) - 1 for motor in self.choice_for(name).motors], dtype=np.intp)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Proposal:
    """Designs to evaluate."""

    values: Floats  #: values of the free variables, shape (n, d)
    #: weight of the first objective in a weighted search (the paper's lambda1), stored with each of these trials; None
    #: for other searches
    height_weight: float | None = None


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Scores:
    """What a search algorithm may know about n evaluated designs.

    Example:
        >>> import numpy as np
        >>> from pareto_monoped import Scores, Study
        >>> objectives = Study.define(name="mine", evaluations=40).objectives  # height, which is maximised, and energy
        >>> none = np.zeros(1)
        >>> scores = Scores(
        ...     objectives=objectives, values=np.array([[0.8, 15.0]]), violation=none, constraints=none[:, None]
        ... )
        >>> scores.minimised().tolist()
        [[-0.8, 15.0]]
    """

    objectives: Objectives  #: which measures the search is for
    values: Floats  #: values of these m objectives, shape (n, m); NaN where the jump failed
    #: how far the constraints are missed, shape (n,): 0 where all hold, large where the jump failed
    violation: Floats
    #: how far each of k constraints is missed, as a share of its limit, shape (n, k); it holds at <= 0; shape (n, 0)
    #: where a search has none
    constraints: Floats

    def __repr__(self) -> str:
        """Return one line: the number of designs, how many are feasible, and the objectives."""
        feasible = int((self.violation <= 0.0).sum())
        return f"Scores({len(self.values)} designs, {feasible} feasible, {', '.join(self.objectives.names)})"

    def minimised(self) -> Floats:
        """Return all objectives as minimisation, shape (n, m); zeros for failed jumps, which have a violation."""
        return np.nan_to_num(self.objectives.minimised(self.values), nan=0.0)

    def of(self, rows: slice) -> "Scores":
        """Return the scores of some of the designs."""
        return Scores(
            objectives=self.objectives,
            values=self.values[rows],
            violation=self.violation[rows],
            constraints=self.constraints[rows],
        )


class Algorithm(ABC):
    """Base class of the search algorithms, as the run loop sees them.

    The loop calls ``state`` after ``tell`` or before the first ``ask``. A new algorithm with the same settings and
    seed, restored from that state, continues exactly as the saved one would have.
    """

    @abstractmethod
    def ask(self) -> Proposal | None:
        """Return the next designs to evaluate; None if the search has ended by itself."""

    @abstractmethod
    def tell(self, scores: Scores) -> None:
        """Take the scores of all designs of the last ``ask``, in their order."""

    @abstractmethod
    def state(self) -> dict[str, Any]:
        """Return everything needed to continue, as plain JSON values."""

    @abstractmethod
    def restore(self, state: dict[str, Any], history: Iterable[tuple[Floats, Scores]]) -> None:
        """Continue from a saved state; ``history`` has values and scores of every ``tell`` so far, in order."""

    def same_designs(self, asked: Floats, stored: Floats) -> bool:
        """Check that designs which a restored algorithm asks for again are those stored: here, to the last bit."""
        return np.array_equal(asked, stored)

    def other_designs(self, trials: str, source: str) -> InputError:
        """Return the error for stored ``trials``, in words, that are not those asked for."""
        return DatabaseError(f"{source}: {trials} do not follow from its checkpoint; it is damaged, restore a copy")
