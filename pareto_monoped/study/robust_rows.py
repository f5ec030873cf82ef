"""The table of robustness in a study database: one row per trial that was simulated under uncertainty.

The table is made when the first row is stored; most studies have none. Its rows have their place in the running hash.
"""

import sqlite3
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pareto_monoped.config import checked, parsed_json
from pareto_monoped.errors import DatabaseError
from pareto_monoped.study.database import reading
from pareto_monoped.study.seals import damaged, has_seals, read_seals
from pareto_monoped.uncertainty.statistics import Robustness

SEALED_AS = "robustness"
"""Its name in the running hash."""
CREATE = """
CREATE TABLE IF NOT EXISTS monoped_robustness (
    trial INTEGER PRIMARY KEY, settings TEXT NOT NULL, result TEXT NOT NULL
)
"""
INSERT = "INSERT OR REPLACE INTO monoped_robustness VALUES (?, ?, ?)"
_SELECT = "SELECT trial, settings, result FROM monoped_robustness ORDER BY trial"

Row = tuple[int, str, str]
"""A trial, the settings under which it was simulated, and the result, both as JSON."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Stored:
    """The robustness of one trial, and the settings that it was simulated under."""

    settings: dict[str, Any]
    result: Robustness


def read_robustness(db: Path) -> dict[int, Stored]:
    """The stored robustness of a study by trial; empty if it has none.

    Raises:
        DatabaseError: missing, not a study, or damaged.
    """
    with reading(db) as connection:
        rows = _rows(connection)
        findings = read_seals(connection, db).row_findings(SEALED_AS, rows) if has_seals(connection) else []
    if findings:
        raise damaged(db, findings)
    try:
        return {int(trial): _stored(settings, result, db) for trial, settings, result in rows}
    except (TypeError, ValueError, RecursionError) as error:
        raise DatabaseError(
            f"study database {str(db)!r}: its robustness is damaged ({type(error).__name__}: {error}); restore a copy"
        ) from None


def _stored(settings: str, result: str, db: Path) -> Stored:
    source = f"study database {str(db)!r}, its robustness"
    known = checked(Robustness, parsed_json(result), source=source, error=DatabaseError)
    return Stored(settings=dict(parsed_json(settings)), result=known)


def _rows(connection: sqlite3.Connection) -> list[Row]:
    there = connection.execute("SELECT 1 FROM sqlite_master WHERE type = 'table' AND name = 'monoped_robustness'")
    return connection.execute(_SELECT).fetchall() if there.fetchone() else []
