"""The folder of an export: it is complete or absent, nothing is written outside it, and foreign files stay.

A file is foreign unless the record of an earlier export lists it, under a name that an export writes.
"""

import re
import secrets
from collections.abc import Collection, Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path

from pareto_monoped.cad.write.formats import ALWAYS, FILES, RECORD
from pareto_monoped.cad.write.unbroken import noted, unbroken
from pareto_monoped.config import read_json
from pareto_monoped.errors import OutputError
from pareto_monoped.files import FORCE, unwritable

_SAFE_NAME = re.compile(r"[a-z0-9_]+")


def require_free(out_dir: Path, *, force: bool) -> None:
    """Refuse a place that must not be written to.

    Raises:
        OutputError: a file, a folder that is not empty without ``force``, or one with foreign files in the way.
        DiskError: the disk fails.
    """
    try:
        if out_dir.exists() and not out_dir.is_dir():
            raise OutputError(f"output {str(out_dir)!r}: is a file; give the name of a folder")
        filled = out_dir.is_dir() and any(out_dir.iterdir())
    except OSError as error:
        raise unwritable(out_dir, error, "give a folder that can be read and written") from error
    if filled and not force:
        raise OutputError(
            f"output {str(out_dir)!r}: is not empty; give another folder, or {FORCE} to replace an export"
        )
    if filled:  # before the work of an export, not only after it
        _require_own(out_dir, ALWAYS, _earlier_files(out_dir))


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
    # The name is noted before there is a folder, because an interrupt may come as soon as it has been made. With 64
    # random bits it is nobody else's.
    folder = out_dir.parent / f".{out_dir.name}-{secrets.token_hex(8)}"
    with noted(folder):
        try:
            out_dir.parent.mkdir(parents=True, exist_ok=True)
            folder.mkdir()
        except OSError as error:
            raise unwritable(out_dir, error, "give a writable folder") from error
        try:
            yield folder
        except OSError as error:
            raise unwritable(out_dir, error, "make room or give another") from error


def move_in(folder: Path, out_dir: Path) -> None:
    """Put a finished folder in its place, instead of the files of an earlier export; other files stay.

    An interrupt waits until this is done.

    Raises:
        OutputError: a foreign file has the name of one of the new files; nothing has changed then.
    """
    with unbroken():
        _move(folder, out_dir)


def _move(folder: Path, out_dir: Path) -> None:
    if not out_dir.exists() or not any(out_dir.iterdir()):
        folder.replace(out_dir)
        return
    earlier = _earlier_files(out_dir)
    _require_own(out_dir, files_in(folder), earlier)
    for path in earlier:
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


def _require_own(out_dir: Path, names: Iterable[str], earlier: Collection[Path]) -> None:
    """Refuse to replace what no earlier export made: a foreign file, or anything else that has a file's name."""
    own = set(earlier)
    for name in names:
        path = out_dir / name
        taken = [parent for parent in path.parents[: name.count("/")] if parent.exists() and not parent.is_dir()]
        if not taken and path not in own and (path.is_symlink() or path.exists()):
            taken = [path]
        if taken:
            raise OutputError(
                f"output {str(out_dir)!r}: {str(taken[0].relative_to(out_dir))!r} is not of an earlier export and "
                "would be lost; move it away, or give another folder"
            )


def _earlier_files(out_dir: Path) -> list[Path]:
    """Files that an earlier export wrote here, its record first."""
    try:
        names = [str(name) for name in read_json(out_dir / RECORD)["files"]]
    except (OSError, ValueError, KeyError, TypeError):
        return []  # nothing here is known to be ours
    # The record is a file like any other: it may neither point outside, nor at what no export writes.
    paths = [out_dir / name for name in (RECORD, *filter(_written_by_exports, names))]
    return [
        path
        for path in paths
        if path.is_file() and not path.is_symlink() and path.parent.resolve().is_relative_to(out_dir.resolve())
    ]


def _written_by_exports(name: str) -> bool:
    """Whether an export writes a file of this name, or into its folder at least, of which not all files are listed."""
    made = (*ALWAYS, *(path for files in FILES.values() for path, _ in files))
    first, *rest = Path(name).parts or ("",)
    folders = {path.partition("/")[0] for path in made if "/" in path}
    return ".." not in rest and (first in folders if rest else name in made)
