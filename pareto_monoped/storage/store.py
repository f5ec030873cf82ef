"""Write a study: trials, checkpoint and history of a generation in one transaction, into Optuna's tables and ours.

Optuna's tables hold what Optuna and its dashboard show. Ours hold every measure in one wide table, which is read a
hundred times faster, and the state of the search algorithm as JSON.
"""

import json
import sqlite3
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from pareto_monoped.definition.study import Study
from pareto_monoped.errors import DatabaseError
from pareto_monoped.files import temporary_beside
from pareto_monoped.search.space import Coordinates, plain_coordinates
from pareto_monoped.storage.arrival import settle
from pareto_monoped.storage.columns import LATER, Generation, columns_of
from pareto_monoped.storage.connection import Connection, FileConnection
from pareto_monoped.storage.database import FORMAT, check, translated
from pareto_monoped.storage.extra_rows import ExtraTable, Row
from pareto_monoped.storage.front_reader import foreign_count
from pareto_monoped.storage.kept_front import FRONT, KeptFront
from pareto_monoped.storage.lock import Lock
from pareto_monoped.storage.meta import StudyMeta, strict_json
from pareto_monoped.storage.optuna_tables import (
    KNOWN_SCHEMAS,
    OptunaTables,
    create_tables,
    drop_trials,
    stored_digest,
    study_digests,
    trial_ids,
)
from pareto_monoped.storage.place import StudyPlace
from pareto_monoped.storage.seals import BY_OPTUNA, OPTUNA_STUDY, ROWS, SEALS, Sealer, row_digests
from pareto_monoped.storage.server.address import Server
from pareto_monoped.storage.writing import open_for_writing

if TYPE_CHECKING:
    from pareto_monoped.storage.server.lock import ServerLock

_OUR_TABLES = """
CREATE TABLE monoped_meta (key TEXT PRIMARY KEY, value TEXT NOT NULL);
CREATE TABLE monoped_checkpoint (
    id INTEGER PRIMARY KEY CHECK (id = 1), generation INTEGER NOT NULL, told INTEGER NOT NULL, state TEXT NOT NULL
);
CREATE TABLE monoped_history (
    generation INTEGER PRIMARY KEY, evaluations INTEGER NOT NULL, hypervolume REAL NOT NULL, seconds REAL NOT NULL
);
CREATE TABLE monoped_audits (trial INTEGER PRIMARY KEY, well_conditioned INTEGER NOT NULL, measures TEXT NOT NULL);
CREATE TABLE monoped_trials ({columns});
"""
_OUR_TABLES += SEALS + FRONT


def create_database(path: StudyPlace, study: Study, meta: StudyMeta, state: Mapping[str, Any]) -> None:
    """Create a study database without trials; after an error there is none.

    A killed creation leaves the hidden file ``.NAME-new`` and perhaps its journal, or on a server the schema
    ``NAME_new``, which the next creation deletes.

    Args:
        path: where to; must be vacant, see ``arrival``. The caller holds its lock.
        study: the definition.
        meta: everything else that is known about the study.
        state: state of the algorithm before its first ``ask``.

    Raises:
        DatabaseError: it cannot be written.
        OutputError: the folder cannot be written to.
        ServerError: the server is away.
    """
    attributes = {"study": meta.study, "versions": meta.versions, "hash": meta.hash}
    if isinstance(path, Server):
        from pareto_monoped.storage.server.connection import ServerConnection
        from pareto_monoped.storage.server.creating import new_schema

        with translated(path), new_schema(path) as schema:
            create_tables(schema, study, attributes)
            _create_ours(ServerConnection(schema), study, meta, state)
        return
    new = path.with_name(f".{path.name}-new")
    # Before the file itself: a journal without its file would be rolled back into the next file of that name.
    Path(f"{new}-journal").unlink(missing_ok=True)
    with temporary_beside(path, new) as temporary:
        temporary.unlink()
        with translated(path):
            create_tables(temporary, study, attributes)
            connection = sqlite3.connect(temporary, isolation_level=None, factory=FileConnection)
            _create_ours(connection, study, meta, state)
        settle(temporary, path)


def _create_ours(connection: Connection, study: Study, meta: StudyMeta, state: Mapping[str, Any]) -> None:
    """Create our tables beside those of Optuna, and close the connection."""
    try:
        columns = ", ".join(f'"{column.name}" {column.sql}' for column in columns_of(study))
        with _transaction(connection):
            for statement in _OUR_TABLES.format(columns=columns).split(";"):
                connection.execute(statement)
            rows = [("format", strict_json(FORMAT)), *meta.as_rows()]
            connection.executemany("INSERT INTO monoped_meta VALUES (?, ?)", rows)
            connection.execute("INSERT INTO monoped_checkpoint VALUES (1, 0, 0, ?)", (strict_json(state),))
            KeptFront(study.objectives).store(connection)
            written = {table: row_digests(connection.execute(sql)) for table, sql in ROWS.items()}
            Sealer(connection).add(written | {OPTUNA_STUDY: study_digests(connection)})
    finally:
        connection.close()


class Store:
    """A study database that is open for writing. Use it as a context manager."""

    def __init__(
        self,
        path: StudyPlace,
        study: Study,
        *,
        coordinates: Coordinates | None = None,
        known_schemas: Sequence[str] = KNOWN_SCHEMAS,
        lock: "Lock | ServerLock | None" = None,
    ) -> None:
        """Open an existing study for writing.

        Args:
            path: the database.
            study: its definition.
            coordinates: what is searched; every free variable within its bounds if None.
            known_schemas: revisions of Optuna's schema that are written directly.
            lock: is told what is safe.

        Raises:
            DatabaseError: not a study, damaged, read-only, or of a newer version.
        """
        self.path = path
        self._objectives, self._columns = study.objectives, columns_of(study)
        self._lock = lock
        with translated(path):
            self._place = open_for_writing(path)
            self._connection = self._place.connection
            try:
                self._open(coordinates or plain_coordinates(study), known_schemas)
            except BaseException:
                self._place.close()
                raise

    def _open(self, coordinates: Coordinates, known_schemas: Sequence[str]) -> None:
        connection = self._connection
        version = check(connection, self.path)
        self._place.examine()
        rows = connection.execute("SELECT study_id FROM studies").fetchall()
        if len(rows) != 1:
            raise DatabaseError(
                f"study database {str(self.path)!r}: holds {len(rows)} studies, must be 1; give a file that 'run' made"
            )
        self._optuna = OptunaTables(self.path, int(rows[0][0]), coordinates)
        revision = connection.execute("SELECT version_num FROM alembic_version").fetchone()
        self._direct = revision is not None and revision[0] in known_schemas
        self._add_later_columns()
        self._sealer, self._front = Sealer(connection), KeptFront(self._objectives)
        if version < FORMAT:
            self._adopt()
        self._front.load(connection)
        self._place.settle()

    def _add_later_columns(self) -> None:
        """Give a database of an earlier version the columns that trials have now."""
        there = self._connection.columns("monoped_trials")
        missing = [column for column in LATER if column.name not in there]
        if missing:
            with _transaction(self._connection):
                for column in missing:
                    self._connection.execute(f"ALTER TABLE monoped_trials ADD COLUMN {column.name} {column.sql}")

    def _adopt(self) -> None:
        """Give a study of format 1 what it lacks: running hash and kept front, over all that it holds now."""
        execute = self._connection.execute
        with _transaction(self._connection):
            for statement in (SEALS, FRONT):
                execute(statement)
            execute("UPDATE monoped_meta SET value = ? WHERE key = 'format'", (strict_json(FORMAT),))
            cursor = execute("SELECT * FROM monoped_trials ORDER BY trial")
            names, rows = [entry[0] for entry in cursor.description], cursor.fetchall()
            trials: dict[str, Any] = dict(zip(names, zip(*rows, strict=True), strict=True)) if rows else {}
            if rows:
                if trials["trial"] != tuple(range(len(rows))):
                    raise DatabaseError(
                        f"study database {str(self.path)!r}: is damaged (its trials are not numbered from 0 to "
                        f"{len(rows) - 1}); restore a copy"
                    )
                self._front.add(trials)
            self._front.leave_out(self._connection, self._ill_conditioned())
            self._front.store(self._connection)
            written = {table: row_digests(execute(sql)) for table, sql in ROWS.items()}
            written[OPTUNA_STUDY] = study_digests(self._connection)
            self._sealer.add(written, 0, names if rows else (), trials)

    def _ill_conditioned(self) -> set[int]:
        rows = self._connection.execute("SELECT trial FROM monoped_audits WHERE well_conditioned = 0")
        return {int(row[0]) for row in rows}

    def __enter__(self) -> "Store":
        return self

    def __exit__(self, *_: object) -> None:
        """Close; a file is a single one again."""
        self._place.close_at_rest()

    @contextmanager
    def _writing(self) -> Iterator[None]:
        """A transaction; what it wrote is acknowledged only if the files it went to are still those of the study."""
        with translated(self.path), _transaction(self._connection):
            yield
        self._place.require_place()
        if self._lock is not None:
            self._lock.acknowledge(self._sealer.links)

    def set_meta(self, values: Mapping[str, Any]) -> None:
        """Replace the values of some fields of ``StudyMeta``."""
        with self._writing():
            rows = [(key, strict_json(value)) for key, value in values.items()]
            self._connection.replace("monoped_meta", rows)
            written = {"meta": row_digests(rows)}
            if self._front.behind:  # a study at rest lacks nothing
                written["front"] = row_digests([self._front.store(self._connection)])
            self._sealer.add(written)

    def set_audits(self, audits: Sequence[tuple[int, bool, Mapping[str, Any]]]) -> None:
        """Store audits of trials: number of the trial, whether it is well-conditioned, measures of the audit."""
        with self._writing():
            rows = [(trial, int(good), json.dumps(dict(measures))) for trial, good, measures in audits]
            self._connection.replace("monoped_audits", rows)
            written = {"audits": row_digests(rows)}
            if not all(good for _, good, _ in audits):
                self._front.leave_out(self._connection, self._ill_conditioned())
                written["front"] = row_digests([self._front.store(self._connection)])
            self._sealer.add(written)

    def set_rows(self, table: ExtraTable, rows: Sequence[Row]) -> None:
        """Store rows of a table that only some studies have."""
        with self._writing():
            self._connection.execute(table.create)
            self._connection.replace(f"monoped_{table.what}", rows)
            self._sealer.add({table.what: row_digests(rows)})

    def foreign_count(self) -> int:
        """How many of Optuna's trials are not of this package."""
        with translated(self.path):
            return foreign_count(self._connection)

    def drop_foreign(self, numbers: Sequence[int], generations: Mapping[int, int]) -> None:
        """Delete trials of an Optuna user.

        Args:
            numbers: Optuna's numbers of these trials.
            generations: first trial -> number of trials of everything that the running hash has a digest of in Optuna's
                tables; it gets new ones, because Optuna's numbers change.
        """
        with self._writing():
            drop_trials(self._connection, numbers)
            ids = trial_ids(self._connection)
            self._sealer.add(
                {
                    "optuna": {
                        str(first): stored_digest(self._connection, {ids[n] for n in range(first, first + count)})
                        for first, count in generations.items()
                    },
                    "optuna_first": {str(n): str(n) for n in generations},
                }
            )

    def add(self, generation: Generation) -> None:
        """Store a generation. When this returns, its trials are safe.

        Raises:
            DatabaseError: the disk is full, or the file cannot be written.
        """
        if not self._direct:
            with translated(self.path):
                self._optuna.add_by_optuna(generation)
        with self._writing():
            by_optuna = {"optuna": {str(generation.first_trial): BY_OPTUNA}}
            written = self._optuna.insert(self._connection, generation) if self._direct else by_optuna
            self._add_to_our_tables(generation, written)

    def _add_to_our_tables(self, generation: Generation, written: dict[str, dict[str, str]]) -> None:
        """Add a generation to our tables; ``written`` is what the running hash has of Optuna's."""
        values = {column.name: column.values(generation) for column in self._columns}
        self._connection.insert(
            "monoped_trials",
            tuple(values),
            zip(*(v.tolist() if isinstance(v, np.ndarray) else v for v in values.values()), strict=True),
        )
        total = generation.first_trial + len(generation.designs)
        passed = (generation.number, total, float(generation.hypervolume), float(generation.seconds))
        self._connection.replace("monoped_history", [passed])
        self._front.add(values)
        written["history"] = row_digests([passed])
        if self._front.due:
            written["front"] = row_digests([self._front.store(self._connection)])
        if generation.state is not None:
            state = (1, generation.number + 1, total, strict_json(generation.state))
            self._connection.replace("monoped_checkpoint", [state])
            written["checkpoint"] = row_digests([state])
        self._sealer.add(written, generation.first_trial, tuple(values), values)


class _transaction:  # noqa: N801
    """A context: BEGIN, then COMMIT, or ROLLBACK after an error. A commit that fails is rolled back too."""

    def __init__(self, connection: Connection) -> None:
        self._connection = connection

    def __enter__(self) -> None:
        self._connection.begin()

    def __exit__(self, kind: type[BaseException] | None, *rest: object) -> None:
        try:
            if kind is None:
                self._connection.execute("COMMIT")
        finally:
            if self._connection.in_transaction:
                self._connection.execute("ROLLBACK")
