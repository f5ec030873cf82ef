"""Write files so that they are complete or absent: first beside the target, then renamed."""

import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from pareto_monoped.errors import OutputError


@contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """Yield a temporary path beside ``path``, which replaces ``path`` if the block succeeds and is deleted if not.

    The temporary file keeps the suffix of ``path``, for writers that choose the format by it.

    Raises:
        OutputError: the folder is missing or cannot be written to.
    """
    try:
        handle, name = tempfile.mkstemp(prefix=f".{path.stem}-", suffix=path.suffix, dir=path.parent)
    except OSError as error:
        raise unwritable(path, error, "give a file in a writable folder") from error
    os.close(handle)
    temporary = Path(name)
    try:
        yield temporary
        # mkstemp makes private files, but results should have the permissions of any other file of the user.
        temporary.chmod(0o666 & ~current_umask())
        try:
            temporary.replace(path)
        except OSError as error:
            raise unwritable(path, error, "give the name of a file") from error
    finally:
        temporary.unlink(missing_ok=True)


def unwritable(path: Path, error: OSError, cure: str) -> OutputError:
    """The error for a file or folder that the system does not let us write."""
    return OutputError(f"output {str(path)!r}: cannot be written ({error.strerror or error}); {cure}")


def current_umask() -> int:
    """The permissions that this process withholds from new files; the system offers no way to only read them."""
    umask = os.umask(0)
    os.umask(umask)
    return umask


def write_text(path: Path, text: str) -> None:
    """Write ``text`` as UTF-8 to ``path``, completely or not at all."""
    with replacing(path) as temporary:
        temporary.write_text(text, encoding="utf-8", newline="\n")


def write_bytes(path: Path, data: bytes) -> None:
    """Write ``data`` to ``path``, completely or not at all."""
    with replacing(path) as temporary:
        temporary.write_bytes(data)
