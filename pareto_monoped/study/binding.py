"""Which limits hold a design where it is: bounds of its variables and constraints of its study."""

import numpy as np
import pandas as pd

from pareto_monoped.measures import measure
from pareto_monoped.study.at_bounds import at_bounds
from pareto_monoped.study.front_reader import StudyFront
from pareto_monoped.study.reader import Checkpoint, StudyData

_AT = 0.01
"""Share of a constraint's limit within which a design is at it. Our own choice: 1 percent is 40 g of a 4 kg robot."""


def binding_limits(data: StudyData, trial: int) -> list[str]:
    """The limits that a design is at, one phrase for each: bounds first, then constraints; none if it is free.

    A search would leave such a limit if it could, so that widening it may lead to a better design.

    Args:
        data: the study.
        trial: number of a trial that jumped.
    """
    row = data.trials[data.trials["trial"] == trial]
    return [*_bounds(data, row), *_constraints(data, row)]


def front_alone(front: StudyFront) -> StudyData:
    """A study of which only the front was read: without its other trials, its history, audits and checkpoint."""
    return StudyData(
        db=front.db,
        study=front.study,
        meta=front.meta,
        trials=front.rows,
        history=pd.DataFrame(),
        audits=pd.DataFrame({"trial": [], "well_conditioned": []}),
        checkpoint=Checkpoint(generation=0, evaluations=0, state={}),
        sealed=front.sealed,
    )


def _bounds(data: StudyData, row: pd.DataFrame) -> list[str]:
    return [f"{found.name} at {found.words}{found.within}" for found in at_bounds(data, row)]


def _constraints(data: StudyData, row: pd.DataFrame) -> list[str]:
    phrases = []
    for limit in data.study.constraints.limits:
        values = row[limit.measure].to_numpy(dtype=np.float64)
        if -_AT <= limit.shares(values)[0] <= 0.0:
            entry = measure(limit.measure)
            unit = "" if entry.unit == "1" else f" {entry.unit}"
            least = "most" if limit.side == "max" else "least"
            phrases.append(f"{limit.measure} {values[0]:.4g}{unit}, at {least} {limit.value:g}{unit} is asked")
    return phrases
