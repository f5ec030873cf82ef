"""A connection to a PostgreSQL server, which speaks the same SQL as ``study.connection`` has for files.

psycopg is an extra: nothing here is imported before an address of a server is used.
"""

import os
import socket
from collections.abc import Callable, Iterable, Iterator, Sequence
from datetime import datetime
from functools import lru_cache
from typing import Any

import psycopg
from psycopg import sql as composing
from psycopg.adapt import Buffer, Dumper, Loader
from psycopg.conninfo import conninfo_to_dict
from psycopg.pq import TransactionStatus

from pareto_monoped.errors import DatabaseError
from pareto_monoped.storage.connection import Rows
from pareto_monoped.storage.server.address import Server
from pareto_monoped.storage.server.failures import failure

_PROGRAM = "pareto-monoped"
_OURS = {
    "connect_timeout": "10",
    # A host that is gone is noticed within about a minute, not after the hours that systems take by themselves.
    "keepalives_idle": "30",
    "keepalives_interval": "10",
    "keepalives_count": "3",
    "tcp_user_timeout": "60000",
}
"""Settings of libpq unless the address has others: seconds, and at last milliseconds; our own choice."""
_SESSION = {
    # Numbers go through as text: with less than 1, the last bits would be lost.
    "extra_float_digits": "1",
    "DateStyle": "ISO",
    "standard_conforming_strings": "on",
    # A lock is held for hours by a session that does nothing else.
    "idle_session_timeout": "0",
    # As for the client; the server frees the lock of a host that is gone.
    "tcp_keepalives_idle": "30",
    "tcp_keepalives_interval": "10",
    "tcp_keepalives_count": "3",
}
"""Settings of each session; those that a version of PostgreSQL lacks are left out."""
_SETTING = """
SELECT set_config(name, value, false) FROM pg_settings JOIN (VALUES {rows}) AS ours(name, value) USING (name)
"""


class _Number(Dumper):
    """Numbers as SQLite keeps them: no NaN but NULL, and no sign of zero."""

    oid = psycopg.adapters.types["float8"].oid

    def dump(self, obj: float) -> bytes | None:
        return None if obj != obj else repr(float(obj) + 0.0).encode()


class _Date(Loader):
    """Dates as Optuna's tables have them in a file: text."""

    def load(self, data: Buffer) -> str:
        return datetime.fromisoformat(bytes(data).decode()).isoformat(" ")


def opened(server: Server, *, read_only: bool = False) -> "psycopg.Connection[Any]":
    """A session on the server in which the study's schema is the only one; every statement commits by itself.

    Args:
        server: where; a schema that does not exist makes no error before a table is asked for.
        read_only: whether the server refuses everything that writes.

    Raises:
        ServerError: the server is away.
        DatabaseError: it refuses us, or the address is none.
    """
    # Who holds a study is told by this name; 63 characters are kept of it.
    name = f"{_PROGRAM} {os.getpid()}@{socket.gethostname()}"[:63]
    try:
        given = conninfo_to_dict(server.conninfo)
        settings: dict[str, Any] = _OURS | {"application_name": name} | given | {"client_encoding": "utf8"}
        connection = psycopg.connect(**settings, autocommit=True)
    except psycopg.Error as error:
        raise failure(server, error) from None
    try:
        ours = dict(_SESSION)
        if server.schema is not None:
            ours["search_path"] = server.schema
        if read_only:
            ours["default_transaction_read_only"] = "on"
        rows = ", ".join(["(%s, %s)"] * len(ours))
        connection.execute(_SETTING.format(rows=rows), [text for pair in ours.items() for text in pair])
    except BaseException:
        connection.close()
        raise
    return connection


SQLALCHEMY = "postgresql+psycopg://"
"""What SQLAlchemy is told of a server whose connections a ``creator`` opens: only which kind it is."""


def creator(server: Server, *, read_only: bool = False) -> Callable[[], "psycopg.Connection[Any]"]:
    """What opens connections for SQLAlchemy, which wants to begin transactions itself."""

    def create() -> "psycopg.Connection[Any]":
        connection = opened(server, read_only=read_only)
        connection.autocommit = False
        return connection

    return create


@lru_cache(maxsize=256)
def _translated(sql: str) -> str:
    """SQL for SQLite as PostgreSQL takes it: other marks for values, and real numbers of 64 bits instead of 32."""
    text = sql.replace("%", "%%").replace("?", "%s")
    return text.replace(" REAL", " DOUBLE PRECISION") if sql.lstrip().startswith(("CREATE", "ALTER")) else text


class ServerConnection:
    """A session on a server; see ``study.connection.Connection``."""

    def __init__(self, server: Server) -> None:
        """Open it.

        Raises:
            ServerError: the server is away.
            DatabaseError: it refuses us, or the address names no schema.
        """
        self._session = opened(server)
        self._session.adapters.register_dumper(float, _Number)
        self._session.adapters.register_loader("timestamp", _Date)
        try:
            if server.schema is None:
                raise no_schema(server, self._session)
        except BaseException:
            self.close()
            raise

    @property
    def in_transaction(self) -> bool:
        """Whether a transaction is open, an aborted one included."""
        return self._session.info.transaction_status in (TransactionStatus.INTRANS, TransactionStatus.INERROR)

    def execute(self, sql: str, parameters: Sequence[Any] = (), /) -> Rows:
        """Run a statement."""
        return self._session.execute(_translated(sql), parameters)

    def executemany(self, sql: str, parameters: Iterable[Sequence[Any]], /) -> None:
        """Run a statement once per row of values."""
        with self._session.cursor() as cursor:
            cursor.executemany(_translated(sql), parameters)

    def begin(self) -> None:
        """Begin a transaction that writes."""
        self.execute("BEGIN")

    def insert(self, table: str, columns: Sequence[str], rows: Iterable[Sequence[Any]]) -> None:
        """Add rows to a table, by COPY, which is many times as fast as INSERT."""
        names = composing.SQL(", ").join(map(composing.Identifier, columns))
        statement = composing.SQL("COPY {} ({}) FROM STDIN").format(composing.Identifier(table), names)
        with self._session.cursor() as cursor, cursor.copy(statement) as copy:
            for row in rows:
                copy.write_row(row)

    def replace(self, table: str, rows: Sequence[Sequence[Any]]) -> None:
        """Add whole rows to a table, in place of those with the same key."""
        key, *others = self.columns(table)
        marks = ", ".join("?" * (len(others) + 1))
        new = ", ".join(f"{name} = excluded.{name}" for name in others)
        self.executemany(f"INSERT INTO {table} VALUES ({marks}) ON CONFLICT ({key}) DO UPDATE SET {new}", rows)

    def objects(self) -> list[tuple[str, str]]:
        """Kind and name of everything in the schema that a study may have or must not have."""
        return self._session.execute(_OBJECTS).fetchall()

    def nothing_there(self, server: Server) -> DatabaseError:
        """The error for a schema of which nothing is seen: it does not exist, is empty, or may not be looked into."""
        row = self._session.execute(_RIGHTS, (server.schema,)).fetchone()
        what = f"study database {str(server)!r}"
        if row is None or row[0]:
            return DatabaseError(f"{what}: no such study on the server; check the schema, or run a study first")
        schema, user, owner = row[1:]
        return DatabaseError(
            f"{what}: its user {user} has no right to look into it; ask {owner} for GRANT USAGE ON SCHEMA {schema} TO "
            f"{user}, and for GRANT SELECT ON ALL TABLES IN SCHEMA {schema} TO {user}"
        )

    def columns(self, table: str) -> list[str]:
        """Names of a table's columns."""
        rows = self._session.execute(
            "SELECT attname FROM pg_attribute WHERE attrelid = to_regclass(%s) AND attnum > 0 AND NOT attisdropped "
            "ORDER BY attnum",
            (table,),
        )
        return [name for (name,) in rows]

    def defects(self) -> Iterator[str]:
        """Nothing: a server looks after its pages itself."""
        return iter(())

    def trial_ids_after(self, last: int, count: int) -> int:
        """The first of ``count`` successive keys for Optuna's trials, which the server's own count then leaves out.

        Nobody else adds trials before the transaction ends; who has asked for a key already may have the last one.
        """
        self.execute("LOCK TABLE trials IN SHARE ROW EXCLUSIVE MODE")
        (counter,) = self.execute("SELECT pg_get_serial_sequence('trials', 'trial_id')").fetchone()
        given, used = self.execute(f"SELECT last_value, is_called FROM {counter}").fetchone()
        (stored,) = self.execute("SELECT coalesce(max(trial_id), 0) FROM trials").fetchone()
        first = int(max(stored, given if used else given - 1)) + 1
        if count:
            self.execute("SELECT setval(?, ?)", (counter, first + count - 1))
        return first

    def close(self) -> None:
        """Close it."""
        self._session.close()


_RIGHTS = """
SELECT has_schema_privilege(oid, 'USAGE'), quote_ident(nspname), quote_ident(current_user),
quote_ident(pg_get_userbyid(nspowner)) FROM pg_namespace WHERE nspname = %s
"""
_OBJECTS = """
SELECT CASE WHEN relkind IN ('r', 'p') THEN 'table' ELSE 'view' END, relname FROM pg_class
WHERE relnamespace = current_schema()::regnamespace AND relkind IN ('r', 'p', 'v', 'm', 'f')
UNION ALL
SELECT 'trigger', tgname FROM pg_trigger JOIN pg_class ON pg_class.oid = tgrelid
WHERE relnamespace = current_schema()::regnamespace AND NOT tgisinternal
UNION ALL
SELECT 'trigger', rulename FROM pg_rewrite JOIN pg_class ON pg_class.oid = ev_class
WHERE relnamespace = current_schema()::regnamespace AND relkind IN ('r', 'p')
"""


_NAMED = 10
"""Studies that the error for an address without schema names: our own choice, what fits on two lines."""


def no_schema(server: Server, session: "psycopg.Connection[Any]") -> DatabaseError:
    """The error for an address that names no schema; it names those that are studies."""
    found = session.execute(
        "SELECT nspname FROM pg_namespace JOIN pg_class ON relnamespace = pg_namespace.oid "
        "WHERE relname = 'monoped_meta' ORDER BY nspname"
    ).fetchall()
    studies = f"one of {', '.join(name for (name,) in found[:_NAMED])}" if found else "there are no studies yet"
    if more := len(found[_NAMED:]):
        studies += f" and {more} other{'' if more == 1 else 's'}"
    return DatabaseError(
        f"study database {str(server)!r}: names no study; add {'&' if '?' in str(server) else '?'}schema=NAME "
        f"to the address, {studies}"
    )
