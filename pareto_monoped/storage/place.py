"""The place of a study, and the storage that is chosen by it."""

from pathlib import Path

from pareto_monoped.errors import require_extra
from pareto_monoped.storage.address import LONGEST_SCHEMA, Server, is_address, server_of
from pareto_monoped.storage.base import Storage

StudyPlace = Path | Server
"""A database file, or a schema on a server."""


def place_of(text: str) -> StudyPlace:
    """Return the place that a user names: the address of a server, which needs an extra, else a file."""
    if not is_address(text):
        return Path(text)
    server = server_of(text)
    require_extra("postgres", f"study database {str(server)!r}", instead="give the name of a file")
    return server


def storage_of(place: StudyPlace) -> Storage:
    """Return the storage of a study at this place; what the other kind of place needs is not imported."""
    if isinstance(place, Path):
        from pareto_monoped.storage.file import FileStorage

        return FileStorage(place)
    from pareto_monoped.storage.server import ServerStorage

    return ServerStorage(place)


def beside(place: StudyPlace, suffix: str) -> StudyPlace:
    """Return the place of another study, whose file or schema has the same name and a suffix."""
    if isinstance(place, Path):
        return place.with_stem(place.stem + suffix)
    return place.of_schema((place.schema or "")[: LONGEST_SCHEMA - len(suffix)] + suffix)
