"""Options that say where the work is done: threads of this process, processes of this machine, or a cluster."""

from collections.abc import Callable, Iterator
from concurrent.futures import Executor
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import click

from pareto_monoped.cli.terminal import echo

if TYPE_CHECKING:
    from pareto_monoped.compute.staff import Limits


@dataclass(frozen=True, slots=True, kw_only=True)
class Where:
    """Where the work is done: at most one of them is given; on threads if none is.

    Attributes:
        processes: number of processes of this machine.
        scheduler: address of a Dask scheduler.
    """

    processes: int | None = None
    scheduler: str | None = None


scheduler_option = click.option(
    "--scheduler", metavar="ADDRESS", help="Compute on the workers of a Dask scheduler, such as tcp://host:8786."
)


def where_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """``--processes`` and ``--scheduler``, handed over as ``processes`` and ``scheduler``."""
    processes = click.option(
        "--processes", type=click.IntRange(1, 256), metavar="N", help="Compute in N processes instead of threads."
    )
    return processes(scheduler_option(command))


def where(processes: int | None, scheduler: str | None, workers: int | None) -> Where:
    """What the options say; a usage error if they contradict each other."""
    given = {"--processes": processes, "--scheduler": scheduler, "--workers": workers}
    named = [option for option, value in given.items() if value is not None]
    if len(named) > 1:
        raise click.UsageError(f"{named[0]} and {named[1]} exclude each other; drop one")
    return Where(processes=processes, scheduler=scheduler)


@contextmanager
def executor_at(place: Where, *, limits: "Limits | None" = None, extra: str | None = None) -> Iterator[Executor | None]:
    """The executor for a place, None for threads; what happens to its workers is said on standard error.

    Args:
        place: what the options say.
        limits: how long to wait for tasks and workers; None: as for jumps.
        extra: whose packages other hosts must have in the same versions, too.
    """
    if place.processes is None and place.scheduler is None:
        yield None
        return
    from pareto_monoped.jump.peers import cluster, processes

    def tell(line: str) -> None:
        echo(line, err=True)

    if place.scheduler is not None:
        with cluster(place.scheduler, tell=tell, limits=limits, extra=extra) as crew:
            yield crew
    else:
        with processes(place.processes, tell=tell, limits=limits) as crew:
            yield crew
