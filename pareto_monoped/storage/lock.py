"""At most one writer per study: a lock that ends with its process."""

import errno
import fcntl
import os
import stat
from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING

from pareto_monoped.errors import DatabaseError, OutputError
from pareto_monoped.files import is_failure
from pareto_monoped.storage.place import BY_NAME, StudyPlace, inaccessible, require_file_name
from pareto_monoped.storage.server.address import Server

if TYPE_CHECKING:
    from pareto_monoped.storage.server.lock import ServerLock


class Lock:
    """A lock that this process holds; its file has the process id and how much of the study is safe."""

    def __init__(self, descriptor: int, path: Path, before: int) -> None:
        self.path = path
        self.before = before
        """Links of the running hash that were safe when the last holder was killed; 0 if it ended in order."""
        self.settled = before == 0
        """Whether the study is known to have all that was safe; otherwise the file stays, to say so to the next run."""
        self._descriptor = descriptor

    def acknowledge(self, links: int) -> None:
        """Note that so many links of the running hash are safe; what survives a kill tells if they get lost."""
        self.settled = True
        try:
            os.pwrite(self._descriptor, _content(links), 0)
        except OSError as error:
            raise inaccessible(self.path, error) from None


def _content(links: int) -> bytes:
    # Always of the same length, so that one write replaces the other.
    return f"{os.getpid():<10}\n{links:<10}\n".encode("ascii")


def locked(db: StudyPlace) -> "AbstractContextManager[Lock | ServerLock]":
    """Lock the study for this process, on whatever place it stands.

    The lock ends when the process ends in any way, so a killed run never blocks the next one.

    Raises:
        DatabaseError: another process holds the study.
        OutputError: the file's folder cannot be written to, or something else has the name of the lock.
        DiskError: the disk is full or fails.
        ServerError: the server is away.
    """
    if isinstance(db, Path):
        return _locked_file(db)
    from pareto_monoped.storage.server.lock import locked_there

    return locked_there(db)


@contextmanager
def _locked_file(db: Path) -> Iterator[Lock]:
    """Lock a file. The file ``DB-lock`` beside the database, links resolved, holds the process id.

    The kernel releases the lock when the process ends in any way.
    """
    require_file_name(db)
    path = _lock_path(db)
    while True:
        try:
            # A link of that name must not lead to a file that the lock would overwrite.
            descriptor = os.open(path, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC | os.O_NOFOLLOW | os.O_NONBLOCK, 0o666)
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
        try:
            try:
                fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
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
                os.pwrite(descriptor, _content(before), 0)
            except OSError as error:
                path.unlink(missing_ok=True)
                raise inaccessible(db, error) from None
            lock = Lock(descriptor, path, before)
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


def _in_the_way(path: Path) -> OutputError:
    return OutputError(
        f"lock file {str(path)!r}: something else has its name; move that away, or give another database file {BY_NAME}"
    )


def _words(descriptor: int) -> list[str]:
    """The words of a lock file: process id, and how many links are safe; a first one that is no number is unknown."""
    words = os.pread(descriptor, 64, 0).decode("ascii", "replace").split()
    return words if words and words[0].isdigit() else ["unknown", *words]


def holder(db: StudyPlace) -> int | None:
    """Process id of the run that holds the study, or None."""
    if isinstance(db, Server):
        from pareto_monoped.storage.server.lock import holder_there

        return holder_there(db)
    try:
        descriptor = os.open(_lock_path(db), os.O_RDONLY | os.O_CLOEXEC | os.O_NOFOLLOW | os.O_NONBLOCK)
    except OSError:
        return None
    try:
        fcntl.flock(descriptor, fcntl.LOCK_SH | fcntl.LOCK_NB)
    except BlockingIOError:
        word = _words(descriptor)[0]
        return int(word) if word.isdigit() else None
    except OSError:
        return None
    else:
        return None
    finally:
        os.close(descriptor)


def _lock_path(db: Path) -> Path:
    # Two links to a study are the same study.
    resolved = db.resolve()
    return resolved.with_name(f"{resolved.name}-lock")


def _same_file(descriptor: int, path: Path) -> bool:
    try:
        there = path.stat()
    except FileNotFoundError:
        return False
    here = os.fstat(descriptor)
    return (here.st_ino, here.st_dev) == (there.st_ino, there.st_dev)
