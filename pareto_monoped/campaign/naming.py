"""Names for the values of a campaign's axes: what a study, its database and its line in a table are called."""

import hashlib
import json
import re
from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

LONGEST_PART, LONGEST = 48, 180
"""Letters of one axis in a name, and of a name. Our own choice: file systems take 255, and ``.db-journal`` follows."""
_UNUSUAL = re.compile(r"[^A-Za-z0-9._+-]+")
_BEFORE = {
    "seeds": "seed",
    "cases": "case-",
    "evaluations": "jumps",
    "hip_motors": "hip-",
    "knee_motors": "knee-",
}
"""Axis -> what stands before a value that says too little alone."""


def canonical(value: Any) -> str:
    """A text that is equal for equal values; capitals do not tell names apart, as for motors."""
    return json.dumps(value, sort_keys=True, default=str).casefold()


def names_of(axis: str, values: Sequence[Any]) -> list[str]:
    """A readable name for each value of an axis; no two are alike, also where capitals count for nothing.

    Args:
        axis: key of the campaign file.
        values: different values, as ``canonical`` tells them apart; any may be of a wrong type.
    """
    texts = [slug(_BEFORE.get(axis, "") + text) for text in _texts(axis, values)]
    counts = Counter(text.casefold() for text in texts)
    return [
        text if counts[text.casefold()] == 1 else f"{text}-{_digest(value)}"
        for text, value in zip(texts, values, strict=True)
    ]


def _texts(axis: str, values: Sequence[Any]) -> list[str]:
    if axis == "objectives":
        return _objectives(values)
    if axis == "algorithms":
        return _algorithms(values)
    return [_plain(value) for value in values]


def _plain(value: Any) -> str:
    """A value in letters: a file by its stem, a list or a table by what it has."""
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
    """Objectives by what not all values have in common."""
    lists = [[str(name) for name in value] if isinstance(value, list | tuple) else [str(value)] for value in values]
    common = set.intersection(*map(set, lists)) if lists else set()
    shorter = ["-".join(name for name in names if name not in common) for names in lists]
    return [short or "-".join(names) for short, names in zip(shorter, lists, strict=True)]


def _algorithms(values: Sequence[Any]) -> list[str]:
    """Algorithms by name, and by their settings where several have one name."""
    tables = [value if isinstance(value, Mapping) else {"name": value} for value in values]
    names = [str(table.get("name")) for table in tables]
    return [
        name if names.count(name) == 1 else "-".join([name, _plain({k: v for k, v in table.items() if k != "name"})])
        for name, table in zip(names, tables, strict=True)
    ]


def joined(parts: Sequence[str]) -> str:
    """The name of a study from those of its values."""
    name = "_".join(parts)
    return name if len(name) <= LONGEST else f"{name[: LONGEST - 7]}-{_digest(name)}"


def slug(text: str) -> str:
    """Any text as part of a file's name."""
    short = _UNUSUAL.sub("-", text).strip("-.") or "study"
    return short if len(short) <= LONGEST_PART else f"{short[: LONGEST_PART - 7]}-{_digest(text)}"


def _digest(value: Any) -> str:
    return hashlib.sha256(canonical(value).encode()).hexdigest()[:6]
