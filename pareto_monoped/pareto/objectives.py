"""What a search is for, two or three measures of a jump with directions, and how good a front is: its hypervolume."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.measures import Measure, measure

Floats = NDArray[np.float64]

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
    def signs(self) -> Floats:
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

    def minimised(self, values: Floats) -> Floats:
        """Return ``values``, shape (n, m) in stored units, with the sign that makes less better."""
        return np.ascontiguousarray(values * self.signs)

    def text(self, values: Sequence[float]) -> str:
        """Return the values of one design in words, such as "0.800 m on 15.36 J" or "mass 3.812 kg, height 0.800 m"."""
        if self == HEIGHT_AND_ENERGY:
            return f"{values[0]:.3f} m on {values[1]:.2f} J"
        apart = "; " if any("," in entry.words for entry in self.measures) else ", "
        return apart.join(
            f"{entry.words} {entry.text(value)}" for entry, value in zip(self.measures, values, strict=True)
        )

    def other_than(self, name: str) -> Measure:
        """Return the first of the objectives that is not called ``name``."""
        return next(entry for entry in self.measures if entry.name != name)


HEIGHT_AND_ENERGY = Objectives(names=("height_m", "energy_j"))
"""The paper's objectives, which are the default."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ReferencePoint:
    """The corner from which the hypervolume is measured: designs that are worse in any objective add nothing."""

    objectives: Objectives  #: the search's
    values: tuple[float, ...]  #: a value of each objective, in their order and stored units

    def as_dict(self) -> dict[str, float]:
        """Return the values by the names of their measures."""
        return dict(zip(self.objectives.names, self.values, strict=True))

    def text(self) -> str:
        """Write the values with their units, such as "0.55 m, 100 J"."""
        pairs = zip(self.objectives.measures, self.values, strict=True)
        return ", ".join(f"{value:g} {entry.unit}" if entry.unit != "1" else f"{value:g}" for entry, value in pairs)


def reference_point(objectives: Objectives, given: Mapping[str, float] | None = None) -> ReferencePoint:
    """Make the corner for some objectives: values ``given`` by name, for the others those of the table of measures."""
    given = given or {}
    values = (given.get(entry.name, entry.reference) for entry in objectives.measures)
    return ReferencePoint(objectives=objectives, values=tuple(0.0 if value is None else value for value in values))


def hypervolume(points: Floats, reference: ReferencePoint) -> float:
    """Compute the area or volume that ``points`` in stored units dominate (Zitzler and Thiele 1998)."""
    less_is_better = reference.objectives.minimised(points)
    corner = reference.objectives.minimised(np.array(reference.values))
    inside = less_is_better[(less_is_better < corner).all(axis=1)]
    if len(inside) == 0:
        return 0.0
    if len(corner) == 2:
        return _area(inside, corner)
    import moocore

    return float(moocore.hypervolume(np.ascontiguousarray(inside), ref=corner))


def _area(points: Floats, corner: Floats) -> float:
    """Compute the area between points, shape (n, 2), and a corner that is worse than all: moocore's to the last bit.

    The sum goes over the points by their first objective; each adds the strip that reaches from its own second
    objective to the least one before it. Without moocore, which takes longer to import than a front of 1,000 designs.
    """
    first, second = points[:, 0], points[:, 1]
    if not (first[1:] > first[:-1]).all():  # a front that is followed is sorted, and sorting is most of the time
        order = np.lexsort((second, first))
        first, second = first[order], second[order]
    before = np.concatenate((corner[1:], np.minimum.accumulate(second)[:-1]))
    better = second < before
    # A cumulative sum adds in order, as moocore does; ``np.sum`` adds in pairs.
    return float(np.cumsum((corner[0] - first[better]) * (before[better] - second[better]))[-1])
