"""Write a study: trials, checkpoint and history of a generation in one transaction, into Optuna's tables and ours.

Optuna's tables hold what Optuna and its dashboard show. Ours hold every measure in one wide table, which is read a
hundred times faster, and the state of the search algorithm as JSON.
"""

import json
from collections.abc import Iterator, Mapping, Sequence
from contextlib import closing, contextmanager
from typing import Any

import numpy as np

from pareto_monoped.definition.study import Study
from pareto_monoped.errors import DatabaseError
from pareto_monoped.search.space import Coordinates, plain_coordinates
from pareto_monoped.storage.base import FORMAT, StudyLock, check
from pareto_monoped.storage.columns import LATER, Generation, columns_of
from pareto_monoped.storage.extra_rows import ExtraTable, Row
from pareto_monoped.storage.kept_front import FRONT, KeptFront, foreign_count
from pareto_monoped.storage.meta import StudyMeta, strict_json
from pareto_monoped.storage.optuna_tables import (
    KNOWN_SCHEMAS,
    OptunaTables,
    create_tables,
    drop_trials,
    require_columns,
    stored_digest,
    study_digests,
    trial_ids,
)
from pareto_monoped.storage.place import StudyPlace, storage_of
from pareto_monoped.storage.seals import BY_OPTUNA, OPTUNA_STUDY, ROWS, SEALS, Sealer, row_digests

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
    """Create a study without trials at a vacant place whose lock is held, with an algorithm's first ``state``."""
    columns = ", ".join(f'"{column.name}" {column.sql}' for column in columns_of(study))
    with storage_of(path).creating() as draft:
        create_tables(draft, study, {"study": meta.study, "versions": meta.versions, "hash": meta.hash})
        with closing(draft.connect()) as connection, connection.transaction():
            connection.define(_OUR_TABLES.format(columns=columns))
            connection.insert("monoped_meta", ("key", "value"), [("format", strict_json(FORMAT)), *meta.as_rows()])
            state_row = (1, 0, 0, strict_json(state))
            connection.insert("monoped_checkpoint", ("id", "generation", "told", "state"), [state_row])
            KeptFront(study.objectives).store(connection)
            written = {table: row_digests(connection.execute(sql)) for table, sql in ROWS.items()}
            Sealer(connection).add(written | {OPTUNA_STUDY: study_digests(connection)})


class Store:
    """A study database that is open for writing. Use it as a context manager."""

    def __init__(
        self,
        path: StudyPlace,
        study: Study,
        *,
        coordinates: Coordinates | None = None,
        known_schemas: Sequence[str] = KNOWN_SCHEMAS,
        lock: StudyLock | None = None,
    ) -> None:
        """Open an existing study for writing; ``lock`` is told what is safe."""
        self.path = path
        self._objectives, self._columns = study.objectives, columns_of(study)
        self._lock = lock
        self._storage = storage_of(path)
        with self._storage.translated():
            self._connection = self._storage.connect()
            try:
                self._open(coordinates or plain_coordinates(study), known_schemas)
            except BaseException:
                self._connection.close()
                raise

    def _open(self, coordinates: Coordinates, known_schemas: Sequence[str]) -> None:
        connection = self._connection
        if check(connection, self.path) < FORMAT:
            raise DatabaseError(
                f"study database {str(self.path)!r}: is of version 0.2.0 or earlier, which is only read; run the study "
                "anew in another database"
            )
        connection.examine()
        rows = connection.execute("SELECT study_id FROM studies").fetchall()
        if len(rows) != 1:
            raise DatabaseError(
                f"study database {str(self.path)!r}: holds {len(rows)} studies, must be 1; give a file that 'run' made"
            )
        self._optuna = OptunaTables(self._storage, int(rows[0][0]), coordinates)
        revision = connection.execute("SELECT version_num FROM alembic_version").fetchone()
        self._direct = revision is not None and revision[0] in known_schemas
        if self._direct:
            require_columns(connection)
        self._add_later_columns()
        self._sealer, self._front = Sealer(connection), KeptFront(self._objectives)
        self._front.load(connection)
        connection.settle()

    def _add_later_columns(self) -> None:
        """Give a database of an earlier version the columns that trials have now."""
        there = self._connection.columns("monoped_trials")
        missing = [column for column in LATER if column.name not in there]
        if missing:
            with self._connection.transaction():
                for column in missing:
                    self._connection.define(f"ALTER TABLE monoped_trials ADD COLUMN {column.name} {column.sql}")

    def _ill_conditioned(self) -> set[int]:
        rows = self._connection.execute("SELECT trial FROM monoped_audits WHERE well_conditioned = 0")
        return {int(row[0]) for row in rows}

    def __enter__(self) -> "Store":
        return self

    def __exit__(self, *_: object) -> None:
        """Close; a file is a single one again."""
        self._connection.close_at_rest()

    @contextmanager
    def _writing(self) -> Iterator[None]:
        """Write in a transaction, which is acknowledged only if the files it went to are still those of the study."""
        with self._storage.translated(), self._connection.transaction():
            yield
        self._connection.require_place()
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
            self._connection.define(table.create)
            self._connection.replace(f"monoped_{table.what}", rows)
            self._sealer.add({table.what: row_digests(rows)})

    def foreign_count(self) -> int:
        """Count how many of Optuna's trials are not of this package."""
        with self._storage.translated():
            (own,) = self._connection.execute("SELECT count(*) FROM monoped_trials").fetchone()
            return foreign_count(self._connection, int(own))

    def drop_foreign(self, numbers: Sequence[int], generations: Mapping[int, int]) -> None:
        """Delete trials of an Optuna user, by Optuna's ``numbers``.

        ``generations`` has the first trial -> number of trials of everything that the running hash has a digest of in
        Optuna's tables; it gets new ones, because Optuna's numbers change.
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
        """Store a generation. When this returns, its trials are safe."""
        if not self._direct:
            with self._storage.translated():
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
