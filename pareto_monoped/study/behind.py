"""Trials behind the front, such as alternatives, which can be chosen by their number like designs of the front."""

import numpy as np
import pandas as pd

from pareto_monoped.pareto.objectives import Objectives
from pareto_monoped.pareto.selectors import Among, Selector, Trial
from pareto_monoped.study.reader import StudyData


def numbered(selector: Selector | None) -> int | None:
    """The number of the trial that a selector names; None if it chooses in another way."""
    chooser = selector.chooser if isinstance(selector, Among) else selector
    return chooser.number if isinstance(chooser, Trial) else None


def with_numbered(data: StudyData, front: pd.DataFrame, selector: Selector | None) -> pd.DataFrame:
    """The front, and after it the trial that a selector names, if it is feasible and has not failed an audit.

    Args:
        data: the study.
        front: of the study, or of some of its trials under uncertainty.
        selector: what is asked for.
    """
    number = numbered(selector)
    if number is None or (front["trial"] == number).any() or number in data.ill_conditioned:
        return front
    rows = data.trials[(data.trials["trial"] == number) & (data.trials["state"] == "feasible")]
    return pd.concat([front, rows], ignore_index=True) if len(rows) else front


def better_than(rows: pd.DataFrame, trial: int, objectives: Objectives) -> list[int]:
    """The trials that dominate one of them: no worse in any objective, and better in one."""
    loss = objectives.minimised(rows[list(objectives.names)].to_numpy(dtype=np.float64))
    own = loss[np.flatnonzero(rows["trial"] == trial)[0]]
    found = (loss <= own).all(axis=1) & (loss < own).any(axis=1)
    return [int(number) for number in rows["trial"][found]]
