"""Open study databases: check that a file or schema is one, and turn the errors of databases into ours.

A database may come from a stranger. It is read with plain SELECTs on known tables and with SQLite's defences switched
on (no trusted schema, no views or triggers, no extensions). It holds only numbers, text and JSON.
"""

import os
import sqlite3
import sys
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

from pareto_monoped.config import MAX_JSON_CHARACTERS
from pareto_monoped.errors import DatabaseError, DiskError
from pareto_monoped.files import SQLITE
from pareto_monoped.storage.connection import Connection, FileConnection
from pareto_monoped.storage.lock import holder, locked
from pareto_monoped.storage.place import StudyPlace, inaccessible, require_file_name
from pareto_monoped.storage.server.address import Server

FORMAT = 2
"""Version of our tables. Readers refuse later versions. Format 1, up to version 0.2.0, had neither running hash nor
kept front; a study gets both when it goes on."""

READ_TIMEOUT_S = 10.0
"""How long a reader waits while another program has locked the whole file. A run locks it only for moments."""

TABLES = ("monoped_meta", "monoped_checkpoint", "monoped_history", "monoped_trials", "monoped_audits")
_SINCE_2 = ("monoped_seals", "monoped_front")
_OPTUNA_TABLES = ("studies", "trials", "trial_params", "trial_values")


@contextmanager
def translated(path: StudyPlace) -> Iterator[None]:
    """Turn the exceptions of databases, SQLAlchemy and the system into one clear error of ours."""
    try:
        if isinstance(path, Server):
            from pareto_monoped.storage.server.failures import translated_there

            with translated_there(path):
                yield
        else:
            yield
    except sqlite3.Error as error:
        raise _clear(path, error) from error
    except OSError as error:
        raise inaccessible(path, error) from error
    except Exception as error:
        wrapped = _of_sqlalchemy(error)
        if wrapped is None:
            raise
        inner = getattr(wrapped, "orig", None)
        raise _clear(path, inner if isinstance(inner, sqlite3.Error) else sqlite3.Error(str(wrapped))) from error


def _of_sqlalchemy(error: BaseException | None) -> BaseException | None:
    """The error of SQLAlchemy that this one is or comes from; None if there is none.

    Optuna writes through SQLAlchemy, which wraps SQLite's own errors, and at times wraps these once more. Neither is
    imported only to ask for names.
    """
    library = sys.modules.get("sqlalchemy.exc")
    if library is None:
        return None
    wrapper: type[BaseException] = library.SQLAlchemyError
    while error is not None:
        if isinstance(error, wrapper):
            return error
        error = error.__cause__
    return None


@contextmanager
def undamaged(path: StudyPlace) -> Iterator[None]:
    """Say that a database is damaged where its content makes the block fail.

    Numbers that are text, text that is no JSON, rows that are missing: a study as this package writes it has none.
    """
    try:
        yield
    except (ArithmeticError, AttributeError, LookupError, RecursionError, TypeError, ValueError) as error:
        raise DatabaseError(
            f"study database {str(path)!r}: is damaged ({type(error).__name__}: {error}); restore a copy"
        ) from error


def _clear(path: StudyPlace, error: sqlite3.Error) -> DatabaseError | DiskError:
    code = getattr(error, "sqlite_errorcode", 0) & 0xFF
    kind = DiskError if code in (sqlite3.SQLITE_FULL, sqlite3.SQLITE_IOERR, sqlite3.SQLITE_NOMEM) else DatabaseError
    return kind(f"study database {str(path)!r}: {' '.join(_explained(error).split())}")


def _explained(error: sqlite3.Error) -> str:
    extended = getattr(error, "sqlite_errorcode", 0)
    if extended == sqlite3.SQLITE_READONLY_ROLLBACK:
        return "is being changed by another process; try again"
    match extended & 0xFF:
        case sqlite3.SQLITE_FULL:
            return "the disk is full; make room and resume, all acknowledged trials are safe"
        case sqlite3.SQLITE_TOOBIG:
            return f"is damaged (it has a value of more than {MAX_JSON_CHARACTERS} bytes); restore a copy"
        case sqlite3.SQLITE_IOERR:
            return (
                f"cannot be written or read ({error}); check the disk's free space and health and resume, "
                "all acknowledged trials are safe"
            )
        case sqlite3.SQLITE_READONLY:
            return "is read-only; allow writing, or run on a copy"
        case sqlite3.SQLITE_BUSY | sqlite3.SQLITE_LOCKED:
            return "is locked by another program; close it and try again"
        case sqlite3.SQLITE_CORRUPT | sqlite3.SQLITE_NOTADB:
            return f"is damaged ({error}); restore a copy, or move it away and run the study again"
        case sqlite3.SQLITE_CANTOPEN:
            return "cannot be opened; check that the folder exists and may be written to"
        case _:
            return f"cannot be used ({error}); restore a copy, or move it away and run the study again"


@contextmanager
def reading(path: StudyPlace) -> Iterator[Connection]:
    """A read-only connection to a study database. All its reads see the database as it was at one moment.

    Raises:
        DatabaseError: missing, not a study, damaged, or of a newer version.
        DiskError: the disk fails.
        ServerError: the server is away.
    """
    with _reading_there(path) if isinstance(path, Server) else _reading_file(path) as connection:
        yield connection


@contextmanager
def _reading_there(server: Server) -> Iterator[Connection]:
    with translated(server), undamaged(server):
        from pareto_monoped.storage.server.connection import ServerConnection

        connection = ServerConnection(server)
        try:
            connection.execute("BEGIN ISOLATION LEVEL REPEATABLE READ READ ONLY")
            if not connection.objects():
                raise connection.nothing_there(server)
            check(connection, server)
            yield connection
        finally:
            connection.close()


@contextmanager
def _reading_file(path: Path) -> Iterator[Connection]:
    require_file_name(path)
    if not path.is_file():
        raise DatabaseError(f"study database {str(path)!r}: no such file; check the path, or run a study first")
    with translated(path), path.open("rb") as stream:
        header = stream.read(len(SQLITE))
    if header != SQLITE:
        raise DatabaseError(f"study database {str(path)!r}: is not a study database; give a file that 'run' made")
    roll_back(path)
    with translated(path), undamaged(path):
        connection = sqlite3.connect(
            _address(path), uri=True, isolation_level=None, timeout=READ_TIMEOUT_S, factory=FileConnection
        )
        try:
            connection.setlimit(sqlite3.SQLITE_LIMIT_LENGTH, MAX_JSON_CHARACTERS)
            connection.execute("PRAGMA trusted_schema = OFF")
            connection.execute("PRAGMA query_only = ON")
            connection.execute("BEGIN")
            check(connection, path)
            yield connection
        finally:
            connection.close()


def roll_back(path: Path) -> None:
    """Roll back what a killed process had not committed, if it left a rollback journal.

    A run changes the journal mode at its start and end, which SQLite does under such a journal. A read-only connection
    cannot roll back, and would call the database read-only for ever.

    Raises:
        DatabaseError: the folder cannot be written to.
    """
    journal = Path(f"{path.resolve()}-journal")
    if not (journal.exists() and journal.stat().st_size):
        return
    if not _folder_writable(path):
        raise DatabaseError(
            f"study database {str(path)!r}: a killed process left {journal.name!r} beside it, which must be "
            "rolled back; allow writing in its folder, or copy both files to one where it is allowed"
        )
    with ExitStack() as stack, translated(path):
        if (running := holder(path)) != os.getpid():
            if running is not None:  # it is changing the mode right now, or will roll back itself
                return
            try:
                stack.enter_context(locked(path))
            except DatabaseError:  # somebody has begun to run it meanwhile
                return
        connection = sqlite3.connect(path, timeout=READ_TIMEOUT_S)
        try:
            connection.execute("SELECT count(*) FROM sqlite_master").fetchone()
        finally:
            connection.close()


def _address(path: Path) -> str:
    address = f"{path.resolve().as_uri()}?mode=ro"
    wal = Path(f"{path}-wal")
    # SQLite opens a database in WAL mode only if it can create a shared-memory file beside it. In a folder that cannot
    # be written it cannot; if there is no log either, the file is complete and may be declared immutable.
    if not (wal.exists() and wal.stat().st_size) and not _folder_writable(path):
        address += "&immutable=1"
    return address


def _folder_writable(path: Path) -> bool:
    return os.access(path.resolve().parent, os.W_OK)


def check(connection: Connection, path: StudyPlace) -> int:
    """Check that a database is a study database of a known version; returns the version of its format.

    Raises:
        DatabaseError: not a study, or of a newer version.
    """
    kinds = connection.objects()
    tables = {name for kind, name in kinds if kind == "table"}
    active = [name for kind, name in kinds if kind in ("view", "trigger")]
    if missing := [name for name in (*_OPTUNA_TABLES, *TABLES) if name not in tables]:
        hint = " (it is a study of Optuna, but not of this package)" if "studies" in tables else ""
        raise DatabaseError(
            f"study database {str(path)!r}: is not a study database, it lacks the table {missing[0]!r}{hint}; "
            "give a file that 'run' made"
        )
    if active:
        raise DatabaseError(
            f"study database {str(path)!r}: holds the view or trigger {active[0]!r}, which no study has; "
            "do not trust it, or drop that from it"
        )
    row = connection.execute("SELECT value FROM monoped_meta WHERE key = 'format'").fetchone()
    version = row[0] if row else None
    if not isinstance(version, str) or not version.isascii() or not version.isdigit() or version in ("0", ""):
        raise DatabaseError(
            f"study database {str(path)!r}: its format is {version!r}, must be a version number; it is damaged, "
            "restore a copy"
        )
    if int(version) > FORMAT:
        raise DatabaseError(
            f"study database {str(path)!r}: format {version} is newer than this version's {FORMAT}; "
            "update pareto-monoped"
        )
    if int(version) >= 2 and (lost := [name for name in _SINCE_2 if name not in tables]):
        raise DatabaseError(
            f"study database {str(path)!r}: is damaged (it lacks the table {lost[0]!r}); restore a copy"
        )
    return int(version)
