"""Tables that only some studies have: robustness per trial, sensitivity per trial and kind of factors.

Their rows have their place in the running hash.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Generic, TypeVar, get_args

from pareto_monoped.config import checked, parsed_json
from pareto_monoped.errors import DatabaseError
from pareto_monoped.storage.connection import Connection
from pareto_monoped.storage.place import StudyPlace, storage_of
from pareto_monoped.storage.seals import damaged, has_seals, read_seals
from pareto_monoped.uncertainty.sensitivity import About, Sensitivity
from pareto_monoped.uncertainty.statistics import Robustness

T = TypeVar("T")
Row = tuple[int | str, str, str]
"""A key, the settings under which something was simulated, and the result, both as JSON."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ExtraTable:
    """A table of keys, settings and results."""

    what: str  #: its name in the running hash and in messages
    key: str  #: SQL of the column that is the key

    @property
    def create(self) -> str:
        """Statement that makes the table where it is missing."""
        columns = f"{self.key} PRIMARY KEY, settings TEXT NOT NULL, result TEXT NOT NULL"
        return f"CREATE TABLE IF NOT EXISTS monoped_{self.what} ({columns})"

    def rows(self, connection: Connection) -> list[Row]:
        """Return all rows by their keys; none if the study has no such table."""
        there = ("table", f"monoped_{self.what}") in connection.objects()
        key = self.key.split()[0]
        select = f"SELECT {key}, settings, result FROM monoped_{self.what} ORDER BY {key}"
        return connection.execute(select).fetchall() if there else []


@dataclass(frozen=True, kw_only=True)  # without slots: aliases of generic classes with slots cannot be called
class StoredResult(Generic[T]):
    """A result, and the settings that it was simulated under."""

    settings: dict[str, Any]
    result: T


Stored = StoredResult[Robustness]
StoredSensitivity = StoredResult[Sensitivity]


def read_rows(db: StudyPlace, table: ExtraTable, make: Callable[[Any, Any, str], T]) -> dict[Any, StoredResult[T]]:
    """Read settings and results by key, and check them against the running hash.

    ``make`` turns a key, the result's JSON values and a source for messages into a result.
    """
    with storage_of(db).reading() as connection:
        rows = table.rows(connection)
        findings = read_seals(connection, db).row_findings(table.what, rows) if has_seals(connection) else []
    if findings:
        raise damaged(db, findings)
    source = f"study database {str(db)!r}, its {table.what}"
    try:
        return {
            key: StoredResult(settings=dict(parsed_json(text)), result=make(key, parsed_json(result), source))
            for key, text, result in rows
        }
    except (TypeError, ValueError, RecursionError) as error:
        raise DatabaseError(
            f"study database {str(db)!r}: its {table.what} is damaged ({type(error).__name__}: {error}); restore a copy"
        ) from None


ROBUSTNESS = ExtraTable(what="robustness", key="trial INTEGER")


def read_robustness(db: StudyPlace) -> dict[int, Stored]:
    """Read the stored robustness of a study by trial; empty if it has none."""

    def result(_: Any, values: Any, source: str) -> Robustness:
        return checked(Robustness, values, source=source, error=DatabaseError)

    return {int(trial): stored for trial, stored in read_rows(db, ROBUSTNESS, result).items()}


SENSITIVITY = ExtraTable(what="sensitivity", key="trial_and_factors TEXT")


def key_of(trial: int, about: About) -> str:
    """Return the key of a row, such as "17 assumptions"."""
    return f"{trial} {about}"


def read_sensitivity(db: StudyPlace) -> dict[tuple[int, About], StoredSensitivity]:
    """Read the stored sensitivities of a study by trial and kind of factors; empty if it has none."""
    found = read_rows(db, SENSITIVITY, _sensitivity)
    return {(int(key.split()[0]), stored.result.about): stored for key, stored in found.items()}


def _sensitivity(key: Any, values: Any, source: str) -> Sensitivity:
    trial, _, about = str(key).partition(" ")
    result = checked(Sensitivity, values, source=source, error=DatabaseError)
    if not trial.isdecimal() or about != result.about or about not in get_args(About):
        raise ValueError(f"a row is called {key!r}")
    return result
