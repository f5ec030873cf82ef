"""How a new study comes to its place, also where a reader has made the file by asking for the study too early.

Whoever opens a database with SQLite makes an empty file, and Optuna fills it with its tables. Such a file holds
nothing. It is filled, not replaced: the reader would go on with the file that was there before.
"""

import os
import sqlite3
import time
from pathlib import Path

from pareto_monoped.storage.database import READ_TIMEOUT_S, roll_back, translated
from pareto_monoped.storage.place import StudyPlace, require_file_name
from pareto_monoped.storage.server.address import Server

_OPTUNAS_OWN = {"alembic_version", "version_info"}
"""Tables in which Optuna keeps the version of its schema; all others are empty before the first study."""
_OPTUNA = _OPTUNAS_OWN | {
    "studies",
    "study_directions",
    "study_user_attributes",
    "study_system_attributes",
    "trials",
    "trial_user_attributes",
    "trial_system_attributes",
    "trial_params",
    "trial_values",
    "trial_intermediate_values",
    "trial_heartbeats",
}


def is_vacant(path: StudyPlace) -> bool:
    """Whether there is nothing yet: no file, an empty one, or Optuna's tables without any study; on a server no tables.

    Raises:
        DatabaseError: something else than a file.
        ServerError: the server is away.
    """
    if isinstance(path, Server):
        from pareto_monoped.storage.server.creating import is_vacant_there

        with translated(path):
            return is_vacant_there(path)
    require_file_name(path)
    if not path.exists():
        return True
    with translated(path):
        if path.stat().st_size == 0:
            return True
        roll_back(path)
        try:
            return _is_bare(path)
        except sqlite3.DatabaseError:  # not a database, or damaged: not vacant
            return False


def _is_bare(path: Path) -> bool:
    connection = sqlite3.connect(f"{path.resolve().as_uri()}?mode=ro", uri=True, timeout=READ_TIMEOUT_S)
    try:
        objects = connection.execute("SELECT type, name FROM sqlite_master WHERE type != 'index'").fetchall()
        tables = {name for kind, name in objects if kind == "table"}
        if len(objects) > len(tables) or not tables <= _OPTUNA:
            return False
        return not any(connection.execute(f"SELECT 1 FROM {name} LIMIT 1").fetchone() for name in tables - _OPTUNAS_OWN)
    finally:
        connection.close()


def settle(new: Path, path: Path) -> None:
    """Put a new database in its place, which is vacant; the other file is left over.

    Args:
        new: the database, complete and closed, in the same folder.
        path: where it belongs.

    Raises:
        DatabaseError: somebody has filled the file meanwhile, or keeps it locked.
        DiskError: the disk is full or fails.
    """
    with translated(path):
        try:
            # Unlike a rename, a link does not replace what a reader may have made a moment ago.
            os.link(new, path)
            return
        except FileExistsError:
            pass
        except OSError:  # a file system without links
            if not path.exists():
                new.replace(path)
                return
        if not is_vacant(path):
            raise sqlite3.DatabaseError("another program has filled it meanwhile")
        _fill(new, path)


def _fill(new: Path, path: Path) -> None:
    """Copy a database into a vacant one, in one transaction: other connections see all of it or nothing."""
    deadline = time.monotonic() + READ_TIMEOUT_S

    def wait(status: int, remaining: int, total: int) -> None:
        if status in (sqlite3.SQLITE_BUSY, sqlite3.SQLITE_LOCKED) and time.monotonic() > deadline:
            error = sqlite3.OperationalError("database is locked")
            error.sqlite_errorcode = sqlite3.SQLITE_BUSY
            raise error

    source, target = sqlite3.connect(new), sqlite3.connect(path, timeout=READ_TIMEOUT_S)
    try:
        source.backup(target, progress=wait, sleep=0.02)
    finally:
        source.close()
        target.close()
