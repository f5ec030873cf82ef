"""Tables that a study has only where something was stored in them; their rows have their place in the running hash."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, TypeVar

from pareto_monoped.config import parsed_json
from pareto_monoped.errors import DatabaseError
from pareto_monoped.study.connection import Connection
from pareto_monoped.study.database import reading
from pareto_monoped.study.place import StudyPlace
from pareto_monoped.study.seals import damaged, has_seals, read_seals

T = TypeVar("T")
Row = tuple[int | str, str, str]
"""A key, the settings under which something was simulated, and the result, both as JSON."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ExtraTable:
    """A table of keys, settings and results.

    Attributes:
        what: its name in the running hash and in messages.
        key: SQL of the column that is the key.
    """

    what: str
    key: str

    @property
    def create(self) -> str:
        """The statement that makes it where it is not there."""
        columns = f"{self.key} PRIMARY KEY, settings TEXT NOT NULL, result TEXT NOT NULL"
        return f"CREATE TABLE IF NOT EXISTS monoped_{self.what} ({columns})"

    def rows(self, connection: Connection) -> list[Row]:
        """All rows by their keys; none if the study has no such table."""
        there = connection.columns(f"monoped_{self.what}")
        key = self.key.split()[0]
        select = f"SELECT {key}, settings, result FROM monoped_{self.what} ORDER BY {key}"
        return connection.execute(select).fetchall() if there else []


def read_rows(
    db: StudyPlace, table: ExtraTable, make: Callable[[Any, Any, str], T]
) -> dict[Any, tuple[dict[str, Any], T]]:
    """Settings and results by key, checked against the running hash.

    Args:
        db: the study's database.
        table: the table.
        make: key, result as JSON values and source for messages -> the result.

    Raises:
        DatabaseError: missing, not a study, or damaged.
    """
    with reading(db) as connection:
        rows = table.rows(connection)
        findings = read_seals(connection, db).row_findings(table.what, rows) if has_seals(connection) else []
    if findings:
        raise damaged(db, findings)
    source = f"study database {str(db)!r}, its {table.what}"
    try:
        return {key: (dict(parsed_json(text)), make(key, parsed_json(result), source)) for key, text, result in rows}
    except (TypeError, ValueError, RecursionError) as error:
        raise DatabaseError(
            f"study database {str(db)!r}: its {table.what} is damaged ({type(error).__name__}: {error}); restore a copy"
        ) from None
