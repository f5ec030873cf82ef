"""Commands on a study database: ``verify``, ``repair``, ``dashboard``, ``report`` and ``trials``."""

import errno
import re
import webbrowser
from collections.abc import Callable
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from pareto_monoped.cli import options
from pareto_monoped.cli.terminal import echo, name, note
from pareto_monoped.errors import require_extra
from pareto_monoped.storage.place import StudyPlace

if TYPE_CHECKING:
    from wsgiref.simple_server import WSGIServer

    from pandas import DataFrame

    from pareto_monoped.report.schema import Payload


class ContentHash(click.ParamType[str]):
    """A content hash, or at least so many of its leading digits that no other study has them by chance."""

    name = "hash"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> str:
        """Return the digits in lower case."""
        if not re.fullmatch("[0-9a-f]{16,64}", str(value).lower()):
            self.fail(f"{value!r} is no content hash; give 16 to 64 hexadecimal digits, as 'status' prints them")
        return str(value).lower()


@click.command()
@click.argument("db", type=options.DATABASE)
@click.option(
    "--simulate", type=click.IntRange(min=0), default=0, metavar="N", help="Simulate N trials again and compare."
)
@click.option("--workers", type=click.IntRange(1, 1024), metavar="N", help="Number of threads.  [default: all cores]")
@click.option("--expect", type=ContentHash(), metavar="HASH", help="Content hash that the study must have.")
@options.where_options
def verify(
    db: StudyPlace,
    simulate: int,
    workers: int | None,
    expect: str | None,
    processes: int | None,
    scheduler: str | None,
) -> None:
    """Check that nothing in a study has been lost or changed.

    Checks the running hash, the numbering, that values are finite and possible, and that Optuna's tables agree. Only a
    content hash noted elsewhere, from 'status' or a report, shows that it was not exchanged or edited on purpose.
    """
    from pareto_monoped.analysis.verify import require_sound
    from pareto_monoped.analysis.verify import verify as verify_study
    from pareto_monoped.compute.chunks import cores
    from pareto_monoped.storage.kept_front import foreign_note
    from pareto_monoped.storage.seals import UNSEALED

    place = options.where(processes, scheduler, workers)
    if place != options.Where() and not simulate:
        raise click.UsageError("--processes and --scheduler go with --simulate only, which is what they do; drop them")
    with options.executor_at(place) as executor:
        result = verify_study(db, simulate=simulate, expect=expect, workers=workers or cores(), executor=executor)
    for line in result.findings:
        echo(f"found: {line}", err=True)
    if result.foreign and not result.findings:
        note(foreign_note(len(result.foreign)))
    if not result.sealed:
        note(UNSEALED)
    require_sound(db, result)
    again = f", {result.simulated} jumped again as stored" if result.simulated else ""
    echo(f"{db}: sound, {result.trials} trials{again}\ncontent hash {result.content_hash}")


@click.command()
@click.argument("db", type=options.DATABASE)
def repair(db: StudyPlace) -> None:
    """Drop trials that an Optuna user has added to a study.

    They are ignored by all other commands, but Optuna and its dashboard count them among the study's.
    """
    from pareto_monoped.storage.optuna_check import repair as repair_study

    dropped = repair_study(db)
    numbers = f", which Optuna numbered {', '.join(map(str, dropped))}" if dropped else ""
    echo(f"{db}: dropped {len(dropped)} trials{numbers}")


HOST = "127.0.0.1"  #: The loopback: nobody else in the network reaches the dashboard, which asks for no password.
PORT = 8080  #: Where optuna-dashboard listens by default, too.


@click.command()
@click.argument("db", type=options.DATABASE)
@click.option(
    "--port", type=click.IntRange(1, 65535), metavar="N", help=f"Where it listens.  [default: {PORT}, or any free one]"
)
@click.option("--open", "browse", is_flag=True, help="Open it in the browser.")
def dashboard(db: StudyPlace, port: int | None, browse: bool) -> None:
    """Show a study in optuna-dashboard, until Ctrl-C.

    It listens on this machine only. The study is opened for reading, also while it runs: notes, new names and deletions
    are refused there.
    """
    from pareto_monoped.storage.status import read_summary

    require_extra("dashboard", "dashboard")
    read_summary(db)  # says what is wrong with the file before Optuna does
    with _server(_application(db), port) as server:
        address = f"http://{HOST}:{server.server_port}/"
        echo(f"{name(db)} is at {address}, read only; Ctrl-C ends it", err=True)
        if browse:
            webbrowser.open(address)
        try:
            server.serve_forever(poll_interval=0.1)
        except KeyboardInterrupt:
            echo("ended", err=True)


def _application(db: StudyPlace) -> Any:
    """Return the dashboard's WSGI application of a study."""
    from optuna_dashboard import wsgi

    from pareto_monoped.storage.place import storage_of

    return _reading(wsgi(storage_of(db).optuna_storage(read_only=True)))


def _reading(application: Any) -> Any:
    """Return the application for requests that read; others are answered with a refusal, which the page shows."""

    def answered(environment: dict[str, Any], start: Any) -> Any:
        if environment["REQUEST_METHOD"] in ("GET", "HEAD"):
            return application(environment, start)
        start("403 Forbidden", [("Content-Type", "application/json")])
        return [b'{"reason": "the study is open for reading only"}']

    return answered


def _server(application: Any, port: int | None) -> "WSGIServer":
    """Return a server on the loopback; raise ``InputError`` for a port that is in use or not allowed."""
    from socketserver import ThreadingMixIn
    from wsgiref.simple_server import WSGIRequestHandler, WSGIServer, make_server

    from pareto_monoped.errors import InputError

    class Quiet(WSGIRequestHandler):
        """Nobody needs a line per request."""

        def log_message(self, *_: Any) -> None:
            """Say nothing."""

    class Threads(ThreadingMixIn, WSGIServer):
        """A slow request holds up no other one; none holds up the end."""

        daemon_threads = True

    def at(number: int) -> WSGIServer:
        return make_server(HOST, number, application, server_class=Threads, handler_class=Quiet)

    try:
        return at(port or PORT)
    except OSError as error:
        if port is None and error.errno == errno.EADDRINUSE:
            return at(0)
        raise InputError(
            f"--port = {port or PORT}: cannot be listened at ({error.strerror}); give another one"
        ) from None


@click.command()
@click.argument("dbs", metavar="DB [DB ...]", nargs=-1, required=True, type=options.DATABASE)
@click.option("-o", "--output", type=options.HTML_FILE, metavar="FILE.html", help="The HTML page.")
@click.option(
    "--figures",
    type=options.Local(file_okay=False),
    metavar="DIR",
    help="Folder for figures for print, as SVG and PNG.",
)
@click.option(
    "--exports", type=options.Local(file_okay=False), metavar="DIR", help="Folder of exported designs, DIR/trial_N."
)
@click.option("--no-jumps", is_flag=True, help="Leave out the jumps of the fronts' designs: quicker, and smaller.")
@options.force_option
def report(
    dbs: tuple[StudyPlace, ...],
    output: Path | None,
    figures: Path | None,
    exports: Path | None,
    no_jumps: bool,
    force: bool,
) -> None:
    """Write the report of a study, or of several in comparison.

    The page is one file that works without a network.
    """
    if output is None and figures is None:
        raise click.UsageError("no output given: must be -o FILE.html, --figures DIR, or both; add one")
    from pareto_monoped.files import refuse_database
    from pareto_monoped.report.page import payload_of

    if output is not None:
        refuse_database(output)
    # Figures show one jump only.
    most_jumps = 0 if no_jumps else 1 if output is None else None
    payload = payload_of(dbs, exports=exports, most_jumps=most_jumps, note=note)
    if output is not None:
        write_page(payload, output, force=force)
    if figures is not None:
        from pareto_monoped.report.figures import write_figures

        for path in write_figures(payload, figures, force=force):
            echo(f"wrote {path}", err=True)


def write_page(payload: "Payload", output: Path, *, force: bool = False) -> None:
    """Write a page with a content, and say so."""
    from pareto_monoped.files import write_text
    from pareto_monoped.report.page import page

    write_text(output, page(payload), force=force)
    echo(f"wrote {output} ({output.stat().st_size / 1e6:.1f} MB)", err=True)


@click.command()
@click.argument("db", type=options.DATABASE)
@click.option("--csv", "csv_file", metavar="FILE.csv", type=options.CSV_FILE, help="Write a table of text.")
@click.option("--parquet", metavar="FILE.parquet", type=options.PARQUET_FILE, help="Write a table of Apache Parquet.")
@click.option(
    "--state", type=click.Choice(["feasible", "infeasible", "failed"]), help="Only trials that ended like this."
)
@options.force_option
def trials(db: StudyPlace, csv_file: Path | None, parquet: Path | None, state: str | None, force: bool) -> None:
    """Give all trials of a study with every measure, as a table.

    Columns have their stored names and SI units. Without a file the table goes to stdout, as CSV.
    """
    from pareto_monoped.files import replacing
    from pareto_monoped.storage.reader import read_trials
    from pareto_monoped.storage.seals import UNSEALED

    if parquet is not None:
        require_extra("parquet", "--parquet", instead="use --csv")
    count, first = 0, True
    with ExitStack() as outputs:
        write: list[Callable[[DataFrame], object]] = []
        if csv_file is not None:
            new = outputs.enter_context(replacing(csv_file, force=force))
            stream = outputs.enter_context(new.open("w", encoding="utf-8", newline=""))
            write.append(lambda rows: stream.write(_csv(rows, header=first)))
        if parquet is not None:
            write.append(_parquet_writer(outputs, outputs.enter_context(replacing(parquet, force=force))))
        if not write:
            write.append(lambda rows: echo(_csv(rows, header=first), nl=False))
        # Block by block: a study of a million trials needs no more memory than a small one.
        for rows in read_trials(db):
            if first and not rows.attrs["sealed"]:
                note(UNSEALED)
            wanted = rows if state is None else rows[rows["state"] == state]
            for each in write:
                each(wanted)
            count, first = count + len(wanted), False
    for path in (csv_file, parquet):
        if path is not None:
            echo(f"wrote {path} ({count} trials)", err=True)


def _csv(rows: "DataFrame", *, header: bool) -> str:
    # As objects, numbers are written by ``csv`` at once; else pandas makes texts of them first, in a third more time.
    return str(rows.astype(object).to_csv(index=False, header=header, lineterminator="\n"))


def _parquet_writer(outputs: ExitStack, path: Path) -> "Callable[[DataFrame], None]":
    """Return what appends rows to a new file, which ``outputs`` closes."""
    from pyarrow import Table
    from pyarrow.parquet import ParquetWriter

    writers: list[Any] = []

    def write(rows: "DataFrame") -> None:
        table = Table.from_pandas(rows, preserve_index=False)
        if not writers:  # the first rows say what the columns are
            writers.append(outputs.enter_context(ParquetWriter(path, table.schema)))
        writers[0].write_table(table)

    return write
