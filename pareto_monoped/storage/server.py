"""Studies in schemas of a PostgreSQL server, reached through SQLAlchemy with psycopg, an extra imported when needed."""

import hashlib
import os
import re
import socket
import time
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import closing, contextmanager
from datetime import datetime
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import psycopg
import sqlalchemy
from psycopg.adapt import Buffer, Dumper, Loader
from psycopg.conninfo import conninfo_to_dict
from psycopg.pq import TransactionStatus
from sqlalchemy.exc import PendingRollbackError

from pareto_monoped.errors import DatabaseError, DiskError, ParetoMonopedError, ServerError
from pareto_monoped.storage.address import Server, schema_for
from pareto_monoped.storage.base import Storage, StudyLock, error_behind
from pareto_monoped.storage.columns import listed
from pareto_monoped.storage.connection import Connection, Rows

if TYPE_CHECKING:
    from optuna.storages import RDBStorage

_URL = "postgresql+psycopg://"
"""What SQLAlchemy is told of a server whose connections ``_opened`` makes: only which kind it is."""
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
_RIGHTS = """
SELECT has_schema_privilege(oid, 'USAGE'), quote_ident(nspname), quote_ident(current_user),
quote_ident(pg_get_userbyid(nspowner)) FROM pg_namespace WHERE nspname = :schema
"""
_STUDIES = """
SELECT nspname FROM pg_namespace JOIN pg_class ON relnamespace = pg_namespace.oid
WHERE relname = 'monoped_meta' ORDER BY nspname
"""
_RELATIONS = (
    "SELECT relname FROM pg_class WHERE relnamespace = to_regnamespace(:name) AND relkind IN ('r', 'p', 'v', 'm')"
)
_ENUMS = "SELECT typname FROM pg_type WHERE typnamespace = to_regnamespace(:name) AND typtype = 'e'"
_HOLDER = """
SELECT application_name FROM pg_locks JOIN pg_stat_activity USING (pid)
WHERE locktype = 'advisory' AND granted AND objsubid = 1 AND (classid::bigint << 32) | objid::bigint = :key
AND database = (SELECT oid FROM pg_database WHERE datname = current_database())
"""
_NAMED = 10
"""Studies that the error for an address without schema names: our own choice, what fits on two lines."""
_WAIT_S, _TRY_S = 3.0, 0.05
"""How long a lock is asked for, and how often: a server notices within moments that a process was killed, and frees
what it held."""

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


class _Number(Dumper):
    """Numbers as SQLite keeps them: no NaN but NULL, and no sign of zero."""

    oid = psycopg.adapters.types["float8"].oid

    def dump(self, obj: float) -> bytes | None:
        return None if obj != obj else repr(float(obj) + 0.0).encode()


class _Date(Loader):
    """Dates as Optuna's tables have them in a file: text."""

    def load(self, data: Buffer) -> str:
        return datetime.fromisoformat(bytes(data).decode()).isoformat(" ")


def _opened(server: Server, *, read_only: bool = False) -> "psycopg.Connection[Any]":
    """Open a session for SQLAlchemy in the study's schema; a missing one raises only when a table is asked for."""
    # Who holds a study is told by this name; 63 characters are kept of it.
    name = f"pareto-monoped {os.getpid()}@{socket.gethostname()}"[:63]
    try:
        given = conninfo_to_dict(server.conninfo)
        settings: dict[str, Any] = _OURS | {"application_name": name} | given | {"client_encoding": "utf8"}
        session = psycopg.connect(**settings, autocommit=True)
    except psycopg.Error as error:
        raise failure(server, error) from None
    ours = _SESSION | ({} if server.schema is None else {"search_path": server.schema})
    if read_only:
        ours["default_transaction_read_only"] = "on"
    try:
        rows = ", ".join(["(%s, %s)"] * len(ours))
        session.execute(_SETTING.format(rows=rows), [text for pair in ours.items() for text in pair])
    except BaseException:
        session.close()
        raise
    session.autocommit = False
    return session


@lru_cache(maxsize=16)
def _engine(server: Server) -> sqlalchemy.Engine:
    """Return what opens sessions on a server; it keeps none of them."""
    return sqlalchemy.create_engine(
        _URL,
        creator=lambda: _opened(server),
        poolclass=sqlalchemy.NullPool,
        pool_reset_on_return=None,  # the end of a session rolls back by itself
        isolation_level="AUTOCOMMIT",
        use_native_hstore=False,
    )


class ServerConnection(Connection):
    """A session on a server."""

    def __init__(self, server: Server, **options: Any) -> None:
        """Open it, with execution options of SQLAlchemy."""
        self._session = _engine(server).connect().execution_options(**options)
        driver = self._session.connection.driver_connection
        assert isinstance(driver, psycopg.Connection)
        driver.adapters.register_dumper(float, _Number)
        driver.adapters.register_loader("timestamp", _Date)
        self._driver = driver

    @property
    def in_transaction(self) -> bool:
        """Whether a transaction is open, an aborted one included."""
        return self._driver.info.transaction_status in (TransactionStatus.INTRANS, TransactionStatus.INERROR)

    def execute(self, sql: str, parameters: Mapping[str, Any] | None = None, /) -> Rows:
        """Run a statement with named values."""
        return self._session.execute(sqlalchemy.text(sql), parameters)

    def executemany(self, sql: str, parameters: Iterable[Mapping[str, Any]], /) -> None:
        """Run a statement once per set of named values."""
        if rows := list(parameters):
            self._session.execute(sqlalchemy.text(sql), rows)

    def define(self, sql: str) -> None:
        """Run statements that make or change tables; PostgreSQL's REAL has 32 bits."""
        super().define(sql.replace(" REAL", " DOUBLE PRECISION"))

    def insert(self, table: str, columns: Sequence[str], rows: Iterable[Sequence[Any]]) -> None:
        """Add rows to a table by COPY, which SQLAlchemy lacks and which is many times as fast as INSERT."""
        with self._driver.cursor() as cursor, cursor.copy(f"COPY {table} ({listed(columns)}) FROM STDIN") as copy:
            for row in rows:
                copy.write_row(row)

    def replace(self, table: str, rows: Sequence[Sequence[Any]]) -> None:
        """Add whole rows to a table, in place of those with the same key."""
        key, *others = columns = self.columns(table)
        values = ", ".join(f":{name}" for name in columns)
        new = ", ".join(f"{name} = excluded.{name}" for name in others)
        sql = f"INSERT INTO {table} VALUES ({values}) ON CONFLICT ({key}) DO UPDATE SET {new}"
        self.executemany(sql, [dict(zip(columns, row, strict=True)) for row in rows])

    def objects(self) -> list[tuple[str, str]]:
        """Return kind and name of everything in the schema that a study may have or must not have."""
        return [(kind, name) for kind, name in self.execute(_OBJECTS)]

    def columns(self, table: str) -> list[str]:
        """Return the names of a table's columns."""
        return list(self._session.execute(sqlalchemy.text(f"SELECT * FROM {table} LIMIT 0")).keys())

    def trial_ids_after(self, last: int, count: int) -> int:
        """Return the first of ``count`` successive keys, which the server's own count then leaves out.

        Nobody else adds trials before the transaction ends; who has asked for a key already may have the last one.
        """
        self.execute("LOCK TABLE trials IN SHARE ROW EXCLUSIVE MODE")
        (counter,) = self.execute("SELECT pg_get_serial_sequence('trials', 'trial_id')").fetchone()
        given, used = self.execute(f"SELECT last_value, is_called FROM {counter}").fetchone()
        (stored,) = self.execute("SELECT coalesce(max(trial_id), 0) FROM trials").fetchone()
        first = int(max(stored, given if used else given - 1)) + 1
        if count:
            self.execute("SELECT setval(:counter, :last)", {"counter": counter, "last": first + count - 1})
        return first

    def settle(self) -> None:
        """Let a commit wait for the server's disk, where its owner has not asked for more than that."""
        self.execute(
            "SELECT set_config('synchronous_commit', 'on', false) WHERE current_setting('synchronous_commit') = 'off'"
        )

    @property
    def is_lost(self) -> bool:
        """Whether the session has ended."""
        return self._driver.closed

    def close(self) -> None:
        """Close the session; invalidated, SQLAlchemy asks nothing more of a server that may be gone."""
        self._session.invalidate()
        self._session.close()


class ServerStorage(Storage):
    """A schema of a server that keeps one study."""

    place: Server

    def __init__(self, place: Server) -> None:
        self.place = place

    def place_for(self, study: str) -> Server:
        """Return the place of a study of this name: the schema of the address, or one after the name."""
        return self.place.of_schema(self.place.schema or schema_for(study))

    def is_vacant(self) -> bool:
        """Return whether the schema is missing, or has no tables yet."""
        with self.translated(), closing(ServerConnection(self.place)) as connection:
            return _is_empty(connection, self.place.schema)

    @contextmanager
    def creating(self) -> Iterator["ServerStorage"]:
        """Yield a draft in the schema ``NAME_new``; its tables move to the study's schema in one transaction."""
        draft = self.place.of_schema(f"{self.place.schema}_new")
        drop = f'DROP SCHEMA IF EXISTS "{draft.schema}" CASCADE'
        with self.translated(), closing(ServerConnection(self.place)) as connection:
            connection.execute(drop)
            connection.execute(f'CREATE SCHEMA "{draft.schema}"')
            try:
                yield ServerStorage(draft)
                with connection.transaction():
                    self._move(connection, draft)
            finally:
                if not connection.is_lost:
                    connection.execute(drop)

    def _move(self, connection: ServerConnection, draft: Server) -> None:
        connection.execute(f'CREATE SCHEMA IF NOT EXISTS "{self.place.schema}"')
        if not _is_empty(connection, self.place.schema):
            raise DatabaseError(
                f"study database {str(self.place)!r}: another program has filled it meanwhile; see what is there, "
                "or give another schema"
            )
        for kind, query in (("TABLE", _RELATIONS), ("TYPE", _ENUMS)):
            for (name,) in connection.execute(query, {"name": draft.schema}).fetchall():
                connection.execute(f'ALTER {kind} "{draft.schema}"."{name}" SET SCHEMA "{self.place.schema}"')

    def connect(self) -> ServerConnection:
        """Open a session for writing; should a run lose the session of its lock, this one keeps others from writing."""
        return self._connected("write")

    def _connected(self, lock: str | None = None, **options: Any) -> ServerConnection:
        """Open a session in the study's schema, which holds a lock until it ends: of who runs, or of who writes."""
        connection = ServerConnection(self.place, **options)
        try:
            if self.place.schema is None:
                raise self._no_schema(connection)
            if lock is not None:
                self._take(connection, lock)
        except BaseException:
            connection.close()
            raise
        return connection

    def _connect_to_read(self) -> ServerConnection:
        connection = self._connected(isolation_level="REPEATABLE READ", postgresql_readonly=True)
        try:
            if not connection.objects():
                raise self._nothing_there(connection)
        except BaseException:
            connection.close()
            raise
        return connection

    @contextmanager
    def locked(self) -> Iterator[StudyLock]:
        """Hold the study's advisory lock in a session of its own, which ends with its connection."""
        with self.translated():
            connection = self._connected("run")
        with closing(connection):
            yield StudyLock()

    def _take(self, connection: ServerConnection, lock: str) -> None:
        deadline_s = time.monotonic() + _WAIT_S
        key = {"key": self._key(lock)}
        while not connection.execute("SELECT pg_try_advisory_lock(:key)", key).fetchone()[0]:
            if time.monotonic() > deadline_s:
                found = re.fullmatch(r"\S+ (\d+)@(\S+)", self._program(connection, lock) or "")
                who = f"process {found[1]} on {found[2]}" if found else "another process"
                raise DatabaseError(
                    f"study database {str(self.place)!r}: is being run by {who}; wait for it, stop it, or give another "
                    "schema"
                )
            time.sleep(_TRY_S)

    def _key(self, lock: str) -> int:
        """Return a key of 64 bits; those of other programs in the database are other ones, but for chance."""
        digest = hashlib.sha256(f"pareto-monoped {lock} {self.place.schema}".encode()).digest()
        return int.from_bytes(digest[:8], "big", signed=True)

    def _program(self, connection: ServerConnection, lock: str) -> str | None:
        """Return the name of the program that holds a lock of the study, or None."""
        row = connection.execute(_HOLDER, {"key": self._key(lock)}).fetchone()
        return None if row is None else str(row[0])

    def holder(self) -> int | None:
        """Return the process id of the run that holds the study, on whatever host; 0 if it hides that."""
        with self.translated(), closing(self._connected()) as connection:
            program = self._program(connection, "run")
        found = re.search(r" (\d+)@", program or "")
        return None if program is None else int(found[1]) if found else 0

    @contextmanager
    def translated(self) -> Iterator[None]:
        """Turn exceptions of psycopg and of SQLAlchemy into one clear error of ours."""
        try:
            yield
        except Exception as error:
            found = error if isinstance(error, psycopg.Error) else error_behind(error)
            if found is None:
                raise
            raise failure(self.place, found, open_before=True) from error

    def optuna_storage(self, *, read_only: bool = False) -> "RDBStorage":
        """Return Optuna's view of the schema."""
        from optuna.storages import RDBStorage

        return RDBStorage(
            _URL,
            engine_kwargs={"creator": lambda: _opened(self.place, read_only=read_only)},
            skip_compatibility_check=read_only,
            skip_table_creation=read_only,
        )

    def _nothing_there(self, connection: ServerConnection) -> DatabaseError:
        """Return the error for a schema that does not exist, is empty, or may not be looked into."""
        row = connection.execute(_RIGHTS, {"schema": self.place.schema}).fetchone()
        what = f"study database {str(self.place)!r}"
        if row is None or row[0]:
            return DatabaseError(f"{what}: no such study on the server; check the schema, or run a study first")
        _, schema, user, owner = row
        return DatabaseError(
            f"{what}: its user {user} has no right to look into it; ask {owner} for GRANT USAGE ON SCHEMA {schema} TO "
            f"{user}, and for GRANT SELECT ON ALL TABLES IN SCHEMA {schema} TO {user}"
        )

    def _no_schema(self, connection: ServerConnection) -> DatabaseError:
        """Return the error for an address that names no schema; it names those that are studies."""
        found = [name for (name,) in connection.execute(_STUDIES)]
        studies = f"one of {', '.join(found[:_NAMED])}" if found else "there are no studies yet"
        if more := len(found[_NAMED:]):
            studies += f" and {more} other{'' if more == 1 else 's'}"
        return DatabaseError(
            f"study database {str(self.place)!r}: names no study; add {'&' if '?' in str(self.place) else '?'}"
            f"schema=NAME to the address, {studies}"
        )


def _is_empty(connection: ServerConnection, schema: str | None) -> bool:
    return connection.execute(_RELATIONS, {"name": schema}).fetchone() is None


def failure(server: Server, error: BaseException, *, open_before: bool = False) -> ParetoMonopedError:
    """Return our error for one of psycopg or SQLAlchemy, whose connection may have been ``open_before``."""
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
            message = start + words.format(text=text)
            return DatabaseError(message)
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
