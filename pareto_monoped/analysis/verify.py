"""Check a whole study: running hash, numbering, plausible values, Optuna's tables against ours, jumps anew."""

import sys
from collections.abc import Iterator
from concurrent.futures import Executor
from dataclasses import dataclass

import numpy as np
import pandas as pd

from pareto_monoped.design import designs_of
from pareto_monoped.errors import DatabaseError
from pareto_monoped.measures import ENERGIES, MEASURE_NAMES
from pareto_monoped.pareto.objectives import HEIGHT_AND_ENERGY
from pareto_monoped.storage.connection import Connection
from pareto_monoped.storage.extra_rows import read_limits, read_robustness, read_sensitivity
from pareto_monoped.storage.kept_front import STATES, KeptFront
from pareto_monoped.storage.optuna_check import foreign_trials, optuna_findings
from pareto_monoped.storage.place import StudyPlace, storage_of
from pareto_monoped.storage.reader import StudyData, read_study
from pareto_monoped.storage.seals import read_seals, trials_of_hash

HIGHEST_JUMP_M = 10.0
"""No robot here jumps higher: our own choice, several times the highest of the paper's designs and of any search."""
_BOUNDS_SLACK = 0.05
"""Share by which a variable may be beyond its bounds: the real ratio of the last gearbox of an interval of the actuator
map may be a little more than the upper bound. Our own choice: half an interval at the lowest ratios."""


def implausible(data: StudyData) -> list[str]:
    """Return one line per kind of thing that cannot be, with the first row that has it; none if all is plausible."""
    exists = data.audits["trial"].isin(data.trials["trial"])
    return [
        *_trial_findings(data),
        *_history_findings(data),
        *(f"audit of trial {n}, which does not exist" for n in data.audits["trial"][~exists].head(1)),
    ]


def _trial_findings(data: StudyData) -> Iterator[str]:
    trials = data.trials
    feasible = (trials["state"] == "feasible").to_numpy()
    yield from _first(trials, ~trials["state"].isin(STATES).to_numpy(), "has an unknown state")
    yield from _first(trials, np.diff(trials["generation"].to_numpy(), prepend=0) < 0, "has an impossible generation")
    for name in dict.fromkeys((*HEIGHT_AND_ENERGY.names, *data.study.objectives.names)):
        values = trials[name].to_numpy(dtype=np.float64)
        yield from _first(trials, feasible & ~np.isfinite(values), f"is feasible, but its {name} is no finite number")
    for name in (name for name in trials if name == "height_m" or name in ENERGIES):
        values = trials[name].to_numpy(dtype=np.float64)
        yield from _first(trials, feasible & (values < 0.0), f"is feasible, but its {name} is negative")
    high = trials["height_m"].to_numpy() > HIGHEST_JUMP_M
    yield from _first(trials, high, f"has a height_m above {HIGHEST_JUMP_M:g}")
    for name, lower, upper in zip(data.study.names, data.study.lower, data.study.upper, strict=True):
        if name not in trials:  # out of use
            continue
        values, slack = trials[name].to_numpy(dtype=np.float64), _BOUNDS_SLACK * max(abs(lower), abs(upper))
        inside = (values >= lower - slack) & (values <= upper + slack)
        yield from _first(trials, ~inside, f"has a {name} beyond {lower:g} to {upper:g}")
    violation = trials["violation"].to_numpy(dtype=np.float64)
    yield from _first(trials, ~np.isfinite(violation) | (feasible != (violation == 0.0)), "has an impossible violation")


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


@dataclass(frozen=True, slots=True, kw_only=True)
class Verification:
    """What a check of a study found."""

    trials: int  #: number of trials of the study
    sealed: bool  #: whether the study has a running hash
    content_hash: str  #: see ``seals.content_hash``
    foreign: tuple[int, ...]  #: Optuna's numbers of trials that are not of this package
    simulated: int  #: how many trials jumped anew
    findings: tuple[str, ...]  #: what is wrong, one line each; none for a sound study


def verify(
    db: StudyPlace,
    *,
    simulate: int = 0,
    expect: str | None = None,
    workers: int = 1,
    executor: Executor | None = None,
) -> Verification:
    """Check a study, and simulate some of its trials again, evenly spread; they must be equal to the last bit.

    ``expect`` has the first digits of the content hash that the study must have.

    Raises:
        DatabaseError: it cannot be read at all, or its rows do not match their hash.
        StudyError: ``simulate``, but this code or machine computes other jumps than the study began with.
    """
    data = read_study(db)
    read_robustness(db)
    read_sensitivity(db)
    read_limits(db)
    with storage_of(db).reading() as connection:
        seals = read_seals(connection, db, since=sys.maxsize) if data.sealed else None  # trials were compared above
        foreign = foreign_trials(connection, len(data.trials), seals)
        findings = [
            *connection.defects(),
            *implausible(data),
            *_kept_front_findings(connection, data),
            *optuna_findings(connection, data, seals),
        ]
    if expect is not None and not data.content_hash.startswith(expect):
        findings.append(_of_another_hash(data, expect))
    numbers = np.unique(np.linspace(0, len(data.trials) - 1, min(simulate, len(data.trials))).astype(int))
    if len(numbers):
        findings += _jump_findings(data, numbers, workers, executor)
    return Verification(
        trials=len(data.trials),
        sealed=data.sealed,
        content_hash=data.content_hash,
        foreign=foreign,
        simulated=len(numbers),
        findings=tuple(findings),
    )


def _of_another_hash(data: StudyData, expect: str) -> str:
    known = trials_of_hash(data.meta, data.parts, expect)
    cause = (
        "it was changed, an older copy has taken its place, or it is another study"
        if known is None
        else f"its first {known} trials have the latter, and {len(data.trials) - known} have come since"
    )
    return f"its content hash is {data.content_hash[: len(expect)]}, expected {expect}: {cause}"


def _kept_front_findings(connection: Connection, data: StudyData) -> Iterator[str]:
    if not data.sealed:
        return
    kept = KeptFront(data.study.objectives)
    kept.load(connection)
    if kept.numbers != sorted(data.front()["trial"].tolist()):
        yield "its kept front is not the front of its trials"
    states = data.trials["state"].tolist()
    if kept.counts != {state: states.count(state) for state in STATES}:
        yield "its counts of feasible, infeasible and failed trials are not those of its trials"


def _jump_findings(
    data: StudyData, numbers: "np.typing.NDArray[np.int_]", workers: int, executor: Executor | None
) -> Iterator[str]:
    from pareto_monoped.study.run import refuse_other_code
    from pareto_monoped.study.simulator import evaluation_of, stored_simulator

    simulator = stored_simulator(data, workers=workers, executor=executor)
    refuse_other_code(data, simulator)
    rows = data.trials.iloc[numbers]
    designs = designs_of(rows)
    jumps = evaluation_of(data.study, simulator.evaluator)(designs, data.kit_numbers(rows))
    for name in (*MEASURE_NAMES, *data.study.robust_names):
        again, stored = jumps.of(name), rows[name].to_numpy(dtype=np.float64)
        # Trials that were stored before the first one with a measure are older than it.
        has = np.flatnonzero(data.trials[name].notna())
        older = numbers < (has[0] if len(has) else len(data.trials))
        for k in np.flatnonzero(~((again == stored) | (np.isnan(stored) & (np.isnan(again) | older))))[:1]:
            yield f"trial {numbers[k]} jumps otherwise: its {name} is {float(stored[k])!r}, again {float(again[k])!r}"
    for k in np.flatnonzero(jumps.status != rows["status"].to_numpy(dtype=np.str_))[:1]:
        yield f"trial {numbers[k]} ends otherwise: {rows['status'].iloc[k]}, simulated again {jumps.status[k]}"


def require_sound(db: StudyPlace, verification: Verification) -> None:
    """Raise ``DatabaseError`` for a study that is not sound: the first finding and the number of others."""
    if verification.findings:
        more = len(verification.findings) - 1
        raise DatabaseError(
            f"study database {str(db)!r}: {verification.findings[0]}"
            + (f" (and {more} more)" if more else "")
            + "; restore a copy"
        )
