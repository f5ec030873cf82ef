import json
from dataclasses import fields, replace

import pytest

from pareto_monoped.errors import DatabaseError
from pareto_monoped.storage.meta import StudyMeta, meta_of_rows
from tests.study.support import made_meta, made_study

KEYS = [field.name for field in fields(StudyMeta)]


def rows(**changes):
    return list((dict(made_meta(made_study()).as_rows()) | changes).items())


def test_what_is_stored_comes_back(tmp_path):
    meta = made_meta(made_study())
    meta = replace(meta, probe=[[0.8, 15.36], [None, None]], stop_reason="budget", finished=True)
    assert meta_of_rows(meta.as_rows(), tmp_path) == meta


def test_rows_of_a_later_version_are_passed_over(tmp_path):
    assert meta_of_rows([("format", "1"), *rows(), ("later", "{}")], tmp_path) == made_meta(made_study())


@pytest.mark.parametrize("key", KEYS)
def test_every_key_must_be_there(tmp_path, key):
    less = [row for row in rows() if row[0] != key]
    with pytest.raises(DatabaseError, match=f"is damaged .*{key} is missing"):
        meta_of_rows(less, tmp_path / "s.db")


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("study", [1]),
        ("motor", 3),
        ("seed", "1"),
        ("contents", {"motor": 5}),
        ("files", {"motor": 5}),
        ("versions", ["mujoco"]),
        ("hash", None),
        ("probe", [["high"]]),
        ("budget", "800"),
        ("budget", 800.5),
        ("finished", 1),
        ("stop_reason", False),
    ],
)
def test_a_value_of_another_type_is_damage(tmp_path, key, value):
    with pytest.raises(DatabaseError, match=f"is damaged .*{key}.*; restore a copy") as caught:
        meta_of_rows(rows(**{key: json.dumps(value)}), tmp_path / "s.db")
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("text", ["{", b"\x80", None])
def test_text_that_is_no_json_is_damage(tmp_path, text):
    with pytest.raises(DatabaseError, match="is damaged"):
        meta_of_rows(rows(budget=text), tmp_path / "s.db")


def test_nan_is_never_stored():
    with pytest.raises(ValueError, match="not JSON compliant"):
        replace(made_meta(made_study()), probe=[[float("nan"), 1.0]]).as_rows()
