"""Command ``campaign``, and how its studies stand: on a terminal, in a pipe, or as lines of JSON."""

import json
import time
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from pareto_monoped.cli.options import CSV_FILE, HTML_FILE, Local, force_option, scheduler_option
from pareto_monoped.cli.terminal import echo, name, new_console, note

if TYPE_CHECKING:
    from rich.table import Table

    from pareto_monoped.campaign.coordinator import Standing
    from pareto_monoped.campaign.folder import Place
    from pareto_monoped.campaign.grid import Campaign


@click.command()
@click.argument("campaign_file", metavar="CAMPAIGN.toml", type=Local())
@click.option("--folder", type=Local(), metavar="DIR", help="Of the databases.  [default: CAMPAIGN/ beside it]")
@click.option(
    "--workers",
    type=click.IntRange(1, 1024),
    metavar="N",
    help="Number of threads of all studies together, or of studies at a time with --scheduler.  [default: all cores, "
    "or all threads of the scheduler's workers]",
)
@scheduler_option
@click.option("--status", is_flag=True, help="Run nothing: only show how the studies stand.")
@click.option("--report", "page", type=HTML_FILE, metavar="FILE.html", help="Write a page that compares them.")
@click.option("--csv", "table", type=CSV_FILE, metavar="FILE.csv", help="Write a table with a row per study.")
@click.option("--json", "as_json", is_flag=True, help="Print JSON: a line per stored generation and per study.")
@force_option
def campaign(
    campaign_file: Path,
    folder: Path | None,
    workers: int | None,
    scheduler: str | None,
    status: bool,
    page: Path | None,
    table: Path | None,
    as_json: bool,
    force: bool,
) -> int:
    """Run a grid of studies, or continue it where it stopped.

    CAMPAIGN.toml names a study and, for some of its keys, lists of values; each combination is a study with a database
    of its own. They run side by side, and the same command continues all of them after an interrupt or a kill.
    """
    from pareto_monoped.campaign.coordinator import run_campaign, standings_of
    from pareto_monoped.campaign.folder import held, places_of
    from pareto_monoped.campaign.grid import load_campaign
    from pareto_monoped.errors import require_extra
    from pareto_monoped.files import require_writable

    if scheduler is not None:
        require_extra("cluster", "--scheduler")
    for output in (page, table):
        if output is not None:
            require_writable(output)
    grid = load_campaign(campaign_file)
    place = folder or grid.folder
    complete = True
    if status:
        places = places_of(grid, place)
        standings = standings_of(places)
    else:
        with held(place):
            places = places_of(grid, place)
            standings = standings_of(places)
            with reports(standings, as_json=as_json) as (changed, notify):
                complete = run_campaign(standings, cores=workers, scheduler=scheduler, changed=changed, notify=notify)
    if as_json:
        echo(json.dumps({"event": "end", "studies": [one.as_dict() for one in standings]}))
    else:
        print_table(standings)
        echo(f"{grid.path}: {studies(len(standings))}, {counted(standings)}", err=True)
    if complete and not (page is None and table is None):
        _write(grid, standings, page, table, force)
    _tell(standings, place, places)
    if not complete:
        return 130
    return 1 if any(one.state == "failed" for one in standings) else 0


def _tell(standings: "Sequence[Standing]", folder: Path, places: "Sequence[Place]") -> None:
    """One line for databases that are of no study of the campaign, and one for each study that failed, as the last."""
    from pareto_monoped.campaign.folder import strangers

    if others := strangers(folder, places):
        some = ", ".join(name(db.name) for db in others[:3]) + (", ..." if len(others) > 3 else "")
        those = "a database" if len(others) == 1 else f"{len(others)} databases"
        note(f"no study of this grid has {those} in {folder}: {some}")
    for one in standings:
        if one.state == "failed":
            echo(f"error: {name(one.name)}: {name(one.reason)}", err=True)


def _write(
    grid: "Campaign", standings: "Sequence[Standing]", page: Path | None, table: Path | None, force: bool
) -> None:
    from pareto_monoped.campaign.page import write_results

    failed = {one.name: one.reason for one in standings if one.state == "failed"}
    write_results(grid, [one.place for one in standings], failed, page=page, table=table, force=force, wrote=_told)


def _told(path: Path) -> None:
    size = f" ({path.stat().st_size / 1e6:.1f} MB)" if path.suffix == ".html" else ""
    echo(f"wrote {path}{size}", err=True)


_SECONDS_BETWEEN_LINES = 5.0
_NAME_WIDTH = 24  #: Letters of a study's name in 80 columns; longer ones lose their middle, not their ends.
_AROUND = 5  #: Lines of the live table that are no studies: what stands above them, their count below, and the prompt.

Reports = tuple[Callable[["Standing"], object], Callable[[str], None]]
"""Called with a changed standing, and with a line."""


@contextmanager
def reports(standings: "Sequence[Standing]", *, as_json: bool) -> Iterator[Reports]:
    """Show the progress of a campaign on stderr, as a table on a terminal, else as a line every few seconds.

    As JSON it is a line on stdout for every stored generation and for every study that ends.
    """
    import sys

    if as_json:
        yield _json_report, _say
    elif sys.stderr is not None and sys.stderr.isatty():
        yield from _live(standings)
    else:
        yield _lines(standings), _say


def print_table(standings: "Sequence[Standing]") -> None:
    """All studies and how they stand, on stdout."""
    cells = ((str(one.front) if one.front else "", f"{one.seconds:.1f} s" if one.seconds else "") for one in standings)
    new_console(width=80).print(_shown(standings, "front", "time", cells))


def studies(count: int) -> str:
    """Return so many studies, in words."""
    return "1 study" if count == 1 else f"{count} studies"


def counted(standings: "Sequence[Standing]") -> str:
    """Return how many studies are in which state."""
    return ", ".join(f"{count} {state}" for state, count in Counter(one.doing for one in standings).items())


def shortened(text: str, width: int) -> str:
    """Return a name of at most so many letters, without its middle if it has more."""
    text = name(text)
    if len(text) <= width:
        return text
    tail = width // 2
    return f"{text[: width - tail - 1]}…{text[-tail:]}"


def _json_report(standing: "Standing") -> None:
    ended = standing.state in ("finished", "failed")
    echo(json.dumps({"event": "study" if ended else "generation"} | standing.as_dict()))


def _say(line: str) -> None:
    echo(name(line), err=True)


def _lines(standings: "Sequence[Standing]") -> "Callable[[Standing], None]":
    last, began = time.monotonic(), time.monotonic()

    def show(standing: "Standing") -> None:
        nonlocal last
        if standing.state == "finished":
            _say(f"{standing.name}: {standing.evaluations} jumps, hypervolume {_volume(standing)}")
        elif standing.state == "failed":
            _say(f"{standing.name}: failed: {standing.reason}")
        elif time.monotonic() - last >= _SECONDS_BETWEEN_LINES:
            last = time.monotonic()
            _say(_all(standings, last - began))

    return show


def _live(standings: "Sequence[Standing]") -> Iterator[Reports]:
    from rich.console import Group
    from rich.live import Live
    from rich.text import Text

    began = time.monotonic()
    console = new_console(stderr=True)

    def picture() -> Group:
        seconds = time.monotonic() - began
        return Group(
            Text(_all(standings, seconds), no_wrap=True, overflow="ellipsis"), *_rows(standings, console.height)
        )

    with Live(get_renderable=picture, console=console, refresh_per_second=4, transient=True):
        yield (lambda _: None), (lambda line: console.print(name(line)))


def _rows(standings: "Sequence[Standing]", height: int) -> list[Any]:
    """Return the table and, if not all studies fit into it, what the others are at."""
    from rich.text import Text

    room = max(height - _AROUND, 3)
    shown = standings if len(standings) <= room else _of_interest(standings, room - 1)
    parts: list[Any] = [_table(shown)]
    if len(shown) < len(standings):
        left = [one for one in standings if not any(one is other for other in shown)]
        parts.append(Text(f"and {len(left)} more: {counted(left)}"))
    return parts


def _of_interest(standings: "Sequence[Standing]", room: int) -> "list[Standing]":
    """Return so many studies: those at work, then failed ones, the next ones, and those that have ended."""
    ranks = {"running": 0, "failed": 1, "unfinished": 2, "waiting": 2, "finished": 3}
    places = sorted(range(len(standings)), key=lambda k: (ranks[standings[k].state], k))
    return [standings[k] for k in sorted(places[:room])]


def _shown(standings: "Sequence[Standing]", second: str, last: str, cells: Iterable[tuple[str, str]]) -> "Table":
    """Return a row per study with how it stands; ``cells`` belong under the titles of two columns of numbers."""
    from rich import box
    from rich.table import Table

    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    table.add_column("study", no_wrap=True)
    for title in ("jumps", second, "hypervolume", last):
        table.add_column(title, justify="right", no_wrap=True)
    table.add_column("state", no_wrap=True)
    for one, (in_second, in_last) in zip(standings, cells, strict=True):
        name = shortened(one.name, _NAME_WIDTH)
        table.add_row(name, _jumps(one), in_second, _volume(one), in_last, one.doing)
    return table


def _table(standings: "Sequence[Standing]") -> "Table":
    cells = (
        (
            f"{one.per_second:.0f}/s" if one.per_second else "",
            "" if one.seconds_left is None else clock(one.seconds_left),
        )
        for one in standings
    )
    return _shown(standings, "rate", "left", cells)


def _jumps(standing: "Standing") -> str:
    return f"{standing.evaluations}/{standing.budget}"


def _volume(standing: "Standing") -> str:
    return f"{standing.hypervolume:.3f} {standing.hypervolume_unit}" if standing.evaluations else ""


def clock(seconds: float) -> str:
    """Return a time as minutes and seconds, or as hours, minutes and seconds."""
    minutes, rest = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours}:{minutes:02d}:{rest:02d}" if hours else f"{minutes}:{rest:02d}"


def _all(standings: "Sequence[Standing]", seconds: float) -> str:
    ended = sum(one.state in ("finished", "failed") for one in standings)
    done, budget = (sum(getattr(one, key) for one in standings) for key in ("evaluations", "budget"))
    left = sum(one.budget - one.evaluations for one in standings if one.state != "failed")
    rate = sum(one.new_evaluations for one in standings) / max(seconds, 1e-9)
    pace = f", {rate:.0f}/s, {clock(left / rate)} left" if rate > 0.0 else ""
    return f"{ended} of {studies(len(standings))} ended, {done} of {budget} jumps{pace}"
