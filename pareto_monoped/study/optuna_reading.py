"""A study as a storage of Optuna that can only be read, for programs that show it."""

import sqlite3

import optuna

from pareto_monoped.study.database import READ_TIMEOUT_S
from pareto_monoped.study.place import StudyPlace
from pareto_monoped.study.server.address import Server


def reading_storage(db: StudyPlace) -> optuna.storages.RDBStorage:
    """Optuna's view of a study database; whatever would write to it fails with an error of the database.

    Args:
        db: the database, which may be growing.
    """
    if isinstance(db, Server):
        from pareto_monoped.study.server.connection import SQLALCHEMY, creator

        return optuna.storages.RDBStorage(
            SQLALCHEMY,
            engine_kwargs={"creator": creator(db, read_only=True)},
            skip_compatibility_check=True,
            skip_table_creation=True,
        )
    address = f"{db.resolve().as_uri()}?mode=ro"

    def connect() -> sqlite3.Connection:
        connection = sqlite3.connect(address, uri=True, timeout=READ_TIMEOUT_S, check_same_thread=False)
        connection.execute("PRAGMA query_only = ON")
        return connection

    # The address of the file is that of ``connect``; this one only says which kind of database it is.
    return optuna.storages.RDBStorage(
        "sqlite:///study.db",
        engine_kwargs={"creator": connect},
        skip_compatibility_check=True,
        skip_table_creation=True,
    )
