"""Write files so that they are complete or absent: first beside the target, then renamed.

No output replaces a study, and none replaces a file of another kind unless ``force`` is set. Arrays that every command
would compute anew are kept in the user's cache.
"""

import errno
import hashlib
import os
import platform
import secrets
import stat
import sys
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO

from pareto_monoped.errors import DiskError, OutputError

if TYPE_CHECKING:
    from numpy.typing import NDArray

SQLITE = b"SQLite format 3\x00"  #: How a database begins (SQLite's file format, section 1.3).
FORCE = "--force (in Python force=True)"  #: What allows an output to be replaced, on the command line and in Python.
_BESIDE_A_DATABASE = ("-wal", "-shm", "-journal", "-lock", "-lock-guard")


@contextmanager
def replacing(path: Path, *, force: bool = False) -> Iterator[Path]:
    """Yield a temporary path beside ``path``, which replaces ``path`` if the block succeeds and is deleted if not.

    The temporary file keeps the suffix of ``path``, for writers that choose the format by it.

    Raises:
        OutputError: the folder is missing or cannot be written to, or ``path`` is a database, a device, or, without
            ``force``, a file of another kind.
        DiskError: the disk is full or fails.
    """
    refuse_database(path)
    with temporary_beside(path) as temporary:
        try:
            yield temporary
        except OSError as error:
            if error.filename not in (None, str(temporary)) or not is_failure(error):
                raise
            raise unwritable(path, error, "") from error
        if not force and path.is_file() and (old := _kind(path)) and old != _kind(temporary):
            raise OutputError(
                f"output {str(path)!r}: is a file of another kind, which would be lost; give another name, or {FORCE}"
            )
        try:
            temporary.replace(path)
        except OSError as error:
            raise unwritable(path, error, "give the name of a file") from error


@contextmanager
def temporary_beside(path: Path, temporary: Path | None = None) -> Iterator[Path]:
    """Yield a new, empty file beside ``path``, with its suffix and ordinary permissions; at the end it is deleted.

    A writer that holds a lock gives the new file's name; what a killed writer left there is deleted.

    Raises:
        OutputError: the folder is missing or cannot be written to.
        DiskError: the disk is full or fails.
    """
    if temporary is None:
        # With 64 random bits it is nobody else's name.
        temporary = path.parent / f".{path.stem}-{secrets.token_urlsafe(8)}{path.suffix}"
    try:  # from here on, because an interrupt may come as soon as there is a file
        try:
            temporary.unlink(missing_ok=True)
            temporary.touch(exist_ok=False)
        except OSError as error:
            raise unwritable(path, error, "give a file in a writable folder") from error
        yield temporary
    finally:
        for end in ("", *_BESIDE_A_DATABASE):
            with suppress(OSError):
                Path(f"{temporary}{end}").unlink(missing_ok=True)


def rename_new(source: Path, target: Path) -> None:
    """Rename a file in one step that replaces nothing; raise ``FileExistsError`` if there is a target.

    Linux alone does so by renameat2 (its manual page, RENAME_NOREPLACE). Elsewhere a kill may leave both names.
    """
    import ctypes

    with suppress(AttributeError, TypeError):  # macOS has no such function, Windows no C library of this name
        names = os.fsencode(source.absolute()), os.fsencode(target.absolute())
        if ctypes.CDLL(None, use_errno=True).renameat2(-1, names[0], -1, names[1], ctypes.c_uint(1)) == 0:
            return
    try:
        os.link(source, target)
        source.unlink()
    except FileExistsError:
        raise
    except OSError:  # a file system without links
        if target.exists():
            raise FileExistsError(errno.EEXIST, "is there", str(target)) from None
        source.replace(target)


def refuse_database(path: Path) -> None:
    """Raise ``OutputError`` for a study, any other database, a file that belongs to one, or a device."""
    try:
        mode = path.stat().st_mode
    except (OSError, ValueError):
        mode = 0
    if stat.S_ISCHR(mode) or stat.S_ISBLK(mode):  # whoever may write to its folder would replace the device
        raise OutputError(f"output {str(path)!r}: is a device; give the name of a file")
    beside = next((end for end in _BESIDE_A_DATABASE if path.name.endswith(end)), None)
    database = path if beside is None else path.with_name(path.name.removesuffix(beside))
    if _beginning(database).startswith(SQLITE):
        what = "is a database" if beside is None else f"belongs to the database {str(database)!r}"
        raise OutputError(f"output {str(path)!r}: {what}, which no output replaces; give another name")


def require_writable(path: Path) -> None:
    """Refuse an output that could not be written, before work is done for it; raises as ``temporary_beside`` does."""
    refuse_database(path)
    with temporary_beside(path):
        pass


def open_file(path: Path) -> BinaryIO:
    """Open a regular file for reading; raise ``OSError`` for a pipe, socket or device, which may never end."""
    # Without O_NONBLOCK, which Windows lacks, opening a pipe waits until somebody writes to it.
    flags = os.O_RDONLY | getattr(os, "O_NONBLOCK", 0)
    stream = os.fdopen(os.open(path, flags), "rb")
    if not stat.S_ISREG(os.fstat(stream.fileno()).st_mode):
        stream.close()
        raise OSError(errno.EINVAL, "it is no regular file", str(path))
    return stream


def _beginning(path: Path) -> bytes:
    try:
        with open_file(path) as stream:
            return stream.read(4096)
    except OSError:
        return b""


def _kind(path: Path) -> tuple[bytes, ...]:
    """Return how files of this kind begin; empty for an empty file.

    For pictures this is the magic number, for tables the first column's name, for other text the beginnings of its
    lines.
    """
    content = _beginning(path)
    if content[4:8] == b"ftyp":  # MP4 begins with the length of its first box
        return (content[4:8],)
    for magic in _MAGIC:
        if content.startswith(magic):
            return (magic,)
    lines = content.splitlines()
    if lines and not content.startswith(b"<"):
        return (lines[0].split(b",")[0],)
    return tuple(line.strip()[:_TOLD] for line in lines[:_LINES])


_MAGIC = (b"\x89PNG", b"GIF8", b"\x1aE\xdf\xa3", b"PAR1")  #: How PNG, GIF, WebM and Parquet files begin.
_LINES, _TOLD = 5, 24  #: Lines, and bytes of each, that tell pages and models from others. Our own choice.


_FAILURES = {
    errno.ENOSPC: "make room and try again",
    errno.EDQUOT: "make room and try again",
    errno.EIO: "check the disk's health",
    errno.EFBIG: "raise the limit on the size of files (ulimit -f)",
    errno.EMFILE: "raise the limit on open files (ulimit -n)",
    errno.ENFILE: "close other programs",
    errno.ENOMEM: "close other programs",
    errno.EAGAIN: "close other programs",
}  #: Errors of a system that is full or fails, whatever file it is about, and their cures.
_REFUSALS = {
    errno.ENOENT: "check the path",
    errno.ENOTDIR: "check the path",
    errno.EISDIR: "give the name of a file",
    errno.ENAMETOOLONG: "give a shorter name",
    errno.ELOOP: "remove the circular link",
    errno.EROFS: "give a place that can be written to",
}


def is_failure(error: OSError) -> bool:
    """Return whether the system is full or fails, rather than that what the user gave cannot be used."""
    return error.errno in _FAILURES


def cure_of(error: OSError) -> str:
    """Return what helps against an error of the system."""
    number = error.errno or 0
    return (_FAILURES | _REFUSALS).get(number, "allow access to it, or give another")


ADRIFT = "working directory: has been deleted; change to a folder that exists"


def is_adrift() -> bool:
    """Return whether the working directory was deleted: names of files then lead nowhere, and no process can start."""
    try:
        os.getcwd()
    except FileNotFoundError:
        return True
    return False


def unwritable(path: Path, error: OSError, cure: str) -> OutputError | DiskError:
    """Return the error for a path that cannot be written; ``cure`` helps unless the system is full or fails."""
    if error.errno == errno.ENOENT and is_adrift():
        return OutputError(ADRIFT)
    kind = DiskError if is_failure(error) else OutputError
    if is_failure(error) or error.errno == errno.ENAMETOOLONG:
        cure = cure_of(error)
    return kind(f"output {str(path)!r}: cannot be written ({error.strerror or error}); {cure}")


def write_text(path: Path, text: str, *, force: bool = False) -> None:
    """Write ``text`` as UTF-8 to ``path``, completely or not at all; see ``replacing``."""
    with replacing(path, force=force) as temporary:
        temporary.write_text(text, encoding="utf-8", newline="\n")


def write_bytes(path: Path, data: bytes, *, force: bool = False) -> None:
    """Write ``data`` to ``path``, completely or not at all; see ``replacing``."""
    with replacing(path, force=force) as temporary:
        temporary.write_bytes(data)


CACHE = "PARETO_MONOPED_CACHE"
"""Environment variable: the folder of what is kept, instead of ``~/.cache/pareto_monoped``; empty keeps nothing."""
_MOST_KEPT = 200  # files of some 20 kB each: about 30 motors


def kept(key: str | None, make: Callable[[], Mapping[str, "NDArray[Any]"]]) -> Mapping[str, "NDArray[Any]"]:
    """Return the arrays that ``make`` computes, from the user's cache if they were computed there before.

    ``key`` must name everything that decides them but code, data files, NumPy and the machine, which are added to it;
    None keeps nothing. Nothing is unpickled. Whatever is wrong with the cache or its files, the arrays are computed.
    """
    import numpy as np

    if key is None or (folder := _cache_folder()) is None:
        return make()
    path = folder / f"{hashlib.sha256((_stamp() + key).encode()).hexdigest()[:32]}.npz"
    # A damaged archive raises what its bytes lead to: errors of zipfile, zlib, struct and NumPy.
    with suppress(Exception), path.open("rb") as stream, np.load(stream, allow_pickle=False) as stored:
        return dict(stored)
    made = make()
    with suppress(OSError, OutputError, DiskError):
        folder.mkdir(parents=True, exist_ok=True)
        with temporary_beside(path) as temporary:
            with temporary.open("wb") as target:
                np.savez(target, allow_pickle=False, **made)
            temporary.replace(path)
        for old in sorted(folder.glob("*.npz"), key=lambda one: one.stat().st_mtime)[:-_MOST_KEPT]:
            old.unlink(missing_ok=True)
    return made


def _cache_folder() -> Path | None:
    named = os.environ.get(CACHE)
    if named is not None:
        return Path(named) if named else None
    if other := os.environ.get("XDG_CACHE_HOME"):
        return Path(other) / "pareto_monoped"
    with suppress(RuntimeError):  # a user without a home, whom Debian gives /nonexistent: it stays so
        return Path.home() / ".cache" / "pareto_monoped" if Path.home().is_dir() else None
    return None


@cache
def _stamp() -> str:
    """Return what changes with code and data of the package, with NumPy, and with the machine."""
    import numpy as np

    digest = hashlib.sha256(repr((sys.version, np.__version__, platform.machine(), platform.node())).encode())
    for path in sorted(Path(__file__).parent.rglob("*")):
        if path.suffix in (".py", ".toml") and path.is_file():  # an editor's lock is a link to nothing
            digest.update(path.read_bytes())
    return digest.hexdigest()
