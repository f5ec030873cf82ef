"""What a search is for: two or three measures of a jump, each with its direction."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.measures import Measure, measure

FEWEST, MOST = 2, 3
"""How many objectives a search may have: one has no front, and four or more cannot be shown on a page."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Objectives:
    """Two or three measures, in the order in which tables and charts show them."""

    names: tuple[str, ...]  #: of the measures; each is in ``measures.MEASURES`` and has a direction

    @property
    def measures(self) -> tuple[Measure, ...]:
        """The measures themselves."""
        return tuple(measure(name) for name in self.names)

    @property
    def signs(self) -> NDArray[np.float64]:
        """-1 for each measure that is maximised, 1 for each that is minimised; times a value it is to be minimised."""
        return np.array([-1.0 if entry.direction == "maximise" else 1.0 for entry in self.measures])

    @property
    def directions(self) -> dict[str, str]:
        """Direction of each measure, by name."""
        return {entry.name: str(entry.direction) for entry in self.measures}

    @property
    def volume_unit(self) -> str:
        """Unit of a hypervolume, such as "m J"; shares have none."""
        return " ".join(entry.unit for entry in self.measures if entry.unit != "1") or "1"

    def minimised(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """``values``, shape (n, m) in stored units, with the sign that makes less better."""
        return np.ascontiguousarray(values * self.signs)

    def text(self, values: Sequence[float]) -> str:
        """The values of one design in words, such as "0.800 m on 15.36 J" or "mass 3.812 kg, height 0.800 m"."""
        if self == HEIGHT_AND_ENERGY:
            return f"{values[0]:.3f} m on {values[1]:.2f} J"
        apart = "; " if any("," in entry.words for entry in self.measures) else ", "
        return apart.join(
            f"{entry.words} {entry.text(value)}" for entry, value in zip(self.measures, values, strict=True)
        )

    def other_than(self, name: str) -> Measure:
        """The first of the objectives that is not called ``name``."""
        return next(entry for entry in self.measures if entry.name != name)


HEIGHT_AND_ENERGY = Objectives(names=("height_m", "energy_j"))
"""The paper's objectives, which are the default."""
