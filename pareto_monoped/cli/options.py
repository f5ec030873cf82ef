"""Options that several commands share: a robot's motors, where work is done, and what the shell completes.

Nothing that takes longer than a key press is imported to complete a name.
"""

from collections.abc import Callable, Iterable
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from pareto_monoped.cli.terminal import echo
from pareto_monoped.design import CONSTRAINT_NAMES, NAMES, PAPER_MOTOR
from pareto_monoped.errors import DatabaseError, InputError, ParetoMonopedError, complaint
from pareto_monoped.storage.address import is_address
from pareto_monoped.storage.place import place_of

if TYPE_CHECKING:
    from concurrent.futures import Executor

    from click.shell_completion import CompletionItem

    from pareto_monoped.compute.crew import Limits


class Local(click.Path):
    """The name of a file or folder, such as of a study file; studies alone may have the address of a server."""

    def __init__(self, *, dir_okay: bool = True, file_okay: bool = True, allow_dash: bool = False) -> None:
        super().__init__(dir_okay=dir_okay, file_okay=file_okay, allow_dash=allow_dash, path_type=Path)

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """Return the path; the address of a server is refused and not repeated, because it may hold a password."""
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
        """Return the ``StudyPlace``; an address of no study, or where only files will do, is a ``DatabaseError``."""
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
        """Return the path; the ending of another kind of file is refused."""
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
    "--uncertainty", type=Local(), metavar="FILE.toml", help="TOML file of ranges, instead of the study's or ours."
)


Completion = Callable[["click.Context", "click.Parameter", str], "list[CompletionItem]"]


def _completing(known: Callable[[], Iterable[str]], *, files: bool = False) -> Completion:
    """Complete a name out of those known, in a list with commas the last one; files as well if asked for."""

    def complete(_: "click.Context", __: "click.Parameter", incomplete: str) -> "list[CompletionItem]":
        from click.shell_completion import CompletionItem

        before, comma, begun = incomplete.rpartition(",")
        found = [CompletionItem(f"{before}{comma}{name}") for name in known() if name.startswith(begun)]
        return [*found, CompletionItem(incomplete, type="file")] if files else found

    return complete


def _motors() -> Iterable[str]:
    from pareto_monoped.actuator.motors import motor_names

    return motor_names()


def _calibrations() -> Iterable[str]:
    from pareto_monoped.jump.calibration import calibration_names

    return calibration_names()


def _studies() -> Iterable[str]:
    from pareto_monoped.definition.study_file import shipped_studies

    return shipped_studies()


def _variables() -> Iterable[str]:
    return (f"{name}=" for name in NAMES)


def _measures() -> Iterable[str]:
    from pareto_monoped.measures import MEASURES

    return (entry.name for entry in MEASURES if entry.direction is not None)


def _conditions() -> Iterable[str]:
    return (f"{name}=" for name in (*_measures(), *(name.removesuffix("=") for name in _variables())))


def _formats() -> Iterable[str]:
    from pareto_monoped.cad.write.folder import FORMATS

    return FORMATS


def trials(ctx: "click.Context", _: "click.Parameter", incomplete: str) -> "list[CompletionItem]":
    """Return numbers of the trials on the front of the study that the line names, with their objectives as help."""
    from click.shell_completion import CompletionItem

    from pareto_monoped.storage.kept_front import front_trials

    # An option without its value ends click's reading of a line, before arguments get their names.
    db = ctx.params.get("db") or next(iter(ctx.args), None)
    try:
        known = {} if db is None else front_trials(place_of(db) if isinstance(db, str) else db)
    except ParetoMonopedError:
        return []
    return [CompletionItem(str(n), help=text) for n, text in known.items() if str(n).startswith(incomplete)]


trials_option = click.option(
    "--trial",
    "trials",
    type=click.IntRange(min=0),
    multiple=True,
    metavar="N",
    shell_complete=trials,
    help="A trial, instead of the front.",
)


motors = _completing(_motors, files=True)
calibrations = _completing(_calibrations, files=True)
studies = _completing(_studies)
constraints = _completing(lambda: CONSTRAINT_NAMES)
variables = _completing(_variables)
measures = _completing(_measures)
conditions = _completing(_conditions)
names = _completing(lambda: (name.removesuffix("=") for name in _conditions()))
formats = _completing(_formats)


def motor_options(prefix: str = "") -> Callable[[Callable[..., Any]], Callable[..., Any]]:
    """Add options ``--motor``, ``--hip-motor`` and ``--knee-motor`` to a command; ``chosen_motors`` reads them."""
    both = click.option(
        "--motor", metavar="NAME", shell_complete=motors, help=f"{prefix}Name or TOML file.  [default: {PAPER_MOTOR}]"
    )
    hip = click.option(
        "--hip-motor",
        metavar="NAME",
        shell_complete=motors,
        help=f"{prefix}The hip's, with --knee-motor instead of --motor.",
    )
    knee = click.option(
        "--knee-motor", metavar="NAME", shell_complete=motors, help=f"{prefix}The knee's, with --hip-motor."
    )
    return lambda command: both(hip(knee(command)))


def chosen_motors(motor: str | None, hip_motor: str | None, knee_motor: str | None) -> tuple[str, str]:
    """Return names or files of the hip's and the knee's motor; options that contradict each other are a usage error."""
    if hip_motor is None and knee_motor is None:
        return motor or PAPER_MOTOR, motor or PAPER_MOTOR
    if motor is not None:
        raise click.UsageError("--motor stands for both joints; drop it, or --hip-motor and --knee-motor")
    if hip_motor is None or knee_motor is None:
        missing = "--knee-motor" if knee_motor is None else "--hip-motor"
        raise click.UsageError(f"{missing} is missing; name both joints' motors, or one for both with --motor")
    return hip_motor, knee_motor


@dataclass(frozen=True, slots=True, kw_only=True)
class Where:
    """Where the work is done: in a number of processes, or at a Dask scheduler's address; on threads if neither."""

    processes: int | None = None
    scheduler: str | None = None


scheduler_option = click.option(
    "--scheduler", metavar="ADDRESS", help="Compute on the workers of a Dask scheduler, such as tcp://host:8786."
)


def where_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """Add options ``--processes`` and ``--scheduler``, handed over as ``processes`` and ``scheduler``."""
    processes = click.option(
        "--processes", type=click.IntRange(1, 256), metavar="N", help="Compute in N processes instead of threads."
    )
    return processes(scheduler_option(command))


def where(processes: int | None, scheduler: str | None, workers: int | None) -> Where:
    """Return what the options say; a usage error if they contradict each other."""
    given = {"--processes": processes, "--scheduler": scheduler, "--workers": workers}
    named = [option for option, value in given.items() if value is not None]
    if len(named) > 1:
        raise click.UsageError(f"{named[0]} and {named[1]} exclude each other; drop one")
    return Where(processes=processes, scheduler=scheduler)


def executor_at(
    place: Where, *, limits: "Limits | None" = None, extra: str | None = None
) -> "AbstractContextManager[Executor | None]":
    """Return the executor for a place, None for threads; what happens to its workers is said on standard error.

    Packages of ``extra`` must have the same versions on other hosts; ``limits`` are those of jumps if None.
    """
    if place.processes is None and place.scheduler is None:
        return nullcontext()
    from pareto_monoped.jump.peers import cluster, processes

    def tell(line: str) -> None:
        echo(line, err=True)

    if place.scheduler is not None:
        return cluster(place.scheduler, tell=tell, limits=limits, extra=extra)
    return processes(place.processes, tell=tell, limits=limits)
