"""Check a whole study: running hash, numbering, plausible values, Optuna's tables against ours, jumps anew."""

from collections.abc import Iterator
from concurrent.futures import Executor
from dataclasses import dataclass

import numpy as np

from pareto_monoped.design import NAMES
from pareto_monoped.errors import DatabaseError
from pareto_monoped.measures import MEASURE_NAMES
from pareto_monoped.study.connection import Connection
from pareto_monoped.study.database import reading
from pareto_monoped.study.kept_front import STATES, KeptFront
from pareto_monoped.study.optuna_check import foreign_trials, optuna_findings
from pareto_monoped.study.place import StudyPlace
from pareto_monoped.study.plausible import implausible
from pareto_monoped.study.reader import StudyData, read_study
from pareto_monoped.study.robust_rows import read_robustness
from pareto_monoped.study.seals import read_seals
from pareto_monoped.study.sensitivity_rows import read_sensitivity


@dataclass(frozen=True, slots=True, kw_only=True)
class Verification:
    """What a check of a study found.

    Attributes:
        trials: how many it has.
        sealed: whether it has a running hash.
        foreign: Optuna's numbers of trials that are not of this package.
        simulated: how many trials jumped anew.
        findings: what is wrong, one line each; none for a sound study.
    """

    trials: int
    sealed: bool
    foreign: tuple[int, ...]
    simulated: int
    findings: tuple[str, ...]


def verify(db: StudyPlace, *, simulate: int = 0, workers: int = 1, executor: Executor | None = None) -> Verification:
    """Check a study.

    Args:
        db: its database.
        simulate: how many of its trials to simulate again, evenly spread over all; they must be equal to the last bit.
        workers: threads that simulate.
        executor: does the jumps in their place.

    Raises:
        DatabaseError: it cannot be read at all, or its rows do not match their hash.
        StudyError: ``simulate``, but this code or machine computes other jumps than the study began with.
    """
    data = read_study(db)
    read_robustness(db)
    read_sensitivity(db)
    with reading(db) as connection:
        seals = read_seals(connection, db) if data.sealed else None
        foreign = foreign_trials(connection, len(data.trials), seals)
        findings = [
            *connection.defects(),
            *implausible(data),
            *_kept_front_findings(connection, data),
            *optuna_findings(connection, data, seals),
        ]
    numbers = np.unique(np.linspace(0, len(data.trials) - 1, min(simulate, len(data.trials))).astype(int))
    if len(numbers):
        findings += _jump_findings(data, numbers, workers, executor)
    return Verification(
        trials=len(data.trials),
        sealed=data.sealed,
        foreign=foreign,
        simulated=len(numbers),
        findings=tuple(findings),
    )


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
    designs = rows[list(NAMES)].to_numpy(dtype=np.float64)
    jumps = evaluation_of(data.study, simulator.evaluator)(designs, data.kit_numbers(rows))
    for name in (*MEASURE_NAMES, *data.study.robust_names):
        again, stored = jumps.of(name), rows[name].to_numpy(dtype=np.float64)
        for k in np.flatnonzero(~((again == stored) | (np.isnan(again) & np.isnan(stored))))[:1]:
            yield f"trial {numbers[k]} jumps otherwise: its {name} is {stored[k]!r}, simulated again {again[k]!r}"
    for k in np.flatnonzero(jumps.status != rows["status"].to_numpy(dtype=np.str_))[:1]:
        yield f"trial {numbers[k]} ends otherwise: {rows['status'].iloc[k]}, simulated again {jumps.status[k]}"


def require_sound(db: StudyPlace, verification: Verification) -> None:
    """Raise for a study that is not sound.

    Raises:
        DatabaseError: names the first finding and counts the others.
    """
    if verification.findings:
        more = len(verification.findings) - 1
        raise DatabaseError(
            f"study database {str(db)!r}: {verification.findings[0]}"
            + (f" (and {more} more)" if more else "")
            + "; restore a copy"
        )
