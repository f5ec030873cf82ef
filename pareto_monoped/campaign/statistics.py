"""Medians and bands over studies: by motor, by seed, by whatever varies, where studies can be compared at all."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.campaign.results import Result, pair_of
from pareto_monoped.pareto.objectives import Objectives

Floats = NDArray[np.float64]

LOW, HIGH = 0.1, 0.9
"""Ends of the bands: what a tenth of the studies and nine tenths of them reach."""
POINTS = 120
"""Of a curve: more than a chart can show apart."""
SEEDS = "seeds"
"""The axis that says nothing of the robot; its studies are repetitions."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Group:
    """Finished studies that have something in common, such as all seeds with one motor."""

    label: str
    results: tuple[Result, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Section:
    """Finished studies that can be compared: the same objectives under the same calibration.

    Attributes:
        objectives, calibration: of all of them.
        axes: that vary among them.
        results: the studies.
        groups: those that differ in nothing but the seed.
    """

    objectives: Objectives
    calibration: str
    axes: tuple[str, ...]
    results: tuple[Result, ...]
    groups: tuple[Group, ...]

    def by(self, axis: str) -> tuple[Group, ...]:
        """The studies by their value on one axis, whatever they have on the others."""
        return _grouped(self.results, (axis,))


@dataclass(frozen=True, slots=True, kw_only=True)
class Spread:
    """What half of some values reach, a tenth of them and nine tenths; NaN where so many reach nothing."""

    middle: float
    low: float
    high: float


def sections_of(results: Sequence[Result], axes: Sequence[str]) -> list[Section]:
    """The finished studies by what can be compared, in the order of the campaign."""
    found: dict[tuple[tuple[str, ...], str], list[Result]] = {}
    for result in results:
        if result.finished:
            found.setdefault((result.objectives.names, result.calibration), []).append(result)
    sections = []
    for (names, calibration), members in found.items():
        varying = tuple(axis for axis in axes if _values(members, axis) > 1)
        sections.append(
            Section(
                objectives=Objectives(names=names),
                calibration=calibration,
                axes=varying,
                results=tuple(members),
                groups=_grouped(members, [axis for axis in varying if axis != SEEDS]),
            )
        )
    return sections


def _values(results: Sequence[Result], axis: str) -> int:
    return len({result.place.member.labels.get(axis) for result in results})


def _grouped(results: Sequence[Result], axes: Sequence[str]) -> tuple[Group, ...]:
    groups: dict[str, list[Result]] = {}
    for result in results:
        label = ", ".join(result.place.member.labels[axis] for axis in axes)
        groups.setdefault(label, []).append(result)
    return tuple(Group(label=label or "all", results=tuple(members)) for label, members in groups.items())


def spread_of(values: Sequence[float] | Floats) -> Spread:
    """Median and band of some values: order statistics, no values between them.

    Of an even number the median is the lower one of the middle two. Of fewer than ten values the band goes from the
    least to the greatest. NaN counts as greater than every number.
    """
    middle, low, high = quantiles(np.asarray(values, dtype=np.float64)[:, None])[:, 0]
    return Spread(middle=float(middle), low=float(low), high=float(high))


def quantiles(values: Floats) -> Floats:
    """Median, low and high end of the bands of n runs at k places, shape (3, k) from shape (n, k)."""
    ranked = np.sort(values, axis=0)  # NaN last
    count = len(ranked)
    ranks = [max(int(np.ceil(share * count - 1e-9)) - 1, 0) for share in (0.5, LOW, HIGH)]
    return np.asarray(ranked[ranks])


def levels_of_section(section: Section) -> Floats:
    """Levels of the first objective of ``pair_of`` from the least to the most on any front, shape (k,)."""
    first = section.objectives.names.index(pair_of(section.objectives)[0])
    values = np.concatenate([result.front[:, first] for result in section.results])
    return np.linspace(values.min(), values.max(), POINTS)


def attainment(group: Group, levels: Floats) -> Floats:
    """What half, a tenth and nine tenths of the runs need at most for each level, shape (3, k).

    These are empirical attainment surfaces (Grunert da Fonseca et al. 2001): order statistics of the runs' best second
    objectives at each level of the first, such as their least energies at each height.
    """
    sign = group.results[0].objectives.signs[
        group.results[0].objectives.names.index(pair_of(group.results[0].objectives)[1])
    ]
    return np.asarray(sign * quantiles(np.stack([sign * result.least(levels) for result in group.results])))


def growth(group: Group) -> tuple[Floats, Floats]:
    """Evaluations, shape (k,), and median and band of the hypervolume there, shape (3, k); the last value is held."""
    histories = [result.history for result in group.results if len(result.history)]
    if not histories:
        return np.zeros(0), np.zeros((3, 0))
    last = max(float(history[-1, 0]) for history in histories)
    first = max(float(history[0, 0]) for history in histories)  # from there on all of them have a value
    at = np.unique(np.linspace(first, last, POINTS).round())
    return at, quantiles(np.stack([_held(history, at) for history in histories]))


def _held(history: Floats, at: Floats) -> Floats:
    """The latest value at each number of evaluations, none of them before the first."""
    return np.asarray(history[np.searchsorted(history[:, 0], at, side="right") - 1, 1])


def relative(section: Section) -> dict[str, float]:
    """Name of each study -> its hypervolume as a share of the median of the studies that differ in the seed only."""
    shares = {}
    for group in section.groups:
        middle = spread_of([result.stored.hypervolume for result in group.results]).middle
        for result in group.results:
            shares[result.place.name] = result.stored.hypervolume / middle if middle > 0.0 else float("nan")
    return shares
