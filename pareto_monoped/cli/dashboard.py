"""Command ``dashboard``: optuna-dashboard on a study, for this machine only and without leave to write."""

import errno
import webbrowser
from typing import TYPE_CHECKING, Any

import click

from pareto_monoped.cli.options import DATABASE
from pareto_monoped.cli.terminal import echo, name
from pareto_monoped.study.place import StudyPlace

if TYPE_CHECKING:
    from wsgiref.simple_server import WSGIServer

HOST = "127.0.0.1"
"""The loopback: nobody else in the network reaches the dashboard, which asks for no password."""
PORT = 8080
"""Where optuna-dashboard listens by default, too."""


@click.command()
@click.argument("db", type=DATABASE)
@click.option(
    "--port", type=click.IntRange(1, 65535), metavar="N", help=f"Where it listens.  [default: {PORT}, or any free one]"
)
@click.option("--open", "browse", is_flag=True, help="Open it in the browser.")
def dashboard(db: StudyPlace, port: int | None, browse: bool) -> None:
    """Show a study in optuna-dashboard, until Ctrl-C.

    It listens on this machine only. The study is opened for reading, also while it runs: notes, new names and deletions
    are refused there.
    """
    from pareto_monoped.extras import require_extra
    from pareto_monoped.study.summary import read_summary

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
    """The dashboard's WSGI application of a study."""
    from optuna_dashboard import wsgi

    from pareto_monoped.study.optuna_reading import reading_storage

    return _reading(wsgi(reading_storage(db)))


def _reading(application: Any) -> Any:
    """The application for requests that read; others are answered with a refusal, which the page shows."""

    def answered(environment: dict[str, Any], start: Any) -> Any:
        if environment["REQUEST_METHOD"] in ("GET", "HEAD"):
            return application(environment, start)
        start("403 Forbidden", [("Content-Type", "application/json")])
        return [b'{"reason": "the study is open for reading only"}']

    return answered


def _server(application: Any, port: int | None) -> "WSGIServer":
    """A server on the loopback, at the port asked for.

    Raises:
        InputError: that port is in use, or not allowed.
    """
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
