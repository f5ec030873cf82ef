"""Progress, settings, counts, front and hypervolume of a study, read without its other trials, and checked."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.definition.study import Study, study_from_dict
from pareto_monoped.design import HEADLINE_HEIGHT_M
from pareto_monoped.pareto.front import best_at_height
from pareto_monoped.pareto.growth import left_to_gain
from pareto_monoped.pareto.objectives import hypervolume
from pareto_monoped.storage.base import undamaged
from pareto_monoped.storage.connection import Connection
from pareto_monoped.storage.kept_front import STATES, KeptFront, checked_front, foreign_count
from pareto_monoped.storage.meta import StudyMeta
from pareto_monoped.storage.place import StudyPlace, storage_of
from pareto_monoped.storage.seals import ROWS, damaged, has_seals


@dataclass(frozen=True, slots=True, kw_only=True)
class Summary:
    """The size and the result of a study."""

    study: Study  #: the definition
    meta: StudyMeta
    counts: dict[str, int]  #: number of trials that are feasible, infeasible and failed
    seconds: float  #: running time so far, over all sessions
    left_to_gain: float | None  #: see ``pareto.growth.left_to_gain``
    ill_conditioned: int  #: number of trials that failed their audit
    #: values of the objectives of the designs on the front, shape (n, m), by the first of them
    front: NDArray[np.float64]
    heights_m: NDArray[np.float64]  #: heights of the designs on the front, shape (n,)
    energies_j: NDArray[np.float64]  #: energies of the designs on the front, shape (n,)
    foreign: int  #: how many of Optuna's trials are not of this package
    content_hash: str  #: see ``seals.content_hash``
    sealed: bool  #: whether the study has a running hash


def read_summary(db: StudyPlace) -> Summary:
    """Read the summary of a study, from its kept front if it has one; what it says is checked against the running hash.

    Raises:
        DatabaseError: missing, not a study, damaged, or of a newer version.
    """
    with undamaged(db), storage_of(db).reading() as connection:
        if not has_seals(connection):
            return _computed(connection, db)
        checked = checked_front(connection, db, briefly=True)
        last = connection.execute(f"{ROWS['history']} DESC LIMIT 1").fetchall()
        audits = connection.execute(ROWS["audits"]).fetchall()
        middle = _around_half(connection, last[0][1]) if last else []
        findings = checked.seals.row_findings("history", [*middle, *last], whole=False)
        if [row[0] for row in last] != sorted(map(int, checked.seals.written.get("history", {})))[-1:]:
            findings.append("the last rows of its history are missing")
        if findings := [*findings, *checked.seals.row_findings("audits", audits)]:
            raise damaged(db, findings)
        study = study_from_dict(checked.meta.study, source=f"study database {str(db)!r}")
        kept = KeptFront(study.objectives)
        kept.load(connection)
        numbers = set(kept.numbers)
        rows = np.array([row for row in checked.trials if row[0] in numbers], dtype=np.float64)
        return _summary(
            rows.reshape(-1, len(study.objectives.names) + 3)[:, 1:],
            study=study,
            meta=checked.meta,
            counts=kept.counts,
            seconds=float(last[0][3]) if last else 0.0,
            left_to_gain=_left([*middle, *last]),
            ill_conditioned=sum(1 for row in audits if not row[1]),
            foreign=foreign_count(connection, checked.seals.trials),
            content_hash=checked.seals.content_hash,
            sealed=True,
        )


def _summary(values: NDArray[np.float64], **known: Any) -> Summary:
    """Return a summary; ``values`` has the objectives, height and energy of each design on the front."""
    values = values[np.argsort(values[:, 0], kind="stable")]
    return Summary(front=values[:, :-2], heights_m=values[:, -2], energies_j=values[:, -1], **known)


def _around_half(connection: Connection, evaluations: int) -> list[Any]:
    """Return the rows of the history on either side of half of the evaluations, which may be one; none before them."""
    before, after = ROWS["history"].split(" ORDER BY ")[0], int(evaluations) // 2
    low = connection.execute(f"{before} WHERE evaluations <= {after} ORDER BY generation DESC LIMIT 1").fetchall()
    high = connection.execute(f"{before} WHERE evaluations > {after} ORDER BY generation LIMIT 1").fetchall()
    return [*low, *high] if low else []


def _left(history: Sequence[Sequence[float]]) -> float | None:
    """Return what is left to gain by rows of the history."""
    return left_to_gain([row[1] for row in history], [row[2] for row in history])


def _computed(connection: Connection, db: StudyPlace) -> Summary:
    """Compute the summary of a study of format 1, which keeps no front."""
    from pareto_monoped.storage.reader import read_study

    data = read_study(db)
    states = data.trials["state"].tolist()
    names = [*data.study.objectives.names, "height_m", "energy_j"]
    return _summary(
        data.front().sort_values("trial")[names].to_numpy(dtype=np.float64),
        study=data.study,
        meta=data.meta,
        counts={state: states.count(state) for state in STATES},
        seconds=data.wall_time_s,
        left_to_gain=_left(data.history.to_numpy().tolist()),
        ill_conditioned=len(data.ill_conditioned),
        foreign=foreign_count(connection, len(data.trials)),
        content_hash=data.content_hash,
        sealed=False,
    )


def status(db: StudyPlace) -> dict[str, Any]:
    """Return progress and settings of a study as JSON values."""
    data = read_summary(db)
    objectives, done, seconds = data.study.objectives, sum(data.counts.values()), data.seconds
    high = data.energies_j[data.heights_m >= HEADLINE_HEIGHT_M]
    best = best_at_height(data.front, objectives)
    running = storage_of(db).holder()
    return {
        "name": data.study.name,
        "database": str(db),
        "motor": data.meta.motor,
        "calibration": data.meta.calibration,
        "algorithm": data.study.algorithm.name,
        "seed": data.study.seed,
        "free": list(data.study.free),
        "state": "running" if running else "finished" if data.meta.finished else "unfinished",
        "process": running,
        "stop_reason": data.meta.stop_reason,
        "evaluations": done,
        "budget": data.meta.budget,
        **data.counts,
        "wall_time_s": seconds,
        "evaluations_per_second": done / seconds if seconds > 0.0 else None,
        "front": len(data.front),
        "ill_conditioned": data.ill_conditioned,
        "foreign": data.foreign,
        "hypervolume": hypervolume(data.front, data.study.reference_point),
        "hypervolume_unit": objectives.volume_unit,
        "left_to_gain": data.left_to_gain,
        "objectives": objectives.directions,
        "reference_point": data.study.reference_point.as_dict(),
        "least_energy_at_0_8_m_j": float(high.min()) if len(high) else None,
        "best_at_0_8_m": None if best is None else {best.measure.name: best.value},
        "hash": data.meta.hash,
        "content_hash": data.content_hash,
        "sealed": data.sealed,
        "versions": data.meta.versions,
        "created": data.meta.created,
        "strength": data.study.strength,
        "settings": data.study.as_dict(),
    }
