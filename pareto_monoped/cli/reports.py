"""Command ``report``: one HTML page of one or more studies, and figures for print."""

from pathlib import Path

import click

from pareto_monoped.cli.options import DATABASE, HTML_FILE, Local, force_option
from pareto_monoped.cli.terminal import echo, note
from pareto_monoped.study.place import StudyPlace


@click.command()
@click.argument("dbs", metavar="DB [DB ...]", nargs=-1, required=True, type=DATABASE)
@click.option("-o", "--output", type=HTML_FILE, metavar="FILE.html", help="The HTML page.")
@click.option(
    "--figures",
    type=Local(file_okay=False),
    metavar="DIR",
    help="Folder for figures for print, as SVG and PNG.",
)
@click.option(
    "--exports",
    type=Local(file_okay=False),
    metavar="DIR",
    help="Folder of exported designs, DIR/trial_N.",
)
@click.option("--no-jumps", is_flag=True, help="Leave out the jumps of the fronts' designs: quicker, and smaller.")
@force_option
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
    from pareto_monoped.files import refuse_database, write_text
    from pareto_monoped.report.page import page, payload_of

    if output is not None:
        refuse_database(output)
    # Figures show one jump only.
    most_jumps = 0 if no_jumps else 1 if output is None else None
    payload = payload_of(dbs, exports=exports, most_jumps=most_jumps, note=note)
    if output is not None:
        write_text(output, page(payload), force=force)
        echo(f"wrote {output} ({output.stat().st_size / 1e6:.1f} MB)", err=True)
    if figures is not None:
        from pareto_monoped.report.figures import write_figures

        for path in write_figures(payload, figures, force=force):
            echo(f"wrote {path}", err=True)
