"""Options that several commands share."""

from pathlib import Path
from typing import Any

import click

from pareto_monoped.errors import DatabaseError, InputError, complaint
from pareto_monoped.study.place import place_of
from pareto_monoped.study.server.address import is_address


class Local(click.Path):
    """The name of a file or folder, such as of a study file; studies alone may have the address of a server."""

    def __init__(self, *, dir_okay: bool = True, file_okay: bool = True, allow_dash: bool = False) -> None:
        super().__init__(dir_okay=dir_okay, file_okay=file_okay, allow_dash=allow_dash, path_type=Path)

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """The path.

        Raises:
            InputError: the address of a server, which is not repeated because it may hold a password.
        """
        if isinstance(value, str) and is_address(value):
            what = "dir" if not self.file_okay else "file"
            if param is not None:
                what = max(param.opts, key=len) if isinstance(param, click.Option) else str(param.metavar)
            raise InputError(
                f"{what}: is the address of a server, must be the name of a file or folder; give one, and the study on "
                "a server where a command takes DB or --db"
            )
        return super().convert(value, param, ctx)


class _Database(click.Path):
    """A parameter that names a study: a file, or the address of one on a server."""

    def __init__(self, *, servers: bool) -> None:
        super().__init__(path_type=Path)
        self._servers = servers

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """The ``StudyPlace`` that a user names.

        Raises:
            DatabaseError: an address that cannot be one of a study, or of a server where only files will do.
        """
        if not isinstance(value, str) or not is_address(value):
            return super().convert(value, param, ctx)
        place = place_of(value)
        if not self._servers:
            raise DatabaseError(
                f"study database {str(place)!r}: is on a server, which this command does not take; give the name of a "
                "file, or run its steps one by one: run, export, report"
            )
        return place


class _OutputFile(Local):
    """The name of a file to write, whose ending does not say that it is of another kind; it may have none."""

    def __init__(self, *endings: str, allow_dash: bool = False) -> None:
        super().__init__(dir_okay=False, allow_dash=allow_dash)
        self._endings = endings

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """The path.

        Raises:
            InputError: it has the ending of another kind of file.
        """
        path: Path = super().convert(value, param, ctx)
        if path.suffix and path.suffix.lower() not in self._endings:
            option = max(param.opts, key=len) if param else "file"
            raise InputError(complaint(option, str(path), f"a file ending in {self._endings[0]}", "correct the name"))
        return path


CSV_FILE = _OutputFile(".csv", ".txt", ".dat")
CSV_FILE_OR_DASH = _OutputFile(".csv", ".txt", ".dat", allow_dash=True)
PARQUET_FILE = _OutputFile(".parquet", ".pq")
HTML_FILE = _OutputFile(".html", ".htm")

DATABASE = _Database(servers=True)
DATABASE_FILE = _Database(servers=False)

force_option = click.option("--force", is_flag=True, help="Replace files of another kind; a study is never replaced.")
workers_option = click.option(
    "--workers", type=click.IntRange(1, 1024), metavar="N", help="Number of threads.  [default: all cores]"
)
sample_seed_option = click.option(
    "--seed", type=click.IntRange(min=0), metavar="N", help="Of the samples.  [default: the study's, or 1]"
)
uncertainty_option = click.option(
    "--uncertainty",
    type=Local(),
    metavar="FILE.toml",
    help="TOML file of ranges, instead of the study's or ours.",
)
