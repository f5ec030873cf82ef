"""At most one writer per study: a lock that ends with its process."""

import fcntl
import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from pareto_monoped.errors import DatabaseError, OutputError


@contextmanager
def locked(db: Path) -> Iterator[None]:
    """Lock the study for this process. The file ``DB-lock`` beside the database holds the process id.

    The kernel releases the lock when the process ends in any way, so a killed run never blocks the next one.

    Raises:
        DatabaseError: another process holds the study.
        OutputError: the folder cannot be written to.
    """
    path = _lock_path(db)
    while True:
        try:
            descriptor = os.open(path, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o666)
        except OSError as error:
            raise OutputError(
                f"study database {str(db)!r}: its folder cannot be written to ({error.strerror}); "
                "give --db FILE in a writable folder"
            ) from None
        try:
            try:
                fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError:
                holder = os.pread(descriptor, 32, 0).decode("ascii", "replace").strip() or "unknown"
                raise DatabaseError(
                    f"study database {str(db)!r}: is being run by process {holder}; wait for it, stop it, "
                    "or give another --db"
                ) from None
            # The previous holder removes the file. If that happened between our opening and our locking it, we have
            # locked a file that nobody else can find, and must try again.
            if not _same_file(descriptor, path):
                continue
            os.ftruncate(descriptor, 0)
            os.pwrite(descriptor, f"{os.getpid()}\n".encode("ascii"), 0)
            try:
                yield
            finally:
                path.unlink(missing_ok=True)
            return
        finally:
            os.close(descriptor)


def holder(db: Path) -> int | None:
    """Process id of the run that holds the study, or None."""
    try:
        descriptor = os.open(_lock_path(db), os.O_RDONLY | os.O_CLOEXEC)
    except OSError:
        return None
    try:
        fcntl.flock(descriptor, fcntl.LOCK_SH | fcntl.LOCK_NB)
    except BlockingIOError:
        text = os.pread(descriptor, 32, 0).decode("ascii", "replace").strip()
        return int(text) if text.isdigit() else None
    else:
        return None
    finally:
        os.close(descriptor)


def _lock_path(db: Path) -> Path:
    return db.with_name(f"{db.name}-lock")


def _same_file(descriptor: int, path: Path) -> bool:
    try:
        there = path.stat()
    except FileNotFoundError:
        return False
    here = os.fstat(descriptor)
    return (here.st_ino, here.st_dev) == (there.st_ino, there.st_dev)
