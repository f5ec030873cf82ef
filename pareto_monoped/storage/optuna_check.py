"""Compare Optuna's tables with ours; find and drop the trials that an Optuna user has added to a study."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from pareto_monoped.definition.study import Study
from pareto_monoped.errors import DatabaseError
from pareto_monoped.storage.connection import Connection, Rows
from pareto_monoped.storage.optuna_tables import OURS, stored_digest, study_digests, trial_ids
from pareto_monoped.storage.place import StudyPlace, storage_of
from pareto_monoped.storage.reader import StudyData, read_study
from pareto_monoped.storage.seals import BY_OPTUNA, OPTUNA_STUDY, Seals, read_seals
from pareto_monoped.storage.store import Store


def optuna_numbers(connection: Connection, count: int, seals: Seals | None) -> list[int]:
    """Return Optuna's numbers of a study's ``count`` trials; they are not ours where an Optuna user has added trials.

    Trials written directly are numbered on from the first of their generation, which the running hash has where it
    differs. Those that Optuna has written for us carry our number.
    """
    numbers = np.arange(count)
    if seals is not None:
        changed = sorted((int(ours), int(number)) for ours, number in seals.written.get("optuna_first", {}).items())
        for ours, number in changed:
            numbers[ours:] = number + np.arange(count - ours)
    rows = connection.execute(
        "SELECT value_json, number FROM trial_system_attributes JOIN trials USING (trial_id) WHERE key = :key",
        {"key": OURS},
    )
    for text, number in rows:
        if text.isdigit() and int(text) < count:
            numbers[int(text)] = number
    return [int(number) for number in numbers]


def foreign_trials(connection: Connection, count: int, seals: Seals | None) -> tuple[int, ...]:
    """Return Optuna's numbers of the trials that are not among the study's ``count``."""
    ours = set(optuna_numbers(connection, count, seals))
    return tuple(n for (n,) in connection.execute("SELECT number FROM trials ORDER BY number") if n not in ours)


def optuna_findings(connection: Connection, data: StudyData, seals: Seals | None) -> list[str]:
    """Return what Optuna's tables say otherwise than ours; one line per kind, with the first trial that has it."""
    numbers = optuna_numbers(connection, len(data.trials), seals)
    findings = list(_study_findings(connection, data.study))
    if not findings and seals is not None:
        findings += _attribute_findings(connection, seals.written.get(OPTUNA_STUDY, {}))
    findings += _trial_findings(connection, data, numbers)
    if not findings and seals is not None:
        # Equal in what both hold; dates, constraints and attributes stand in Optuna's tables alone.
        findings += _digest_findings(connection, numbers, seals)
    return findings


def _study_findings(connection: Connection, study: Study) -> Iterator[str]:
    names = [name for (name,) in connection.execute("SELECT study_name FROM studies")]
    if names != [study.name]:
        yield f"Optuna's name of the study is {', '.join(map(repr, names))}, ours {study.name!r}"
    wanted = ["MAXIMIZE" if sign < 0.0 else "MINIMIZE" for sign in study.objectives.signs]
    rows = connection.execute("SELECT direction FROM study_directions ORDER BY objective").fetchall()
    if [direction for (direction,) in rows] != wanted:
        yield "Optuna's directions of the objectives are not ours"


def _attribute_findings(connection: Connection, sealed: Mapping[str, str]) -> Iterator[str]:
    """Yield what Optuna's tables say otherwise of the study itself than when it was created, but for additions."""
    found = study_digests(connection)
    different = [name for name, digest in sealed.items() if found.get(name) != digest]
    versions = ("alembic_version", "version_info")
    if all(name in different for name in versions):  # 'optuna storage upgrade' has changed both
        different = [name for name in different if name not in versions]
    for name in different:
        yield f"Optuna's {name} " + ("does not match its hash" if name in found else "is missing")


def _trial_findings(connection: Connection, data: StudyData, numbers: Sequence[int]) -> Iterator[str]:
    place = {number: k for k, number in enumerate(numbers)}
    trials = data.trials
    failed = (trials["state"] == "failed").to_numpy()
    stored, words = ["missing"] * len(numbers), dict[str, str]()  # the same text once, not once per row
    for number, state in connection.execute("SELECT number, state FROM trials"):
        if (k := place.get(number)) is not None:
            stored[k] = words.setdefault(state, state)
    for k, state in enumerate(stored):
        if state != (wanted := "FAIL" if failed[k] else "COMPLETE"):
            yield f"trial {k} is {state} in Optuna's tables, must be {wanted}"
            break
    names = list(data.study.objectives.names)
    values = trials[names].to_numpy(dtype=np.float64)
    rows = connection.execute("SELECT number, objective, value FROM trial_values JOIN trials USING (trial_id)")
    yield from _different("value", rows, place, {m: values[:, m] for m in range(len(names))}, ~failed)
    wanted_params: dict[Any, Any] = {n: trials[n].to_numpy(dtype=np.float64) for n in data.study.free}
    for choice, motors in data.motor_choices.items():
        wanted_params[choice] = np.array([motors.index(name) for name in trials[choice]], dtype=np.float64)
    rows = connection.execute("SELECT number, param_name, param_value FROM trial_params JOIN trials USING (trial_id)")
    yield from _different("parameter", rows, place, wanted_params, np.ones(len(trials), dtype=bool))


def _different(
    what: str,
    rows: Rows,
    place: dict[int, int],
    wanted: dict[Any, Any],
    present: "np.typing.NDArray[np.bool_]",
) -> Iterator[str]:
    """Yield the first of some values (number, key, value) that is not the wanted one, or is missing."""
    counts = np.zeros(len(present), dtype=np.int64)
    for number, key, value in rows:
        k = place.get(number)
        if k is None:
            continue
        counts[k] += 1
        if key not in wanted or not present[k] or value != wanted[key][k]:
            yield f"trial {k} has another {what} {key!r} in Optuna's tables: {value!r}"
            return
    lacking = np.flatnonzero(counts != len(wanted) * present)
    if len(lacking):
        yield f"trial {lacking[0]} lacks a {what} in Optuna's tables"


def sealed_generations(seals: Seals) -> dict[int, int]:
    """Return first trial -> number of trials of all generations whose rows in Optuna's tables have a digest."""
    digests = {int(first): digest for first, digest in seals.written.get("optuna", {}).items()}
    firsts = sorted(digests)
    ends = zip(firsts, [*firsts[1:], seals.trials], strict=True)
    return {first: end - first for first, end in ends if digests[first] != BY_OPTUNA}


def _digest_findings(connection: Connection, numbers: Sequence[int], seals: Seals) -> Iterator[str]:
    sealed, ids = seals.written.get("optuna", {}), trial_ids(connection)
    for first, count in sealed_generations(seals).items():
        end = first + count
        # Each trial is there: that was looked at before.
        theirs = {ids[number] for number in numbers[first:end]}
        if end > len(numbers) or stored_digest(connection, theirs) != sealed[str(first)]:
            yield f"trials {first} to {end - 1} do not match their hash in Optuna's tables"
            return


def repair(db: StudyPlace) -> tuple[int, ...]:
    """Drop foreign trials from Optuna's tables, number the others from 0 on, and return the dropped numbers.

    Nothing is changed in a study that is in use or damaged.
    """
    read_study(db)
    with storage_of(db).locked():
        data = read_study(db)
        with storage_of(db).reading() as connection:
            seals = read_seals(connection, db) if data.sealed else None
            foreign = foreign_trials(connection, len(data.trials), seals)
            findings = optuna_findings(connection, data, seals)
        if findings:
            raise DatabaseError(f"study database {str(db)!r}: cannot be repaired ({findings[0]}); restore a copy")
        if foreign:
            with Store(db, data.study, coordinates=data.coordinates) as store:
                store.drop_foreign(foreign, sealed_generations(seals) if seals is not None else {})
    return foreign
