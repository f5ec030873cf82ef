"""Drop from a study what an Optuna user has added to it."""

from pareto_monoped.errors import DatabaseError
from pareto_monoped.study.database import reading
from pareto_monoped.study.lock import locked
from pareto_monoped.study.optuna_check import foreign_trials, optuna_findings, sealed_generations
from pareto_monoped.study.place import StudyPlace
from pareto_monoped.study.reader import read_study
from pareto_monoped.study.seals import read_seals
from pareto_monoped.study.store import Store


def repair(db: StudyPlace) -> tuple[int, ...]:
    """Drop trials that are not of this package from Optuna's tables, and number Optuna's others from 0 on.

    Returns:
        Optuna's numbers of the trials that were dropped.

    Raises:
        DatabaseError: not a study, in use, or damaged: then nothing is changed.
    """
    read_study(db)
    with locked(db):
        data = read_study(db)
        with reading(db) as connection:
            seals = read_seals(connection, db) if data.sealed else None
            foreign = foreign_trials(connection, len(data.trials), seals)
            findings = optuna_findings(connection, data, seals)
        if findings:
            raise DatabaseError(f"study database {str(db)!r}: cannot be repaired ({findings[0]}); restore a copy")
        if foreign:
            with Store(db, data.study, coordinates=data.coordinates) as store:
                store.drop_foreign(foreign, sealed_generations(seals) if seals is not None else {})
    return foreign
