"""The front and the counts of a study as its database keeps them, so that nobody needs to read all trials for them."""

import json
import sqlite3
from collections.abc import Collection, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.config import parsed_json
from pareto_monoped.design import in_use
from pareto_monoped.pareto.front import front_mask
from pareto_monoped.pareto.objectives import Objectives
from pareto_monoped.study.columns import listed

FRONT = """
CREATE TABLE monoped_front (
    id INTEGER PRIMARY KEY CHECK (id = 1), trials TEXT NOT NULL, feasible INTEGER NOT NULL,
    infeasible INTEGER NOT NULL, failed INTEGER NOT NULL, used TEXT NOT NULL
);
"""
"""One row: numbers of the trials on the front without ill-conditioned ones, ascending; how many trials have each state;
names of the optional variables of which some trial has another value than the default."""

STATES = ("feasible", "infeasible", "failed")
_CHUNK = 500
"""Rows asked for at once; SQLite takes at least 999 parameters."""


class KeptFront:
    """Follows the front of a study while it grows."""

    def __init__(self, objectives: Objectives) -> None:
        self._objectives = objectives
        self._numbers = np.zeros(0, dtype=np.int64)
        self._values = np.zeros((0, len(objectives.names)))
        self._counts = dict.fromkeys(STATES, 0)
        self._used: set[str] = set()

    def load(self, connection: sqlite3.Connection) -> None:
        """Take what the database keeps."""
        row = connection.execute("SELECT trials, feasible, infeasible, failed, used FROM monoped_front").fetchone()
        self._numbers = np.array(parsed_json(row[0]), dtype=np.int64)
        self._counts = dict(zip(STATES, row[1:4], strict=True))
        self._used = set(parsed_json(row[4]))
        rows = rows_of(connection, self._objectives.names, self._numbers.tolist())
        self._values = np.array(rows, dtype=np.float64).reshape(-1, len(self._objectives.names))

    def add(self, values: Mapping[str, Any]) -> None:
        """Add trials: column -> values, one per trial."""
        states = list(values["state"])
        for state in STATES:
            self._counts[state] += states.count(state)
        self._used.update(variable.name for variable in in_use(values) if variable.default is not None)
        feasible = np.array([state == "feasible" for state in states], dtype=bool)
        objectives = np.column_stack([np.asarray(values[n], dtype=np.float64) for n in self._objectives.names])
        self._numbers = np.concatenate((self._numbers, np.asarray(values["trial"], dtype=np.int64)[feasible]))
        self._values = np.vstack((self._values, objectives[feasible]))
        self._keep_best()

    def leave_out(self, connection: sqlite3.Connection, ill_conditioned: Collection[int]) -> None:
        """Make the front anew without these trials; trials that they dominated may enter."""
        names = listed(self._objectives.names)
        rows = connection.execute(
            f"SELECT trial, {names} FROM monoped_trials WHERE state = 'feasible' ORDER BY trial"
        ).fetchall()
        rows = [row for row in rows if row[0] not in ill_conditioned]
        self._numbers = np.array([row[0] for row in rows], dtype=np.int64)
        self._values = np.array([row[1:] for row in rows], dtype=np.float64).reshape(-1, len(self._objectives.names))
        self._keep_best()

    def _keep_best(self) -> None:
        mask: NDArray[np.bool_] = front_mask(self._values, self._objectives)
        self._numbers, self._values = self._numbers[mask], self._values[mask]

    def store(self, connection: sqlite3.Connection) -> tuple[Any, ...]:
        """Replace the kept row; returns it."""
        numbers = json.dumps(self._numbers.tolist(), separators=(",", ":"))
        row = (1, numbers, *self._counts.values(), json.dumps(sorted(self._used)))
        connection.execute("INSERT OR REPLACE INTO monoped_front VALUES (?, ?, ?, ?, ?, ?)", row)
        return row


def rows_of(connection: sqlite3.Connection, names: Sequence[str], trials: Sequence[int]) -> list[tuple[Any, ...]]:
    """Values of some columns of some trials, ascending by number."""
    rows = []
    for first in range(0, len(trials), _CHUNK):
        chunk = trials[first : first + _CHUNK]
        marks = ", ".join("?" * len(chunk))
        rows += connection.execute(
            f"SELECT {listed(names)} FROM monoped_trials WHERE trial IN ({marks}) ORDER BY trial", chunk
        ).fetchall()
    return rows
