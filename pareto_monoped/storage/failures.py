"""One line with a cure for each error of PostgreSQL."""

import re

import psycopg
from sqlalchemy.exc import PendingRollbackError

from pareto_monoped.errors import DatabaseError, DiskError, ParetoMonopedError, ServerError
from pareto_monoped.storage.address import Server

_AWAY = ("57P01", "57P02", "57P03", "08000", "08001", "08003", "08004", "08006")
"""States of SQL: the server is shut down, starts, or has no connection."""
_STATES: dict[str, tuple[type[ParetoMonopedError], str]] = {
    "53100": (DiskError, "the server's disk is full; make room and resume, all acknowledged trials are safe"),
    "53200": (ServerError, "the server has no memory left; resume when it has, all acknowledged trials are safe"),
    "53300": (ServerError, "the server has too many connections; close some, or raise max_connections"),
    "42501": (DatabaseError, "is not allowed to us ({text}); ask its owner for the right, or give another user"),
    "25006": (DatabaseError, "is read-only; allow writing, or give another server"),
    "3F000": (DatabaseError, "no such schema; check the address, or run a study first"),
    "42P01": (DatabaseError, "is damaged ({text}); restore a copy"),
    "42703": (DatabaseError, "is damaged ({text}); restore a copy"),
    "57014": (ServerError, "the server has ended a query ({text}); raise its time limit and resume"),
    "55P03": (DatabaseError, "is locked by another program; close it and try again"),
    "40P01": (DatabaseError, "is locked by another program; close it and try again"),
}
_AT_THE_DOOR = {
    "password authentication failed": "the password of its user is refused; correct it (PGPASSWORD or ~/.pgpass)",
    "no password supplied": "the server asks for a password; give it in PGPASSWORD or ~/.pgpass",
    r'role ".*" does not exist': "the server has no such user; correct the user, or make it with createuser",
    r'database ".*" does not exist': "the server has no such database; correct its name, or make it with createdb",
    "pg_hba.conf|authentication failed": "the server refuses us ({text}); ask its owner to let us in",
    "too many (clients|connections)": _STATES["53300"][1],
    'invalid .*"': "its address cannot be used ({text}); correct it",
    "certificate|private key|sslmode|SSL was required|GSSAPI": (
        "no encrypted connection can be made ({text}); correct sslmode, sslrootcert, sslcert or sslkey in the address, "
        "or the files that they name"
    ),
}
"""What a connection is refused with, for which libpq gives no state, in English as servers mostly speak."""


def failure(server: Server, error: BaseException, *, open_before: bool = False) -> ParetoMonopedError:
    """Return the error of ours for one of psycopg or SQLAlchemy; ``open_before``: the connection had been open."""
    text = _said(error)
    start = f"study database {str(server)!r}: "
    state = getattr(error, "sqlstate", None)
    if state in _STATES:
        kind, words = _STATES[state]
        return kind(start + words.format(text=text))
    # A session that has ended is used no more by SQLAlchemy, which says so by an error of its own.
    lost = (psycopg.OperationalError, psycopg.InterfaceError, PendingRollbackError)
    gone = isinstance(error, lost) and state is None
    if state in _AWAY or (gone and open_before):
        return ServerError(
            f"{start}the server went away ({text}); start it and resume, all acknowledged trials are safe"
        )
    for pattern, words in _AT_THE_DOOR.items():
        if re.search(pattern, text):
            return DatabaseError(start + words.format(text=text))
    if gone:
        return ServerError(f"{start}the server does not answer ({text}); start it, or check host and port")
    if isinstance(error, psycopg.ProgrammingError) and state is None:
        return DatabaseError(f"{start}its address cannot be used ({text}); correct it")
    return DatabaseError(f"{start}cannot be used ({text}); restore a copy, or run the study again in another schema")


def _said(error: BaseException) -> str:
    """Return the first message of an error, on one line; libpq repeats itself for each address of a host."""
    lines = [line.strip() for line in str(error).splitlines() if line.strip()]
    words = lines[0] if lines else type(error).__name__
    return words.removeprefix("connection failed: ").removeprefix("connection is bad: ").rstrip(":")
