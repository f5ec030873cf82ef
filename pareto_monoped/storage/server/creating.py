"""How a new study comes to its schema: made whole in another one beside it, then moved there in one transaction."""

from collections.abc import Iterator
from contextlib import contextmanager

from psycopg import sql

from pareto_monoped.errors import DatabaseError
from pareto_monoped.storage.server.address import Server
from pareto_monoped.storage.server.connection import opened

_RELATIONS = "SELECT relname FROM pg_class WHERE relnamespace = to_regnamespace(%s) AND relkind IN ('r', 'p', 'v', 'm')"
_ENUMS = "SELECT typname FROM pg_type WHERE typnamespace = to_regnamespace(%s) AND typtype = 'e'"


def is_vacant_there(server: Server) -> bool:
    """Whether the schema is missing, or has no tables yet.

    Raises:
        DatabaseError: the server refuses us.
        ServerError: it is away.
    """
    session = opened(server)
    try:
        return session.execute(_RELATIONS, (server.schema,)).fetchone() is None
    finally:
        session.close()


@contextmanager
def new_schema(server: Server) -> Iterator[Server]:
    """Yield a new schema, whose tables move to that of the study if the block succeeds; afterwards it is gone.

    A killed creation leaves it, and the next one deletes that. The caller holds the study's lock.

    Raises:
        DatabaseError: we may not make it, or somebody has filled the study's schema meanwhile.
    """
    assert server.schema is not None
    draft, place = sql.Identifier(f"{server.schema}_new"), sql.Identifier(server.schema)
    session = opened(server)
    try:
        session.execute(sql.SQL("DROP SCHEMA IF EXISTS {} CASCADE").format(draft))
        session.execute(sql.SQL("CREATE SCHEMA {}").format(draft))
        try:
            yield server.of_schema(f"{server.schema}_new")
            with session.transaction():
                session.execute(sql.SQL("CREATE SCHEMA IF NOT EXISTS {}").format(place))
                if session.execute(_RELATIONS, (server.schema,)).fetchone() is not None:
                    raise DatabaseError(
                        f"study database {str(server)!r}: another program has filled it meanwhile; see what is there, "
                        "or give another schema"
                    )
                for kind, query in (("TABLE", _RELATIONS), ("TYPE", _ENUMS)):
                    for (name,) in session.execute(query, (f"{server.schema}_new",)).fetchall():
                        move = f"ALTER {kind} {{}}.{{}} SET SCHEMA {{}}"
                        session.execute(sql.SQL(move).format(draft, sql.Identifier(name), place))
        finally:
            if not session.closed:
                session.execute(sql.SQL("DROP SCHEMA IF EXISTS {} CASCADE").format(draft))
    finally:
        session.close()
