"""What goes wrong between a study and its server is one line with a cure, and without a password."""

import itertools
import socket
import threading

import pytest

from pareto_monoped.definition.study import study_from_dict
from pareto_monoped.errors import DatabaseError, ServerError
from pareto_monoped.storage.place import place_of
from pareto_monoped.storage.reader import read_study
from pareto_monoped.storage.status import status
from pareto_monoped.storage.store import Store
from pareto_monoped.study.run import resume, run
from tests.study.same import assert_same_study
from tests.study.support import copied_database, made_database, made_evaluations, made_generation, made_study

pytest.importorskip("psycopg", reason="the extra postgres is not installed")

_NUMBERS = itertools.count()

STUDY = {
    "name": "s",
    "evaluations": 60,
    "strength": False,
    "audit": False,
    "algorithm": {"name": "nsga2", "population": 20},
}


def refused(kind, place, *words):
    with pytest.raises(kind) as caught:
        read_study(place)
    message = str(caught.value)
    assert type(caught.value) is kind
    assert "\n" not in message
    assert "S3cret" not in message
    assert message.startswith(f"study database {str(place)!r}: ")
    for word in words:
        assert word in message


def test_nobody_listens():
    refused(ServerError, place_of("postgresql://ann:S3cret@127.0.0.1:1/team?schema=s"), "does not answer", "start it")


def test_no_such_host(tmp_path):
    address = f"postgresql://ann:S3cret@/team?host={tmp_path}&schema=s"
    refused(ServerError, place_of(address), "does not answer", "check host and port")


def test_a_setting_that_libpq_does_not_know(cluster):
    place = place_of(cluster.address("s", more="passwrd=S3cret"))
    refused(DatabaseError, place, "its address cannot be used", "correct it")


def test_no_such_database(cluster):
    refused(DatabaseError, place_of(cluster.address("s", database="none")), "no such database", "createdb")


def test_no_such_user(cluster):
    refused(DatabaseError, place_of(cluster.address("s", user="nobody_here")), "no such user", "createuser")


def test_passwords(cluster, place, address, monkeypatch):
    copied_database(place)
    cluster.sql(
        "CREATE ROLE guarded LOGIN PASSWORD 'S3cret'",
        f"GRANT USAGE ON SCHEMA {place.schema} TO guarded",
        f"GRANT SELECT ON ALL TABLES IN SCHEMA {place.schema} TO guarded",
    )
    monkeypatch.delenv("PGPASSWORD", raising=False)
    monkeypatch.setenv("PGPASSFILE", "/nowhere")
    theirs = address.replace("//owner@", "//guarded@")
    refused(DatabaseError, place_of(theirs), "asks for a password", "PGPASSWORD or ~/.pgpass")
    wrong = place_of(theirs.replace("guarded@", "guarded:S3cretive@"))
    refused(DatabaseError, wrong, "the password of its user is refused", "correct it")
    assert len(read_study(place_of(theirs.replace("guarded@", "guarded:S3cret@"))).trials) == 6
    monkeypatch.setenv("PGPASSWORD", "S3cret")
    assert len(read_study(place_of(theirs)).trials) == 6

    def change_budget():
        with Store(place_of(theirs), made_study()) as store:
            store.set_meta({"budget": 7})

    with pytest.raises(DatabaseError, match=r"is not allowed to us .*ask its owner"):
        change_budget()


def test_no_such_study(cluster, place):
    refused(DatabaseError, place, "no such study on the server", "check the schema")
    cluster.sql(f"CREATE SCHEMA {place.schema}", f"CREATE TABLE {place.schema}.studies (x int)")
    refused(DatabaseError, place, "is not a study database", "it lacks the table 'trials'")
    with pytest.raises(DatabaseError, match="is not a study database"):
        run(made_study(), place)


def test_an_address_without_schema_names_the_studies_there(cluster):
    """The first ten by name: other tests have made many on the same server."""
    copied_database(place_of(cluster.address("a_study")))
    refused(DatabaseError, place_of(cluster.address()), "names no study", "add ?schema=NAME", "a_study")


@pytest.mark.parametrize(("unnamed", "words"), [(0, ""), (1, " and 1 other"), (2, " and 2 others")])
def test_an_address_without_schema_counts_the_studies_that_it_does_not_name(cluster, monkeypatch, unnamed, words):
    """It said "and 1 others"."""
    for _ in range(3):
        copied_database(place_of(cluster.address(f"counted_{next(_NUMBERS)}")))
    ((there,),) = cluster.sql("SELECT count(*) FROM pg_class WHERE relname = 'monoped_meta'")
    monkeypatch.setattr("pareto_monoped.storage.server._NAMED", there - unnamed)
    with pytest.raises(DatabaseError) as caught:
        read_study(place_of(cluster.address()))
    names = str(caught.value).partition(", one of ")[2].removesuffix(words).split(", ")
    assert len(names) == there - unnamed
    assert not any(" other" in name for name in names)


def test_a_study_that_its_owner_has_not_opened_to_a_role_is_not_said_to_be_missing(cluster, place, address):
    """It was "no such study on the server; check the schema, or run a study first"."""
    copied_database(place)
    cluster.sql("CREATE ROLE colleague LOGIN")
    theirs = place_of(address.replace("//owner@", "//colleague@"))
    grants = [
        f"GRANT USAGE ON SCHEMA {place.schema} TO colleague",
        f"GRANT SELECT ON ALL TABLES IN SCHEMA {place.schema} TO colleague",
    ]
    refused(DatabaseError, theirs, "no right to look into it; ask owner for", *grants)
    with pytest.raises(DatabaseError, match=grants[0]):
        run(made_study(), theirs)
    cluster.sql(grants[0])
    refused(DatabaseError, theirs, "is not allowed to us")
    cluster.sql(grants[1])
    assert len(read_study(theirs).trials) == 6


def test_a_role_that_the_server_rejects(cluster):
    """It was "the server does not answer; start it"."""
    cluster.sql("CREATE ROLE banned LOGIN")
    refused(
        DatabaseError, place_of(cluster.address("s", user="banned")), "the server refuses us", "pg_hba.conf rejects"
    )


@pytest.mark.parametrize("more", ["sslmode=none", "port=nowhere", "connect_timeout=soon"])
def test_a_setting_with_an_impossible_value_is_no_silent_server(cluster, more):
    refused(DatabaseError, place_of(cluster.address("s", more=more)), "its address cannot be used (", "correct")


@pytest.mark.parametrize(
    ("answer", "more", "words"),
    [
        (b"S", "sslmode=verify-full&sslrootcert=/nowhere/ca.pem", 'root certificate file "/nowhere/ca.pem" does not'),
        (b"N", "sslmode=require", "server does not support SSL, but SSL was required"),
    ],
)
def test_encryption_that_cannot_be_had_is_no_silent_server(answer, more, words):
    """What answers here knows of PostgreSQL only the answer to the first question, whether it encrypts."""

    def say(listening):
        talking, _ = listening.accept()
        with talking:
            talking.recv(8)
            talking.sendall(answer)
            talking.recv(8)

    with socket.create_server(("127.0.0.1", 0)) as listening:
        answering = threading.Thread(target=say, args=(listening,))
        answering.start()
        address = f"postgresql://ann:S3cret@127.0.0.1:{listening.getsockname()[1]}/team?{more}&schema=s"
        refused(DatabaseError, place_of(address), "no encrypted connection", words, "correct sslmode, sslrootcert")
        answering.join()


def test_an_empty_schema_may_be_there_before(cluster, place):
    cluster.sql(f"CREATE SCHEMA {place.schema}")
    made_database(place)
    assert len(read_study(place).trials) == 6


def test_a_creation_that_was_killed_is_made_anew(cluster, place):
    cluster.sql(f"CREATE SCHEMA {place.schema}_new", f"CREATE TABLE {place.schema}_new.studies (x int)")
    made_database(place)
    assert len(read_study(place).trials) == 6
    assert cluster.sql(f"SELECT to_regnamespace('{place.schema}_new') IS NULL") == [(True,)]


def test_the_server_goes_away_in_the_middle_and_comes_back(cluster, tmp_path, place):
    """One line, everything acknowledged is there, and a resume ends where a run without trouble does."""
    study, reported = study_from_dict(STUDY, source="test"), []

    def stop(progress):
        reported.append(progress.evaluations)
        if len(reported) == 2:
            cluster.stop("immediate")

    try:
        with pytest.raises(ServerError) as caught:
            run(study, place, progress=stop)
        message = str(caught.value)
        assert "\n" not in message
        assert "the server went away" in message
        assert "start it and resume" in message
        refused(ServerError, place, "does not answer")
    finally:
        cluster.start()
    assert len(read_study(place).trials) >= reported[-1] == 40
    resume(place)
    run(study, tmp_path / "s.db")
    assert_same_study(tmp_path / "s.db", place)


def test_a_session_that_the_server_ends_is_said_in_one_line(cluster, place):
    study = copied_database(place)
    with Store(place, study) as store:
        cluster.sql("SELECT pg_terminate_backend(pid) FROM pg_stat_activity WHERE application_name LIKE 'pareto-mon%'")
        with pytest.raises(ServerError, match=r"the server went away .*all acknowledged trials are safe"):
            store.add(made_generation(study, 2, 6, made_evaluations([0.9], [9.0]), state={"after": 2}))
    assert len(read_study(place).trials) == 6


def test_psycopg_is_missing(monkeypatch):
    from pareto_monoped.errors import InputError

    monkeypatch.setattr("pareto_monoped.errors.find_spec", lambda _: None)
    with pytest.raises(InputError) as caught:
        place_of("postgresql://ann:S3cret@db/team?schema=s")
    assert "pip install 'pareto-monoped[postgres]'" in str(caught.value)
    assert "S3cret" not in str(caught.value)


def test_no_secret_is_stored_or_told(cluster, address, monkeypatch):
    cluster.sql("DROP ROLE IF EXISTS bearer", "CREATE ROLE bearer LOGIN SUPERUSER PASSWORD 'S3cret'")
    place = place_of(address.replace("//owner@", "//bearer:S3cret@"))
    study = study_from_dict(STUDY | {"evaluations": 20}, source="test")
    summary = run(study, place)
    assert "S3cret" not in repr(summary)
    assert "S3cret" not in repr(status(place))
    tables = cluster.sql(f"SELECT tablename FROM pg_tables WHERE schemaname = '{place.schema}'")
    assert len(tables) > 10
    for (table,) in tables:
        assert "S3cret" not in repr(cluster.sql(f"SELECT * FROM {place.schema}.{table}")), table
