"""The running hash of a study: every transaction stores digests of the rows that it wrote, chained to all before.

A row's digest is the first 16 hexadecimal digits of SHA-256 over its values, enough to tell damage from chance (one in
1.8e19). A link of the chain holds the digests of one transaction and SHA-256 over them and the previous link's hash. So
a few rows can be checked without reading the others: first the links, then the rows against the digests in them.

The hash finds damage and careless edits. It is no signature: who edits a study on purpose can compute it anew. Such
edits, and an older copy in a study's place, change the content hash, which somebody can have noted elsewhere.
"""

import hashlib
import json
import sys
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import chain
from typing import Any

import numpy as np

from pareto_monoped.config import parsed_json
from pareto_monoped.definition.provenance import NOT_RESULTS, digest
from pareto_monoped.design import DEFAULTS
from pareto_monoped.errors import DatabaseError
from pareto_monoped.storage.columns import COLUMNS
from pareto_monoped.storage.connection import Connection
from pareto_monoped.storage.meta import StudyMeta
from pareto_monoped.storage.place import StudyPlace

SEALS = """
CREATE TABLE monoped_seals (
    link INTEGER PRIMARY KEY, first INTEGER NOT NULL, columns TEXT NOT NULL, trials TEXT NOT NULL,
    written TEXT NOT NULL, hash TEXT NOT NULL
);
"""
"""One row per transaction: number of its ``first`` trial; digests of its ``trials``, one after the other; the
``columns`` that these are over (empty: as in the link before); digests of the rows ``written`` into the other tables,
by table and key; the chained hash."""

ROWS = {
    "meta": "SELECT key, value FROM monoped_meta ORDER BY key",
    "checkpoint": "SELECT id, generation, told, state FROM monoped_checkpoint ORDER BY id",
    "history": "SELECT generation, evaluations, hypervolume, seconds FROM monoped_history ORDER BY generation",
    "audits": "SELECT trial, well_conditioned, measures FROM monoped_audits ORDER BY trial",
    "front": "SELECT id, trials, feasible, infeasible, failed, used FROM monoped_front ORDER BY id",
}
"""What is sealed besides the trials; the first value of a row is its key.

Besides, ``optuna`` has the digest of all rows of a link's trials in Optuna's tables, by the number of the first trial,
and ``optuna_first`` Optuna's own number of that trial where it is another one."""

BY_OPTUNA = ""
"""In place of the digest of a generation that Optuna has written for us, in a form that only Optuna knows."""

OPTUNA_STUDY = "optuna_study"
"""What is sealed of Optuna's tables on the study itself when it is created, see ``optuna_tables.study_digests``."""

UNSEALED = (
    "the study has no running hash, so damage to numbers may go unnoticed; studies of version 0.3.0 and later have one"
)
"""Note on a study of version 0.2.0 or earlier."""

_DIGITS = 16
_KNOWN = frozenset(column.name for column in COLUMNS)
_TEXTS = frozenset(column.name for column in COLUMNS if column.dtype == "str")
_BEFORE_ALL = ""

Written = Mapping[str, Mapping[str, str]]
"""Table -> key of a row -> its digest."""


def row_digest(values: Sequence[Any]) -> str:
    """Return the digest of a row of numbers and text; rows within it may be of any type."""
    return hashlib.sha256(json.dumps(list(values), default=list).encode()).hexdigest()[:_DIGITS]


def trial_digests(names: Sequence[str], values: Mapping[str, Any]) -> list[str]:
    """Return digests of trials, the same in memory and as read again; None is the same as NaN and as empty text."""
    numbers = [name for name in names if name not in _TEXTS]
    # SQLite keeps neither the sign of zero nor the payload of a NaN.
    matrix = np.array([np.asarray(values[name], dtype=np.float64) for name in numbers]).T + 0.0
    matrix[np.isnan(matrix)] = np.nan
    content = np.ascontiguousarray(matrix, dtype="<f8").tobytes()
    width = 8 * len(numbers)
    words = zip(*(["" if word is None else str(word) for word in values[n]] for n in names if n in _TEXTS), strict=True)
    return [
        hashlib.sha256("\x1f".join(row).encode() + b"\x1e" + content[k * width : (k + 1) * width]).hexdigest()[:_DIGITS]
        for k, row in enumerate(words)
    ]


def row_digests(rows: Iterable[Sequence[Any]]) -> dict[str, str]:
    """Return the digest of each row of a table of ``ROWS`` by its key."""
    return {str(row[0]): row_digest(row) for row in rows}


def _link_hash(previous: str, first: int, columns: str, trials: str, written: str) -> str:
    return hashlib.sha256("\n".join((previous, str(first), columns, trials, written)).encode()).hexdigest()


class Sealer:
    """Adds links to the chain, each within the transaction whose rows it seals."""

    def __init__(self, connection: Connection) -> None:
        self._connection = connection
        self._names: list[str] = []
        self._names_link = -1
        self.links = 0

    def add(self, written: Written, first: int = 0, names: Sequence[str] = (), values: Any = None) -> None:
        """Add a link over the digests ``written`` into other tables and the new trials from number ``first`` on."""
        last = self._connection.execute("SELECT link, hash FROM monoped_seals ORDER BY link DESC LIMIT 1").fetchone()
        link, previous = (last[0] + 1, last[1]) if last else (0, _BEFORE_ALL)
        columns = trials = ""
        if names:
            trials = "".join(trial_digests(names, values))
            # A transaction that was rolled back takes its link with it, and the columns that it named.
            if list(names) != self._names or self._names_link >= link:
                columns = json.dumps(list(names))
                self._names, self._names_link = list(names), link
        text = json.dumps({table: dict(rows) for table, rows in written.items()})
        digest = _link_hash(previous, first, columns, trials, text)
        row = (link, first, columns, trials, text, digest)
        self._connection.insert("monoped_seals", ("link", "first", "columns", "trials", "written", "hash"), [row])
        self.links = link + 1


Parts = Sequence[tuple[int, tuple[str, ...], str]]
"""Number of the first trial, columns and digests of trials that follow one another."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Seals:
    """The digests of all rows of a study."""

    db: StudyPlace  #: the study's database
    links: int  #: number of links in the chain
    parts: Parts  #: of all trials
    #: the latest digests of the rows of all other tables
    written: dict[str, dict[str, str]] = field(default_factory=dict)

    @property
    def trials(self) -> int:
        """Number of trials that have a digest."""
        return sum(len(digests) for _, _, digests in self.parts) // _DIGITS

    def trial_findings(self, values: Mapping[str, Any], numbers: Sequence[int]) -> list[str]:
        """Return what does not match among some trials, ascending by number; ``values`` has their columns."""
        findings = []
        places = np.asarray(numbers, dtype=np.int64)
        known = np.zeros(len(places), dtype=bool)
        for first, names, digests in self.parts:
            begin, end = np.searchsorted(places, (first, first + len(digests) // _DIGITS))
            known[begin:end] = True
            if begin == end:
                continue
            if lost := [name for name in names if name not in values]:
                return [f"its trials lack the column {lost[0]!r}"]
            numbers_there = places[begin:end]
            part = {name: np.asarray(column[begin:end]) for name, column in values.items()}
            found = trial_digests(names, part)
            wrong = {
                int(number)
                for number, digest in zip(numbers_there, found, strict=True)
                if digests[_DIGITS * (number - first) : _DIGITS * (number - first + 1)] != digest
            }
            without = _KNOWN & set(values) - set(names)
            wrong.update(numbers_there[_not_default(part, without, len(numbers_there))].tolist())
            findings += [f"trial {number} does not match its hash" for number in sorted(wrong)]
        return findings + [f"trial {number} has no hash" for number in places[~known]]

    def row_findings(self, table: str, rows: Iterable[Sequence[Any]], *, whole: bool = True) -> list[str]:
        """Return what does not match among rows of a table of ``ROWS``, or among all of them if it is ``whole``."""
        sealed = self.written.get(table, {})
        found = row_digests(rows)
        findings = [
            f"row {key} of its {table} " + ("does not match its hash" if key in sealed else "has no hash")
            for key, digest in found.items()
            if sealed.get(key) != digest
        ]
        return findings + [f"row {key} of its {table} is missing" for key in sealed if whole and key not in found]


def _not_default(values: Mapping[str, Any], names: Iterable[str], count: int) -> Any:
    """Return which trials have a value in a later column, where they can only have its default."""
    wrong = np.zeros(count, dtype=bool)
    for name in names:
        if name in _TEXTS:
            wrong |= np.array([bool(word) for word in values[name]], dtype=bool)
            continue
        numbers, default = np.asarray(values[name], dtype=np.float64), DEFAULTS.get(name)
        wrong |= ~np.isnan(numbers) if default is None else numbers != default
    return wrong


def has_seals(connection: Connection) -> bool:
    """Return whether a study has a running hash, as all have but those of versions up to 0.2.0."""
    row = connection.execute("SELECT value FROM monoped_meta WHERE key = 'format'").fetchone()
    return row is not None and row[0] != "1"


def read_seals(connection: Connection, db: StudyPlace) -> Seals:
    """Read the chain, and raise ``DatabaseError`` unless its links follow from each other."""
    parts: list[tuple[int, tuple[str, ...], list[str]]] = []
    names: tuple[str, ...] = ()
    written: dict[str, dict[str, str]] = {}
    previous, links, trials = _BEFORE_ALL, 0, 0
    for row in connection.execute("SELECT * FROM monoped_seals ORDER BY link"):
        link, first, columns, digests, text, digest = row
        whole = all(isinstance(part, str) for part in (columns, digests, text))
        if not whole or link != links or _link_hash(previous, first, columns, digests, text) != digest:
            raise damaged(db, [f"link {links} of its running hash does not follow from those before"])
        previous, links = digest, links + 1
        if columns:
            names = tuple(parsed_json(columns))
        if digests and (columns or not parts or first != trials):
            parts.append((first, names, []))
        if digests:
            parts[-1][2].append(digests)
            trials = first + len(digests) // _DIGITS
        for table, digests_of_rows in parsed_json(text).items():
            written.setdefault(table, {}).update(digests_of_rows)
    if links == 0:
        raise damaged(db, ["its running hash is empty"])
    joined = tuple((first, names, "".join(digests)) for first, names, digests in parts)
    return Seals(db=db, links=links, parts=joined, written=written)


def numbering_findings(numbers: Any, first: int = 0) -> list[str]:
    """Return what is wrong with the numbers of trials in stored order, which are ``first``, the next one and so on."""
    wrong = np.flatnonzero(numbers != np.arange(first, first + len(numbers)))[:1]
    return [f"trial {numbers[k]} stands in place {first + k}, where trial {first + k} must be" for k in wrong]


def missing_findings(count: int, sealed: int) -> list[str]:
    """Return what is wrong if there are ``count`` trials and the chain has so many ``sealed`` ones."""
    return [f"{sealed - count} trials are missing"] if count < sealed else []


def seals_of_trials(connection: Connection, db: StudyPlace) -> Seals:
    """Read the chain, and raise ``DatabaseError`` unless exactly the trials that it has are stored, each once."""
    seals = read_seals(connection, db)
    rows = connection.execute("SELECT trial FROM monoped_trials ORDER BY trial")
    numbers = np.fromiter(chain.from_iterable(rows), np.int64)
    if findings := numbering_findings(numbers) + missing_findings(len(numbers), seals.trials):
        raise damaged(db, findings)
    return seals


def content_hash(meta: StudyMeta, parts: Parts) -> str:
    """Return the SHA-256 of what decides a study's trials and of the digests of all trials in order.

    It is the same in a file and on a server, with any number of workers and after any interruption: it depends neither
    on how trials were grouped into transactions nor on what was computed from them.
    """
    *_, found = _growing(meta, parts, sys.maxsize)
    return found


def trials_of_hash(meta: StudyMeta, parts: Parts, expected: str) -> int | None:
    """Return how many of the first trials have a content hash that begins so, or None if no number of them has."""
    hashes = enumerate(_growing(meta, parts, _DIGITS))
    return next((count for count, found in hashes if found.startswith(expected)), None)


def _growing(meta: StudyMeta, parts: Parts, digits: int) -> Iterator[str]:
    """Yield the content hash without trials, and after so many more ``digits`` of its digests."""
    study = {key: value for key, value in meta.study.items() if key not in NOT_RESULTS}
    decisive = digest({"study": study, "contents": meta.contents, "versions": meta.versions})
    found = hashlib.sha256(decisive.encode())
    before: tuple[str, ...] = ()
    yield found.hexdigest()
    for _, names, digests in parts:
        if names != before:
            found.update(json.dumps(names).encode())
            before = names
        for place in range(0, len(digests), digits):
            found.update(digests[place : place + digits].encode())
            yield found.hexdigest()


_SHOWN = 3


def damaged(db: StudyPlace, findings: Sequence[str]) -> DatabaseError:
    """Return the error for rows that do not match their hash."""
    more = f" and {len(findings) - _SHOWN} others" if len(findings) > _SHOWN else ""
    return DatabaseError(
        f"study database {str(db)!r}: is damaged ({'; '.join(findings[:_SHOWN])}{more}); restore a copy"
    )
