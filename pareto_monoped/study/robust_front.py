"""The front by what nineteen of twenty built robots keep, from what is stored of the robustness of trials."""

import json
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import pandas as pd

from pareto_monoped.errors import SelectionError
from pareto_monoped.measures import MEASURES, STATISTICS
from pareto_monoped.pareto.front import front_mask
from pareto_monoped.study.reader import StudyData
from pareto_monoped.study.robust_rows import Stored
from pareto_monoped.uncertainty.settings import MOST_FAILED

_SIDES = {"maximise": "p05", "minimise": "p95", None: "mean"}
"""Which statistic stands for a measure, by its direction: of the two percentiles the worse one."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RobustTrials:
    """Trials by what they keep under uncertainty.

    Attributes:
        rows: as ``StudyData.trials``, of the trials that fail in at most ``MOST_FAILED`` of their jumps. A measure has
            its 5th percentile where it is to be maximised, its 95th where it is to be minimised, and else its mean.
            There are also columns of all statistics, such as "height_m.p05", ``failed_share`` and
            ``overloaded_share``.
        fragile: how many trials fail more often.
        settings: under which all of them were simulated.
        others: how many trials were simulated under other settings, and are left out.
    """

    rows: pd.DataFrame
    fragile: int
    settings: dict[str, object]
    others: int


def robust_trials(data: StudyData, stored: Mapping[int, Stored]) -> RobustTrials:
    """The trials whose robustness can be compared: those under the settings that most of them share.

    Args:
        data: the study.
        stored: robustness of some of its trials.

    Raises:
        SelectionError: no trial has a robustness.
    """
    if not stored:
        raise SelectionError(f"study database {str(data.db)!r}: holds no robustness; simulate it with 'robust' first")
    texts = {trial: json.dumps(one.settings, sort_keys=True) for trial, one in stored.items()}
    usual = Counter(texts.values()).most_common(1)[0][0]
    alike = [trial for trial, text in texts.items() if text == usual]
    rows = data.trials[data.trials["trial"].isin(alike)].reset_index(drop=True)
    results = [stored[int(trial)].result for trial in rows["trial"]]
    columns = {
        "failed_share": np.array([result.failed for result in results]),
        "overloaded_share": np.array([result.overloaded for result in results]),
    }
    for entry in MEASURES:
        found = [result.measures.get(entry.name) for result in results]
        for side in STATISTICS:
            values = np.array([np.nan if one is None else getattr(one, side) for one in found])
            columns[f"{entry.name}.{side}"] = values
        columns[entry.name] = columns[f"{entry.name}.{_SIDES[entry.direction]}"]
    kept = columns["failed_share"] <= MOST_FAILED
    table = rows.drop(columns=[name for name in columns if name in rows])
    added = pd.DataFrame(columns, index=rows.index)
    return RobustTrials(
        rows=pd.concat([table, added], axis=1)[kept].reset_index(drop=True),
        fragile=int((~kept).sum()),
        settings=stored[alike[0]].settings,
        others=len(stored) - len(alike),
    )


def robust_front(data: StudyData, trials: RobustTrials) -> pd.DataFrame:
    """The trials that no other dominates under uncertainty, as ``StudyData.front``.

    Raises:
        SelectionError: all fail too often, or none is feasible as designed.
    """
    objectives, rows = data.study.objectives, trials.rows
    if len(rows) == 0:
        raise SelectionError(
            f"robust front: has 0 designs, because all {trials.fragile} fail in more than {100 * MOST_FAILED:g} "
            "percent of their jumps; simulate more trials with 'robust'"
        )
    able = (rows["state"] == "feasible").to_numpy() & ~rows["trial"].isin(data.ill_conditioned).to_numpy()
    if not able.any():
        raise SelectionError(
            f"robust front: has 0 designs, because none of the {len(rows)} is feasible and well-conditioned as "
            "designed; simulate others with 'robust'"
        )
    mask = front_mask(rows[list(objectives.names)].to_numpy(dtype=np.float64), objectives, able)
    return rows[mask].sort_values(objectives.names[0], kind="stable", ignore_index=True)
