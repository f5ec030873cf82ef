"""A campaign file: a base study, and axes whose values are combined; one study per combination, with its name."""

import hashlib
import json
import re
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from itertools import product
from math import prod
from pathlib import Path
from typing import Annotated, Any

from pydantic import Field

from pareto_monoped.config import Strict, checked, read_toml
from pareto_monoped.definition.study import Study, filled
from pareto_monoped.definition.study_file import file_values, with_objectives, with_paths
from pareto_monoped.errors import StudyError, complaint

LONGEST_PART, LONGEST = 48, 180  #: Letters of one axis in a name, and of a name: file systems take 255. Our own choice.
_UNUSUAL = re.compile(r"[^A-Za-z0-9._+-]+")
_BEFORE = {"seeds": "seed", "cases": "case-", "evaluations": "jumps", "hip_motors": "hip-", "knee_motors": "knee-"}
"""Axis -> what stands before a value that says too little alone."""
MOST_STUDIES = 1000  #: Our own choice: a thousand studies of 8,000 jumps take a day on 16 cores.
KEYS = {
    "motors": "motor",
    "hip_motors": "hip_motor",
    "knee_motors": "knee_motor",
    "calibrations": "calibration",
    "cases": "case",
    "algorithms": "algorithm",
    "seeds": "seed",
}  #: Axis -> key of a study file, where it is not the same word.
_TABLES = ("variables", "constraints")
"""Axes whose values are added to the base study's table instead of replacing it."""

Values = Annotated[list[Any], Field(min_length=1)]


def canonical(value: Any) -> str:
    """Return a text that is equal for equal values; capitals do not tell names apart, as for motors."""
    return json.dumps(value, sort_keys=True, default=str).casefold()


def names_of(axis: str, values: Sequence[Any]) -> list[str]:
    """Return a readable name per value of an axis, whatever its type; no two are alike, also without capitals."""
    made = {"objectives": _objectives, "algorithms": _algorithms}.get(axis)
    texts = [slug(_BEFORE.get(axis, "") + text) for text in (made(values) if made else map(_plain, values))]
    counts = Counter(text.casefold() for text in texts)
    return [
        text if counts[text.casefold()] == 1 else f"{text}-{_digest(value)}"
        for text, value in zip(texts, values, strict=True)
    ]


def _plain(value: Any) -> str:
    """Return a value in letters: a file by its stem, a list or a table by what it has."""
    if isinstance(value, str):
        return Path(value).stem if value.endswith(".toml") else value
    if isinstance(value, Mapping):
        return "-".join(f"{key}-{_plain(entry)}" if _plain(entry) else str(key) for key, entry in value.items())
    if isinstance(value, list | tuple):
        return "+".join(map(_plain, value))
    if isinstance(value, float):
        return f"{value:g}"
    return str(value)


def _objectives(values: Sequence[Any]) -> list[str]:
    """Return objectives by what not all values have in common."""
    lists = [[str(name) for name in value] if isinstance(value, list | tuple) else [str(value)] for value in values]
    common = set.intersection(*map(set, lists)) if lists else set()
    shorter = ["-".join(name for name in names if name not in common) for names in lists]
    return [short or "-".join(names) for short, names in zip(shorter, lists, strict=True)]


def _algorithms(values: Sequence[Any]) -> list[str]:
    """Return algorithms by name, and by their settings where several have one name."""
    tables = [value if isinstance(value, Mapping) else {"name": value} for value in values]
    names = [str(table.get("name")) for table in tables]
    return [
        name if names.count(name) == 1 else "-".join([name, _plain({k: v for k, v in table.items() if k != "name"})])
        for name, table in zip(names, tables, strict=True)
    ]


def joined(parts: Sequence[str]) -> str:
    """Return the name of a study from those of its values."""
    name = "_".join(parts)
    return name if len(name) <= LONGEST else f"{name[: LONGEST - 7]}-{_digest(name)}"


def slug(text: str) -> str:
    """Return any text as part of a file's name."""
    short = _UNUSUAL.sub("-", text).strip("-.") or "study"
    return short if len(short) <= LONGEST_PART else f"{short[: LONGEST_PART - 7]}-{_digest(text)}"


def _digest(value: Any) -> str:
    return hashlib.sha256(canonical(value).encode()).hexdigest()[:6]


@dataclass(frozen=True, slots=True, kw_only=True)
class _File(Strict):
    """Keys of a campaign file; the study and the axes are checked separately."""

    name: Annotated[str, Field(min_length=1, max_length=200)]
    description: Annotated[str, Field(max_length=2000)] = ""
    study: Any = None
    axes: dict[str, Any]


@dataclass(frozen=True, slots=True, kw_only=True)
class _Axes(Strict):
    """The axes that a campaign may have, each a list of values for one key of a study file."""

    motors: Values | None = None
    hip_motors: Values | None = None
    knee_motors: Values | None = None
    calibrations: Values | None = None
    rules: Values | None = None
    cases: Values | None = None
    objectives: Values | None = None
    variables: Values | None = None
    constraints: Values | None = None
    evaluations: Values | None = None
    algorithms: Values | None = None
    seeds: Values | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Member:
    """One study of a campaign."""

    name: str  #: of the study and of its database, without suffix
    study: Study
    labels: Mapping[str, str]  #: axis that varies -> name of the study's value


@dataclass(frozen=True, slots=True, kw_only=True)
class Campaign:
    """A grid of studies."""

    name: str
    description: str
    path: Path  #: of the file
    axes: tuple[str, ...]  #: names of the axes that vary, in the order of the file
    members: tuple[Member, ...]  #: the studies, the last axis varying fastest

    @property
    def folder(self) -> Path:
        """Where the databases are, unless the user names another folder: beside the file, named as it is."""
        return self.path.with_suffix("")


def load_campaign(path: Path) -> Campaign:
    """Return the campaign in a TOML file; every study of it is checked.

    Raises:
        StudyError: no readable TOML, an unknown key, a wrong type, a value named twice, too many studies, or a
            combination that no study file could have.
        MotorError, CalibrationError: an unknown name.
    """
    source = f"campaign file {str(path)!r}"
    raw = read_toml(path, what="campaign file", error=StudyError)
    file = checked(_File, raw, source=source, error=StudyError)
    base = _base(file.study, path, source)
    axes = _axes(file.axes, path, source)
    count = prod(map(len, axes.values()))
    if count > MOST_STUDIES:
        made = " x ".join(f"{len(values)} {axis}" for axis, values in axes.items())
        raise StudyError(
            f"{source}: axes make {count} studies ({made}): must be {MOST_STUDIES} at most; name fewer values, or make "
            "several campaigns"
        )
    named = {axis: names_of(axis, values) for axis, values in axes.items()}
    varying = tuple(axis for axis, values in axes.items() if len(values) > 1)
    members = []
    for places in product(*(range(len(values)) for values in axes.values())):
        labels = {axis: named[axis][place] for axis, place in zip(axes, places, strict=True) if axis in varying}
        name = joined(list(labels.values())) or slug(file.name)
        chosen = {axis: axes[axis][place] for axis, place in zip(axes, places, strict=True)}
        values = _combined(base, chosen) | {"name": name}
        study = filled(values, source=f"{source}, study {name!r}")
        members.append(Member(name=name, study=study, labels=labels))
    _refuse_equal_names([member.name for member in members], source)
    return Campaign(name=file.name, description=file.description, path=path, axes=varying, members=tuple(members))


def _refuse_equal_names(names: Sequence[str], source: str) -> None:
    """Refuse names that are equal together, such as ``a_b`` with ``c`` and ``a`` with ``b_c``."""
    name, count = Counter(name.casefold() for name in names).most_common(1)[0]
    if count > 1:
        raise StudyError(f"{source}: {count} studies would be named {name!r}; rename one of the files of their values")


def _base(given: Any, path: Path, source: str) -> dict[str, Any]:
    """Return the keys of the base study: of a file, or of a table in the campaign file."""
    if isinstance(given, Mapping):
        return with_paths(given, path.parent)
    if isinstance(given, str) and given.endswith(".toml"):
        return file_values(path.parent / given)
    raise StudyError(
        f"{source}: {complaint('study', given, 'the name of a study file (*.toml) or a table of its keys', 'give one')}"
    )


def _axes(given: Mapping[str, Any], path: Path, source: str) -> dict[str, list[Any]]:
    """Return axis -> values, in the order of the file, with full paths."""
    table = checked(_Axes, given, source=f"{source}, table [axes]", error=StudyError)
    known = {field.name: getattr(table, field.name) for field in fields(table)}
    axes = {axis: known[axis] for axis in given if known[axis] is not None}
    if not axes:
        raise StudyError(f"{source}: axes: none is named; name one or more of {', '.join(known)}")
    for axis, values in axes.items():
        key = KEYS.get(axis, axis)
        axes[axis] = [with_paths({key: value}, path.parent)[key] for value in values]
        texts = [canonical(value) for value in axes[axis]]
        text, count = Counter(texts).most_common(1)[0]
        if count > 1:
            value = values[texts.index(text)]
            raise StudyError(f"{source}: axes.{axis}: {value!r} is named {count} times; name it once")
    return axes


def _combined(base: Mapping[str, Any], chosen: Mapping[str, Any]) -> dict[str, Any]:
    """Return the keys of a study: those of the base with a value of each axis."""
    values = dict(base)
    for axis, value in chosen.items():
        key = KEYS.get(axis, axis)
        before = values.get(key)
        if axis == "objectives" and isinstance(value, list):
            values = with_objectives(values, value)
        elif axis in _TABLES and isinstance(value, Mapping) and isinstance(before, Mapping):
            values[key] = {**before, **value}
        else:
            values[key] = value
    return values
