"""Optuna's own tables: what Optuna and its dashboard show of a study."""

import json
import warnings
from collections.abc import Collection, Mapping, Sequence
from datetime import UTC
from typing import Any

from pareto_monoped.definition.study import Study
from pareto_monoped.design import ALL_NAMES
from pareto_monoped.search.scoring import values_of
from pareto_monoped.search.space import Coordinates
from pareto_monoped.storage.base import Storage
from pareto_monoped.storage.columns import Generation
from pareto_monoped.storage.connection import Connection
from pareto_monoped.storage.seals import row_digest

KNOWN_SCHEMAS = ("v3.2.0.a",)
"""Revisions of Optuna's schema that are written directly. For any other, Optuna writes its tables itself."""

_KEYS = {
    "trials": "trial_id",
    "trial_params": "param_id",
    "trial_values": "trial_value_id",
    "trial_system_attributes": "trial_system_attribute_id",
    "trial_user_attributes": "trial_user_attribute_id",
}
"""Primary keys of these tables; their rows were written in this order."""

_WRITTEN = {
    "trials": ("trial_id", "number", "study_id", "state", "datetime_start", "datetime_complete"),
    "trial_params": ("trial_id", "param_name", "param_value", "distribution_json"),
    "trial_values": ("trial_id", "objective", "value", "value_type"),
    "trial_system_attributes": ("trial_id", "key", "value_json"),
    "trial_user_attributes": ("trial_id", "key", "value_json"),
}
"""Optuna's tables that trials are written into, and the columns that are; the database numbers the others."""

OURS = "monoped:trial"
"""Key of our number in a trial that Optuna writes for us, which tells it from trials of an Optuna user."""
_OF_TRIALS = ("trial_params", "trial_values", "trial_system_attributes", "trial_user_attributes")
_OF_OTHERS = ("trial_intermediate_values", "trial_heartbeats")


def trial_ids(connection: Connection) -> dict[int, int]:
    """Read the key of each trial by Optuna's number, of which Optuna has no index: a search for each reads all."""
    return dict(connection.execute("SELECT number, trial_id FROM trials ORDER BY number").fetchall())


def require_columns(connection: Connection) -> None:
    """Ask for every column that trials are written into, so that a damaged schema is refused before anything is."""
    for table, columns in _WRITTEN.items():
        connection.execute(f"SELECT {', '.join(columns)} FROM {table} LIMIT 0").fetchall()


def drop_trials(connection: Connection, foreign: Sequence[int]) -> None:
    """Delete Optuna's trials of these numbers, and number the others from 0 on, as Optuna would have."""
    known = trial_ids(connection)
    ids = [{"id": known.pop(n)} for n in foreign]
    for table in (*_OF_TRIALS, *_OF_OTHERS, "trials"):
        connection.executemany(f"DELETE FROM {table} WHERE trial_id = :id", ids)
    connection.executemany(
        "UPDATE trials SET number = :number WHERE trial_id = :id",
        [{"number": n, "id": i} for n, i in enumerate(known.values())],
    )


def stored_digest(connection: Connection, ids: Collection[int]) -> str:
    """Compute the digest that ``OptunaTables.insert`` gave of a whole generation from what is stored of it now."""
    rows = []
    for table, columns in _WRITTEN.items():
        found = connection.execute(
            f"SELECT {', '.join(columns)} FROM {table} "
            f"WHERE trial_id BETWEEN :first AND :last ORDER BY trial_id, {_KEYS[table]}",
            {"first": min(ids), "last": max(ids)},
        )
        # The keys of a generation follow one another, but for those of trials that somebody has put in between.
        rows.append([row for row in found if row[0] in ids])
    return _digest(rows)


_OF_STUDY = {
    "alembic_version": "SELECT * FROM alembic_version",
    "version_info": "SELECT * FROM version_info",
    "studies": "SELECT * FROM studies ORDER BY study_id",
    "study_directions": "SELECT * FROM study_directions ORDER BY study_direction_id",
}


def study_digests(connection: Connection) -> dict[str, str]:
    """Compute digests of what Optuna's tables say of the study itself: per table, and per attribute of the study."""
    rows: dict[str, list[Any]] = {table: connection.execute(sql).fetchall() for table, sql in _OF_STUDY.items()}
    for kind in ("user", "system"):
        for row in connection.execute(f"SELECT * FROM study_{kind}_attributes"):
            rows[f"study_{kind}_attributes {row[2]}"] = [row]
    return {name: row_digest(found) for name, found in rows.items()}


def _digest(rows: list[list[Any]]) -> str:
    """Compute the digest of rows of the tables of ``_WRITTEN``; all trials have the same distributions."""
    trials, params, *others = rows
    distributions = sorted({(name, text) for _, name, _, text in params})
    return row_digest([trials, [row[:3] for row in params], distributions, *others])


def create_tables(draft: Storage, study: Study, attributes: Mapping[str, Any]) -> None:
    """Let Optuna create a new database with an empty study and its user attributes, JSON values."""
    with warnings.catch_warnings():
        # In a notebook without ipywidgets, Optuna's progress bar warns of itself; it is not used here.
        warnings.filterwarnings("ignore", message="IProgress not found")
        import optuna

    verbosity = optuna.logging.get_verbosity()
    optuna.logging.set_verbosity(optuna.logging.WARNING)
    try:
        storage = draft.optuna_storage()
        try:
            study_id = storage.create_new_study(
                [
                    optuna.study.StudyDirection.MAXIMIZE if sign < 0.0 else optuna.study.StudyDirection.MINIMIZE
                    for sign in study.objectives.signs
                ],
                study.name,
            )
            # This is what optuna.study.Study.set_metric_names writes; calling it would warn that it is experimental.
            storage.set_study_system_attr(study_id, "study:metric_names", list(study.objectives.names))
            for key, value in attributes.items():
                storage.set_study_user_attr(study_id, key, value)
        finally:
            storage.remove_session()
            storage.engine.dispose()
    finally:
        optuna.logging.set_verbosity(verbosity)


class OptunaTables:
    """Writes trials into an existing study: directly if the schema is known, otherwise by Optuna's public call."""

    def __init__(self, storage: Storage, study_id: int, coordinates: Coordinates) -> None:
        study = coordinates.study
        self._storage = storage
        self._study_id = study_id
        self._objectives = study.objectives
        self._free = [i for i, name in enumerate(study.names) if name in study.free]
        limits = {name: coordinates.limits(name) for name in study.free}
        # Optuna stores them with each parameter of each trial, half of a database; it reads this shorter form, too
        # (optuna.distributions.json_to_distribution).
        distributions: dict[str, dict[str, Any]] = {
            name: {"type": "float", "low": low, "high": high} for name, (low, high) in limits.items()
        }
        # Optuna stores the position of a category, and shows the category itself.
        self._motors: dict[str, tuple[str, ...]] = {
            choice.name: tuple(motor.name for motor in choice.motors) for choice in coordinates.space.choices
        }
        distributions |= {name: {"type": "categorical", "choices": motors} for name, motors in self._motors.items()}
        self._distributions = {
            name: json.dumps(distribution, separators=(",", ":")) for name, distribution in distributions.items()
        }

    def insert(self, connection: Connection, generation: Generation) -> dict[str, dict[str, str]]:
        """Insert a generation's rows within the open transaction, and return what the running hash has of them.

        That is their digest, and Optuna's number of the first trial where it is not ours, because of an Optuna user.
        """
        rows, first = self._rows(connection, generation)
        for table, columns in _WRITTEN.items():
            connection.insert(table, columns, rows[table])
        key = str(generation.first_trial)
        sealed = {"optuna": {key: _digest(list(rows.values()))}}
        return sealed if first == generation.first_trial else {**sealed, "optuna_first": {key: str(first)}}

    def _rows(self, connection: Connection, generation: Generation) -> tuple[dict[str, list[Any]], int]:
        """Return the rows of each table of ``_WRITTEN``, and Optuna's number of the first trial."""
        # Optuna's numbers and primary keys are ours, and one more, unless an Optuna user has added trials. It numbers
        # trials by their keys, so the last key has the last number; to look for that would be to read all trials.
        first, last_id = connection.execute(
            "SELECT number + 1, trial_id FROM trials ORDER BY trial_id DESC LIMIT 1"
        ).fetchone() or (0, 0)
        count = len(generation.designs)
        first_id = connection.trial_ids_after(last_id, count)
        ids = range(first_id, first_id + count)
        failed = (generation.judgement.state == "failed").tolist()
        started, ended = (
            t.astimezone(UTC).replace(tzinfo=None).isoformat(" ") for t in (generation.started, generation.ended)
        )
        values = values_of(generation.evaluations, self._objectives).tolist()
        numbers = zip(ids, range(first, first + len(ids)), failed, strict=True)
        rows: dict[str, list[Any]] = {
            "trials": [(i, n, self._study_id, "FAIL" if bad else "COMPLETE", started, ended) for i, n, bad in numbers],
            "trial_params": self._parameter_rows(generation, ids),
            "trial_values": [
                (i, m, v, "FINITE")
                for i, bad, row in zip(ids, failed, values, strict=True)
                if not bad
                for m, v in enumerate(row)
            ],
            # Both Optuna and its dashboard read the constraints as one list under this key.
            "trial_system_attributes": [
                (i, "constraints", text)
                for i, text in zip(ids, _json_rows(generation.judgement.constraints.tolist()), strict=True)
            ],
            "trial_user_attributes": [
                (i, key, json.dumps(value))
                for k, i in enumerate(ids)
                for key, value in _attributes(generation, k).items()
            ],
        }
        return rows, first

    def _parameter_rows(self, generation: Generation, ids: Sequence[int]) -> list[tuple[Any, ...]]:
        """Return rows of the table of parameters, those of one trial after the other; motors by their positions."""
        names = [*(ALL_NAMES[i] for i in self._free), *self._motors]
        columns = generation.designs[:, self._free].T.tolist()
        columns += [[float(motors.index(name)) for name in generation.motors[n]] for n, motors in self._motors.items()]
        pairs = [(name, self._distributions[name]) for name in names]
        return [
            (i, name, value, text)
            for i, *row in zip(ids, *columns, strict=True)
            for (name, text), value in zip(pairs, row, strict=True)
        ]

    def _parameters(self, generation: Generation, k: int) -> dict[str, Any]:
        """Return the free variables of trial ``k``, and its motors by name."""
        row = generation.designs[k].tolist()
        values: dict[str, Any] = {ALL_NAMES[i]: row[i] for i in self._free}
        return values | {choice: generation.motors[choice][k] for choice in self._motors}

    def add_by_optuna(self, generation: Generation) -> None:
        """Let Optuna write the trials into a schema that is not known here.

        Optuna commits each trial on its own, so a kill may leave trials that our checkpoint does not know yet. When
        they come again after a resume, they are skipped.
        """
        import optuna

        storage = self._storage.optuna_storage()
        try:
            there: set[Any] = set()
            if storage.get_n_trials(self._study_id) > generation.first_trial:
                there = {trial.system_attrs.get(OURS) for trial in storage.get_all_trials(self._study_id)}
            for k in range(len(generation.designs)):
                if generation.first_trial + k in there:
                    continue
                bad = generation.judgement.state[k] == "failed"
                storage.create_new_trial(
                    self._study_id,
                    optuna.trial.create_trial(
                        state=optuna.trial.TrialState.FAIL if bad else optuna.trial.TrialState.COMPLETE,
                        params=self._parameters(generation, k),
                        distributions={
                            name: optuna.distributions.json_to_distribution(text)
                            for name, text in self._distributions.items()
                        },
                        values=None if bad else values_of(generation.evaluations, self._objectives)[k].tolist(),
                        system_attrs={
                            "constraints": generation.judgement.constraints[k].tolist(),
                            OURS: generation.first_trial + k,
                        },
                        user_attrs=_attributes(generation, k),
                    ),
                )
        finally:
            storage.remove_session()
            storage.engine.dispose()


def _json_rows(rows: list[list[float]]) -> list[str]:
    """Return the JSON text of each of n lists of numbers, made at once, which is many times as fast."""
    return [f"[{text}]" for text in json.dumps(rows, separators=(",", ":"))[2:-2].split("],[")]


def _attributes(generation: Generation, k: int) -> dict[str, Any]:
    """Return what Optuna's dashboard shows of trial ``k`` besides its values."""
    attributes: dict[str, Any] = {}
    if generation.judgement.reason[k]:
        attributes["status"] = str(generation.evaluations.status[k])
        attributes["reason"] = generation.judgement.reason[k]
    if generation.height_weight is not None:
        attributes["height_weight"] = generation.height_weight
    return attributes
