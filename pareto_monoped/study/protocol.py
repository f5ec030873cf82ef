"""The interface between run loop and search algorithms: ask for designs, tell their scores, save, restore.

An algorithm never simulates and never stores. It sees the free variables only, in their own units, and a list of
gearboxes by position (``study.coordinates``).
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.pareto.objectives import HEIGHT_AND_ENERGY, Objectives

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class Gear:
    """What a search knows of a gearbox: its real ratio and its mass."""

    ratio: float
    mass_kg: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Space:
    """What is searched, and for what.

    Attributes:
        names, lower, upper: names and bounds of the free variables, each of length d.
        objectives: two or three measures.
        gears: the gearboxes of each variable that chooses one; its values are the whole numbers from 0 to n - 1.
    """

    names: tuple[str, ...]
    lower: Floats
    upper: Floats
    objectives: Objectives = HEIGHT_AND_ENERGY
    gears: Mapping[str, tuple[Gear, ...]] = field(default_factory=dict)

    @property
    def whole(self) -> NDArray[np.bool_]:
        """Which variables are whole numbers, shape (d,)."""
        return np.array([name in self.gears for name in self.names])

    @property
    def edges(self) -> tuple[Floats, Floats]:
        """Bounds of numbers that ``snap`` rounds, each of shape (d,): every whole number owns an equal share."""
        return self.lower - 0.5 * self.whole, self.upper + 0.5 * self.whole

    def snap(self, values: Floats) -> Floats:
        """Values within the edges with whole numbers where they must be, shape (n, d); the others stay."""
        return np.where(self.whole, np.clip(np.round(values), self.lower, self.upper), values)


@dataclass(frozen=True, slots=True, kw_only=True)
class Proposal:
    """Designs to evaluate.

    Attributes:
        values: values of the free variables, shape (n, d).
        height_weight: weight of the first objective in a weighted search (the paper's lambda1), stored with each of
            these trials; None for other searches.
    """

    values: Floats
    height_weight: float | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Scores:
    """What a search algorithm may know about n evaluated designs.

    Attributes:
        objectives: which measures the search is for.
        values: of these m objectives, shape (n, m); NaN where the jump failed.
        violation: how far the constraints are missed, shape (n,): 0 where all hold, large where the jump failed.
        constraints: how far each of k constraints is missed, as a share of its limit, shape (n, k); it holds at <= 0.
            Shape (n, 0) where a search has none.
    """

    objectives: Objectives
    values: Floats
    violation: Floats
    constraints: Floats

    def minimised(self) -> Floats:
        """All objectives as minimisation, shape (n, m). Failed jumps get zeros; their violation tells them apart."""
        return np.nan_to_num(self.objectives.minimised(self.values), nan=0.0)

    def of(self, rows: slice) -> "Scores":
        """The scores of some of the designs."""
        return Scores(
            objectives=self.objectives,
            values=self.values[rows],
            violation=self.violation[rows],
            constraints=self.constraints[rows],
        )


class Algorithm(Protocol):
    """What the run loop asks of a search algorithm.

    The loop calls ``state`` after ``tell`` or before the first ``ask``. A new algorithm with the same settings and
    seed, restored from that state, continues exactly as the saved one would have.
    """

    def ask(self) -> Proposal | None:
        """The next designs to evaluate; None if the search has ended by itself."""

    def tell(self, scores: Scores) -> None:
        """Take the scores of all designs of the last ``ask``, in their order."""

    def state(self) -> dict[str, Any]:
        """Everything needed to continue, as plain JSON values."""

    def restore(self, state: dict[str, Any], history: Iterable[tuple[Floats, Scores]]) -> None:
        """Continue from a saved state.

        Args:
            state: what ``state`` returned.
            history: values and scores of every ``tell`` so far, in order. Some algorithms rebuild themselves from it;
                the others ignore it.
        """
