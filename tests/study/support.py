"""Studies with plain numbers in place of jumps, for tests of storage that no physics matters to."""

import sqlite3
import subprocess
import tempfile
from contextlib import closing
from datetime import UTC, datetime
from functools import cache
from pathlib import Path

import numpy as np
import pytest

import pareto_monoped
from pareto_monoped.definition import provenance
from pareto_monoped.definition.study import study_from_dict
from pareto_monoped.errors import StudyError
from pareto_monoped.jump.evaluate import Evaluations
from pareto_monoped.measures import MEASURE_NAMES
from pareto_monoped.search.algorithm import Scores
from pareto_monoped.search.registry import make_algorithm
from pareto_monoped.search.scoring import judge
from pareto_monoped.storage.columns import Generation
from pareto_monoped.storage.meta import StudyMeta
from pareto_monoped.storage.optuna_tables import study_digests
from pareto_monoped.storage.place import storage_of
from pareto_monoped.storage.seals import BY_OPTUNA, OPTUNA_STUDY, ROWS, Sealer, row_digests
from pareto_monoped.storage.store import Store, create_database

MINIMAL = {"name": "s", "evaluations": 10}
"""What a study file must have at least."""
CONTENTS = {"motor": {"peak_torque_n_m": 5.5}, "calibration": {"name": "reference"}}


def study_of(**more):
    """A study from a file with the least it needs, and more."""
    return study_from_dict(MINIMAL | more, source="study file 's.toml'")


def assert_refused(change, words):
    """A study file with ``change`` is refused in one line that has all ``words``."""
    with pytest.raises(StudyError) as caught:
        study_of(**change)
    message = str(caught.value)
    assert message.startswith("study file 's.toml'")
    assert "\n" not in message
    for word in words:
        assert word in message


def made_study(**more):
    return study_from_dict({"name": "made", "evaluations": 40} | more, source="test")


def made_evaluations(height_m, energy_j, status=None, seed=0):
    """Evaluations with these heights and energies, and drawn numbers for all other measures."""
    height_m, energy_j = np.asarray(height_m, float), np.asarray(energy_j, float)
    status = np.array(status if status is not None else ["ok"] * len(height_m))
    generator = np.random.default_rng(seed)
    columns = {name: generator.standard_normal(len(height_m)) for name in MEASURE_NAMES}
    columns |= {"height_m": height_m, "energy_j": energy_j}
    for values in columns.values():
        values[status != "ok"] = np.nan
    return Evaluations(status=status, reason=tuple("" if s == "ok" else f"it was {s}" for s in status), **columns)


def made_meta(study):
    versions = provenance.versions(study)
    return StudyMeta(
        study=study.as_dict(),
        motor=study.motor,
        calibration="reference-4",
        seed=study.seed,
        contents=CONTENTS,
        files={"motor": None, "calibration": None},
        versions=versions,
        environment=provenance.environment(),
        hash=provenance.digest(provenance.decisive(study, CONTENTS, versions)),
        probe=[],
        created="2025-01-01T00:00:00+00:00",
        budget=study.evaluations,
        finished=False,
        stop_reason=None,
    )


def made_generation(study, number, first, evaluations, state=None, seed=0, height_weight=None):
    designs = np.random.default_rng([seed, number]).uniform(
        study.lower, study.upper, (len(evaluations.height_m), len(study.lower))
    )
    now = datetime(2025, 1, 1, tzinfo=UTC)
    return Generation(
        number=number,
        first_trial=first,
        designs=designs,
        evaluations=evaluations,
        judgement=judge(evaluations, study.constraints, study.objectives),
        height_weight=height_weight,
        state=state,
        hypervolume=float(number),
        seconds=float(number) + 0.5,
        started=now,
        ended=now,
    )


def made_database(path, generations=None, study=None, **options):
    """A study database; returns the study and the stored generations.

    Default: two generations with feasible, infeasible and failed trials.
    """
    study = study or made_study()
    create_database(path, study, made_meta(study), make_algorithm(study).state())
    if generations is None:
        generations = [
            made_generation(
                study,
                0,
                0,
                made_evaluations(
                    [0.8, 0.52, np.nan, 1.1], [9.0, 1.0, np.nan, 30.0], ["ok", "ok", "diverged", "ok"], seed=1
                ),
                state={"after": 0},
            ),
            made_generation(
                study, 1, 4, made_evaluations([0.7, 0.9], [8.0, 40.0], seed=2), state={"after": 1}, height_weight=0.25
            ),
        ]
    with Store(path, study, **options) as store:
        for generation in generations:
            store.add(generation)
    return study, generations


def copied_database(place):
    """What ``made_database`` makes by default, in a new place, copied from one that this process made; the study.

    To make one takes a twentieth of a second in a file, and a fifth on a server: tests of what is done with a study
    need not wait for that, tests of how one is made do.
    """
    if isinstance(place, Path):
        place.write_bytes(_made_file())
    else:
        import psycopg

        with closing(psycopg.connect(place.conninfo, autocommit=True)) as connection:
            connection.execute(_made_on_server(place.of_schema(_COPIED)).replace(_COPIED, place.schema))
    return made_study()


_COPIED = "copied_from_here"


@cache
def _made_file():
    with tempfile.TemporaryDirectory() as folder:
        made_database(Path(folder) / "s.db")
        return (Path(folder) / "s.db").read_bytes()


@cache
def _made_on_server(place):
    """PostgreSQL's own dump of a study on the server, as statements."""
    from tests.storage.server.cluster import programs

    made_database(place)
    dump = [programs() / "pg_dump", "--inserts", "--schema", _COPIED, "--dbname", place.conninfo]
    text = subprocess.run(dump, capture_output=True, text=True, check=True).stdout
    # Lines with a backslash are for psql.
    return "".join(line for line in text.splitlines(keepends=True) if not line.startswith("\\"))


def change(path, *statements):
    """Change a database by SQL behind the package's back."""
    connection = sqlite3.connect(path)
    for statement in statements:
        connection.execute(statement)
    connection.commit()
    connection.close()


UNSEALED = (
    "DROP TABLE monoped_seals",
    "DROP TABLE monoped_front",
    "UPDATE monoped_meta SET value = '1' WHERE key = 'format'",
    f"UPDATE monoped_meta SET value = replace(value, '{pareto_monoped.__version__}', '0.2.0') WHERE key = 'versions'",
)
"""Statements that make a study one of version 0.2.0, which has no running hash: what else refuses it is then seen."""


def reseal(path):
    """Compute the running hash of a study anew, as somebody who knows this code can after editing rows."""
    with closing(storage_of(path).connect()) as connection, connection.transaction():
        names = connection.columns("monoped_trials")
        rows = connection.execute("SELECT * FROM monoped_trials ORDER BY trial").fetchall()
        connection.execute("DELETE FROM monoped_seals")
        written = {table: row_digests(connection.execute(sql)) for table, sql in ROWS.items()}
        written |= {OPTUNA_STUDY: study_digests(connection), "optuna": {"0": BY_OPTUNA}}
        Sealer(connection).add(written, 0, names, dict(zip(names, zip(*rows, strict=True), strict=True)))


def search_among_motors(study, coordinates, best, generations=6, algorithm=None):
    """Coordinates that an algorithm asks for, and their scores: ``best`` motors gain, and a plane decides the rest."""
    algorithm = algorithm or make_algorithm(study, coordinates)
    history = []
    for _ in range(generations):
        proposal = algorithm.ask()
        if proposal is None:
            break
        values, motors = proposal.values, len(best)
        height = 1.0 + values[:, 0] + (values[:, -motors:] == best).sum(axis=1)
        scores = Scores(
            objectives=study.objectives,
            values=np.column_stack((height, 1.0 + values[:, 1:-motors].sum(axis=1))),
            violation=np.zeros(len(values)),
            constraints=np.zeros((len(values), 0)),
        )
        algorithm.tell(scores)
        history.append((values, scores))
    return algorithm, history
