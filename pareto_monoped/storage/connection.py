"""What the storage of studies asks of a database, and SQLite's way to do it; PostgreSQL's is ``server.connection``.

Both take the same SQL, with question marks for values. What they write in different words is a method here.
"""

import sqlite3
from collections.abc import Iterable, Iterator, Sequence
from typing import Any, Protocol

from pareto_monoped.storage.columns import listed


class Rows(Protocol):
    """The rows that a query gives."""

    @property
    def description(self) -> Any:
        """One entry per column, which begins with its name."""

    def fetchone(self) -> Any:
        """The next row, or None."""

    def fetchall(self) -> list[Any]:
        """All that are left."""

    def __iter__(self) -> Iterator[Any]: ...


class Connection(Protocol):
    """A connection to a database, in which every statement outside of a transaction is one of its own."""

    @property
    def in_transaction(self) -> bool:
        """Whether a transaction is open."""

    def execute(self, sql: str, parameters: Sequence[Any] = ..., /) -> Rows:
        """Run a statement."""

    def executemany(self, sql: str, parameters: Iterable[Sequence[Any]], /) -> object:
        """Run a statement once per row of values."""

    def begin(self) -> None:
        """Begin a transaction that writes."""

    def insert(self, table: str, columns: Sequence[str], rows: Iterable[Sequence[Any]]) -> None:
        """Add rows to a table, with values of these columns; the database fills the others."""

    def replace(self, table: str, rows: Sequence[Sequence[Any]]) -> None:
        """Add whole rows to a table, in place of those with the same key, which is the first column."""

    def objects(self) -> list[tuple[str, str]]:
        """Kind (such as ``table``, ``view`` or ``trigger``) and name of everything in the database."""

    def columns(self, table: str) -> list[str]:
        """Names of a table's columns, in its order."""

    def defects(self) -> Iterator[str]:
        """What the database itself finds wrong with its pages and indexes, one line each."""

    def trial_ids_after(self, last: int, count: int) -> int:
        """The first of ``count`` successive keys for Optuna's trials, of which ``last`` is the greatest so far."""

    def close(self) -> None:
        """Close it; an open transaction is rolled back."""


class FileConnection(sqlite3.Connection):
    """A connection to a file of SQLite; give it to ``sqlite3.connect`` as its factory."""

    def begin(self) -> None:
        """Begin a transaction that writes."""
        self.execute("BEGIN IMMEDIATE")

    def insert(self, table: str, columns: Sequence[str], rows: Iterable[Sequence[Any]]) -> None:
        """Add rows to a table, with values of these columns."""
        marks = ", ".join("?" * len(columns))
        self.executemany(f"INSERT INTO {table} ({listed(columns)}) VALUES ({marks})", rows)

    def replace(self, table: str, rows: Sequence[Sequence[Any]]) -> None:
        """Add whole rows to a table, in place of those with the same key."""
        for row in rows[:1]:
            self.executemany(f"INSERT OR REPLACE INTO {table} VALUES ({', '.join('?' * len(row))})", rows)

    def objects(self) -> list[tuple[str, str]]:
        """Kind and name of everything in the database."""
        return self.execute("SELECT type, name FROM sqlite_master").fetchall()

    def columns(self, table: str) -> list[str]:
        """Names of a table's columns."""
        return [row[1] for row in self.execute(f"PRAGMA table_info({table})")]

    def defects(self) -> Iterator[str]:
        """What SQLite finds wrong with pages and indexes; it lists all of one kind in one text of several lines."""
        for (text,) in self.execute("PRAGMA integrity_check(5)"):
            for line in text.splitlines():
                if line != "ok" and not line.startswith("***"):
                    yield f"SQLite: {line}"

    def trial_ids_after(self, last: int, count: int) -> int:
        """The first of ``count`` successive keys; a transaction that writes is alone, so they follow the last."""
        return last + 1
