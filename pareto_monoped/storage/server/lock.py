"""At most one writer per study on a server: an advisory lock of the session, which ends with its connection."""

import hashlib
import re
import time
from collections.abc import Iterator
from contextlib import ExitStack, closing, contextmanager

from pareto_monoped.errors import DatabaseError
from pareto_monoped.storage.server.address import Server
from pareto_monoped.storage.server.connection import ServerConnection
from pareto_monoped.storage.server.failures import translated_there

_WAIT_S, _TRY_S = 3.0, 0.05
"""How long a lock is asked for, and how often: a server notices within moments that a process was killed, and frees
what it held."""
_HOLDER = """
SELECT application_name FROM pg_locks JOIN pg_stat_activity USING (pid)
WHERE locktype = 'advisory' AND granted AND objsubid = 1 AND classid = ?::bigint::oid AND objid = ?::bigint::oid
AND database = (SELECT oid FROM pg_database WHERE datname = current_database())
"""


class ServerLock:
    """A lock that a session holds; what was safe stays safe on a server, so nothing is noted of it."""

    before = 0
    """Links of the running hash of which a lock file would know."""

    def acknowledge(self, links: int) -> None:
        """Nothing to note."""


@contextmanager
def locked_there(server: Server) -> Iterator[ServerLock]:
    """Hold the study's lock in a session of its own.

    Raises:
        DatabaseError: another session holds it.
        ServerError: the server is away.
    """
    with ExitStack() as stack:
        with translated_there(server):
            connection = ServerConnection(server)
            stack.callback(connection.close)
            take(connection, server, "run")
        yield ServerLock()


def take(connection: ServerConnection, server: Server, what: str) -> None:
    """Take a lock of the study for a session, until this ends.

    Args:
        connection: the session.
        server: the study.
        what: ``run`` for the process that runs a study, ``write`` for the session that writes: should a run lose the
            first of its two sessions, the second still keeps others from writing.

    Raises:
        DatabaseError: another session holds it.
    """
    deadline_s = time.monotonic() + _WAIT_S
    while not connection.execute("SELECT pg_try_advisory_lock(?)", (_key(server, what),)).fetchone()[0]:
        if time.monotonic() > deadline_s:
            raise DatabaseError(
                f"study database {str(server)!r}: is being run by {_words(_program(connection, server, what))}; wait "
                "for it, stop it, or give another schema"
            )
        time.sleep(_TRY_S)


def holder_there(server: Server) -> int | None:
    """Process id of the run that holds the study, on whatever host; 0 if it hides that, None if there is no run."""
    with translated_there(server), closing(ServerConnection(server)) as connection:
        program = _program(connection, server, "run")
    found = re.search(r" (\d+)@", program or "")
    return None if program is None else int(found[1]) if found else 0


def _program(connection: ServerConnection, server: Server, what: str) -> str | None:
    key = _key(server, what) % 2**64
    row = connection.execute(_HOLDER, divmod(key, 2**32)).fetchone()
    return None if row is None else str(row[0])


def _words(program: str | None) -> str:
    found = re.fullmatch(r"\S+ (\d+)@(\S+)", program or "")
    return f"process {found[1]} on {found[2]}" if found else "another process"


def _key(server: Server, what: str) -> int:
    """A key of 64 bits; those of other programs in the database are other ones, but for chance."""
    digest = hashlib.sha256(f"pareto-monoped {what} {server.schema}".encode()).digest()
    return int.from_bytes(digest[:8], "big", signed=True)
