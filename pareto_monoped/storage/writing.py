"""A study that is open for writing, in a file or on a server: how it is opened, guarded meanwhile, and closed."""

import sqlite3
from pathlib import Path
from typing import Protocol

from pareto_monoped.errors import DatabaseError
from pareto_monoped.storage.connection import Connection, FileConnection
from pareto_monoped.storage.place import StudyPlace
from pareto_monoped.storage.server.address import Server


class Writing(Protocol):
    """A connection that writes, and what belongs to it."""

    @property
    def connection(self) -> Connection:
        """The connection."""

    def examine(self) -> None:
        """Raise an error of the database if its pages are damaged."""

    def settle(self) -> None:
        """Begin to write: what is committed from now on survives a power cut."""

    def require_place(self) -> None:
        """Raise if what was committed did not go to the study's own place."""

    def close(self) -> None:
        """Close the connection."""

    def close_at_rest(self) -> None:
        """Close the connection and leave a study as it is when nobody runs it."""


def open_for_writing(place: StudyPlace) -> Writing:
    """Open a study for writing.

    Raises:
        DatabaseError: read-only, or in use by another process.
        ServerError: the server is away.
    """
    if isinstance(place, Server):
        from pareto_monoped.storage.server.writing import ServerWriting

        return ServerWriting(place)
    return FileWriting(place)


class FileWriting:
    """A file that is open for writing."""

    def __init__(self, path: Path) -> None:
        # A file marked read-only is meant to stay as it is. SQLite would ask the system, which lets root write anyway.
        if not path.stat().st_mode & 0o222:
            raise DatabaseError(
                f"study database {str(path)!r}: is read-only; allow writing (chmod u+w), or run on a copy"
            )
        self._path = path
        # One other thread writes the generations, one at a time, and the run loop waits for it.
        self.connection = sqlite3.connect(
            path, isolation_level=None, timeout=30.0, check_same_thread=False, factory=FileConnection
        )
        self.connection.execute("PRAGMA trusted_schema = OFF")

    def examine(self) -> None:
        """Raise an error of SQLite if pages are damaged."""
        if self.connection.execute("PRAGMA quick_check(1)").fetchone()[0] != "ok":
            raise sqlite3.DatabaseError("its pages contradict each other")

    def settle(self) -> None:
        """Write through a log from now on, and remember which files these are."""
        self.connection.execute("PRAGMA journal_mode = WAL")
        # What was acknowledged must survive a power cut too, not only a killed process.
        self.connection.execute("PRAGMA synchronous = FULL")
        self._files: dict[Path, tuple[int, int]] = {}
        self._resolved = self._path.resolve()
        self._log = Path(f"{self._resolved}-wal")
        self.require_place()

    def require_place(self) -> None:
        """Check that the database and its log are the files that were opened.

        A file that is deleted or replaced while it is open takes everything with it that is still written to it.
        """
        # The study by the name that it was opened by: a link in this that leads elsewhere now is noticed too.
        for file, name in ((self._resolved, self._path), (self._log, self._log)):
            try:
                found = name.stat()
            except OSError:
                found = None
            place = None if found is None else (found.st_dev, found.st_ino)
            if file not in self._files and place is not None:
                self._files[file] = place
            elif place != self._files.get(file):
                raise DatabaseError(
                    f"study database {str(self._path)!r}: {file.name!r} was deleted, renamed or replaced during "
                    "the run; see what is there, put it back or restore a copy, then resume"
                )

    def close(self) -> None:
        """Close the connection."""
        self.connection.close()

    def close_at_rest(self) -> None:
        """Close, and merge the write-ahead log into the file, so that a study at rest is a single file."""
        try:
            self.connection.execute("PRAGMA wal_checkpoint(TRUNCATE)")
            self.connection.execute("PRAGMA journal_mode = DELETE")
        except sqlite3.Error:
            # While a reader is open or the disk is full, the log stays beside the file, which is equally valid.
            pass
        finally:
            self.connection.close()
