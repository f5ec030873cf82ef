"""Read TOML files into checked, frozen dataclasses; a wrong field becomes an error of one line."""

import difflib
import tomllib
from collections.abc import Mapping
from importlib import resources
from pathlib import Path
from typing import Any, TypeVar

from pydantic import TypeAdapter, ValidationError

from pareto_monoped.errors import InputError

T = TypeVar("T")


def read_toml(path: Path, *, what: str, error: type[InputError] = InputError) -> dict[str, Any]:
    """The tables of a TOML file.

    Args:
        path: the file.
        what: what the file should be, for the error message, such as ``"motor file"``.
        error: the kind of ``InputError`` to raise.

    Raises:
        InputError: (or ``error``) the file is missing or unreadable, or is not valid TOML.
    """
    try:
        with path.open("rb") as stream:
            return tomllib.load(stream)
    except FileNotFoundError:
        raise error(f"{what} {str(path)!r}: no such file; check the path") from None
    except OSError as problem:
        raise error(f"{what} {str(path)!r}: cannot be read ({problem.strerror}); give a readable TOML file") from None
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as problem:
        raise error(f"{what} {str(path)!r}: not valid TOML ({problem}); correct that line") from None


def read_shipped(name: str, *, what: str, error: type[InputError] = InputError) -> dict[str, Any]:
    """The tables of a TOML file in the package's ``data`` folder, with arguments as for ``read_toml``."""
    with resources.as_file(resources.files("pareto_monoped") / "data" / name) as path:
        return read_toml(path, what=what, error=error)


def checked(kind: type[T], values: Mapping[str, Any], *, source: str, error: type[InputError] = InputError) -> T:
    """Make an instance of dataclass ``kind`` from plain values; every field is checked against its annotation.

    Bounds stand in the annotations (``Annotated[float, Field(gt=0)]``). Unknown keys are refused if the dataclass
    has ``__pydantic_config__ = ConfigDict(extra="forbid")``.

    Args:
        kind: the dataclass.
        values: the fields by name, nested for nested dataclasses.
        source: where the values come from; begins the error message, such as ``"motor file my.toml"``.
        error: the kind of ``InputError`` to raise.

    Raises:
        InputError: (or ``error``) a field is wrong; the message names the first one, its value, what is allowed and
            the cure.
    """
    try:
        return TypeAdapter(kind).validate_python(dict(values))
    except ValidationError as problem:
        raise error(f"{source}: {_line(kind, problem)}") from None


def _line(kind: type, problem: ValidationError) -> str:
    """The first error in one line. Pydantic lists them in the order of the fields."""
    first = problem.errors(include_url=False)[0]
    # For a field of a union type, pydantic adds the name of the type to the location, which does not help the user.
    key = ".".join(str(step) for step in first["loc"] if not str(step).startswith(("tagged-union", "function-")))
    if first["type"] == "missing":
        return f"{key} is missing; add it"
    if first["type"] in ("extra_forbidden", "unexpected_keyword_argument"):
        allowed = sorted(getattr(kind, "__dataclass_fields__", {}))
        name = str(first["loc"][-1])
        near = difflib.get_close_matches(name, allowed, n=1)
        hint = f"did you mean {near[0]!r}?" if near else "remove it"
        top = f"; allowed: {', '.join(allowed)}" if len(first["loc"]) == 1 and allowed else ""
        return f"unknown key {key!r}{top}; {hint}"
    message = first["msg"].removeprefix("Value error, ")
    if not key:
        return message
    # Errors raised in our own __post_init__ state value and cure already.
    if first["type"] == "value_error":
        return f"{key}: {message}"
    return f"{key} = {first['input']!r}: {message[0].lower()}{message[1:]}; correct it"
