"""The folder of an export: it is complete or absent, nothing is written outside it, and foreign files stay."""

import json
import re
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from pareto_monoped.cad.write.unbroken import noted, unbroken
from pareto_monoped.errors import OutputError
from pareto_monoped.files import current_umask, unwritable

RECORD = "design.json"
"""Name of the file that lists all files of an export; it is written last."""
_SAFE_NAME = re.compile(r"[a-z0-9_]+")


def require_free(out_dir: Path, *, force: bool) -> None:
    """Refuse a place that must not be written to.

    Raises:
        OutputError: a file, or a folder that is not empty without ``force``.
    """
    if out_dir.exists() and not out_dir.is_dir():
        raise OutputError(f"output {str(out_dir)!r}: is a file; give the name of a folder")
    if out_dir.is_dir() and any(out_dir.iterdir()) and not force:
        raise OutputError(
            f"output {str(out_dir)!r}: is not empty; give another folder, or --force to replace an export"
        )


def safe(name: str) -> str:
    """A name that cannot lead out of the folder.

    Raises:
        OutputError: it could.
    """
    if not _SAFE_NAME.fullmatch(name):
        raise OutputError(f"part name {name!r}: must be letters, digits and underscores to become a file; rename it")
    return name


def write(folder: Path, name: str, content: str | bytes) -> None:
    """Write a file of the folder."""
    path = _path(folder, name)
    if isinstance(content, str):
        path.write_text(content, encoding="utf-8", newline="\n")
    else:
        path.write_bytes(content)


def files_in(folder: Path) -> list[str]:
    """All files of a folder, as paths relative to it."""
    return sorted(str(path.relative_to(folder)) for path in folder.rglob("*") if path.is_file())


@contextmanager
def beside(out_dir: Path) -> Iterator[Path]:
    """A temporary folder beside the target; what is still in it when the block ends is deleted."""
    try:
        out_dir.parent.mkdir(parents=True, exist_ok=True)
        folder = Path(tempfile.mkdtemp(prefix=f".{out_dir.name}-", dir=out_dir.parent))
    except OSError as error:
        raise unwritable(out_dir, error, "give a writable folder") from error
    try:
        with noted(folder):
            # mkdtemp makes private folders, but an export should have the permissions of any other folder of the user.
            folder.chmod(0o777 & ~current_umask())
            yield folder
    except OSError as error:
        raise unwritable(out_dir, error, "make room or give another") from error


def move_in(folder: Path, out_dir: Path) -> None:
    """Put a finished folder in its place, instead of the files of an earlier export; other files stay.

    An interrupt waits until this is done.
    """
    with unbroken():
        _move(folder, out_dir)


def _move(folder: Path, out_dir: Path) -> None:
    if not out_dir.exists() or not any(out_dir.iterdir()):
        folder.replace(out_dir)
        return
    for path in _earlier_files(out_dir):
        path.unlink(missing_ok=True)
    for path in sorted(folder.rglob("*")):
        if path.is_file() and path.name != RECORD:
            path.replace(_path(out_dir, str(path.relative_to(folder))))
    # Last, so that a folder with a record is whole.
    (folder / RECORD).replace(out_dir / RECORD)


def _path(folder: Path, name: str) -> Path:
    # The folder itself is not made: once it has been deleted, a thread that still writes must not bring it back.
    path = folder / name
    for parent in reversed(path.relative_to(folder).parents[:-1]):
        (folder / parent).mkdir(exist_ok=True)
    return path


def _earlier_files(out_dir: Path) -> list[Path]:
    """Files that an earlier export wrote here, its record first."""
    try:
        names = json.loads((out_dir / RECORD).read_text(encoding="utf-8"))["files"]
        paths = [(out_dir / RECORD).resolve(), *((out_dir / str(name)).resolve() for name in names)]
    except (OSError, ValueError, KeyError, TypeError):
        return []
    # The record is a file like any other: it may not point outside.
    return [path for path in paths if path.is_relative_to(out_dir.resolve()) and path.is_file()]
