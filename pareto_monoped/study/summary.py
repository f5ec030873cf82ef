"""What a study says of itself without its trials being read: settings, counts, front and hypervolume."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.errors import DatabaseError
from pareto_monoped.study.connection import Connection
from pareto_monoped.study.database import reading
from pareto_monoped.study.definition import Study, study_from_dict
from pareto_monoped.study.foreign import foreign_count
from pareto_monoped.study.kept_front import STATES, KeptFront, rows_of
from pareto_monoped.study.meta import StudyMeta, meta_of_rows
from pareto_monoped.study.place import StudyPlace
from pareto_monoped.study.seals import has_seals


@dataclass(frozen=True, slots=True, kw_only=True)
class Summary:
    """The size and the result of a study.

    Attributes:
        study, meta: as in ``reader.StudyData``.
        counts: number of trials that are feasible, infeasible and failed.
        seconds: running time so far, over all sessions.
        ill_conditioned: number of trials that failed their audit.
        front: values of the objectives of the designs on the front, shape (n, m), by the first of them.
        heights_m, energies_j: of the designs on the front, shape (n,).
        foreign: how many of Optuna's trials are not of this package.
        sealed: whether the study has a running hash.
    """

    study: Study
    meta: StudyMeta
    counts: dict[str, int]
    seconds: float
    ill_conditioned: int
    front: NDArray[np.float64]
    heights_m: NDArray[np.float64]
    energies_j: NDArray[np.float64]
    foreign: int
    sealed: bool


def read_summary(db: StudyPlace) -> Summary:
    """Read the summary of a study, from its kept front if it has one; the checkpoint is never read.

    Raises:
        DatabaseError: missing, not a study, damaged, or of a newer version.
    """
    with reading(db) as connection:
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
    """The same of a study of format 1, which keeps no front."""
    from pareto_monoped.study.reader import read_study

    counts = dict.fromkeys(STATES, 0)
    for state, count in connection.execute("SELECT state, count(*) FROM monoped_trials GROUP BY state"):
        counts[state] = count
    return counts, sorted(read_study(db).front()["trial"].tolist())
