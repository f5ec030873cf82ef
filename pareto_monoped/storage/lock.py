"""At most one writer per study file: a lock that ends with its process; files that cannot be a study."""

import errno
import os
import stat
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

try:
    import fcntl
except ImportError:  # on Windows
    fcntl: Any = None  # type: ignore[no-redef]  # mypy reads it as a module

from pareto_monoped.errors import DatabaseError, DiskError, LostTrialsError, OutputError
from pareto_monoped.files import cure_of, is_failure
from pareto_monoped.storage.base import BY_NAME, StudyLock

# Windows has the last alone, which keeps line ends as they are.
_SAFELY = sum(getattr(os, name, 0) for name in ("O_CLOEXEC", "O_NOFOLLOW", "O_NONBLOCK", "O_BINARY"))


def inaccessible(path: Path, error: OSError) -> DatabaseError | DiskError:
    """Return the error for a database that the system does not let us read or write."""
    kind = DiskError if is_failure(error) else DatabaseError
    said = error.strerror or error
    return kind(f"study database {str(path)!r}: cannot be read or written ({said}); {cure_of(error)}")


def require_file_name(path: Path) -> None:
    """Refuse what cannot be the name of a database: a folder, a device or pipe, or what the system does not take."""
    try:
        mode = path.stat().st_mode
    except FileNotFoundError:
        return
    except OSError as error:
        raise inaccessible(path, error) from None
    except ValueError:
        raise DatabaseError(f"study database {str(path)!r}: cannot be the name of a file; check the path") from None
    if not stat.S_ISREG(mode):
        what = "a folder" if stat.S_ISDIR(mode) else "no regular file"
        raise DatabaseError(f"study database {str(path)!r}: is {what}; give the name of a file")


class Lock(StudyLock):
    """A lock that this process holds; its file has the process id and how much of the study is safe."""

    def __init__(self, descriptor: int, path: Path, db: Path, before: int) -> None:
        self._descriptor, self._path, self._db = descriptor, path, db
        self._before = before  #: links of the running hash that were safe when the last holder was killed, else 0
        #: whether the study is known to have all that was safe; otherwise the file stays, to say so to the next run
        self.settled = before == 0

    def confirm(self, links: int) -> None:
        """Raise ``LostTrialsError`` if a study of so many links of the running hash lacks what was safe before."""
        if links < self._before:
            raise LostTrialsError(
                f"study database {str(self._db)!r}: lacks the last {self._before - links} transactions of a killed "
                f"run, which were safe: its log {self._db.name + '-wal'!r} was deleted, or an older copy was put back; "
                f"restore both, or delete {self._path.name!r} to go on from here"
            )
        self.acknowledge(links)

    def acknowledge(self, links: int) -> None:
        """Note that so many links of the running hash are safe; what survives a kill tells if they get lost."""
        self.settled = True
        try:
            _write(self._descriptor, _content(links))
        except OSError as error:
            raise inaccessible(self._path, error) from None


def _content(links: int) -> bytes:
    # Always of the same length, so that one write replaces the other.
    return f"{os.getpid():<10}\n{links:<10}\n".encode("ascii")


def _write(descriptor: int, content: bytes) -> None:
    os.lseek(descriptor, 0, os.SEEK_SET)  # Windows has no pwrite; nobody else uses this descriptor
    os.write(descriptor, content)


def _claim(descriptor: int, path: Path, *, shared: bool = False) -> Callable[[], None]:
    """Lock an open lock file until it is closed; return what must be called after that.

    Without ``fcntl``, SQLite locks a second, empty file: Windows does not let a locked file be read, but who is refused
    reads who holds it.

    Raises:
        BlockingIOError: another process, or another lock of this one, holds it.
    """
    if fcntl is not None:
        fcntl.flock(descriptor, (fcntl.LOCK_SH if shared else fcntl.LOCK_EX) | fcntl.LOCK_NB)
        return lambda: None
    import sqlite3

    guard = path.with_name(f"{path.name}-guard")
    if shared and not guard.exists():
        return lambda: None
    connection = sqlite3.connect(guard, timeout=0.0, isolation_level=None)
    try:
        connection.execute("SELECT * FROM sqlite_master" if shared else "BEGIN EXCLUSIVE")
    except sqlite3.OperationalError:
        connection.close()
        raise BlockingIOError from None

    def release() -> None:
        connection.close()
        if not shared:
            with suppress(OSError):  # another process has it by now; Windows deletes no open file
                guard.unlink(missing_ok=True)

    return release


@contextmanager
def locked(db: Path) -> Iterator[Lock]:
    """Lock a file for this process, by the file ``DB-lock`` beside it, links resolved.

    The kernel releases the lock when the process ends in any way, so a killed run never blocks the next one.

    Raises:
        DatabaseError: another process holds the file.
        OutputError: the folder cannot be written to, or something else has the name of the lock.
        DiskError: the disk is full or fails.
    """
    require_file_name(db)
    path = _lock_path(db)
    while True:
        try:
            # A link of that name must not lead to a file that the lock would overwrite.
            descriptor = os.open(path, os.O_RDWR | os.O_CREAT | _SAFELY, 0o666)
        except OSError as error:
            if path.is_symlink() or path.is_dir():
                raise _in_the_way(path) from None
            if is_failure(error):
                raise inaccessible(db, error) from None
            if error.errno == errno.ENAMETOOLONG:
                raise OutputError(
                    f"study database {str(db)!r}: its name is too long for the files beside it; give a shorter one"
                ) from None
            raise OutputError(
                f"study database {str(db)!r}: its folder cannot be written to ({error.strerror}); "
                f"give a database file in a writable folder {BY_NAME}"
            ) from None
        lock, release = None, None
        try:
            try:
                release = _claim(descriptor, path)
            except BlockingIOError:
                raise DatabaseError(
                    f"study database {str(db)!r}: is being run by process {_words(descriptor)[0]}; wait for it, stop "
                    f"it, or give another database file {BY_NAME}"
                ) from None
            # The previous holder removes the file. If that happened between our opening and our locking it, we have
            # locked a file that nobody else can find, and must try again.
            if not _same_file(descriptor, path):
                continue
            if not stat.S_ISREG(os.fstat(descriptor).st_mode):
                raise _in_the_way(path)
            words = _words(descriptor)
            if not all(word.isdigit() for word in words[1:]):
                raise _in_the_way(path)
            before = int(words[1]) if len(words) > 1 else 0
            try:
                os.ftruncate(descriptor, 0)
                _write(descriptor, _content(before))
            except OSError as error:
                path.unlink(missing_ok=True)
                raise inaccessible(db, error) from None
            lock = Lock(descriptor, path, db, before)
            try:
                yield lock
            finally:
                if lock.settled:
                    # In a folder that may no longer be written to it stays, and is free for the next run.
                    with suppress(OSError):
                        path.unlink(missing_ok=True)
            return
        finally:
            os.close(descriptor)
            if fcntl is None and lock is not None and lock.settled:
                with suppress(OSError):  # Windows deletes no open file
                    path.unlink(missing_ok=True)
            if release is not None:
                release()


def _in_the_way(path: Path) -> OutputError:
    return OutputError(
        f"lock file {str(path)!r}: something else has its name; move that away, or give another database file {BY_NAME}"
    )


def _words(descriptor: int) -> list[str]:
    """Return the words of a lock file: process id (``unknown`` if it is no number), and how many links are safe."""
    os.lseek(descriptor, 0, os.SEEK_SET)
    words = os.read(descriptor, 64).decode("ascii", "replace").split()
    return words if words and words[0].isdigit() else ["unknown", *words]


def holder(db: Path) -> int | None:
    """Return the process id of the run that holds a file, or None."""
    path = _lock_path(db)
    try:
        descriptor = os.open(path, os.O_RDONLY | _SAFELY)
    except OSError:
        return None
    try:
        _claim(descriptor, path, shared=True)()
    except BlockingIOError:
        word = _words(descriptor)[0]
        return int(word) if word.isdigit() else None
    except OSError:
        pass
    finally:
        os.close(descriptor)
    return None


def _lock_path(db: Path) -> Path:
    # Two links to a study are the same study.
    resolved = db.resolve()
    return resolved.with_name(f"{resolved.name}-lock")


def _same_file(descriptor: int, path: Path) -> bool:
    try:
        return os.path.samestat(os.fstat(descriptor), path.stat())
    except FileNotFoundError:
        return False
