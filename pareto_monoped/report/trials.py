"""The trials of a study as columns: which of them the page holds, and what it says of each."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from pareto_monoped.design import Variable
from pareto_monoped.measures import GOAL_NAMES, is_own
from pareto_monoped.report.packing import column, packed_column, single_column
from pareto_monoped.report.quantities import AUDIT, EVERY_TRIAL
from pareto_monoped.report.schema import Column, Trials

MOST_ROWS = 20_000
"""Trials on one page, of all its studies together. A page with more says that it leaves some dominated trials out."""
LETTERS = {"feasible": "f", "infeasible": "i", "failed": "x"}
"""States of a trial, and the letter that stands for each on the page."""
_HISTORY_POINTS = 300  # of a convergence curve


def rows_per_study(sizes: Sequence[int]) -> list[int]:
    """Return how many rows each study gets: all of them, or a share of ``MOST_ROWS`` in proportion to its trials."""
    total = sum(sizes)
    return [size if total <= MOST_ROWS else max(size * MOST_ROWS // total, 1) for size in sizes]


def thinned(trials: pd.DataFrame, always: NDArray[np.bool_], most: int) -> pd.DataFrame:
    """Return at most ``most`` rows: those at the mask ``always``, however many, and others spread evenly."""
    if len(trials) <= most:
        return trials.reset_index(drop=True)
    others = np.flatnonzero(~always)
    room = max(most - int(always.sum()), 0)
    chosen = others[np.linspace(0, len(others) - 1, room).astype(np.intp)] if room else others[:0]
    rows = np.sort(np.concatenate((np.flatnonzero(always), chosen)))
    return trials.iloc[rows].reset_index(drop=True)


def trial_columns(
    trials: pd.DataFrame,
    numbers: Mapping[str, Sequence[int]],
    total: int,
    variables: Sequence[Variable],
    goals: Sequence[str] = (),
) -> Trials:
    """Return the trials on the page, out of ``total``; ``numbers`` are more columns, such as numbers of gearboxes."""
    names = dict.fromkeys((*(variable.name for variable in variables), "height_m", "energy_j", *goals, *EVERY_TRIAL))
    columns: dict[str, Column] = {name: single_column(values_of(trials, name)) for name in names}
    columns |= numbers
    own = [name for name in trials.columns if is_own(name)]
    others = [name for name in (*GOAL_NAMES, *own) if name in trials.columns and name not in names]
    return Trials(
        trial=trials["trial"].tolist(),
        state="".join(LETTERS.get(str(state), "x") for state in trials["state"]),
        columns=columns,
        packed={name: packed_column(trials[name]) for name in others if trials[name].notna().any()},
        total=total,
    )


def values_of(trials: pd.DataFrame, name: str) -> NDArray[np.float64]:
    """Return a column of the trials, shape (n,); NaN for an objective that only another study on the page has."""
    return trials[name].to_numpy(dtype=np.float64) if name in trials else np.full(len(trials), np.nan)


def audit_records(audits: pd.DataFrame) -> dict[str, dict[str, Any]]:
    """Return measures, verdict and reason of each audit, by trial number; without measures that an audit has not."""
    names = [name for name in AUDIT if name in audits.columns]
    # An infinite change (the perturbed design did not jump) becomes None; the reason says it in words.
    values = {name: column(audits[name], 4) for name in names}
    there = {name: audits[name].notna().to_numpy() for name in names}
    reasons = audits["reason"].tolist() if "reason" in audits.columns else [""] * len(audits)
    good = zip(audits["well_conditioned"], reasons, strict=True)
    verdicts = [{"good": bool(is_good), "reason": str(reason)} for is_good, reason in good]
    return {
        str(int(trial)): {name: values[name][i] for name in names if there[name][i]} | verdicts[i]
        for i, trial in enumerate(audits["trial"])
    }


def history_columns(history: pd.DataFrame) -> dict[str, Column]:
    """Return hypervolume over evaluations, at no more points than a chart can show."""
    rows = np.unique(np.linspace(0, len(history) - 1, min(len(history), _HISTORY_POINTS)).astype(int))
    names = ("evaluations", "hypervolume")
    return {name: column(history[name].to_numpy()[rows], 6) if len(history) else [] for name in names}
