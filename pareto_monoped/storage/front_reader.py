"""Read the front that a study keeps, without its other trials, and count and name the trials of Optuna users."""

from dataclasses import dataclass

import pandas as pd

from pareto_monoped.definition.study import Study, study_from_dict
from pareto_monoped.design import VARIABLES, Variable, in_use
from pareto_monoped.storage.base import undamaged
from pareto_monoped.storage.connection import Connection
from pareto_monoped.storage.kept_front import KeptFront, foreign_count, kept_row, rows_of
from pareto_monoped.storage.meta import StudyMeta, meta_of_rows
from pareto_monoped.storage.place import StudyPlace, storage_of
from pareto_monoped.storage.reader import read_study, trial_frame, with_agility, with_motors
from pareto_monoped.storage.seals import ROWS, damaged, has_seals, read_seals


@dataclass(frozen=True, slots=True, kw_only=True)
class StudyFront:
    """The front of a study, read without its other trials."""

    db: StudyPlace  #: the database it was read from
    study: Study
    meta: StudyMeta
    rows: pd.DataFrame  #: as ``StudyData.front`` returns them
    #: the paper's seven variables, and the optional ones of which some trial has another value than the default
    used: tuple[Variable, ...]
    foreign: int  #: how many of Optuna's trials are not of this package
    sealed: bool


def read_front(db: StudyPlace) -> StudyFront:
    """Read the front that a study keeps, and check it; that of a study of format 1 is made from its trials."""
    with undamaged(db):
        with storage_of(db).reading() as connection:
            foreign = foreign_count(connection)
            if has_seals(connection):
                return _kept(connection, db, foreign)
        data = read_study(db)
        rows, used = data.front(), in_use(data.trials)
        known = {"study": data.study, "meta": data.meta, "rows": rows, "used": used, "sealed": data.sealed}
        return StudyFront(db=db, foreign=foreign, **known)


def _kept(connection: Connection, db: StudyPlace, foreign: int) -> StudyFront:
    seals = read_seals(connection, db)
    rows = {table: connection.execute(ROWS[table]).fetchall() for table in ("meta", "front")}
    if findings := [line for table in rows for line in seals.row_findings(table, rows[table])]:
        raise damaged(db, findings)
    columns = connection.columns("monoped_trials")
    numbers, counts, _ = kept_row(connection)
    total = connection.execute("SELECT count(*) FROM monoped_trials").fetchone()[0]
    # Later trials than the kept front's are checked too: one that is bent may hide that it is on the front.
    read = [*numbers, *range(sum(counts.values()), total)]
    trials = trial_frame(columns, rows_of(connection, columns, read), db)
    if len(trials) < len(read):
        raise damaged(db, ["trials of its kept front are missing"])
    if findings := seals.trial_findings({name: trials[name].to_numpy() for name in trials}, trials["trial"]):
        raise damaged(db, findings)
    meta = meta_of_rows(rows["meta"], db)
    study = study_from_dict(meta.study, source=f"study database {str(db)!r}")
    kept = KeptFront(study.objectives)
    kept.load(connection)
    trials = trials[trials["trial"].isin(kept.numbers)]
    named = with_agility(with_motors(trials, study, meta, db))
    front = named.sort_values(study.objectives.names[0], kind="stable", ignore_index=True)
    used = tuple(variable for variable in VARIABLES if variable.default is None or variable.name in kept.used)
    return StudyFront(db=db, study=study, meta=meta, rows=front, used=used, foreign=foreign, sealed=True)
