"""What the page has of a study's designs under uncertainty, their limits, and alternatives to those pointed out."""

from collections.abc import Mapping, Sequence

import numpy as np

from pareto_monoped.analysis.alternatives import alternatives
from pareto_monoped.analysis.robustness import robust_front, robust_trials
from pareto_monoped.errors import SelectionError
from pareto_monoped.measures import ROBUST_NAMES, is_own, is_robust
from pareto_monoped.report.packing import column, packed_column
from pareto_monoped.report.schema import BestTorque, Influences, Number, OtherDesign, Robust
from pareto_monoped.storage.extra_rows import Stored, StoredLimit, StoredSensitivity
from pareto_monoped.storage.reader import StudyData
from pareto_monoped.uncertainty.sensitivity import About, Influence

MOST_ALTERNATIVES = 5
"""Alternatives listed beside a design. Our own choice, as in the examples of ``pick --alternatives``."""


def robust_of(data: StudyData, stored: Mapping[int, Stored], row_of: Mapping[int, int]) -> Robust | None:
    """Return a study's designs under uncertainty that are in ``row_of``: trial -> row; None without any stored."""
    if not stored:
        return None
    trials = robust_trials(data, stored)
    rows = trials.rows[trials.rows["trial"].isin(row_of)]
    try:
        front = robust_front(data, trials)["trial"].tolist()
    except SelectionError:
        front = []
    settings, ranges = trials.settings, trials.settings.get("uncertainty")
    return Robust(
        ranges=str(ranges.get("name", "")) if isinstance(ranges, Mapping) else "",
        samples=int(str(settings.get("samples", 0))),
        fragile=trials.fragile,
        others=trials.others,
        rows=[row_of[int(trial)] for trial in rows["trial"]],
        front=[row_of[int(trial)] for trial in front if trial in row_of],
        packed={name: packed_column(rows[name]) for name in ROBUST_NAMES if np.isfinite(rows[name]).any()},
    )


def names_of(studies: Sequence[StudyData], robust: Sequence[Robust | None]) -> tuple[str, ...]:
    """Return what some study has beside its jumps' measures: those under uncertainty, then own functions."""
    there = {name for data in studies for name in data.trials if is_robust(name)}
    there.update(name for one in robust if one is not None for name in one.packed)
    own = dict.fromkeys(name for data in studies for name in data.trials if is_own(name))
    return (*(name for name in ROBUST_NAMES if name in there), *own)


def alternatives_of(data: StudyData, trial: int, row_of: Mapping[int, int]) -> tuple[OtherDesign, ...]:
    """Return quite different designs on the page that cost about as much as one of a study's."""
    found = alternatives(data, trial, count=MOST_ALTERNATIVES)
    return tuple(
        OtherDesign(row=row_of[one.trial], price=round(one.price, 5), text=one.text(), audited=one.audited)
        for one in found
        if one.trial in row_of
    )


def best_of(data: StudyData, stored: Mapping[int, StoredLimit], row_of: Mapping[int, int]) -> BestTorque | None:
    """Return what the best torque found reaches with a study's designs that are in ``row_of``; None without any."""
    found = {row_of[trial]: one.result for trial, one in stored.items() if trial in row_of}
    if not found:
        return None
    held, energy, jumps = data.study.strength, next(iter(found.values())).energy, []
    for row, one in found.items():
        both = (one.least_held, one.greatest_held) if held else (one.least, one.greatest)
        jumps += [(jump.height_m, -jump.energy_j, row) for jump in both if jump is not None]
    front: list[tuple[int, Number, Number]] = []
    least_j, designs = np.inf, data.sound
    for height_m, less_j, row in sorted(jumps, reverse=True):
        known_j = designs.loc[designs["height_m"] >= height_m, energy].min()  # NaN where none is as high
        if -less_j < least_j and not known_j <= -less_j:
            least_j = -less_j
            high, little = column([height_m, least_j])
            front.append((row, high, little))
    return BestTorque(
        energy=energy,
        held=held,
        rows=list(found),
        gap=column([one.controller_gap_held if held else one.controller_gap for one in found.values()], 4),
        front=front[::-1],
    )


def influences_of(stored: Mapping[tuple[int, About], StoredSensitivity]) -> dict[str, dict[str, Influences]]:
    """Return the stored sensitivities of a study by trial number and kind of factors."""
    found: dict[str, dict[str, Influences]] = {}
    for (trial, about), one in stored.items():
        factors = one.result.factors
        names = factors[0].measures if factors else ()
        found.setdefault(str(trial), {})[about] = Influences(
            jumps=one.result.jumps,
            factors=[(each.factor.label, each.factor.text, each.factor.tolerance) for each in factors],
            measures={name: [_rounded(each.measures[name]) for each in factors] for name in names},
        )
    return found


def _rounded(one: Influence) -> tuple[Number, Number, Number]:
    change, total, error = column([one.change, one.total, one.error], 4)
    return change, total, error
