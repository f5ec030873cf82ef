"""What the page has of a study's designs under uncertainty, and of alternatives to those that it points out."""

from collections.abc import Mapping, Sequence

import numpy as np

from pareto_monoped.errors import SelectionError
from pareto_monoped.measures import ROBUST_NAMES, is_robust
from pareto_monoped.report.packing import packed
from pareto_monoped.report.schema import OtherDesign, Robust
from pareto_monoped.study.alternatives import alternatives
from pareto_monoped.study.reader import StudyData
from pareto_monoped.study.robust_front import robust_front, robust_trials
from pareto_monoped.study.robust_rows import Stored

MOST_ALTERNATIVES = 5
"""Alternatives listed beside a design. Our own choice, as in the examples of ``pick --alternatives``."""


def robust_of(data: StudyData, stored: Mapping[int, Stored], row_of: Mapping[int, int]) -> Robust | None:
    """The designs of a study under uncertainty; None where nothing of the kind is stored.

    Args:
        data: the study.
        stored: robustness of some of its trials.
        row_of: trial -> its row on the page; trials without one are left out.
    """
    if not stored:
        return None
    trials = robust_trials(data, stored)
    rows = trials.rows[trials.rows["trial"].isin(row_of)]
    try:
        front = robust_front(data, trials)["trial"].tolist()
    except SelectionError:
        front = []
    settings = trials.settings
    ranges = settings.get("uncertainty")
    return Robust(
        ranges=str(ranges.get("name", "")) if isinstance(ranges, Mapping) else "",
        samples=int(str(settings.get("samples", 0))),
        fragile=trials.fragile,
        others=trials.others,
        rows=[row_of[int(trial)] for trial in rows["trial"]],
        front=[row_of[int(trial)] for trial in front if trial in row_of],
        packed={name: packed(rows[name]) for name in ROBUST_NAMES if np.isfinite(rows[name]).any()},
    )


def names_of(studies: Sequence[StudyData], robust: Sequence[Robust | None]) -> tuple[str, ...]:
    """The measures under uncertainty that some study on the page has, in the order of their table."""
    there = {name for data in studies for name in data.trials if is_robust(name)}
    there.update(name for one in robust if one is not None for name in one.packed)
    return tuple(name for name in ROBUST_NAMES if name in there)


def alternatives_of(data: StudyData, trial: int, row_of: Mapping[int, int]) -> tuple[OtherDesign, ...]:
    """Quite different designs that cost about as much as one of a study's, as far as they are on the page."""
    found = alternatives(data, trial, count=MOST_ALTERNATIVES)
    return tuple(
        OtherDesign(row=row_of[one.trial], price=round(one.price, 5), text=one.text(), audited=one.audited)
        for one in found
        if one.trial in row_of
    )
