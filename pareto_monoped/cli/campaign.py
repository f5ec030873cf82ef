"""Command ``campaign``: a grid of studies, run side by side, continued as a whole, compared on one page."""

import json
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import click

from pareto_monoped.cli.computing import scheduler_option
from pareto_monoped.cli.options import CSV_FILE, HTML_FILE, Local, force_option
from pareto_monoped.cli.terminal import echo, name, note

if TYPE_CHECKING:
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
@click.option(
    "--report",
    "page",
    type=HTML_FILE,
    metavar="FILE.html",
    help="Write a page that compares them.",
)
@click.option(
    "--csv",
    "table",
    type=CSV_FILE,
    metavar="FILE.csv",
    help="Write a table with a row per study.",
)
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
    from pareto_monoped.cli.campaign_table import as_values, counted, print_table, reports, studies
    from pareto_monoped.extras import require_extra
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
        echo(json.dumps({"event": "end", "studies": [as_values(one) for one in standings]}))
    else:
        print_table(standings)
        echo(f"{grid.path}: {studies(len(standings))}, {counted(standings)}", err=True)
    _tell(standings, place, places)
    if complete:
        _write(grid, standings, page, table, force)
    if not complete:
        return 130
    return 1 if any(one.state == "failed" for one in standings) else 0


def _tell(standings: "Sequence[Standing]", folder: Path, places: "Sequence[Place]") -> None:
    """One line for each study that failed, and one for databases that are of no study of the campaign."""
    from pareto_monoped.campaign.folder import strangers

    for one in standings:
        if one.state == "failed":
            echo(f"error: {name(one.name)}: {name(one.reason)}", err=True)
    if others := strangers(folder, places):
        some = ", ".join(name(db.name) for db in others[:3]) + (", ..." if len(others) > 3 else "")
        those = "a database" if len(others) == 1 else f"{len(others)} databases"
        note(f"no study of this grid has {those} in {folder}: {some}")


def _write(
    grid: "Campaign", standings: "Sequence[Standing]", page: Path | None, table: Path | None, force: bool
) -> None:
    """Write the outputs that are asked for."""
    from pareto_monoped.files import write_text

    if page is None and table is None:
        return
    from pareto_monoped.campaign.results import results_of

    failed = {one.name: one.reason for one in standings if one.state == "failed"}
    results = results_of([one.place for one in standings], failed)
    if table is not None:
        from pareto_monoped.campaign.table import csv_text

        write_text(table, csv_text(grid, results), force=force)
        echo(f"wrote {table}", err=True)
    if page is not None:
        from pareto_monoped.campaign.page import campaign_page

        write_text(page, campaign_page(grid, results), force=force)
        echo(f"wrote {page} ({page.stat().st_size / 1e6:.1f} MB)", err=True)
