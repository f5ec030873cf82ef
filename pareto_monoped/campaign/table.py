"""A campaign as a table for other programs: one row per study."""

import csv
import io
import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from pareto_monoped.campaign.grid import Campaign
from pareto_monoped.campaign.results import LEVELS_M, Result, levels_of, pair_of


def csv_text(campaign: Campaign, results: Sequence[Result]) -> str:
    """The table as CSV; what a study does not have is empty.

    Columns: name and database of the study, its value on each axis that varies, settings, how far it is, and what it
    found: ``knee_NAME`` are the objectives of the knee, ``best_NAME`` is the best value of the first objective,
    ``NAME_at_0_8_m`` the best second one among the designs that reach 0.8 m.
    """
    rows = [_row(campaign, result) for result in results]
    names = list(dict.fromkeys(name for row in rows for name in row))
    stream = io.StringIO()
    writer = csv.DictWriter(stream, names, restval="", lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    return stream.getvalue()


def _row(campaign: Campaign, result: Result) -> dict[str, Any]:
    study, stored = result.place.study, result.stored
    counts = {} if stored.summary is None else stored.summary.counts
    first, second = pair_of(study.objectives)
    at_levels = result.least(np.array(levels_of(study.objectives)))
    return {
        "study": result.place.name,
        "database": str(result.place.db),
        **{axis: result.place.member.labels[axis] for axis in campaign.axes},
        "motor": study.motor_text,
        "calibration": result.calibration,
        "objective_names": " ".join(study.objectives.names),
        "algorithm": study.algorithm.name,
        "seed": study.seed,
        "state": stored.state,
        "evaluations": stored.evaluations,
        "budget": stored.budget,
        **{state: counts.get(state, 0) for state in ("feasible", "infeasible", "failed")},
        "wall_time_s": stored.seconds,
        "front": stored.front,
        "hypervolume": _number(stored.hypervolume if stored.evaluations else math.nan),
        "hypervolume_unit": stored.hypervolume_unit,
        f"best_{first}": _number(result.most),
        **{
            f"knee_{name}": _number(value)
            for name, value in zip(study.objectives.names, result.knee.tolist(), strict=True)
        },
        **{
            f"{second}_at_{str(level).replace('.', '_')}_m": _number(value)
            for level, value in zip(LEVELS_M, at_levels.tolist(), strict=False)
        },
        "reason": stored.reason,
    }


def _number(value: float) -> float | str:
    return value if math.isfinite(value) else ""
