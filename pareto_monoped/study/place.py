"""Where a study database stands: names that cannot be one, and files that the system does not let us use."""

import stat
from pathlib import Path

from pareto_monoped.errors import DatabaseError, DiskError
from pareto_monoped.files import cure_of, is_failure


def inaccessible(path: Path, error: OSError) -> DatabaseError | DiskError:
    """The error for a database that the system does not let us read or write."""
    kind = DiskError if is_failure(error) else DatabaseError
    said = error.strerror or error
    return kind(f"study database {str(path)!r}: cannot be read or written ({said}); {cure_of(error)}")


def require_file_name(path: Path) -> None:
    """Refuse what cannot be the name of a database.

    Raises:
        DatabaseError: a folder, a device or pipe, or a name that the system does not take.
    """
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
