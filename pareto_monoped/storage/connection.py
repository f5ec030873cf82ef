"""The base class of connections to a study database, whatever kind of database it is."""

from abc import ABC, abstractmethod
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import Any, ClassVar, Protocol


class Rows(Protocol):
    """The rows of a query."""

    def fetchone(self) -> Any:
        """Return the next row, or None."""

    def fetchall(self) -> Any:
        """Return all rows that are left."""

    def __iter__(self) -> Iterator[Any]: ...


class Connection(ABC):
    """A connection on which every statement outside of ``transaction`` is a transaction of its own.

    Statements are in the SQL that SQLite and PostgreSQL share; they name their values, such as ``:trial``.
    """

    _BEGIN: ClassVar[str] = "BEGIN"

    @property
    @abstractmethod
    def in_transaction(self) -> bool:
        """Whether a transaction is open, an aborted one included."""

    @abstractmethod
    def execute(self, sql: str, parameters: Mapping[str, Any] = ..., /) -> Rows:
        """Run a statement with named values."""

    @abstractmethod
    def executemany(self, sql: str, parameters: Iterable[Mapping[str, Any]], /) -> object:
        """Run a statement once per set of named values."""

    @contextmanager
    def transaction(self) -> Iterator[None]:
        """Commit what the block writes, or roll it back after an error, also after one of the commit itself."""
        self.execute(self._BEGIN)
        try:
            yield
            self.execute("COMMIT")
        finally:
            if self.in_transaction:
                self.execute("ROLLBACK")

    def define(self, sql: str) -> None:
        """Run statements that make or change tables, one after the other; the type REAL has 64 bits."""
        for statement in sql.split(";"):
            if statement.strip():
                self.execute(statement)

    @abstractmethod
    def insert(self, table: str, columns: Sequence[str], rows: Iterable[Sequence[Any]]) -> None:
        """Add rows to a table, with values of these columns; the database fills the others."""

    @abstractmethod
    def replace(self, table: str, rows: Sequence[Sequence[Any]]) -> None:
        """Add whole rows to a table, in place of those with the same key, which is the first column."""

    @abstractmethod
    def objects(self) -> list[tuple[str, str]]:
        """Return kind (such as ``table``, ``view`` or ``trigger``) and name of everything in the database."""

    @abstractmethod
    def columns(self, table: str) -> list[str]:
        """Return the names of a table's columns in their order."""

    @abstractmethod
    def trial_ids_after(self, last: int, count: int) -> int:
        """Return the first of ``count`` successive keys for Optuna's trials; ``last`` is the greatest so far."""

    @abstractmethod
    def close(self) -> None:
        """Close the connection; an open transaction is rolled back."""

    def counted(self, table: str, key: str) -> int | None:
        """Return the number of rows if their keys are 0, 1, 2 and so on in stored order; None if not, or not known."""
        return None

    # A server looks after the following itself.

    def defects(self) -> Iterator[str]:
        """Yield what the database finds wrong with its own pages and indexes, one line each."""
        return iter(())

    def examine(self) -> None:  # noqa: B027
        """Raise an error of the database if its pages are damaged."""

    def settle(self) -> None:  # noqa: B027
        """Begin to write: what is committed from now on survives a power cut."""

    def require_place(self) -> None:  # noqa: B027
        """Raise if what was committed did not go to the study's own place."""

    def close_at_rest(self) -> None:
        """Close the connection and leave the study as it is when nobody runs it."""
        self.close()
