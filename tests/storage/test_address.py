"""Addresses: what libpq gets, what may be shown, and what is refused without a word of it."""

from pathlib import Path

import pytest

from pareto_monoped.errors import DatabaseError
from pareto_monoped.storage.address import LONGEST_SCHEMA, is_address, schema_for, server_of
from pareto_monoped.storage.place import beside


@pytest.mark.parametrize(
    ("text", "conninfo", "shown"),
    [
        ("postgresql://ann@db/team?schema=light", "postgresql://ann@db/team", "postgresql://ann@db/team?schema=light"),
        ("postgres:///team?schema=light", "postgresql:///team", "postgresql:///team?schema=light"),
        (
            "postgresql://ann:S3cret%40x@db:5433,[::1]:5434/team?sslmode=require&schema=light&sslpassword=S3cret",
            "postgresql://ann:S3cret%40x@db:5433,[::1]:5434/team?sslmode=require&sslpassword=S3cret",
            "postgresql://ann@db:5433,[::1]:5434/team?sslmode=require&schema=light",
        ),
        (
            "postgresql://%2Ftmp%2Fsocket/team?password=S3cret",
            "postgresql://%2Ftmp%2Fsocket/team?password=S3cret",
            "postgresql://%2Ftmp%2Fsocket/team",
        ),
    ],
)
def test_libpq_gets_all_and_a_message_no_secret(text, conninfo, shown):
    server = server_of(text)
    assert server.conninfo == conninfo
    assert str(server) == shown
    assert "S3cret" not in repr(server)
    assert is_address(text)


@pytest.mark.parametrize(
    "text",
    [
        "postgresql://ann:S3@cret@db/team",
        "postgresql://ann:S3/cret@db/team",
        "postgresql://ann:S3?cret@db/team",
        "postgresql://ann:12?S3cret=x@db/team",
        "postgresql://ann:S3#cret@db/team",
        "postgresql://ann:S3cret/team",
        "mysql://ann:S3cret@db/team",
        "postgresql+psycopg://ann:S3cret@db/team",
        "postgresql://ann:S3cret@db/team%00",
    ],
)
def test_an_address_that_cannot_be_understood_is_not_repeated(text):
    with pytest.raises(DatabaseError) as caught:
        server_of(text)
    message = str(caught.value)
    assert "\n" not in message
    assert "cret" not in message
    assert "give postgresql://USER@HOST:PORT/DATABASE?schema=STUDY" in message


@pytest.mark.parametrize("schema", ["", "Light", "a b", "pg_x", "1a", 'a"b', "a-b", "a" * (LONGEST_SCHEMA + 1)])
def test_a_schema_that_would_need_quotes_is_refused(schema):
    with pytest.raises(DatabaseError, match="must be lower-case letters"):
        server_of(f"postgresql://ann:S3cret@db/team?schema={schema}")


def test_two_schemas_are_refused():
    with pytest.raises(DatabaseError, match="more than one schema"):
        server_of("postgresql:///team?schema=a&schema=b")


@pytest.mark.parametrize("text", ["s.db", "/a/s.db", "a://", "C:\\s.db", "./postgresql:/x", "1://x"])
def test_the_name_of_a_file_is_no_address(text):
    assert is_address(text) == (text == "a://")


@pytest.mark.parametrize(
    ("name", "schema"),
    [("Case C", "case_c"), ("8 legs", "study_8_legs"), ("pg_x", "study_pg_x"), ("héé", "h"), ("é", "study")],
)
def test_the_schema_of_a_study_comes_from_its_name(name, schema):
    assert schema_for(name) == schema
    assert str(server_of(f"postgresql:///t?schema={schema_for(name)}")).endswith(schema)


def test_a_long_name_gives_a_schema_that_is_taken():
    assert server_of(f"postgresql:///t?schema={schema_for('x' * 200)}").schema == "x" * LONGEST_SCHEMA


def test_a_study_beside_another_has_its_name_and_a_suffix():
    long = server_of(f"postgresql://db/robots?sslmode=require&schema={'a' * LONGEST_SCHEMA}")
    assert beside(Path("runs/s.v1.db"), "_seed_2") == Path("runs/s.v1_seed_2.db")
    assert str(beside(long.of_schema("s"), "_seed_2")) == "postgresql://db/robots?sslmode=require&schema=s_seed_2"
    assert beside(long, "_seed_2").schema == "a" * (LONGEST_SCHEMA - 7) + "_seed_2"
