"""What must hold after a call of ``fuzz.py``: its exit code, what it says, and the files that it leaves."""

import contextlib
import hashlib
import json
import os
import re
import signal
import xml.etree.ElementTree as ElementTree
import zipfile
from collections.abc import Iterator
from pathlib import Path

from fuzz_calls import Call
from fuzz_harm import STUDIES

Snapshot = dict[str, tuple[str, str]]
"""Path of each file -> kind and digest of its content."""
Result = tuple[int | None, str, str]
"""Exit code, None for a call that hangs; output; messages."""
WRITERS = {"run", "resume", "robust", "sensitivity", "repair", "pareto", "campaign"}
"""Commands that continue a study, or keep in it what they found."""
_CONTROL = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\u202a-\u202e\u2066-\u2069\u2028\u2029]")
_STYLE = re.compile("\x1b\\[[0-9;]*m")
_FAULTS = (
    "Traceback (most recent",
    "error: unexpected ",
    "Exception ignored",
    "Warning:",
    "Segmentation",
    "Fatal Python",
    "np.float64(",
)
_BESIDE = ("-wal", "-shm", "-journal", "-lock")


def snapshot(folder: Path) -> Snapshot:
    """Every file of a folder: kind and digest of its content."""
    found = {}
    for path in folder.rglob("*"):
        if path.is_symlink():
            found[str(path.relative_to(folder))] = ("link", os.readlink(path))
        elif path.is_file():
            content = path.read_bytes()
            kind = "database" if content.startswith(b"SQLite format 3") else "text"
            found[str(path.relative_to(folder))] = (kind, hashlib.blake2b(content).hexdigest())
    return found


def findings(call: Call, folder: Path, before: Snapshot, result: Result) -> Iterator[str]:
    """What is wrong with how a call ended."""
    code, out, err = result
    options = call.options
    # A signal may come before the command has taken over its process.
    killed = {-signal.Signals[strike[0]]} if isinstance(strike := options.get("signal"), tuple) else set()
    if code not in {0, 1, 2, 130} | killed:
        yield "hangs" if code is None else f"exit code {code}"
    text = out + err
    if call.environment.get("FORCE_COLOR"):
        text = _STYLE.sub("", text)
    for fault in _FAULTS:
        if fault in text:
            yield fault
    if _CONTROL.search(text):
        yield f"control character {_CONTROL.search(text)!r}"
    heard = "stderr" not in options and call.environment.get("PYTHONIOENCODING") != "utf-16"
    if code in (1, 2) and heard and (not err or not err.splitlines()[-1].startswith("error: ")):
        yield "no line says why"
    if code == 0 and "--json" in call.words and "--help" not in call.words and not {"stdout", "signal"} & set(options):
        with contextlib.suppress(IndexError):
            try:
                for text in out.splitlines() if call.words[0] in ("run", "resume", "campaign") else [out]:
                    json.loads(text, parse_constant=lambda name: 1 / 0)
            except (ValueError, ZeroDivisionError):
                if call.environment.get("PYTHONIOENCODING") != "utf-16":
                    yield "JSON that is none"
    yield from _file_findings(call, folder, before, code)


def _file_findings(call: Call, folder: Path, before: Snapshot, code: int | None) -> Iterator[str]:
    after = snapshot(folder)
    command, limited = call.words[0], {"file_size", "tiny_disk", "signal", "files"} & set(call.options)
    writes = command in WRITERS
    for name, content in before.items():
        now = after.get(name)
        if now == content or name.endswith(_BESIDE):
            continue
        if content[0] == "database":
            if not writes and not any(f"{name}{end}" in before for end in _BESIDE):
                yield f"{name} was changed by {command}"
            elif now is None or now[0] != "database":
                yield f"{name} is no database any more"
        elif now is None or name not in call.words or ("--force" not in call.words and name in ("notes.txt",)):
            yield f"{name} was changed"
    for name in sorted(set(after) - set(before)):
        path = folder / name
        if name.endswith(_BESIDE) and writes and limited:
            continue
        if name.endswith(_BESIDE) and any(f"{db}{end}" in before for db in STUDIES for end in _BESIDE):
            continue
        if path.name.startswith(".") or path.name == "MUJOCO_LOG.TXT" or name.endswith(_BESIDE):
            yield f"{name} was left behind"
        elif path.is_file() and not _whole(path):
            yield f"{name} is half-written"


def _whole(path: Path) -> bool:
    content = path.read_bytes()
    if content.startswith(b"SQLite format 3"):
        return True
    if content.startswith(b"\x89PNG"):
        return content.rstrip().endswith(b"IEND\xaeB`\x82")
    if content.startswith((b"<!doctype html", b"<!DOCTYPE html")):
        return content.rstrip().endswith(b"</html>")
    if content.startswith(b"glTF"):  # its third word is its length
        return int.from_bytes(content[8:12], "little") == len(content)
    if content.startswith(b"PK"):  # a 3MF file is a ZIP archive, whose directory comes last
        return zipfile.is_zipfile(path)
    if content.startswith(b"PAR1"):  # Parquet ends as it begins
        return content.endswith(b"PAR1")
    if content.startswith(b"GIF8"):
        return content.endswith(b";")
    if content.startswith(b"%PDF"):
        return content.rstrip().endswith(b"%%EOF")
    if path.suffix == ".stl":  # binary: a head of 80 bytes, the number of triangles, 50 bytes for each
        return len(content) == 84 + 50 * int.from_bytes(content[80:84], "little")
    if content.startswith(b"<"):
        try:
            ElementTree.fromstring(content)
        except ElementTree.ParseError:
            return False
        return True
    return content.endswith(b"\n")
