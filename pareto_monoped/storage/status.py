"""What a study says of itself without its trials being read: progress, settings, counts, front and hypervolume."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.definition.study import Study, study_from_dict
from pareto_monoped.design import HEADLINE_HEIGHT_M
from pareto_monoped.errors import DatabaseError
from pareto_monoped.pareto.front import best_at_height
from pareto_monoped.pareto.objectives import hypervolume
from pareto_monoped.storage.connection import Connection
from pareto_monoped.storage.kept_front import STATES, KeptFront, foreign_count, rows_of
from pareto_monoped.storage.meta import StudyMeta, meta_of_rows
from pareto_monoped.storage.place import StudyPlace, storage_of
from pareto_monoped.storage.seals import has_seals


@dataclass(frozen=True, slots=True, kw_only=True)
class Summary:
    """The size and the result of a study."""

    study: Study  #: the definition
    meta: StudyMeta
    counts: dict[str, int]  #: number of trials that are feasible, infeasible and failed
    seconds: float  #: running time so far, over all sessions
    ill_conditioned: int  #: number of trials that failed their audit
    #: values of the objectives of the designs on the front, shape (n, m), by the first of them
    front: NDArray[np.float64]
    heights_m: NDArray[np.float64]  #: heights of the designs on the front, shape (n,)
    energies_j: NDArray[np.float64]  #: energies of the designs on the front, shape (n,)
    foreign: int  #: how many of Optuna's trials are not of this package
    sealed: bool  #: whether the study has a running hash


def read_summary(db: StudyPlace) -> Summary:
    """Read the summary of a study, from its kept front if it has one; the checkpoint is never read."""
    with storage_of(db).reading() as connection:
        sealed = has_seals(connection)
        meta = meta_of_rows(connection.execute("SELECT key, value FROM monoped_meta").fetchall(), db)
        study = study_from_dict(meta.study, source=f"study database {str(db)!r}")
        try:
            counts, trials = _kept(connection, study) if sealed else _computed(connection, db)
            names = [*study.objectives.names, "height_m", "energy_j"]
            rows = rows_of(connection, names, trials)
            if len(rows) != len(trials):
                raise ValueError("trials of its kept front are missing")
            values = np.array(rows, dtype=np.float64).reshape(-1, len(names))
            values = values[np.argsort(values[:, 0], kind="stable")]
            last = connection.execute("SELECT seconds FROM monoped_history ORDER BY generation DESC LIMIT 1").fetchone()
            bad = connection.execute("SELECT count(*) FROM monoped_audits WHERE well_conditioned = 0").fetchone()
            seconds = float(last[0]) if last else 0.0
            foreign = foreign_count(connection)
        except (TypeError, ValueError, RecursionError) as error:
            raise DatabaseError(f"study database {str(db)!r}: is damaged ({error}); restore a copy") from None
    return Summary(
        study=study,
        meta=meta,
        counts=counts,
        seconds=seconds,
        ill_conditioned=int(bad[0]),
        front=values[:, :-2],
        heights_m=values[:, -2],
        energies_j=values[:, -1],
        foreign=foreign,
        sealed=sealed,
    )


def _kept(connection: Connection, study: Study) -> tuple[dict[str, int], list[int]]:
    front = KeptFront(study.objectives)
    front.load(connection)
    return front.counts, front.numbers


def _computed(connection: Connection, db: StudyPlace) -> tuple[dict[str, int], list[int]]:
    """Compute counts and front of a study of format 1, which keeps no front."""
    from pareto_monoped.storage.reader import read_study

    counts = dict.fromkeys(STATES, 0)
    for state, count in connection.execute("SELECT state, count(*) FROM monoped_trials GROUP BY state"):
        counts[state] = count
    return counts, sorted(read_study(db).front()["trial"].tolist())


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
        "objectives": objectives.directions,
        "reference_point": data.study.reference_point.as_dict(),
        "least_energy_at_0_8_m_j": float(high.min()) if len(high) else None,
        "best_at_0_8_m": None if best is None else {best.measure.name: best.value},
        "hash": data.meta.hash,
        "versions": data.meta.versions,
        "created": data.meta.created,
        "strength": data.study.strength,
        "settings": data.study.as_dict(),
    }
