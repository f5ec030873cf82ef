"""Where a study stands: in a file or on a server; names that cannot be one, and files that we may not use."""

import stat
from pathlib import Path

from pareto_monoped.errors import DatabaseError, DiskError, require_extra
from pareto_monoped.files import cure_of, is_failure
from pareto_monoped.storage.server.address import Server, is_address, server_of

BY_NAME = "(--db, in Python db=...)"
"""How a database is named, on the command line and in Python."""
StudyPlace = Path | Server
"""A database file, or a schema on a server."""


def place_of(text: str) -> StudyPlace:
    """The place that a user names: the address of a server, else a file.

    Raises:
        DatabaseError: an address that cannot be one of a study.
        InputError: what speaks to servers is not installed.
    """
    if not is_address(text):
        return Path(text)
    server = server_of(text)
    require_extra("postgres", f"study database {str(server)!r}", instead="give the name of a file")
    return server


def inaccessible(path: StudyPlace, error: OSError) -> DatabaseError | DiskError:
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
