"""Read the front that a study keeps, without its other trials, and count and name the trials of Optuna users."""

from dataclasses import dataclass

import pandas as pd

from pareto_monoped.definition.study import Study, study_from_dict
from pareto_monoped.design import KNOTS, VARIABLES, Variable, in_use
from pareto_monoped.storage.base import undamaged
from pareto_monoped.storage.connection import Connection
from pareto_monoped.storage.kept_front import KeptFront, checked_front, foreign_count
from pareto_monoped.storage.meta import StudyMeta
from pareto_monoped.storage.place import StudyPlace, storage_of
from pareto_monoped.storage.reader import read_study, trial_blocks, trial_frame, with_agility, with_motors
from pareto_monoped.storage.seals import has_seals


@dataclass(frozen=True, slots=True, kw_only=True)
class StudyFront:
    """The front of a study, read without its other trials."""

    db: StudyPlace  #: the database it was read from
    study: Study
    meta: StudyMeta
    rows: pd.DataFrame  #: as ``StudyData.front`` returns them
    #: the paper's seven variables, and the optional ones of which some trial has another value than the default
    used: tuple[Variable, ...]
    count: int  #: number of all trials of the study
    foreign: int  #: how many of Optuna's trials are not of this package
    content_hash: str  #: see ``seals.ContentHash``
    sealed: bool
    limits: bool  #: whether ``extra_rows.read_limits`` has anything to read or to miss


def read_front(db: StudyPlace) -> StudyFront:
    """Read the front that a study keeps, and check it; that of a study of format 1 is made from its trials."""
    with undamaged(db):
        with storage_of(db).reading() as connection:
            if has_seals(connection):
                return _kept(connection, db)
            data = read_study(db)
            foreign = foreign_count(connection, len(data.trials))
        rows, used = data.front(), in_use(data.trials)
        return StudyFront(
            db=db,
            study=data.study,
            meta=data.meta,
            rows=rows,
            used=used,
            count=len(data.trials),
            foreign=foreign,
            content_hash=data.content_hash,
            sealed=data.sealed,
            limits=True,
        )


def _kept(connection: Connection, db: StudyPlace) -> StudyFront:
    checked = checked_front(connection, db)
    meta = checked.meta
    study = study_from_dict(meta.study, source=f"study database {str(db)!r}")
    kept = KeptFront(study.objectives)
    kept.load(connection)
    trials = trial_frame(trial_blocks(checked.columns, checked.trials, db))
    trials = trials[trials["trial"].isin(kept.numbers)]
    named = with_agility(with_motors(trials, study, meta, db))
    front = named.sort_values(study.objectives.names[0], kind="stable", ignore_index=True)
    used = tuple(
        variable for variable in (*VARIABLES, *KNOTS) if variable.default is None or variable.name in kept.used
    )
    return StudyFront(
        db=db,
        study=study,
        meta=meta,
        rows=front,
        used=used,
        count=checked.seals.trials,
        foreign=foreign_count(connection, checked.seals.trials),
        content_hash=checked.seals.content_hash,
        sealed=True,
        limits="limits" in checked.seals.written or ("table", "monoped_limits") in connection.objects(),
    )
