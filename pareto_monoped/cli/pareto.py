"""Command ``pareto``: the main job, from the actuator map to the CAD of the knee design, made of the other commands."""

import contextlib
import io
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

import click

if TYPE_CHECKING:
    from pareto_monoped.study.reader import StudyData


@click.command()
@click.argument("study_file", metavar="[STUDY.toml]", type=click.Path(path_type=Path), default="studies/case_c.toml")
@click.option(
    "-o", "--output", type=click.Path(path_type=Path), help="Folder for the results.  [default: reports/STUDY]"
)
@click.option("--db", type=click.Path(path_type=Path), help="Study database.  [default: beside STUDY.toml]")
@click.option("--evaluations", type=click.IntRange(min=1), metavar="N", help="Number of jumps, instead of the study's.")
@click.option("--workers", type=click.IntRange(min=1), metavar="N", help="Number of threads.  [default: all cores]")
def pareto(
    study_file: Path, output: Path | None, db: Path | None, evaluations: int | None, workers: int | None
) -> None:
    """Do the main job: actuator map, study, knee design, its CAD, report.

    It can be repeated safely: a finished study is not run again, and CAD and report are made again only if they are
    out of date.
    """
    from pareto_monoped.cad.jobs import trial_job
    from pareto_monoped.cad.made import is_made
    from pareto_monoped.pareto.pick import Knee, pick
    from pareto_monoped.study.definition import load_study
    from pareto_monoped.study.reader import read_study

    study = load_study(study_file)
    folder = output or Path("reports") / study_file.stem
    db = db or study_file.with_suffix(".db")
    folder.mkdir(parents=True, exist_ok=True)
    table, report, cad = folder / "actuators.csv", folder / "report.html", folder / "cad"

    _step(1, "actuators", "--motor", study.motor, "--csv", table)
    options = [f"--evaluations={evaluations}"] if evaluations else []
    options += [f"--workers={workers}"] if workers else []
    _step(2, "run", study_file, "--db", db, *options)
    data = read_study(db)
    knee = pick(data.front(), Knee())
    design = cad / f"trial_{knee.trial}"
    job = trial_job(data, knee.trial, folder=design)
    again = ["--force"] if (design / "design.json").exists() and not is_made(job) else []
    _step(3, "export", db, "--trial", knee.trial, "-o", design, *again, made=lambda: is_made(job))
    _step(4, "report", db, "-o", report, "--exports", cad, made=lambda: _newer(report, db, design / "design.json"))

    click.echo("\nMade")
    for path, what in (
        (table, "the lightest actuator of every ratio"),
        (db, "every jump; resumable, opens in Optuna"),
        (design, "CAD and models of the knee design"),
        (report, "the front: open it in a browser"),
    ):
        click.echo(f"  {path!s:<32} {what}")
    _print_headline(data, knee.trial)


def _step(number: int, command: str, *arguments: object, made: Callable[[], bool] = lambda: False) -> None:
    """Run one of our own commands as a user would. Show the command, but not what it prints to stdout."""
    from pareto_monoped.cli import cli

    words = [command, *map(str, arguments)]
    done = made()
    click.echo(f"[{number}/4] pareto-monoped {' '.join(words)}{'  (up to date)' if done else ''}", err=True)
    if not done:
        with contextlib.redirect_stdout(io.StringIO()):
            code = cli.main(args=words, prog_name="pareto-monoped", standalone_mode=False)
        if code:
            raise click.exceptions.Exit(code)


def _newer(target: Path, *sources: Path) -> bool:
    return target.exists() and all(target.stat().st_mtime >= source.stat().st_mtime for source in sources)


def _print_headline(data: "StudyData", knee_trial: int) -> None:
    from rich import box
    from rich.console import Console
    from rich.table import Table

    from pareto_monoped.study.headline import headline

    table = Table(box=box.SIMPLE_HEAD, title_justify="left", pad_edge=False)
    table.add_column("design")
    table.add_column("height / m", justify="right")
    table.add_column("energy / J", justify="right")
    for row in headline(data, knee_trial):
        table.add_row(row.label, f"{row.height_m:.3f}", f"{row.energy_j:.2f}")
    Console(width=80).print(table)
    study = data.study
    click.echo(
        f"Simulated with motor {study.motor}, calibration {study.calibration}; "
        f"{len(data.front())} designs on the front."
    )
