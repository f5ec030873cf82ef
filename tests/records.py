"""Signatures of records: few numbers that move when any number or word in a record, or in records inside it, does."""

import json
import os
import re
import zlib
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from enum import Enum

import numpy as np

from pareto_monoped import __version__
from tests.cad.signed import GOLDEN

_NUMBER = re.compile(r"(?<![\w.])-?\d+\.?\d*(?:[eE][+-]?\d+)?")
_NEVER_THE_SAME = re.compile(
    rf"{re.escape(__version__)}|(?<![.\w])[0-9a-f]{{16,64}}\b|\S*/pytest-\S*|\b\d\d\d\d-\d\d-\d\d\S*|\b\d\d:\d\d\S*"
    r"|[\d.,]+ (?:s|ms|h|MB|kB|bytes|per second)\b|[\d.]+(?: designs)?/s|\"\w*(?:second|wall_time)\w*\": [\d.]+"
)


def signature(*records):
    """How many numbers the records hold, the sum of their roots weighted by place, and a checksum of all words.

    The roots keep small numbers beside large ones, so that a change of a density in its fifth digit is still seen.
    """
    numbers, words = [], []
    _walk(records, numbers, words)
    values = np.array(numbers)
    values = values[np.isfinite(values)]
    rooted = np.sign(values) * np.sqrt(np.abs(values))
    total = float(rooted @ (1.0 + np.arange(len(values)) * GOLDEN % 1.0))
    return [len(numbers), float(f"{total:.12g}"), zlib.crc32("\n".join(words).encode())]


def _walk(record, numbers, words):
    match record:
        case bool() | None | Enum():
            words.append(str(record))
        case int() | float() | np.number():
            numbers.append(float(record))
        case str():
            words.append(record)
        case np.ndarray() if record.dtype.kind in "fiub":
            numbers += record.astype(np.float64).ravel().tolist()
        case np.ndarray():
            words += map(str, record.ravel().tolist())
        case Mapping():
            for key, value in record.items():
                words.append(str(key))
                _walk(value, numbers, words)
        case tuple() | list():
            for value in record:
                _walk(value, numbers, words)
        case _ if is_dataclass(record):
            for field in fields(record):
                if not field.name.startswith("_"):
                    _walk(getattr(record, field.name), numbers, words)
        case _:
            words.append(type(record).__name__)


def of_text(text, digits=6):
    """The signature of a text: its words, and some digits of its numbers, for the last ones are the machine's."""
    text = _NEVER_THE_SAME.sub("", text)
    numbers = [float(f"{float(one):.{digits}g}") if abs(float(one)) > 1e-9 else 0.0 for one in _NUMBER.findall(text)]
    return signature(numbers, _NUMBER.sub("#", text))


def compare(found, path):
    """Hold signatures by name to those that a file keeps, or keep them there where PARETO_MONOPED_SIGN asks for it."""
    if os.environ.get("PARETO_MONOPED_SIGN"):
        lines = (f" {json.dumps(name)}: {json.dumps(value)}" for name, value in found.items())
        path.write_text("{\n" + ",\n".join(lines) + "\n}\n")
    expected = json.loads(path.read_text())
    assert list(found) == list(expected), set(found) ^ set(expected)
    wrong = {
        name: (value, expected[name])
        for name, value in found.items()
        if value[::2] != expected[name][::2] or not np.isclose(value[1], expected[name][1], rtol=2e-10)
    }
    assert not wrong, f"{wrong}: look at what has changed; CONTRIBUTING.md says how signatures are made again"
