"""How a front still grows: what a search would gain by going on, by what it gained so far and by a second search."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from pareto_monoped.pareto.front import HEIGHT
from pareto_monoped.pareto.objectives import Floats, ReferencePoint, hypervolume

AHEAD = 4
"""How many times as many evaluations ``left_to_gain`` looks ahead to."""
_DOUBLING = 0.42
"""What a doubling of the evaluations gains, as a share of what the doubling before it gained. Our own choice, by
measurement: benchmarks/search_landscapes.md says how near the estimates come."""


def left_to_gain(evaluations: ArrayLike, volumes: ArrayLike) -> float | None:
    """Estimate what ``AHEAD`` times the evaluations would add to the hypervolume, as a share of today's.

    Each of the next two doublings is expected to gain ``_DOUBLING`` of what the doubling before it gained. A fitted
    curve has one more number to find in the same noise, and came less near.

    Args:
        evaluations: number of evaluations after each generation, shape (k,), ascending.
        volumes: the front's hypervolume then, shape (k,).

    Returns:
        None where nothing was known after half of the evaluations, so that nothing can be said.
    """
    done, volume = np.asarray(evaluations, dtype=np.float64), np.asarray(volumes, dtype=np.float64)
    if len(done) == 0 or done[0] > 0.5 * done[-1]:
        return None
    before = float(np.interp(0.5 * done[-1], done, volume))
    if before <= 0.0:
        return None
    return float((volume[-1] - before) / volume[-1] * (_DOUBLING + _DOUBLING**2))


ENOUGH = 0.01
"""Up to which difference of two searches, and which gain left, more evaluations are not worth their time. Our own
choice: less than built robots differ by."""
_ENERGIES = ("energy_j", "electrical_energy_j")


@dataclass(frozen=True, slots=True, kw_only=True)
class SecondSearch:
    """How far a search agrees with a second one that has another seed; pairs are of the first and the second."""

    hypervolume: float  #: of both fronts joined
    alone: tuple[float, float]  #: shares of it that one search has and the other lacks
    heights_m: tuple[float, ...]  #: some that both fronts reach; none if the objectives are not height and an energy
    energies_j: tuple[tuple[float, float], ...]  #: the least energy on either front for at least each of these heights
    left_to_gain: float | None  #: share that the first search would gain by four times the evaluations, if known

    @property
    def differences(self) -> tuple[float, ...]:
        """What the second search needs more than the first at each height, as a share; negative if it needs less."""
        return tuple(second / first - 1.0 for first, second in self.energies_j)

    def text(self) -> str:
        """Say in one sentence how far the searches differ, and what to do."""
        differences = zip(self.differences, self.heights_m, strict=True)
        worst, height_m = max(differences, key=lambda one: abs(one[0]), default=(0.0, 0.0))
        volume, left, more = max(self.alone), self.left_to_gain or 0.0, "the seed still matters, give more evaluations."
        if self.hypervolume == 0.0:
            return "Neither search has a front to compare: give more evaluations, or relax the limits."
        if abs(worst) > ENOUGH:
            word = "less" if worst < 0.0 else "more"
            return f"The second search needs {_percent(worst)} {word} energy at {height_m:.2f} m than the first: {more}"
        if volume > ENOUGH:
            word = "first" if self.alone[0] == volume else "second"
            return f"The {word} search alone has {_percent(volume)} of the hypervolume of both: {more}"
        energy = f"{_percent(worst)} of energy at a height and " if self.heights_m else ""
        gain = f", but {AHEAD} times as many evaluations would gain about {_percent(left)}."
        end = gain if left > ENOUGH else ": more evaluations would gain little."
        return f"The searches differ by at most {energy}{_percent(volume)} of the hypervolume{end}"


def _percent(share: float) -> str:
    return f"{100.0 * abs(share):.1f} percent"


def second_search(first: Floats, second: Floats, corner: ReferencePoint, left: float | None) -> SecondSearch:
    """Compare the fronts of two searches, shapes (n, m) and (k, m) in stored units; the first has ``left`` to gain."""
    names, fronts = corner.objectives.names, (first, second)
    joined = hypervolume(np.concatenate(fronts), corner)
    # Rounding may take a share below 0.
    one, two = (max(0.0, 1.0 - hypervolume(o, corner) / joined) if joined else 0.0 for o in (second, first))
    heights: list[float] = []
    energies: list[tuple[float, float]] = []
    if len(names) == 2 and HEIGHT in names and {*names} & {*_ENERGIES} and len(first) and len(second):
        high = names.index(HEIGHT)
        # What one search has at a height that the other leaves out counts: both can be asked for at least that height.
        least, most = min(front[:, high].min() for front in fronts), min(front[:, high].max() for front in fronts)
        inner = np.unique(np.linspace(least, most, 7)[1:-1].round(2))
        heights = inner[inner <= most].tolist()
        reached = ([float(front[front[:, high] >= h, 1 - high].min()) for h in heights] for front in fronts)
        energies = list(zip(*reached, strict=True))
    return SecondSearch(
        hypervolume=joined, alone=(one, two), heights_m=tuple(heights), energies_j=tuple(energies), left_to_gain=left
    )
