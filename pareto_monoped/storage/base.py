"""The base class of storages: each keeps one study, in a file of SQLite or in a schema of a PostgreSQL server.

A database may come from a stranger. It is read with plain SELECTs on known tables and holds only numbers, text and
JSON.
"""

import re
from abc import ABC, abstractmethod
from collections.abc import Collection, Iterator
from contextlib import AbstractContextManager, closing, contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from pareto_monoped.errors import DatabaseError
from pareto_monoped.storage.address import Server
from pareto_monoped.storage.connection import Connection

if TYPE_CHECKING:
    from optuna.storages import RDBStorage

BY_NAME = "(--db, in Python db=...)"
"""How a database is named, on the command line and in Python."""
FORMAT = 2
"""Version of our tables. Readers refuse later versions. Format 1, up to version 0.2.0, has neither running hash nor
kept front."""
TABLES = ("monoped_meta", "monoped_checkpoint", "monoped_history", "monoped_trials", "monoped_audits")
_SINCE_2 = ("monoped_seals", "monoped_front")
_FIRST_OF_2 = (0, 3)  #: first version of the package whose studies have format 2
_OPTUNA_TABLES = ("studies", "trials", "trial_params", "trial_values")


class StudyLock:
    """A lock that this process holds on a study. A server loses nothing that was safe, so nothing is noted there."""

    def confirm(self, links: int) -> None:
        """Raise ``LostTrialsError`` if a study of so many links of the running hash lacks what was safe before."""

    def acknowledge(self, links: int) -> None:
        """Note that so many links of the running hash are safe."""


class Storage(ABC):
    """The storage of one study.

    Its methods raise ``DatabaseError`` for a place that is none of a study, damaged, in use or not allowed to us,
    ``OutputError`` for a folder that cannot be written to, ``DiskError`` and ``ServerError`` for disks and servers that
    fail.
    """

    place: Path | Server

    def place_for(self, study: str) -> Path | Server:
        """Return the place of a study of this name, where the address that the user gave does not say it."""
        return self.place

    @abstractmethod
    def is_vacant(self) -> bool:
        """Return whether there is nothing yet."""

    @abstractmethod
    def creating(self) -> "AbstractContextManager[Storage]":
        """Create the database atomically: yield the storage of a draft, which the block fills.

        If the block succeeds, the draft takes the study's place, which must be vacant; otherwise it is deleted. A
        killed creation leaves the draft, which the next one deletes. The caller holds the study's lock.
        """

    @abstractmethod
    def connect(self) -> Connection:
        """Open the database for writing."""

    @abstractmethod
    def _connect_to_read(self) -> Connection:
        """Open the database for reading; all reads see it as it was at one moment."""

    @contextmanager
    def reading(self) -> Iterator[Connection]:
        """Check that this is a study, and yield a connection whose reads see it as it was at one moment."""
        with self.translated(), undamaged(self.place), closing(self._connect_to_read()) as connection:
            check(connection, self.place)
            yield connection

    @abstractmethod
    def locked(self) -> AbstractContextManager[StudyLock]:
        """Lock the study for this process, until the process ends in any way: a killed run never blocks the next."""

    @abstractmethod
    def holder(self) -> int | None:
        """Return the process id of the run that holds the study, on whatever host; 0 if it is hidden, None if none."""

    @abstractmethod
    def translated(self) -> AbstractContextManager[None]:
        """Turn exceptions of the database, of SQLAlchemy and of the system into one clear error of ours."""

    def is_at_rest(self) -> bool:
        """Return whether the last run has left nothing beside the database that is to be merged into it."""
        return True

    @abstractmethod
    def optuna_storage(self, *, read_only: bool = False) -> "RDBStorage":
        """Return Optuna's view of the database; if it is for reading only, what would write to it fails."""


def error_behind(error: BaseException | None) -> BaseException | None:
    """Return the database's error behind one of SQLAlchemy or Optuna; SQLAlchemy's own if alone, else None."""
    while error is not None and not type(error).__module__.startswith("sqlalchemy."):  # not imported for a name only
        error = error.__cause__
    return getattr(error, "orig", None) or error


@contextmanager
def undamaged(place: Path | Server) -> Iterator[None]:
    """Raise ``DatabaseError`` where damaged content of a database makes the block fail."""
    try:
        yield
    except (ArithmeticError, AttributeError, LookupError, RecursionError, TypeError, ValueError) as error:
        raise DatabaseError(
            f"study database {str(place)!r}: is damaged ({type(error).__name__}: {error}); restore a copy"
        ) from error


def check(connection: Connection, place: Path | Server) -> int:
    """Check that a database is a study of a known version, and return the version of its format."""
    kinds = connection.objects()
    tables = {name for kind, name in kinds if kind == "table"}
    active = [name for kind, name in kinds if kind in ("view", "trigger")]
    if missing := [name for name in (*_OPTUNA_TABLES, *TABLES) if name not in tables]:
        hint = " (it is a study of Optuna, but not of this package)" if "studies" in tables else ""
        raise DatabaseError(
            f"study database {str(place)!r}: is not a study database, it lacks the table {missing[0]!r}{hint}; "
            "give a file that 'run' made"
        )
    if active:
        raise DatabaseError(
            f"study database {str(place)!r}: holds the view or trigger {active[0]!r}, which no study has; "
            "do not trust it, or drop that from it"
        )
    row = connection.execute("SELECT value FROM monoped_meta WHERE key = 'format'").fetchone()
    version = row[0] if row else None
    if not isinstance(version, str) or not version.isascii() or not version.isdigit() or version in ("0", ""):
        raise DatabaseError(
            f"study database {str(place)!r}: its format is {version!r}, must be a version number; it is damaged, "
            "restore a copy"
        )
    if int(version) > FORMAT:
        raise DatabaseError(
            f"study database {str(place)!r}: format {version} is newer than this version's {FORMAT}; "
            "update pareto-monoped"
        )
    if int(version) >= 2 and (lost := [name for name in _SINCE_2 if name not in tables]):
        raise DatabaseError(
            f"study database {str(place)!r}: is damaged (it lacks the table {lost[0]!r}); restore a copy"
        )
    if int(version) == 1 and (found := _of_later(connection, tables)):
        raise DatabaseError(
            f"study database {str(place)!r}: is damaged (it has {found}, but no running hash); restore a copy"
        )
    return int(version)


def _of_later(connection: Connection, tables: Collection[str]) -> str:
    """Return what a study of format 1 has that only later ones have, so that its running hash was taken off; or ""."""
    if left := [name for name in _SINCE_2 if name in tables]:
        return f"the table {left[0]!r}"
    from pareto_monoped.config import parsed_json

    row = connection.execute("SELECT value FROM monoped_meta WHERE key = 'versions'").fetchone()
    version = str(parsed_json(row[0])["pareto-monoped"]) if row else "no version"
    earlier = re.match(r"(\d+)\.(\d+)(?:\D|$)", version)
    return "" if earlier and tuple(map(int, earlier.groups())) < _FIRST_OF_2 else f"version {version}"
