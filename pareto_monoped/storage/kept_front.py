"""The front and the counts of a study as its database keeps them, so that nobody needs to read all trials for them."""

import json
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from operator import itemgetter
from typing import Any

import numpy as np

from pareto_monoped.config import parsed_json
from pareto_monoped.definition.goals import objectives_of
from pareto_monoped.design import in_use
from pareto_monoped.pareto.front import GrowingFront
from pareto_monoped.pareto.objectives import Objectives
from pareto_monoped.storage.columns import listed
from pareto_monoped.storage.connection import Connection
from pareto_monoped.storage.meta import StudyMeta, meta_of_rows
from pareto_monoped.storage.place import StudyPlace, storage_of
from pareto_monoped.storage.seals import ROWS, Seals, damaged, read_seals, require_trials

FRONT = """
CREATE TABLE monoped_front (
    id INTEGER PRIMARY KEY CHECK (id = 1), trials TEXT NOT NULL, feasible INTEGER NOT NULL,
    infeasible INTEGER NOT NULL, failed INTEGER NOT NULL, used TEXT NOT NULL
);
"""
"""One row: numbers of the trials on the front without ill-conditioned ones, ascending; how many trials have each state;
names of the optional variables of which some trial has another value than the default. The row is of as many trials as
it counts, from the first on. While a study with a long front runs, it may lack the last ones, see ``KeptFront.due``."""

STATES = ("feasible", "infeasible", "failed")
_CHUNK = 500
"""Rows asked for at once: our own choice."""
_BLOCK = 4_000
"""Trials that are checked at once. Our own choice: 10 MB, as ``reader`` has it."""
_SHARE = 16
"""The row is written again once so many times the new trials outnumber the front. Our own choice: a front of a thousand
designs is written with every generation, and one of any length takes less than 200 bytes per trial."""


class KeptFront:
    """Follow the front of a study while it grows."""

    def __init__(self, objectives: Objectives) -> None:
        self._objectives = objectives
        self._front = GrowingFront(objectives)
        self.counts = dict.fromkeys(STATES, 0)  #: number of trials in each state
        #: names of the optional variables of which some trial has another value than the default
        self.used: set[str] = set()
        self._stored = 0

    @property
    def numbers(self) -> list[int]:
        """Of the trials on the front, ascending."""
        numbers: list[int] = self._front.numbers.tolist()
        return numbers

    @property
    def trials(self) -> int:
        """Number of trials that it is of."""
        return sum(self.counts.values())

    @property
    def behind(self) -> bool:
        """Whether the database's row lacks trials."""
        return self._stored < self.trials

    @property
    def due(self) -> bool:
        """Whether the row lacks so many trials that it is to be written again: a long front takes a while."""
        return self.behind and _SHARE * (self.trials - self._stored) >= len(self._front)

    def load(self, connection: Connection) -> None:
        """Take what the database keeps, and add the trials that came after."""
        numbers, self.counts, self.used = kept_row(connection)
        rows = rows_of(connection, self._objectives.names, numbers)
        if len(rows) != len(numbers):
            raise ValueError("trials of its kept front are missing")
        values = np.array(rows, dtype=np.float64).reshape(-1, len(self._objectives.names))
        self._front.add(np.array(numbers, dtype=np.int64), values)
        self._stored = self.trials
        select = "SELECT * FROM monoped_trials WHERE trial >= :first ORDER BY trial"
        later = connection.execute(select, {"first": self._stored}).fetchall()
        if later:
            self.add(dict(zip(connection.columns("monoped_trials"), zip(*later, strict=True), strict=True)))

    def add(self, values: Mapping[str, Any]) -> None:
        """Add trials: column -> values, one per trial."""
        states = list(values["state"])
        for state in STATES:
            self.counts[state] += states.count(state)
        self.used.update(variable.name for variable in in_use(values) if variable.default is not None)
        feasible = np.array([state == "feasible" for state in states], dtype=bool)
        objectives = np.column_stack([np.asarray(values[n], dtype=np.float64) for n in self._objectives.names])
        self._front.add(np.asarray(values["trial"], dtype=np.int64)[feasible], objectives[feasible])

    def leave_out(self, connection: Connection, ill_conditioned: Collection[int]) -> None:
        """Make the front anew without these trials; trials that they dominated may enter."""
        names = listed(self._objectives.names)
        rows = connection.execute(
            f"SELECT trial, {names} FROM monoped_trials WHERE state = 'feasible' ORDER BY trial"
        ).fetchall()
        rows = [row for row in rows if row[0] not in ill_conditioned]
        values = np.array([row[1:] for row in rows], dtype=np.float64).reshape(-1, len(self._objectives.names))
        self._front = GrowingFront(self._objectives)
        self._front.add(np.array([row[0] for row in rows], dtype=np.int64), values)

    def store(self, connection: Connection) -> tuple[Any, ...]:
        """Replace the kept row, and return it."""
        numbers = json.dumps(self.numbers, separators=(",", ":"))
        row = (1, numbers, *self.counts.values(), json.dumps(sorted(self.used)))
        connection.replace("monoped_front", [row])
        self._stored = self.trials
        return row


def kept_row(connection: Connection) -> tuple[list[int], dict[str, int], set[str]]:
    """Read the numbers of trials on the front, how many trials have each state, and the optional variables in use."""
    row = connection.execute("SELECT trials, feasible, infeasible, failed, used FROM monoped_front").fetchone()
    numbers = [int(number) for number in parsed_json(row[0])]
    return numbers, dict(zip(STATES, map(int, row[1:4]), strict=True)), set(parsed_json(row[4]))


def rows_of(connection: Connection, names: Sequence[str], trials: Sequence[int]) -> list[tuple[Any, ...]]:
    """Read some columns of some trials, ascending by number."""
    rows = []
    for first in range(0, len(trials), _CHUNK):
        chunk = trials[first : first + _CHUNK]
        numbers = ", ".join(map(str, map(int, chunk)))
        rows += connection.execute(
            f"SELECT {listed(names)} FROM monoped_trials WHERE trial IN ({numbers}) ORDER BY trial"
        ).fetchall()
    return rows


@dataclass(frozen=True, slots=True, kw_only=True)
class CheckedFront:
    """The stored rows behind the front of a study, checked against its running hash."""

    seals: Seals
    meta: StudyMeta
    columns: list[str]  #: names of the columns of a trial that were kept
    #: the trials on the kept front and all that came after it, ascending: one that is bent may hide that it is on it
    trials: list[tuple[Any, ...]]


def checked_front(connection: Connection, db: StudyPlace, *, briefly: bool = False) -> CheckedFront:
    """Read what is behind the front of a study that has a running hash; raise ``DatabaseError`` if it is damaged.

    All columns of its trials are checked; if ``briefly``, only number, objectives, height and energy are kept.
    """
    rows = {table: connection.execute(ROWS[table]).fetchall() for table in ("meta", "front")}
    meta = meta_of_rows(rows["meta"], db)
    numbers, counts, _ = kept_row(connection) if rows["front"] else ([], {}, set())
    seals = read_seals(connection, db, meta=meta, numbers=numbers, since=sum(counts.values()))
    require_trials(connection, db, seals.trials)
    if findings := [line for table in rows for line in seals.row_findings(table, rows[table])]:
        raise damaged(db, findings)
    columns = connection.columns("monoped_trials")
    read = [*numbers, *range(sum(counts.values()), seals.trials)]
    trials: list[tuple[Any, ...]] = []
    objectives = objectives_of(meta.study["objectives"]).names
    names = ["trial", *objectives, "height_m", "energy_j"] if briefly else columns
    kept = itemgetter(*map(columns.index, names))
    for first in range(0, len(read), _BLOCK):
        some = read[first : first + _BLOCK]
        rows_there = rows_of(connection, columns, some)
        if len(rows_there) < len(some):
            raise damaged(db, ["trials of its kept front are missing"])
        values = dict(zip(columns, zip(*rows_there, strict=True), strict=True))
        if findings := seals.trial_findings(values, some):
            raise damaged(db, findings)
        trials += map(kept, rows_there)
    return CheckedFront(seals=seals, meta=meta, columns=names, trials=trials)


def front_trials(db: StudyPlace) -> dict[int, str]:
    """Read each trial of the kept front -> its objectives in words, by the first objective, for a shell.

    They are not checked against the study's seals, which takes longer than a key press. Format 1 kept no front.
    """
    with storage_of(db).reading() as connection:
        (study,) = connection.execute("SELECT value FROM monoped_meta WHERE key = 'study'").fetchone()
        (numbers,) = connection.execute("SELECT trials FROM monoped_front").fetchone()
        objectives = objectives_of(parsed_json(study)["objectives"])
        rows = rows_of(connection, ("trial", *objectives.names), parsed_json(numbers))
    rows.sort(key=lambda row: (row[1], row[0]))
    return {row[0]: objectives.text(row[1:]) for row in rows}


def foreign_count(connection: Connection, own: int) -> int:
    """Count how many of Optuna's trials are not of this package, which has so many of its ``own``.

    Raises:
        ValueError: rows of another table stand among the trials, or a trial stands there twice.
    """
    (total,) = connection.execute("SELECT count(*) FROM trials").fetchone()  # of an index, which takes little time
    if total > own:
        # Read from the table itself, because the index may be damaged.
        total, sound = connection.execute(
            "SELECT count(number), count(DISTINCT CASE WHEN state IN "
            "('COMPLETE', 'FAIL', 'PRUNED', 'RUNNING', 'WAITING') THEN number END) FROM trials"
        ).fetchone()
        if sound != total:
            raise ValueError(f"{total - sound} rows among Optuna's trials are no trials")
    return max(0, int(total) - own)


def foreign_note(count: int) -> str:
    """Return the warning about foreign trials."""
    what, them = ("1 of Optuna's trials is", "it") if count == 1 else (f"{count} of Optuna's trials are", "them")
    return (
        f"{what} not of this package: ignored here, but Optuna's best_trials may have {them}; 'repair DB' drops {them}"
    )
