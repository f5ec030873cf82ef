"""Whether what a study holds can be: numbering, states, finite and possible values, the kept front."""

from collections.abc import Iterator

import numpy as np
import pandas as pd

from pareto_monoped.design import NAMES
from pareto_monoped.pareto.objectives import HEIGHT_AND_ENERGY
from pareto_monoped.study.kept_front import STATES
from pareto_monoped.study.reader import StudyData

HIGHEST_JUMP_M = 10.0
"""No robot here jumps higher: our own choice, several times the highest of the paper's designs and of any search."""
_BOUNDS_SLACK = 0.05
"""Share by which a variable may be beyond its bounds: the real ratio of the last gearbox of an interval of the actuator
map may be a little more than the upper bound. Our own choice: half an interval at the lowest ratios."""


def implausible(data: StudyData) -> list[str]:
    """One line per kind of thing that cannot be, with the first row that has it; none if all is plausible."""
    return [
        *_trial_findings(data),
        *_history_findings(data),
        *(f"audit of trial {n}, which does not exist" for n in data.audits["trial"][~_exists(data)].head(1)),
    ]


def _exists(data: StudyData) -> "pd.Series[bool]":
    return data.audits["trial"].isin(data.trials["trial"])


def _trial_findings(data: StudyData) -> Iterator[str]:
    trials = data.trials
    numbers = trials["trial"].to_numpy()
    if (wrong := np.flatnonzero(numbers != np.arange(len(numbers)))).size:
        yield f"trials are not numbered from 0 on: trial {numbers[wrong[0]]} stands in place {wrong[0]}"
    feasible = (trials["state"] == "feasible").to_numpy()
    yield from _first(trials, ~trials["state"].isin(STATES).to_numpy(), "has an unknown state")
    yield from _first(trials, np.diff(trials["generation"].to_numpy(), prepend=0) < 0, "has an impossible generation")
    for name in dict.fromkeys((*HEIGHT_AND_ENERGY.names, *data.study.objectives.names)):
        values = trials[name].to_numpy(dtype=np.float64)
        yield from _first(trials, feasible & ~np.isfinite(values), f"is feasible, but its {name} is no finite number")
    for name in (name for name in trials if name == "height_m" or name in _ENERGIES):
        values = trials[name].to_numpy(dtype=np.float64)
        yield from _first(trials, feasible & (values < 0.0), f"is feasible, but its {name} is negative")
    high = trials["height_m"].to_numpy() > HIGHEST_JUMP_M
    yield from _first(trials, high, f"has a height_m above {HIGHEST_JUMP_M:g}")
    for name, lower, upper in zip(NAMES, data.study.lower, data.study.upper, strict=True):
        values, slack = trials[name].to_numpy(dtype=np.float64), _BOUNDS_SLACK * max(abs(lower), abs(upper))
        inside = (values >= lower - slack) & (values <= upper + slack)
        yield from _first(trials, ~inside, f"has a {name} beyond {lower:g} to {upper:g}")
    violation = trials["violation"].to_numpy(dtype=np.float64)
    yield from _first(trials, ~np.isfinite(violation) | (feasible != (violation == 0.0)), "has an impossible violation")


_ENERGIES = frozenset({"energy_j", "electrical_energy_j"})


def _first(trials: pd.DataFrame, wrong: "np.typing.NDArray[np.bool_]", what: str) -> Iterator[str]:
    rows = np.flatnonzero(wrong)
    if len(rows):
        more = f", and {len(rows) - 1} others" if len(rows) > 1 else ""
        yield f"trial {trials['trial'].iloc[rows[0]]} {what}{more}"


def _history_findings(data: StudyData) -> Iterator[str]:
    history, checkpoint, count = data.history, data.checkpoint, len(data.trials)
    done = history["evaluations"].to_numpy()
    if not np.array_equal(history["generation"].to_numpy(), np.arange(len(history))):
        yield "its history does not count generations from 0 on"
    if (np.diff(done, prepend=0) <= 0).any() or (done[-1] if len(done) else 0) != count:
        yield f"its history does not lead to {count} trials"
    for name in ("hypervolume", "seconds"):
        values = history[name].to_numpy()
        if not (np.isfinite(values) & (values >= 0.0)).all():
            yield f"its history has a {name} that is negative or no finite number"
    if (np.diff(history["seconds"].to_numpy(), prepend=0.0) < 0.0).any():
        yield "its history has seconds that go back"
    told = dict(zip((history["generation"] + 1).tolist(), done.tolist(), strict=True)) | {0: 0}
    if told.get(checkpoint.generation) != checkpoint.evaluations:
        yield (
            f"its checkpoint stands before generation {checkpoint.generation} with {checkpoint.evaluations} trials, "
            "which its history does not have"
        )
