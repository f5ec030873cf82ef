"""The address of a study on a PostgreSQL server: what the user gives, what libpq gets, and what may be shown of it."""

import re
from dataclasses import dataclass, field
from urllib.parse import unquote

from pareto_monoped.errors import DatabaseError

_KINDS = ("postgresql", "postgres")
"""How libpq's addresses begin."""
_ADDRESS = re.compile(r"(?P<kind>[A-Za-z][A-Za-z0-9+.-]*)://(?P<rest>.*)", re.DOTALL)
_HOST = re.compile(r"(\[[0-9A-Fa-f:.%]*\]|[^\[\]:]*)(:[0-9]*)?")
_SHOWN = frozenset({"dbname", "host", "hostaddr", "options", "port", "service", "sslmode", "user"})
"""Settings of libpq that hold no secret; others stay out of messages, reports and databases."""
_SCHEMA = re.compile(r"(?!pg_)[a-z_][a-z0-9_]*")
LONGEST_SCHEMA = 58
"""Characters of a schema's name: PostgreSQL takes 63, and ``_new`` follows while the study is made."""
_SHAPE = "postgresql://USER@HOST:PORT/DATABASE?schema=STUDY"


@dataclass(frozen=True, slots=True)
class Server:
    """The place of a study on a server; as text it is the address without its secrets."""

    conninfo: str = field(repr=False)  #: the address for libpq, without the schema; it may have a password
    shown: str  #: the same without secrets
    schema: str | None  #: PostgreSQL's namespace with the study's tables; None if the address names none

    def __str__(self) -> str:
        if self.schema is None:
            return self.shown
        return f"{self.shown}{'&' if '?' in self.shown else '?'}schema={self.schema}"

    def of_schema(self, schema: str) -> "Server":
        """Return another schema of the same server."""
        return Server(self.conninfo, self.shown, schema)


def is_address(text: str) -> bool:
    """Return whether a text is the address of a server, of whatever kind, rather than the name of a file."""
    return _ADDRESS.fullmatch(text) is not None


def server_of(text: str) -> Server:
    """Return the server at an address of the form ``_SHAPE``; messages never have the text of a wrong one.

    Besides ``schema``, everything is as libpq takes it, which also looks for passwords in ``PGPASSWORD`` and
    ``~/.pgpass``.
    """
    found = _ADDRESS.fullmatch(text)
    if found is None or found["kind"] not in _KINDS:
        kind = "" if found is None else f" '{found['kind']}://...'"
        raise DatabaseError(
            f"study database{kind}: is no address of a PostgreSQL server; give {_SHAPE}, or the name of a file"
        )
    before, _, query = found["rest"].partition("?")
    authority, slash, database = before.partition("/")
    credentials, at, hosts = authority.rpartition("@")
    parts = [part for part in query.split("&") if part]
    # Each of these may be a piece of a password with signs that an address gives another meaning.
    strange = text.count("@") > len(at) or "#" in text or not all("=" in part for part in parts)
    if strange or not all(map(_HOST.fullmatch, hosts.split(","))) or "\0" in unquote(text):
        raise DatabaseError(
            f"study database 'postgresql://...': cannot be understood; give {_SHAPE}, and in a password write "
            "@ : / ? # and & as %40 %3A %2F %3F %23 and %26"
        )
    schemas = [unquote(part.partition("=")[2]) for part in parts if part.startswith("schema=")]
    others = [part for part in parts if not part.startswith("schema=")]
    if len(schemas) > 1:
        raise DatabaseError("study database 'postgresql://...': names more than one schema; give one")
    user = credentials.partition(":")[0]
    beginning = f"postgresql://{f'{user}@' if at else ''}{hosts}{slash}{database}"
    shown = [part for part in others if part.partition("=")[0] in _SHOWN]
    server = Server(
        f"postgresql://{before}{'?' + '&'.join(others) if others else ''}",
        f"{beginning}{'?' + '&'.join(shown) if shown else ''}",
        None,
    )
    if not schemas:
        return server
    if _SCHEMA.fullmatch(schemas[0]) is None or len(schemas[0]) > LONGEST_SCHEMA:
        raise DatabaseError(
            f"study database {str(server)!r}: schema = {schemas[0]!r}: must be lower-case letters a to z, digits and "
            f"underscores, at most {LONGEST_SCHEMA}, beginning with a letter but not with 'pg_'; choose another"
        )
    return server.of_schema(schemas[0])


def schema_for(study: str) -> str:
    """Return the schema that a study of this name has unless the address names one."""
    plain = re.sub(r"[^a-z0-9]+", "_", study.lower()).strip("_")
    if plain[:1].isdigit() or plain.startswith("pg_") or not plain:
        plain = f"study_{plain}".rstrip("_")
    return plain[:LONGEST_SCHEMA]
