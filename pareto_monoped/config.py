"""Read TOML files into checked, frozen dataclasses, and JSON within limits: either may come from a stranger."""

import difflib
import json
import re
import tomllib
from collections.abc import Callable, Mapping
from functools import cache
from importlib import resources
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, TypeVar

from pydantic import ConfigDict, Field, TypeAdapter, ValidationError

from pareto_monoped.errors import DiskError, InputError, complaint
from pareto_monoped.files import SQLITE, cure_of, is_failure, open_file

if TYPE_CHECKING:
    from pydantic_core import ErrorDetails

T = TypeVar("T")
Positive = Annotated[float, Field(gt=0.0, allow_inf_nan=False)]
NotNegative = Annotated[float, Field(ge=0.0, allow_inf_nan=False)]

MAX_TOML_BYTES = 1_000_000  #: Our own choice: a hundred times our longest file.
MAX_JSON_CHARACTERS = 64_000_000  #: Our own choice: the kept front of a study of 200,000 trials has 1.4 million.
MAX_JSON_DEPTH = 64  #: Levels of lists and objects in each other. Our own choice: ours have less than ten.
_TEXTS = re.compile(r'"(?:[^"\\]|\\.)*"')
_NO_BRACKETS = re.compile(r"[^\[\]{}]+")
_INNERMOST = re.compile(r"\[\]|\{\}")
_TOO_DEEP = f"JSON nested more than {MAX_JSON_DEPTH} levels deep"


class Strict:
    """The base of records that refuse fields that they do not have."""

    __slots__ = ()
    __pydantic_config__ = ConfigDict(extra="forbid")


def read_toml(path: Path, *, what: str, error: type[InputError] = InputError) -> dict[str, Any]:
    """Return the tables of a TOML file; ``what`` begins error messages, such as ``"motor file"``.

    Raises:
        InputError: (or ``error``) the file is missing or unreadable, or is not valid TOML.
    """
    source = f"{what} {str(path)!r}"
    try:
        with open_file(path) as stream:
            content = stream.read(MAX_TOML_BYTES + 1)
    except FileNotFoundError:
        raise error(f"{source}: no such file; check the path") from None
    except OSError as problem:
        if is_failure(problem):
            raise DiskError(f"{source}: cannot be read ({problem.strerror}); {cure_of(problem)}") from None
        raise error(f"{source}: cannot be read ({problem.strerror}); give a readable TOML file") from None
    except ValueError:  # a zero byte in its name
        raise error(f"{source}: cannot be the name of a file; check the path") from None
    if content.startswith(SQLITE):
        raise error(
            f"{source}: is a database, not a TOML file; give the TOML file, or go on with the study in it: "
            "'resume', load_study"
        )
    if len(content) > MAX_TOML_BYTES:
        raise error(f"{source}: has more than {MAX_TOML_BYTES} bytes; give a TOML file")
    try:
        return tomllib.loads(content.decode())
    except RecursionError:
        raise error(f"{source}: is nested beyond reason; correct it") from None
    except UnicodeDecodeError as problem:
        raise error(f"{source}: is no text in UTF-8 (byte {problem.start}); give a TOML file, saved as UTF-8") from None
    except ValueError as problem:  # not TOML, or a number of too many digits
        raise error(f"{source}: not valid TOML ({problem}); correct that line") from None


def parsed_json(text: Any) -> Any:
    """Return the value of a JSON text.

    Raises:
        ValueError: no text, no JSON, or beyond ``MAX_JSON_CHARACTERS`` or ``MAX_JSON_DEPTH``.
    """
    if not isinstance(text, str):
        raise ValueError(f"{type(text).__name__} in place of JSON text")
    if len(text) > MAX_JSON_CHARACTERS:
        raise ValueError(f"JSON text of {len(text)} characters, must be {MAX_JSON_CHARACTERS} at most")
    try:
        found = json.loads(text)
    except RecursionError:
        raise ValueError(_TOO_DEEP) from None
    # Few texts have so many brackets that it matters how they stand.
    if text.count("[") + text.count("{") > MAX_JSON_DEPTH and _depth_exceeds(text, MAX_JSON_DEPTH):
        raise ValueError(_TOO_DEEP)
    return found


def read_json(path: Path) -> Any:
    """Return the value of a JSON file of limited size and depth.

    Raises:
        OSError: it cannot be read.
        ValueError: as by ``parsed_json``, or not UTF-8.
    """
    with open_file(path) as stream:
        return parsed_json(stream.read(MAX_JSON_CHARACTERS + 1).decode())


def _depth_exceeds(text: str, levels: int) -> bool:
    """Return whether valid JSON is nested more deeply than that many levels."""
    brackets = _NO_BRACKETS.sub("", _TEXTS.sub("", text))
    for _ in range(levels):
        if not brackets:
            return False
        brackets = _INNERMOST.sub("", brackets)
    return bool(brackets)


def read_shipped(name: str, *, what: str, error: type[InputError] = InputError) -> dict[str, Any]:
    """Return the tables of a TOML file in the package's ``data`` folder, with arguments as for ``read_toml``."""
    with resources.as_file(resources.files("pareto_monoped") / "data" / name) as path:
        return read_toml(path, what=what, error=error)


def checked(kind: type[T], values: Mapping[str, Any], *, source: str, error: type[InputError] = InputError) -> T:
    """Make an instance of dataclass ``kind`` from plain values; every field is checked against its annotation.

    Bounds stand in the annotations (``Positive``). Values of nested dataclasses are nested, and a dataclass that
    inherits from ``Strict`` refuses unknown keys. ``source`` begins the error message, such as ``"motor file
    'my.toml'"``.

    Raises:
        InputError: (or ``error``) a field is wrong; the message names the first one, its value, what is allowed and the
            cure.
    """
    try:
        found: T = _adapter(kind).validate_python(dict(values))
        return found
    except ValidationError as problem:
        raise error(f"{source}: {_line(kind, problem)}") from None


_adapter: Callable[[Any], TypeAdapter[Any]] = cache(TypeAdapter)  #: Making one takes milliseconds.
_UNKNOWN = ("extra_forbidden", "unexpected_keyword_argument")  #: What pydantic calls an unknown key.


def _line(kind: type, problem: ValidationError) -> str:
    """Return the first error in one line; pydantic lists errors by field, unknown keys last."""
    errors = problem.errors(include_url=False)
    first = errors[0]
    if first["type"] == "missing":  # an unknown key may be the missing one, misspelt
        first = next((one for one in errors if one["type"] in _UNKNOWN), first)
    # For a field of a union type, pydantic adds the name of the type to the location, which does not help the user.
    key = ".".join(str(step) for step in first["loc"] if not str(step).startswith(("tagged-union", "function-")))
    if first["type"] == "missing":
        return f"{key} is missing; add it"
    if first["type"] in _UNKNOWN:
        allowed = sorted(getattr(kind, "__dataclass_fields__", {}))
        name = str(first["loc"][-1])
        near = difflib.get_close_matches(name, allowed, n=1)
        hint = f"did you mean {near[0]!r}?" if near else "remove it"
        top = f"; allowed: {', '.join(allowed)}" if len(first["loc"]) == 1 and allowed else ""
        return f"unknown key {key!r}{top}; {hint}"
    # Errors raised in our own __post_init__ state value and cure already.
    if first["type"] == "value_error":
        message = first["msg"].removeprefix("Value error, ")
        return f"{key}: {message}" if key else message
    return complaint(key or "value", first["input"], _allowed(first), "correct it")


_ALLOWED = {
    "greater_than": "above {gt}",
    "greater_than_equal": "at least {ge}",
    "less_than": "below {lt}",
    "less_than_equal": "at most {le}",
    "multiple_of": "a multiple of {multiple_of}",
    "finite_number": "a finite number",
    "literal_error": "{expected}",
    "union_tag_invalid": "one of {expected_tags}",
    "string_pattern_mismatch": "text of the form {pattern}",
    "string_too_short": "text of at least {min_length} letters",
    "string_too_long": "text of at most {max_length} letters",
    "too_short": "a list of at least {min_length} values",
    "too_long": "a list of at most {max_length} values",
}  #: Kind of an error of pydantic -> what is allowed; in braces what pydantic knows of it.
_KINDS = {
    "int": "a whole number",
    "float": "a number",
    "bool": "true or false",
    "string": "text",
    "dict": "a table",
    "dataclass": "a table",
    "model": "a table",
    "list": "a list",
    "tuple": "a list",
}  #: First word of such a kind -> what is allowed.


def _allowed(problem: "ErrorDetails") -> str:
    """Return what is allowed in place of a wrong value, in our words."""
    kind = problem["type"]
    if kind in _ALLOWED:
        known = problem.get("ctx", {})
        if known.get("min_length") == 1:
            return "at least one letter" if kind == "string_too_short" else "a list that is not empty"
        return _ALLOWED[kind].format(**{name: f"{v:g}" if isinstance(v, float) else v for name, v in known.items()})
    return _KINDS.get(kind.partition("_")[0]) or problem["msg"].lower().removeprefix("input should be ")
