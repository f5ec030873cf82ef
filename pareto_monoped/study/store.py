"""Writing a study: trials, checkpoint and history of a generation in one transaction, in Optuna's schema and ours.

Optuna's own tables hold what Optuna and its dashboard show; ours hold every measure in one wide table, which is read
a hundred times faster, and the optimiser's state as JSON.
"""

import json
import sqlite3
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.design import NAMES
from pareto_monoped.errors import DatabaseError
from pareto_monoped.jump.evaluate import MEASURES, Evaluations
from pareto_monoped.study.database import FORMAT, check, translated
from pareto_monoped.study.definition import Bounds, Study
from pareto_monoped.study.scoring import Judgement

KNOWN_SCHEMAS = ("v3.2.0.a",)
"""Revisions of Optuna's schema whose tables are written directly; with any other, Optuna writes its own."""

_OUR_TABLES = """
CREATE TABLE monoped_meta (key TEXT PRIMARY KEY, value TEXT NOT NULL);
CREATE TABLE monoped_checkpoint (
    id INTEGER PRIMARY KEY CHECK (id = 1), generation INTEGER NOT NULL, told INTEGER NOT NULL, state TEXT NOT NULL
);
CREATE TABLE monoped_history (
    generation INTEGER PRIMARY KEY, evaluations INTEGER NOT NULL, hypervolume REAL NOT NULL, seconds REAL NOT NULL
);
CREATE TABLE monoped_audits (trial INTEGER PRIMARY KEY, well_conditioned INTEGER NOT NULL, measures TEXT NOT NULL);
CREATE TABLE monoped_trials (
    trial INTEGER PRIMARY KEY, generation INTEGER NOT NULL, state TEXT NOT NULL, status TEXT NOT NULL,
    reason TEXT NOT NULL, violation REAL NOT NULL, height_weight REAL, {columns}
);
"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Generation:
    """What one transaction stores.

    Attributes:
        number: of the generation.
        first_trial: number of its first trial here.
        designs: shape (n, 7).
        evaluations, judgement: of these designs.
        height_weight: of a weighted search.
        state: the algorithm's state after it has been told the whole generation; None while part of it is missing.
        hypervolume: of all trials so far.
        seconds: running time so far, over all sessions.
        started, ended: when the generation was simulated.
    """

    number: int
    first_trial: int
    designs: NDArray[np.float64]
    evaluations: Evaluations
    judgement: Judgement
    height_weight: float | None
    state: Mapping[str, Any] | None
    hypervolume: float
    seconds: float
    started: datetime
    ended: datetime


def create(path: Path, study: Study, meta: Mapping[str, Any], state: Mapping[str, Any]) -> None:
    """A new study database without trials, whole or not at all.

    Args:
        path: where; must not exist.
        study: the study.
        meta: what is known about it, JSON values by key.
        state: the fresh algorithm's state.

    Raises:
        DatabaseError: it cannot be written.
        OutputError: the folder cannot be written to.
    """
    from pareto_monoped.files import replacing

    with replacing(path) as temporary:
        _create_optuna(temporary, study, meta)
        with translated(path):
            connection = sqlite3.connect(temporary, isolation_level=None)
            try:
                columns = ", ".join(f"{name} REAL" for name in (*NAMES, *MEASURES))
                connection.execute("BEGIN IMMEDIATE")
                for statement in _OUR_TABLES.format(columns=columns).split(";"):
                    connection.execute(statement)
                rows = [(key, _strict(value)) for key, value in ({"format": FORMAT} | dict(meta)).items()]
                connection.executemany("INSERT INTO monoped_meta VALUES (?, ?)", rows)
                connection.execute("INSERT INTO monoped_checkpoint VALUES (1, 0, 0, ?)", (_strict(state),))
                connection.execute("COMMIT")
            finally:
                connection.close()


def _create_optuna(path: Path, study: Study, meta: Mapping[str, Any]) -> None:
    import optuna

    path.unlink()
    verbosity = optuna.logging.get_verbosity()
    optuna.logging.set_verbosity(optuna.logging.WARNING)
    try:
        storage = _optuna_storage(path)
        study_id = storage.create_new_study(
            [optuna.study.StudyDirection.MAXIMIZE, optuna.study.StudyDirection.MINIMIZE], study.name
        )
        # What optuna.study.Study.set_metric_names writes; the method itself warns that it is experimental.
        storage.set_study_system_attr(study_id, "study:metric_names", ["height_m", "energy_j"])
        for key in ("study", "versions", "hash"):
            storage.set_study_user_attr(study_id, key, meta[key])
        storage.remove_session()
        storage.engine.dispose()
    finally:
        optuna.logging.set_verbosity(verbosity)


def _optuna_storage(path: Path) -> Any:
    import optuna
    from sqlalchemy.engine import URL

    # A path with a question mark or a percent sign would be taken apart by a plain "sqlite:///..." text.
    url = URL.create("sqlite", database=str(path)).render_as_string(hide_password=False)
    return optuna.storages.RDBStorage(url)


class Store:
    """An open study database that trials are added to. Use as a context manager."""

    def __init__(self, path: Path, study: Study, *, known_schemas: Sequence[str] = KNOWN_SCHEMAS) -> None:
        """Open an existing study for writing.

        Raises:
            DatabaseError: not a study, damaged, read-only, or of another version.
        """
        self.path = path
        # SQLite would ask the system, which lets root write to anything; a file marked read-only is meant to stay.
        if not path.stat().st_mode & 0o222:
            raise DatabaseError(
                f"study database {str(path)!r}: is read-only; allow writing (chmod u+w), or run on a copy"
            )
        self._distributions = {
            name: json.dumps(
                {
                    "name": "FloatDistribution",
                    "attributes": {"step": None, "low": bounds.lower, "high": bounds.upper, "log": False},
                }
            )
            for name, bounds in study.variables.items()
            if isinstance(bounds, Bounds)
        }
        self._free = [i for i, name in enumerate(NAMES) if name in study.free]
        with translated(path):
            # Generations are written by a thread of their own, one at a time; the run loop waits for it.
            self._connection = sqlite3.connect(path, isolation_level=None, timeout=30.0, check_same_thread=False)
            try:
                self._open(known_schemas)
            except BaseException:
                self._connection.close()
                raise

    def _open(self, known_schemas: Sequence[str]) -> None:
        connection = self._connection
        connection.execute("PRAGMA trusted_schema = OFF")
        check(connection, self.path)
        if connection.execute("PRAGMA quick_check(1)").fetchone()[0] != "ok":
            raise sqlite3.DatabaseError("its pages contradict each other")
        rows = connection.execute("SELECT study_id FROM studies").fetchall()
        if len(rows) != 1:
            raise DatabaseError(
                f"study database {str(self.path)!r}: holds {len(rows)} studies, must be 1; give a file that 'run' made"
            )
        self._study_id = int(rows[0][0])
        revision = connection.execute("SELECT version_num FROM alembic_version").fetchone()
        self._direct = revision is not None and revision[0] in known_schemas
        connection.execute("PRAGMA journal_mode = WAL")
        # Not only a killed process but a power cut, too, keeps what was acknowledged.
        connection.execute("PRAGMA synchronous = FULL")

    def __enter__(self) -> "Store":
        return self

    def __exit__(self, *exception: object) -> None:
        """Close; the log is folded into the file, so that a study at rest is one file."""
        try:
            self._connection.execute("PRAGMA wal_checkpoint(TRUNCATE)")
            self._connection.execute("PRAGMA journal_mode = DELETE")
        except sqlite3.Error:
            # A reader is still there, or the disk is full: then the log stays beside the file, as good.
            pass
        finally:
            self._connection.close()

    def set_meta(self, values: Mapping[str, Any]) -> None:
        """Replace what is known about the study under some keys."""
        with translated(self.path), _transaction(self._connection):
            rows = [(key, _strict(value)) for key, value in values.items()]
            self._connection.executemany("INSERT OR REPLACE INTO monoped_meta VALUES (?, ?)", rows)

    def set_audits(self, audits: Sequence[tuple[int, bool, Mapping[str, Any]]]) -> None:
        """Store audits of trials: number, whether it is well-conditioned, the audit's measures."""
        with translated(self.path), _transaction(self._connection):
            rows = [(trial, int(good), json.dumps(dict(measures))) for trial, good, measures in audits]
            self._connection.executemany("INSERT OR REPLACE INTO monoped_audits VALUES (?, ?, ?)", rows)

    def add(self, generation: Generation) -> None:
        """Store a generation; when this returns, its trials are safe.

        Raises:
            DatabaseError: the disk is full, or the file cannot be written.
        """
        with translated(self.path):
            if not self._direct:
                self._add_by_optuna(generation)
            with _transaction(self._connection):
                if self._direct:
                    self._add_to_optuna_tables(generation)
                self._add_to_our_tables(generation)

    def _add_to_our_tables(self, generation: Generation) -> None:
        execute, executemany = self._connection.execute, self._connection.executemany
        evaluations, judgement = generation.evaluations, generation.judgement
        n = len(generation.designs)
        columns = [
            range(generation.first_trial, generation.first_trial + n),
            [generation.number] * n,
            judgement.state.tolist(),
            evaluations.status.tolist(),
            judgement.reason,
            judgement.violation.tolist(),
            [generation.height_weight] * n,
            *generation.designs.T.tolist(),
            *(getattr(evaluations, name).tolist() for name in MEASURES),
        ]
        names = ("trial", "generation", "state", "status", "reason", "violation", "height_weight", *NAMES, *MEASURES)
        executemany(
            f"INSERT INTO monoped_trials ({', '.join(names)}) VALUES ({', '.join('?' * len(names))})",
            zip(*columns, strict=True),
        )
        total = generation.first_trial + n
        execute(
            "INSERT OR REPLACE INTO monoped_history VALUES (?, ?, ?, ?)",
            (generation.number, total, generation.hypervolume, generation.seconds),
        )
        if generation.state is not None:
            execute(
                "UPDATE monoped_checkpoint SET generation = ?, told = ?, state = ?",
                (generation.number + 1, total, _strict(generation.state)),
            )

    def _add_to_optuna_tables(self, generation: Generation) -> None:
        executemany = self._connection.executemany
        evaluations, judgement = generation.evaluations, generation.judgement
        n = len(generation.designs)
        numbers = range(generation.first_trial, generation.first_trial + n)
        # One study a file and no other writer: Optuna's primary key is the trial's number plus one.
        ids = [number + 1 for number in numbers]
        failed = (judgement.state == "failed").tolist()
        started, ended = (
            t.astimezone(UTC).replace(tzinfo=None).isoformat(" ") for t in (generation.started, generation.ended)
        )
        executemany(
            "INSERT INTO trials (trial_id, number, study_id, state, datetime_start, datetime_complete) "
            "VALUES (?, ?, ?, ?, ?, ?)",
            [
                (i, number, self._study_id, "FAIL" if bad else "COMPLETE", started, ended)
                for i, number, bad in zip(ids, numbers, failed, strict=True)
            ],
        )
        executemany(
            "INSERT INTO trial_params (trial_id, param_name, param_value, distribution_json) VALUES (?, ?, ?, ?)",
            [
                (i, NAMES[k], row[k], self._distributions[NAMES[k]])
                for i, row in zip(ids, generation.designs.tolist(), strict=True)
                for k in self._free
            ],
        )
        objectives = zip(ids, failed, evaluations.height_m.tolist(), evaluations.energy_j.tolist(), strict=True)
        executemany(
            "INSERT INTO trial_values (trial_id, objective, value, value_type) VALUES (?, ?, ?, 'FINITE')",
            [(i, k, v) for i, bad, *values in objectives if not bad for k, v in enumerate(values)],
        )
        # The list under one key is the form that both Optuna and its dashboard read.
        executemany(
            "INSERT INTO trial_system_attributes (trial_id, key, value_json) VALUES (?, 'constraints', ?)",
            [(i, json.dumps(row)) for i, row in zip(ids, judgement.constraints.tolist(), strict=True)],
        )
        executemany(
            "INSERT INTO trial_user_attributes (trial_id, key, value_json) VALUES (?, ?, ?)",
            [
                (i, key, json.dumps(value))
                for k, i in enumerate(ids)
                for key, value in _attributes(generation, k).items()
            ],
        )

    def _add_by_optuna(self, generation: Generation) -> None:
        """Let Optuna write trials into a schema that is not known here.

        That is a transaction a trial, so a kill may leave trials that our checkpoint does not know yet. They come
        again, the same, after a resume; then they are not added twice.
        """
        import optuna

        storage = _optuna_storage(self.path)
        try:
            there = storage.get_n_trials(self._study_id)
            for k in range(max(0, there - generation.first_trial), len(generation.designs)):
                bad = generation.judgement.state[k] == "failed"
                row = generation.designs[k].tolist()
                storage.create_new_trial(
                    self._study_id,
                    optuna.trial.create_trial(
                        state=optuna.trial.TrialState.FAIL if bad else optuna.trial.TrialState.COMPLETE,
                        params={NAMES[i]: row[i] for i in self._free},
                        distributions={
                            name: optuna.distributions.json_to_distribution(text)
                            for name, text in self._distributions.items()
                        },
                        values=None
                        if bad
                        else [float(generation.evaluations.height_m[k]), float(generation.evaluations.energy_j[k])],
                        system_attrs={"constraints": generation.judgement.constraints[k].tolist()},
                        user_attrs=_attributes(generation, k),
                    ),
                )
        finally:
            storage.remove_session()
            storage.engine.dispose()


def _strict(value: Any) -> str:
    """JSON that any reader takes: no NaN, no infinity."""
    return json.dumps(value, allow_nan=False)


def _attributes(generation: Generation, k: int) -> dict[str, Any]:
    """What Optuna's dashboard shows of a trial besides its values."""
    attributes: dict[str, Any] = {}
    if generation.judgement.reason[k]:
        attributes["status"] = str(generation.evaluations.status[k])
        attributes["reason"] = generation.judgement.reason[k]
    if generation.height_weight is not None:
        attributes["height_weight"] = generation.height_weight
    return attributes


class _transaction:  # noqa: N801
    """BEGIN IMMEDIATE ... COMMIT, or ROLLBACK; a commit that fails rolls back, too."""

    def __init__(self, connection: sqlite3.Connection) -> None:
        self._connection = connection

    def __enter__(self) -> None:
        self._connection.execute("BEGIN IMMEDIATE")

    def __exit__(self, kind: type[BaseException] | None, *rest: object) -> None:
        try:
            if kind is None:
                self._connection.execute("COMMIT")
        finally:
            if self._connection.in_transaction:
                self._connection.execute("ROLLBACK")
