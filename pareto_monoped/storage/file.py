"""Studies in files of SQLite, read with its defences on: no trusted schema, no views or triggers, no extensions.

Whoever opens a database with SQLite makes an empty file, and Optuna fills it with its tables. A reader that asks for a
study too early therefore leaves a file that holds nothing. Such a file is filled, not replaced: the reader would go on
with the file that was there before.
"""

import os
import sqlite3
import time
from collections.abc import Iterable, Iterator, Sequence
from contextlib import AbstractContextManager, ExitStack, closing, contextmanager, suppress
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pareto_monoped.config import MAX_JSON_CHARACTERS
from pareto_monoped.errors import DatabaseError, DiskError
from pareto_monoped.files import SQLITE, rename_new, temporary_beside
from pareto_monoped.storage.base import Storage, error_behind
from pareto_monoped.storage.columns import listed
from pareto_monoped.storage.connection import Connection
from pareto_monoped.storage.lock import Lock, holder, inaccessible, locked, require_file_name

if TYPE_CHECKING:
    from optuna.storages import RDBStorage

READ_TIMEOUT_S = 10.0
"""How long a reader waits while another program has locked the whole file. A run locks it only for moments."""
_STRETCH = 10_000
"""Keys that are compared at once: 49 kB of text. Our own choice."""
_OPTUNAS_OWN = {"alembic_version", "version_info"}
"""Tables in which Optuna keeps the version of its schema; all others are empty before the first study."""
_OF_TRIALS = ("user_attributes", "system_attributes", "params", "values", "intermediate_values", "heartbeats")
_OPTUNA = {*_OPTUNAS_OWN, "studies", "trials", "study_directions", "study_user_attributes", "study_system_attributes"}
_OPTUNA |= {f"trial_{name}" for name in _OF_TRIALS}
_ANEW = "restore a copy, or move it away and run the study again"
_LOCKED = (DatabaseError, "is locked by another program; close it and try again")
_DAMAGED = (DatabaseError, "is damaged ({}); " + _ANEW)
_CODES: dict[int, tuple[type[DatabaseError | DiskError], str]] = {
    sqlite3.SQLITE_FULL: (DiskError, "the disk is full; make room and {then}"),
    sqlite3.SQLITE_IOERR: (
        DiskError,
        "cannot be written or read ({}); check the disk's free space and health and {then}",
    ),
    sqlite3.SQLITE_NOMEM: (DiskError, "cannot be used ({}); " + _ANEW),
    sqlite3.SQLITE_TOOBIG: (
        DatabaseError,
        f"is damaged (it has a value of more than {MAX_JSON_CHARACTERS} bytes); restore a copy",
    ),
    sqlite3.SQLITE_READONLY: (DatabaseError, "is read-only; allow writing, or run on a copy"),
    sqlite3.SQLITE_BUSY: _LOCKED,
    sqlite3.SQLITE_LOCKED: _LOCKED,
    sqlite3.SQLITE_CORRUPT: _DAMAGED,
    sqlite3.SQLITE_NOTADB: _DAMAGED,
    sqlite3.SQLITE_CANTOPEN: (
        DatabaseError,
        "cannot be opened; check that the folder exists and may be written to",
    ),
}
"""What SQLite's errors mean to the user; ``{}`` is SQLite's own text, ``{then}`` what to do afterwards."""


class FileConnection(sqlite3.Connection, Connection):
    """A connection to a file; give it to ``sqlite3.connect`` as its factory."""

    _BEGIN = "BEGIN IMMEDIATE"
    place: Path  #: the study's file by the name that it was opened by; set by whoever opens it for writing

    def insert(self, table: str, columns: Sequence[str], rows: Iterable[Sequence[Any]]) -> None:
        """Add rows to a table, with values of these columns."""
        marks = ", ".join("?" * len(columns))
        self.executemany(f"INSERT INTO {table} ({listed(columns)}) VALUES ({marks})", rows)

    def replace(self, table: str, rows: Sequence[Sequence[Any]]) -> None:
        """Add whole rows to a table, in place of those with the same key."""
        for row in rows[:1]:
            self.executemany(f"INSERT OR REPLACE INTO {table} VALUES ({', '.join('?' * len(row))})", rows)

    def objects(self) -> list[tuple[str, str]]:
        """Return kind and name of everything in the database."""
        return self.execute("SELECT type, name FROM sqlite_master").fetchall()

    def columns(self, table: str) -> list[str]:
        """Return the names of a table's columns."""
        return [row[1] for row in self.execute(f"PRAGMA table_info({table})")]

    def counted(self, table: str, key: str) -> int | None:
        """Compare keys as text that SQLite joins, for which it takes half the time of handing over each."""
        # Each stretch begins with the last row of the one before, so that none can hide between two.
        count, asked, expected = 0, "", ",".join(map(str, range(_STRETCH)))
        while True:
            before = max(count - 1, 0)
            text, found = self.execute(
                f"SELECT group_concat({key} - {before}), count(*) FROM "
                f"(SELECT {key} FROM {table} {asked} ORDER BY {key} LIMIT {_STRETCH})"
            ).fetchone()
            if text == expected:
                count = before + _STRETCH
                asked = f"WHERE {key} >= {count - 1}"
            else:
                return before + found if found == 0 or expected.startswith(f"{text},") else None

    def trial_ids_after(self, last: int, count: int) -> int:
        """Return the next key; a transaction that writes is alone."""
        return last + 1

    def defects(self) -> Iterator[str]:
        """Yield what SQLite finds wrong; it lists all of one kind in one text of several lines."""
        for (text,) in self.execute("PRAGMA integrity_check(5)"):
            for line in text.splitlines():
                if line != "ok" and not line.startswith("***"):
                    yield f"SQLite: {line}"

    def examine(self) -> None:
        """Raise an error of SQLite if pages are damaged, those of indexes included, which readers do not use."""
        if self.execute("PRAGMA integrity_check(1)").fetchone()[0] != "ok":
            raise sqlite3.DatabaseError("its pages contradict each other")

    def settle(self) -> None:
        """Write through a log from now on, and remember which files these are."""
        self.execute("PRAGMA journal_mode = WAL")
        # What was acknowledged must survive a power cut too, not only a killed process.
        self.execute("PRAGMA synchronous = FULL")
        self._files: dict[Path, tuple[int, int]] = {}
        self._resolved = self.place.resolve()
        self._log = Path(f"{self._resolved}-wal")
        self.require_place()

    def require_place(self) -> None:
        """Check that the database and its log are the files that were opened: writes to deleted ones would be lost."""
        # The study by the name that it was opened by: a link in this that leads elsewhere now is noticed too.
        for file, name in ((self._resolved, self.place), (self._log, self._log)):
            try:
                found = name.stat()
            except OSError:
                found = None
            identity = None if found is None else (found.st_dev, found.st_ino)
            if file not in self._files and identity is not None:
                self._files[file] = identity
            elif identity != self._files.get(file):
                raise DatabaseError(
                    f"study database {str(self.place)!r}: {file.name!r} was deleted, renamed or replaced during "
                    "the run; see what is there, put it back or restore a copy, then resume"
                )

    def close_at_rest(self) -> None:
        """Close, and merge the write-ahead log into the file, so that a study at rest is a single file."""
        try:
            self.execute("PRAGMA wal_checkpoint(TRUNCATE)")
            self.execute("PRAGMA journal_mode = DELETE")
        except sqlite3.Error:
            # While a reader is open or the disk is full, the log stays beside the file, which is equally valid.
            pass
        finally:
            self.close()


class FileStorage(Storage):
    """A file that keeps one study."""

    place: Path

    def __init__(self, place: Path) -> None:
        self.place = place

    def is_vacant(self) -> bool:
        """Return whether there is no file, an empty one, or one with Optuna's tables without any study."""
        require_file_name(self.place)
        if not self.place.exists():
            return True
        with self.translated():
            if self.place.stat().st_size == 0:
                return True
            roll_back(self)
            try:
                with closing(sqlite3.connect(_read_only(self.place), uri=True, timeout=READ_TIMEOUT_S)) as connection:
                    return _is_bare(connection)
            except sqlite3.DatabaseError:  # not a database, or damaged: not vacant
                return False

    @contextmanager
    def creating(self) -> Iterator["FileStorage"]:
        """Yield a draft in the hidden file ``.NAME-new``, which a killed creation leaves with its journal."""
        new = self.place.with_name(f".{self.place.name}-new")
        # Before the file itself: a journal without its file would be rolled back into the next file of that name.
        Path(f"{new}-journal").unlink(missing_ok=True)
        with temporary_beside(self.place, new) as draft:
            draft.unlink()
            with self._translated("run the study again"):
                yield FileStorage(draft)
                self._settle(draft)

    def _settle(self, draft: Path) -> None:
        """Put the draft in its place, or fill the vacant file there; the draft may be left over."""
        with suppress(FileExistsError):  # a reader may have made one a moment ago
            rename_new(draft, self.place)
            return
        if not self.is_vacant():
            raise sqlite3.DatabaseError("another program has filled it meanwhile")
        _fill(draft, self.place)

    def connect(self) -> FileConnection:
        """Open the file for writing."""
        # A file marked read-only is meant to stay as it is. SQLite would ask the system, which lets root write anyway.
        if not self.place.stat().st_mode & 0o222:
            raise DatabaseError(
                f"study database {str(self.place)!r}: is read-only; allow writing (chmod u+w), or run on a copy"
            )
        # One other thread writes the generations, one at a time, and the run loop waits for it.
        connection = sqlite3.connect(
            self.place, isolation_level=None, timeout=30.0, check_same_thread=False, factory=FileConnection
        )
        connection.place = self.place
        connection.execute("PRAGMA trusted_schema = OFF")
        return connection

    def _connect_to_read(self) -> FileConnection:
        require_file_name(self.place)
        if not self.place.is_file():
            raise DatabaseError(
                f"study database {str(self.place)!r}: no such file; check the path, or run a study first"
            )
        with self.place.open("rb") as stream:
            header = stream.read(len(SQLITE))
        if header != SQLITE:
            raise DatabaseError(
                f"study database {str(self.place)!r}: is not a study database; give a file that 'run' made"
            )
        roll_back(self)
        address = _read_only(self.place)
        log = Path(f"{self.place}-wal")
        # SQLite opens a database in WAL mode only if it can create a shared-memory file beside it. In a folder that
        # cannot be written it cannot; without a log the file is complete and may be declared immutable.
        if not (log.exists() and log.stat().st_size) and not _folder_writable(self.place):
            address += "&immutable=1"
        connection = sqlite3.connect(
            address, uri=True, isolation_level=None, timeout=READ_TIMEOUT_S, factory=FileConnection
        )
        try:
            connection.setlimit(sqlite3.SQLITE_LIMIT_LENGTH, MAX_JSON_CHARACTERS)
            connection.execute("PRAGMA trusted_schema = OFF")
            connection.execute("PRAGMA query_only = ON")
            connection.execute("BEGIN")
        except BaseException:
            connection.close()
            raise
        return connection

    def locked(self) -> AbstractContextManager[Lock]:
        """Lock the study by a file beside it."""
        return locked(self.place)

    def holder(self) -> int | None:
        """Return the process id of the run that holds the study, or None."""
        return holder(self.place)

    def translated(self) -> AbstractContextManager[None]:
        """Turn exceptions of SQLite, of SQLAlchemy and of the system into one clear error of ours."""
        return self._translated("resume, all acknowledged trials are safe")

    @contextmanager
    def _translated(self, then: str) -> Iterator[None]:
        """Say what to do ``then``, once the disk has room or works again."""
        try:
            yield
        except OSError as error:
            raise inaccessible(self.place, error) from error
        except Exception as error:
            found = error if isinstance(error, sqlite3.Error) else error_behind(error)
            if found is None:
                raise
            raise _clear(self.place, found, then) from error

    def is_at_rest(self) -> bool:
        """Return whether the study is a single file; a kill at the very end leaves a log beside it."""
        return not any(Path(f"{self.place.resolve()}{end}").exists() for end in ("-wal", "-journal"))

    def optuna_storage(self, *, read_only: bool = False) -> "RDBStorage":
        """Return Optuna's view of the file."""
        from optuna.storages import RDBStorage
        from sqlalchemy.engine import URL

        if not read_only:
            # In a plain "sqlite:///..." text, a question mark or percent sign in the path would get a meaning.
            url = URL.create("sqlite", database=str(self.place)).render_as_string(hide_password=False)
            if new := not self.place.exists():
                with closing(sqlite3.connect(":memory:")) as tables, closing(sqlite3.connect(self.place)) as file:
                    tables.deserialize(_optunas_tables())
                    tables.backup(file)
            return RDBStorage(url, skip_compatibility_check=new, skip_table_creation=new)
        address = _read_only(self.place)

        def connect() -> sqlite3.Connection:
            connection = sqlite3.connect(address, uri=True, timeout=READ_TIMEOUT_S, check_same_thread=False)
            connection.execute("PRAGMA query_only = ON")
            return connection

        # The address of the file is that of ``connect``; this one only says which kind of database it is.
        return RDBStorage(
            "sqlite:///study.db",
            engine_kwargs={"creator": connect},
            skip_compatibility_check=True,
            skip_table_creation=True,
        )


@cache
def _optunas_tables() -> bytes:
    """Let Optuna make its tables, for which it takes a tenth of a second, once for all studies of a process."""
    from optuna.storages import RDBStorage

    with closing(sqlite3.connect(":memory:", check_same_thread=False)) as connection:
        # Tables that Optuna has just made are of its own version; to check that takes as long as to make them.
        RDBStorage("sqlite://", engine_kwargs={"creator": lambda: connection}, skip_compatibility_check=True)
        (made,) = connection.execute("SELECT sql FROM sqlite_master WHERE name = 'trial_params'").fetchone()
        if _NAMED in made:
            connection.execute("DROP TABLE trial_params")
            connection.execute(made.replace(_NAMED, ""))
            connection.execute("CREATE INDEX ix_trial_params_trial_id ON trial_params (trial_id)")
            connection.commit()
        return connection.serialize()


_NAMED = "\tUNIQUE (trial_id, param_name), \n"
"""What makes SQLite keep the name of each parameter twice, in the table and in an index, a tenth of a study.

Optuna looks parameters up by their trial, for which an index of trials is enough, and writes none twice."""


def roll_back(storage: FileStorage) -> None:
    """Roll back what a killed process had not committed, if it left a rollback journal.

    A run changes the journal mode at its start and end, which SQLite does under such a journal. A read-only connection
    cannot roll back, and would call the database read-only for ever.
    """
    path = storage.place
    journal = Path(f"{path.resolve()}-journal")
    if not (journal.exists() and journal.stat().st_size):
        return
    if not _folder_writable(path):
        raise DatabaseError(
            f"study database {str(path)!r}: a killed process left {journal.name!r} beside it, which must be "
            "rolled back; allow writing in its folder, or copy both files to one where it is allowed"
        )
    with ExitStack() as stack, storage.translated():
        if (running := holder(path)) != os.getpid():
            if running is not None:  # it is changing the mode right now, or will roll back itself
                return
            try:
                stack.enter_context(locked(path))
            except DatabaseError:  # somebody has begun to run it meanwhile
                return
        with closing(sqlite3.connect(path, timeout=READ_TIMEOUT_S)) as connection:
            connection.execute("SELECT count(*) FROM sqlite_master").fetchone()


def _read_only(path: Path) -> str:
    return f"{path.resolve().as_uri()}?mode=ro"


def _folder_writable(path: Path) -> bool:
    return os.access(path.resolve().parent, os.W_OK)


def _is_bare(connection: sqlite3.Connection) -> bool:
    """Return whether a database holds at most Optuna's tables, without any study."""
    objects = connection.execute("SELECT type, name FROM sqlite_master WHERE type != 'index'").fetchall()
    tables = {name for kind, name in objects if kind == "table"}
    if len(objects) > len(tables) or not tables <= _OPTUNA:
        return False
    return not any(connection.execute(f"SELECT 1 FROM {name} LIMIT 1").fetchone() for name in tables - _OPTUNAS_OWN)


def _fill(draft: Path, path: Path) -> None:
    """Copy a database into a vacant one, in one transaction: other connections see all of it or nothing."""
    deadline = time.monotonic() + READ_TIMEOUT_S

    def wait(status: int, remaining: int, total: int) -> None:
        if status in (sqlite3.SQLITE_BUSY, sqlite3.SQLITE_LOCKED) and time.monotonic() > deadline:
            error = sqlite3.OperationalError("database is locked")
            error.sqlite_errorcode = sqlite3.SQLITE_BUSY
            raise error

    with closing(sqlite3.connect(draft)) as source, closing(sqlite3.connect(path, timeout=READ_TIMEOUT_S)) as target:
        source.backup(target, progress=wait, sleep=0.02)


def _clear(path: Path, error: BaseException, then: str) -> DatabaseError | DiskError:
    """Return the error of ours for one of SQLite."""
    extended = getattr(error, "sqlite_errorcode", 0)
    kind, words = _CODES.get(extended & 0xFF, (DatabaseError, "cannot be used ({}); " + _ANEW))
    if extended == sqlite3.SQLITE_READONLY_ROLLBACK:
        words = "is being changed by another process; try again"
    return kind(f"study database {str(path)!r}: {' '.join(words.format(error, then=then).split())}")
