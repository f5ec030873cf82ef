"""The running hash of a study: every transaction stores digests of the rows that it wrote, chained to all before.

A row's digest is the first 16 hexadecimal digits of SHA-256 over its values, enough to tell damage from chance (one in
1.8e19). A link of the chain holds the digests of one transaction and SHA-256 over them and the previous link's hash. So
a few rows can be checked without reading the others: first the links, then the rows against the digests in them.

The hash finds damage and careless edits. It is no signature: who edits a study on purpose can compute it anew. Such
edits, and an older copy in a study's place, change the content hash, which somebody can have noted elsewhere.
"""

import hashlib
import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import chain
from typing import Any

import numpy as np
from numpy.typing import NDArray

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


def _link_hash(previous: str, first: int, columns: str, trials: bytes, written: str) -> str:
    found = hashlib.sha256(f"{previous}\n{first}\n{columns}\n".encode())
    found.update(trials)
    found.update(f"\n{written}".encode())
    return found.hexdigest()


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
        digest = _link_hash(previous, first, columns, trials.encode(), text)
        row = (link, first, columns, trials, text, digest)
        self._connection.insert("monoped_seals", ("link", "first", "columns", "trials", "written", "hash"), [row])
        self.links = link + 1


Numbers = range | NDArray[np.int64]
Parts = Sequence[tuple[Numbers, tuple[str, ...], str]]
"""Numbers of trials, ascending, their columns and digests."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Seals:
    """The digests of all rows of a study."""

    db: StudyPlace  #: the study's database
    links: int  #: number of links in the chain
    trials: int  #: number of trials that have a digest
    parts: Parts  #: of all trials, or of those that were asked for
    #: the latest digests of the rows of all other tables
    written: dict[str, dict[str, str]] = field(default_factory=dict)
    content_hash: str = ""  #: if it was asked for

    def trial_findings(self, values: Mapping[str, Any], numbers: Sequence[int]) -> list[str]:
        """Return what does not match among some trials, ascending by number; ``values`` has their columns."""
        findings = []
        places = np.asarray(numbers, dtype=np.int64)
        known = np.zeros(len(places), dtype=bool)
        for sealed, names, digests in self.parts:
            begin, end = np.searchsorted(places, (sealed[0], sealed[-1] + 1))
            known[begin:end] = True
            if begin == end:
                continue
            if lost := [name for name in names if name not in values]:
                return [f"its trials lack the column {lost[0]!r}"]
            numbers_there = places[begin:end]
            part = {name: np.asarray(column[begin:end]) for name, column in values.items()}
            found = trial_digests(names, part)
            range_there = isinstance(sealed, range)
            where = numbers_there - sealed[0] if range_there else np.searchsorted(sealed, numbers_there)
            wrong = {
                int(number)
                for number, k, digest in zip(numbers_there, where.tolist(), found, strict=True)
                if digests[_DIGITS * k : _DIGITS * (k + 1)] != digest
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


def read_seals(
    connection: Connection, db: StudyPlace, *, meta: StudyMeta | None = None, numbers: Any = (), since: int = 0
) -> Seals:
    """Read the chain, and raise ``DatabaseError`` unless its links follow from each other.

    Keep the digests of the trials with these ``numbers``, ascending, and of all from the number ``since`` on: by
    default, of all trials. If ``meta`` is given, compute the content hash, too, while the chain is read.
    """
    parts: list[tuple[list[Numbers], tuple[str, ...], list[bytes]]] = []
    names: tuple[str, ...] = ()
    written: dict[str, dict[str, str]] = {}
    previous, links, trials = _BEFORE_ALL, 0, 0
    content = None if meta is None else ContentHash(meta)
    for row in connection.execute("SELECT * FROM monoped_seals ORDER BY link"):
        link, first, columns, digests, text, digest = row
        whole = all(isinstance(part, str) for part in (columns, digests, text))
        raw = digests.encode() if whole else b""
        if not whole or link != links or _link_hash(previous, first, columns, raw, text) != digest:
            raise damaged(db, [f"link {links} of its running hash does not follow from those before"])
        previous, links = digest, links + 1
        if columns:
            names = tuple(parsed_json(columns))
        if raw:
            there = range(first, first + len(raw) // _DIGITS)
            if content is not None:
                content.add(names, raw)
            if columns or not parts or first != trials:
                parts.append(([], names, []))
            trials = there.stop
            own, raw = (there, raw) if first >= since else _some(there, raw, numbers, since)
            parts[-1][0].append(own)
            parts[-1][2].append(raw)
        for table, digests_of_rows in parsed_json(text).items():
            written.setdefault(table, {}).update(digests_of_rows)
    if links == 0:
        raise damaged(db, ["its running hash is empty"])
    joined = [(_joined(own), names, b"".join(pieces).decode()) for own, names, pieces in parts]
    return Seals(
        db=db,
        links=links,
        trials=trials,
        parts=[part for part in joined if len(part[0])],
        written=written,
        content_hash="" if content is None else content.hexdigest(),
    )


def _some(there: range, raw: bytes, numbers: Any, since: int) -> tuple[Numbers, bytes]:
    """Return which trials of a link are among some numbers or ``since`` one, and their digests."""
    wanted = np.asarray(numbers, dtype=np.int64)
    begin, end = np.searchsorted(wanted, (there.start, there.stop))
    own = np.concatenate((wanted[begin:end], np.arange(max(there.start, since), there.stop)))
    return own, np.frombuffer(raw, dtype=f"S{_DIGITS}")[own - there.start].tobytes()


def _joined(pieces: Sequence[Numbers]) -> Numbers:
    if all(isinstance(one, range) for one in pieces):
        return range(pieces[0][0], pieces[-1][-1] + 1)
    return np.concatenate([np.asarray(one, dtype=np.int64) for one in pieces])


def numbering_findings(numbers: Any, first: int = 0) -> list[str]:
    """Return what is wrong with the numbers of trials in stored order, which are ``first``, the next one and so on."""
    wrong = np.flatnonzero(numbers != np.arange(first, first + len(numbers)))[:1]
    return [f"trial {numbers[k]} stands in place {first + k}, where trial {first + k} must be" for k in wrong]


def missing_findings(count: int, sealed: int) -> list[str]:
    """Return what is wrong if there are ``count`` trials and the chain has so many ``sealed`` ones."""
    return [f"{sealed - count} trials are missing"] if count < sealed else []


def require_trials(connection: Connection, db: StudyPlace, sealed: int) -> None:
    """Raise ``DatabaseError`` unless exactly the trials that the chain has are stored, each once, in order."""
    if connection.counted("monoped_trials", "trial") == sealed:
        return
    rows = connection.execute("SELECT trial FROM monoped_trials ORDER BY trial")
    numbers = np.fromiter(chain.from_iterable(rows), np.int64)
    if findings := numbering_findings(numbers) + missing_findings(len(numbers), sealed):
        raise damaged(db, findings)


class ContentHash:
    """The SHA-256 of what decides a study's trials and of the digests of all trials in order, while it grows.

    It is the same in a file and on a server, with any number of workers and after any interruption: it depends neither
    on how trials were grouped into transactions nor on what was computed from them.
    """

    def __init__(self, meta: StudyMeta) -> None:
        study = {key: value for key, value in meta.study.items() if key not in NOT_RESULTS}
        decisive = digest({"study": study, "contents": meta.contents, "versions": meta.versions})
        self._found = hashlib.sha256(decisive.encode())
        self._names: Sequence[str] = ()

    def add(self, names: Sequence[str], digests: bytes) -> None:
        """Add the digests of trials that have these columns."""
        if names != self._names:
            self._found.update(json.dumps(names).encode())
            self._names = names
        self._found.update(digests)

    def hexdigest(self) -> str:
        """Return the hash of what was added so far."""
        return self._found.hexdigest()


def content_hash(meta: StudyMeta, parts: Parts) -> str:
    """Return the content hash of all trials."""
    found = ContentHash(meta)
    for _, names, digests in parts:
        found.add(names, digests.encode())
    return found.hexdigest()


def trials_of_hash(meta: StudyMeta, parts: Parts, expected: str) -> int | None:
    """Return how many of the first trials have a content hash that begins so, or None if no number of them has."""
    found, count = ContentHash(meta), 0
    if found.hexdigest().startswith(expected):
        return count
    for _, names, digests in parts:
        for place in range(0, len(digests), _DIGITS):
            found.add(names, digests[place : place + _DIGITS].encode())
            count += 1
            if found.hexdigest().startswith(expected):
                return count
    return None


_SHOWN = 3


def damaged(db: StudyPlace, findings: Sequence[str]) -> DatabaseError:
    """Return the error for rows that do not match their hash."""
    more = f" and {len(findings) - _SHOWN} others" if len(findings) > _SHOWN else ""
    return DatabaseError(
        f"study database {str(db)!r}: is damaged ({'; '.join(findings[:_SHOWN])}{more}); restore a copy"
    )
