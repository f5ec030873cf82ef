"""Optuna's own tables: what Optuna and its dashboard show of a study."""

import json
import sqlite3
from collections.abc import Mapping
from datetime import UTC
from pathlib import Path
from typing import Any

from pareto_monoped.design import NAMES
from pareto_monoped.study.definition import Study
from pareto_monoped.study.generation import Generation
from pareto_monoped.study.motor_choice import AnyCoordinates, MotorCoordinates
from pareto_monoped.study.protocol import MOTOR
from pareto_monoped.study.scoring import values_of

KNOWN_SCHEMAS = ("v3.2.0.a",)
"""Revisions of Optuna's schema that are written directly. For any other, Optuna writes its tables itself."""


def create_tables(path: Path, study: Study, attributes: Mapping[str, Any]) -> None:
    """Let Optuna create a new database with an empty study.

    Args:
        path: where; must not exist.
        study: gives the name.
        attributes: the study's user attributes, JSON values.
    """
    import optuna

    verbosity = optuna.logging.get_verbosity()
    optuna.logging.set_verbosity(optuna.logging.WARNING)
    try:
        storage = _optuna_storage(path)
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
        storage.remove_session()
        storage.engine.dispose()
    finally:
        optuna.logging.set_verbosity(verbosity)


def _optuna_storage(path: Path) -> Any:
    import optuna
    from sqlalchemy.engine import URL

    # In a plain "sqlite:///..." text, a question mark or percent sign in the path would get a meaning.
    url = URL.create("sqlite", database=str(path)).render_as_string(hide_password=False)
    return optuna.storages.RDBStorage(url)


class OptunaTables:
    """Writes trials into an existing study: directly if the schema is known, otherwise by Optuna's public call."""

    def __init__(self, path: Path, study_id: int, coordinates: AnyCoordinates) -> None:
        study = coordinates.study
        self._path = path
        self._study_id = study_id
        self._objectives = study.objectives
        self._free = [i for i, name in enumerate(NAMES) if name in study.free]
        limits = {name: coordinates.limits(name) for name in study.free}
        self._distributions = {
            name: json.dumps(
                {
                    "name": "FloatDistribution",
                    "attributes": {"step": None, "low": low, "high": high, "log": False},
                }
            )
            for name, (low, high) in limits.items()
        }
        # Optuna stores the position of a category, and shows the category itself.
        self._motors: tuple[str, ...] = ()
        if isinstance(coordinates, MotorCoordinates):
            self._motors = coordinates.motors
            self._distributions[MOTOR] = json.dumps(
                {"name": "CategoricalDistribution", "attributes": {"choices": self._motors}}
            )

    def insert(self, connection: sqlite3.Connection, generation: Generation) -> None:
        """Insert a generation's rows within the transaction that the connection has open."""
        executemany = connection.executemany
        evaluations, judgement = generation.evaluations, generation.judgement
        n = len(generation.designs)
        numbers = range(generation.first_trial, generation.first_trial + n)
        # With one study per file and no other writer, Optuna's primary key is the number of the trial plus one.
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
                (i, name, value, self._distributions[name])
                for k, i in enumerate(ids)
                for name, value in self._parameters(generation, k, position=True).items()
            ],
        )
        objectives = zip(ids, failed, values_of(evaluations, self._objectives).tolist(), strict=True)
        executemany(
            "INSERT INTO trial_values (trial_id, objective, value, value_type) VALUES (?, ?, ?, 'FINITE')",
            [(i, k, v) for i, bad, values in objectives if not bad for k, v in enumerate(values)],
        )
        # Both Optuna and its dashboard read the constraints as one list under this key.
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

    def _parameters(self, generation: Generation, k: int, *, position: bool = False) -> dict[str, Any]:
        """Free variables of trial ``k``; its motor by name, or by its position as in the tables."""
        row = generation.designs[k].tolist()
        values: dict[str, Any] = {NAMES[i]: row[i] for i in self._free}
        if self._motors:
            name = generation.motors[k]
            values[MOTOR] = float(self._motors.index(name)) if position else name
        return values

    def add_by_optuna(self, generation: Generation) -> None:
        """Let Optuna write the trials into a schema that is not known here.

        Optuna commits each trial on its own, so a kill may leave trials that our checkpoint does not know yet. After a
        resume the same trials come again; those that are already there are skipped.
        """
        import optuna

        storage = _optuna_storage(self._path)
        try:
            there = storage.get_n_trials(self._study_id)
            for k in range(max(0, there - generation.first_trial), len(generation.designs)):
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
                        system_attrs={"constraints": generation.judgement.constraints[k].tolist()},
                        user_attrs=_attributes(generation, k),
                    ),
                )
        finally:
            storage.remove_session()
            storage.engine.dispose()


def _attributes(generation: Generation, k: int) -> dict[str, Any]:
    """What Optuna's dashboard shows of trial ``k`` besides its values."""
    attributes: dict[str, Any] = {}
    if generation.judgement.reason[k]:
        attributes["status"] = str(generation.evaluations.status[k])
        attributes["reason"] = generation.judgement.reason[k]
    if generation.height_weight is not None:
        attributes["height_weight"] = generation.height_weight
    return attributes
