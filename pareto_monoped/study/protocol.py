"""The interface between run loop and search algorithms: ask for designs, tell their scores, save, restore.

An algorithm never simulates and never stores. It sees the free variables only, in their own units.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class Space:
    """The free variables' names and bounds, each of length d."""

    names: tuple[str, ...]
    lower: Floats
    upper: Floats


@dataclass(frozen=True, slots=True, kw_only=True)
class Proposal:
    """Designs to evaluate.

    Attributes:
        values: values of the free variables, shape (n, d).
        height_weight: lambda1 of a weighted search, stored with each of these trials; None for other searches.
    """

    values: Floats
    height_weight: float | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Scores:
    """What a search algorithm may know about n evaluated designs.

    Attributes:
        height_m, energy_j: the objectives, shape (n,); NaN where the jump failed.
        violation: how far the constraints are missed, shape (n,): 0 where all hold, large where the jump failed.
    """

    height_m: Floats
    energy_j: Floats
    violation: Floats

    def minimised(self) -> Floats:
        """Both objectives as minimisation, shape (n, 2). Failed jumps get zeros; their violation tells them apart."""
        return np.nan_to_num(np.column_stack((-self.height_m, self.energy_j)), nan=0.0)


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
