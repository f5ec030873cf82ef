import errno
import json
import os
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Annotated, Literal

import pytest
from pydantic import ConfigDict, Field

from pareto_monoped.config import MAX_JSON_DEPTH, MAX_TOML_BYTES, checked, parsed_json, read_json, read_toml
from pareto_monoped.errors import DiskError, InputError, MotorError


@dataclass(frozen=True, slots=True, kw_only=True)
class Shell:
    __pydantic_config__ = ConfigDict(extra="forbid")

    outer_diameter_mm: Annotated[float, Field(gt=0)]


@dataclass(frozen=True, slots=True, kw_only=True)
class Thing:
    __pydantic_config__ = ConfigDict(extra="forbid")

    mass_kg: Annotated[float, Field(gt=0)]
    shell: Shell | None = None
    name: str = "thing"


@dataclass(frozen=True, slots=True, kw_only=True)
class Ring:
    inner_mm: float
    outer_mm: float

    def __post_init__(self):
        if self.inner_mm >= self.outer_mm:
            raise ValueError(
                f"inner_mm = {self.inner_mm}: must be less than outer_mm = {self.outer_mm}; correct one of them"
            )


@dataclass(frozen=True, slots=True, kw_only=True)
class Pair:
    ring: Ring


def test_values_become_a_record():
    thing = checked(Thing, {"mass_kg": 1, "shell": {"outer_diameter_mm": 2}}, source="file")
    assert thing == Thing(mass_kg=1.0, shell=Shell(outer_diameter_mm=2.0))


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ({}, ["mass_kg", "missing"]),
        ({"mass_kg": 0}, ["mass_kg = 0", "must be above 0"]),
        ({"mass_kg": "heavy"}, ["mass_kg = 'heavy'", "number"]),
        ({"mass_kg": float("nan")}, ["mass_kg = nan", "must be above 0"]),
        ({"mass_kg": 1, "mas_kg": 2}, ["unknown key 'mas_kg'", "mass_kg", "did you mean"]),
        ({"mass_kg": 1, "colour": 2}, ["unknown key 'colour'", "allowed: mass_kg, name, shell"]),
        ({"mass_kg": 1, "shell": {"outer_diameter_mm": -1}}, ["shell.outer_diameter_mm = -1", "must be above 0"]),
        ({"mass_kg": 1, "shell": {}}, ["shell.outer_diameter_mm", "missing"]),
    ],
)
def test_a_wrong_field_is_one_line_with_key_value_and_what_is_allowed(values, words):
    with pytest.raises(MotorError) as caught:
        checked(Thing, values, source="motor file my.toml", error=MotorError)
    line = str(caught.value)
    assert line.startswith("motor file my.toml: ")
    assert "\n" not in line
    for word in words:
        assert word in line


def test_toml_is_read(tmp_path):
    path = tmp_path / "a.toml"
    path.write_text("[a]\nb = 1\n")
    assert read_toml(path, what="file") == {"a": {"b": 1}}


def test_unreadable_toml_is_one_line(tmp_path):
    path = tmp_path / "a.toml"
    with pytest.raises(InputError, match="no such file"):
        read_toml(path, what="motor file")
    path.write_text("a = = 1")
    with pytest.raises(InputError, match="not valid TOML"):
        read_toml(path, what="motor file")
    path.write_bytes(b"a = '\xff\xfe'")
    with pytest.raises(InputError, match=r"no text in UTF-8 \(byte 5\); give a TOML file"):
        read_toml(path, what="motor file")
    with pytest.raises(InputError, match="cannot be read"):
        read_toml(tmp_path, what="motor file")


def test_a_complaint_of_a_records_own_ends_with_one_cure():
    """It once ended with `correct one of them; correct it`."""
    with pytest.raises(InputError) as caught:
        checked(Pair, {"ring": {"inner_mm": 5.0, "outer_mm": 5.0}}, source="file")
    assert str(caught.value) == "file: ring: inner_mm = 5.0: must be less than outer_mm = 5.0; correct one of them"


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"a = " + b"[" * 3000, "nested beyond reason"),
        (b"a = " + b"9" * 5000, "not valid TOML"),
        (b"\xff\xfe", "no text in UTF-8"),
        # The codec's own words on it named a byte and told to correct a line.
        (b"SQLite format 3\x00\x10\x00\x02\x02\xfb", "is a database, not a TOML file; .* 'resume', load_study"),
        # Only its size was named.
        (b"SQLite format 3\x00" + bytes(MAX_TOML_BYTES), "is a database, not a TOML file"),
        (b"a = 'x", "not valid TOML"),
        (b"#" * (MAX_TOML_BYTES + 1), f"has more than {MAX_TOML_BYTES} bytes"),
    ],
)
def test_toml_that_is_none_or_beyond_reason_is_one_line(tmp_path, content, words):
    (tmp_path / "a.toml").write_bytes(content)
    with pytest.raises(InputError, match=words) as caught:
        read_toml(tmp_path / "a.toml", what="motor file")
    assert str(caught.value).startswith(f"motor file '{tmp_path}/a.toml'")
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("path", ["/dev/zero", "a\0b", "/"])
def test_what_is_no_file_is_one_line(path):
    with pytest.raises(InputError, match=r"give a|check the path"):
        read_toml(Path(path), what="motor file")


@pytest.mark.parametrize("reader", [partial(read_toml, what="study file"), read_json])
def test_a_pipe_is_refused_and_not_waited_for(tmp_path, reader):
    os.mkfifo(tmp_path / "a.toml")
    with pytest.raises((InputError, OSError), match="it is no regular file"):
        reader(tmp_path / "a.toml")


def test_a_failing_disk_is_not_the_files_fault(monkeypatch, tmp_path):
    def fails(*_, **__):
        raise OSError(errno.EIO, os.strerror(errno.EIO))

    monkeypatch.setattr(os, "open", fails)
    with pytest.raises(DiskError, match=r"Input/output error.*check the disk's health"):
        read_toml(tmp_path / "a.toml", what="motor file")


@pytest.mark.parametrize("levels", [4, MAX_JSON_DEPTH])
def test_json_of_ordinary_depth_is_read(levels):
    text = "[" * levels + "]" * levels
    assert parsed_json(text) == json.loads(text)
    wide = json.dumps([{"a": [1, "[{" * 50]}] * 300)
    assert parsed_json(wide) == json.loads(wide)


@pytest.mark.parametrize("levels", [MAX_JSON_DEPTH + 1, 3000, 200_000])
@pytest.mark.parametrize(("opening", "closing"), [("[", "]"), ('{"]": ', "}")])
def test_json_that_is_too_deep_is_refused(levels, opening, closing):
    with pytest.raises(ValueError, match="more than 64 levels deep"):
        parsed_json(opening * levels + "1" + closing * levels)


@pytest.mark.parametrize("text", [None, 3, b"[]", "", "{", "9" * 5000])
def test_what_is_no_json_is_a_value_error(text):
    with pytest.raises(ValueError):  # noqa: PT011
        parsed_json(text)


def test_a_long_json_text_is_refused_before_it_is_parsed(monkeypatch, tmp_path):
    monkeypatch.setattr("pareto_monoped.config.MAX_JSON_CHARACTERS", 10)
    monkeypatch.setattr(json, "loads", lambda _: pytest.fail("parsed"))
    (tmp_path / "a.json").write_text("[1, 2, 3, 4]")
    for read in (lambda: parsed_json("[1, 2, 3, 4]"), lambda: read_json(tmp_path / "a.json")):
        with pytest.raises(ValueError, match="must be 10 at most"):
            read()


@dataclass(frozen=True, slots=True, kw_only=True)
class Everything:
    whole: Annotated[int, Field(ge=1, le=9, multiple_of=2)] = 2
    share: Annotated[float, Field(ge=0.0, lt=1.0, allow_inf_nan=False)] = 0.5
    word: Annotated[str, Field(min_length=1, max_length=4)] = "word"
    code: Annotated[str, Field(pattern="^[a-z]+$")] = "code"
    on: bool = True
    table: dict[str, float] | None = None
    several: Annotated[tuple[float, ...], Field(min_length=1, max_length=2)] = (1.0,)
    one_of: Literal["a", "b"] = "a"
    thing: Thing | None = None


@pytest.mark.parametrize(
    ("key", "value", "allowed"),
    [
        ("whole", 0, "at least 1"),
        ("whole", 10, "at most 9"),
        ("whole", 3, "a multiple of 2"),
        ("whole", 1.5, "a whole number"),
        ("whole", "many", "a whole number"),
        ("share", -0.5, "at least 0"),
        ("share", 1.0, "below 1"),
        ("share", float("inf"), "a finite number"),
        ("share", [1], "a number"),
        ("word", "", "at least one letter"),
        ("word", "words", "text of at most 4 letters"),
        ("word", 5, "text"),
        ("code", "A", "text of the form ^[a-z]+$"),
        ("on", "perhaps", "true or false"),
        ("table", 5, "a table"),
        ("several", 5, "a list"),
        ("several", [], "a list that is not empty"),
        ("several", [1, 2, 3], "a list of at most 2 values"),
        ("one_of", "c", "'a' or 'b'"),
        ("thing", 5, "a table"),
    ],
)
def test_what_is_allowed_is_said_in_our_words_and_not_in_pydantics(key, value, allowed):
    """``Study.define(evaluations=-5)`` once said "input should be greater than or equal to 1"."""
    with pytest.raises(InputError) as caught:
        checked(Everything, {key: value}, source="file")
    assert str(caught.value) == f"file: {key} = {value!r}: must be {allowed}; correct it"


def test_a_long_value_is_shown_in_part():
    with pytest.raises(InputError) as caught:
        checked(Everything, {"word": "w" * 5000}, source="file")
    assert len(str(caught.value)) < 500
