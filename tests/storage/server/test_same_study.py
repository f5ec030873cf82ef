"""On a server a study has what it has in a file, to the last bit; Optuna and our other commands read it there."""

import numpy as np
import pytest

from pareto_monoped.analysis.verify import require_sound, verify
from pareto_monoped.definition.study import study_from_dict
from pareto_monoped.errors import DatabaseError
from pareto_monoped.storage.front_reader import read_front
from pareto_monoped.storage.place import place_of, storage_of
from pareto_monoped.storage.reader import read_study
from pareto_monoped.storage.seals import ROWS
from pareto_monoped.storage.status import status
from pareto_monoped.study.run import resume, run, run_second
from tests.study.same import assert_same_study
from tests.study.support import copied_database, made_database, made_evaluations, made_generation, made_study

pytest.importorskip("psycopg", reason="the extra postgres is not installed")

SMALL = {"name": "s", "evaluations": 30, "strength": False}
ALGORITHMS = [
    {"name": "nsga2", "population": 10},
    {"name": "surrogate", "population": 10, "drawn_generations": 1},
    {"name": "weighted_cmaes", "height_weights": [0.3, 0.7], "iterations": 3},
]


def rows_of(place, query):
    with storage_of(place).reading() as connection:
        return [tuple(row) for row in connection.execute(query)]


@pytest.mark.parametrize(
    "options",
    [{}, pytest.param({"known_schemas": ()}, marks=pytest.mark.long)],
    ids=["direct", "by Optuna's public call"],
)
def test_same_rows_and_running_hash(tmp_path, place, options):
    made_database(tmp_path / "s.db", **options)
    made_database(place, **options)
    for query in [*ROWS.values(), "SELECT * FROM monoped_trials ORDER BY trial"]:
        assert rows_of(place, query) == rows_of(tmp_path / "s.db", query), query
    if not options:  # Optuna notes the time of its own call
        chain = "SELECT link, first, columns, trials, written, hash FROM monoped_seals ORDER BY link"
        assert rows_of(place, chain) == rows_of(tmp_path / "s.db", chain)
    # Numbers drawn for measures are not plausible ones; what else is checked finds nothing.
    assert verify(place).findings == verify(tmp_path / "s.db").findings


OTHERS = [pytest.param(one, marks=pytest.mark.long) for one in ALGORITHMS[1:3]]  # the last has a column of its own


@pytest.mark.parametrize("algorithm", [ALGORITHMS[0], *OTHERS], ids=lambda algorithm: algorithm["name"])
def test_same_study(tmp_path, place, algorithm):
    study = study_from_dict(SMALL | {"algorithm": algorithm}, source="test")
    for db in (tmp_path / "s.db", place):
        run(study, db, evaluations=15)
        resume(db, evaluations=30)
    assert_same_study(tmp_path / "s.db", place)
    require_sound(place, verify(place, simulate=5))
    assert read_front(place).rows.equals(read_front(tmp_path / "s.db").rows)
    here, there = status(tmp_path / "s.db"), status(place)
    timed = {"created", "database", "wall_time_s", "evaluations_per_second"}
    assert {key: there[key] for key in there.keys() - timed} == {key: here[key] for key in here.keys() - timed}


def test_minus_zero_and_nan_come_back_as_from_a_file(tmp_path, place):
    study = made_study()
    evaluations = made_evaluations([0.8, np.nan], [9.0, np.nan], ["ok", "diverged"])
    evaluations.drift_m[0] = -0.0
    generations = [made_generation(study, 0, 0, evaluations, state={"after": 0})]
    for db in (tmp_path / "s.db", place):
        made_database(db, generations, study)
    (zero,), (missing,) = rows_of(place, "SELECT drift_m FROM monoped_trials ORDER BY trial")
    assert not np.signbit(zero)
    assert missing is None
    assert verify(place).findings == verify(tmp_path / "s.db").findings


def test_a_rule_of_a_stranger_never_runs(cluster, place):
    copied_database(place)
    cluster.sql(f"CREATE RULE r AS ON INSERT TO {place.schema}.monoped_trials DO INSTEAD NOTHING")
    with pytest.raises(DatabaseError, match="holds the view or trigger 'r'"):
        read_study(place)


def test_nothing_of_a_study_on_a_server_stands_in_a_file(tmp_path, place, monkeypatch):
    monkeypatch.chdir(tmp_path)
    made_database(place)
    read_study(place)
    assert list(tmp_path.iterdir()) == []


def test_run_names_the_schema_after_the_study(cluster):
    study = study_from_dict(SMALL | {"name": "Named So", "algorithm": ALGORITHMS[0], "audit": False}, source="test")
    summary = run(study, place_of(cluster.address()), evaluations=10)
    assert summary.db.schema == "named_so"
    assert len(read_study(summary.db).trials) == 10
    second, found = run_second(summary, study, 7)
    assert (second.db.schema, second.evaluations) == ("named_so_seed_7", 10)
    assert found == run_second(summary, study, 7)[1]


def test_settings_of_a_user_change_no_number(cluster, tmp_path, place):
    """A role may round numbers and write dates in another style; our sessions do not."""
    cluster.sql("ALTER ROLE owner SET extra_float_digits = -5", "ALTER ROLE owner SET DateStyle = 'German'")
    try:
        made_database(tmp_path / "s.db")
        made_database(place)
        query = "SELECT * FROM monoped_trials ORDER BY trial"
        assert rows_of(place, query) == rows_of(tmp_path / "s.db", query)
        assert verify(place).findings == verify(tmp_path / "s.db").findings
    finally:
        cluster.sql("ALTER ROLE owner RESET ALL")
