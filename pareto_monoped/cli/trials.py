"""``trials``: every trial of a study with all its measures, for other programs."""

from pathlib import Path
from typing import TYPE_CHECKING

import click

from pareto_monoped.cli.options import CSV_FILE, DATABASE, PARQUET_FILE, force_option
from pareto_monoped.cli.terminal import echo
from pareto_monoped.extras import require_extra
from pareto_monoped.study.place import StudyPlace

if TYPE_CHECKING:
    from pandas import DataFrame


@click.command()
@click.argument("db", type=DATABASE)
@click.option("--csv", "csv_file", metavar="FILE.csv", type=CSV_FILE, help="Write a table of text.")
@click.option("--parquet", metavar="FILE.parquet", type=PARQUET_FILE, help="Write a table of Apache Parquet.")
@click.option(
    "--state", type=click.Choice(["feasible", "infeasible", "failed"]), help="Only trials that ended like this."
)
@force_option
def trials(db: StudyPlace, csv_file: Path | None, parquet: Path | None, state: str | None, force: bool) -> None:
    """Give all trials of a study with every measure, as a table.

    Columns have their stored names and SI units. Without a file the table goes to stdout, as CSV.
    """
    from pareto_monoped.study.reader import read_study

    if parquet is not None:
        require_extra("parquet", "--parquet", instead="use --csv")
    rows = read_study(db).trials
    if state is not None:
        rows = rows[rows["state"] == state]
    if csv_file is None and parquet is None:
        echo(rows.to_csv(index=False, lineterminator="\n"), nl=False)
        return
    from pareto_monoped.files import write_bytes, write_text

    if csv_file is not None:
        write_text(csv_file, rows.to_csv(index=False, lineterminator="\n"), force=force)
        _say(csv_file, rows)
    if parquet is not None:
        write_bytes(parquet, rows.to_parquet(index=False), force=force)
        _say(parquet, rows)


def _say(path: Path, rows: "DataFrame") -> None:
    echo(f"wrote {path} ({len(rows)} trials)", err=True)
