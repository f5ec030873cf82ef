"""``export``: CAD and model files of one design, or of the whole front."""

import math
import os
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from pareto_monoped.cli.fronts import required, selector_options
from pareto_monoped.design import NAMES, PAPER_CASES, Design

if TYPE_CHECKING:
    from pareto_monoped.actuator.motors import Motor
    from pareto_monoped.cad.jobs import Job
    from pareto_monoped.jump.calibration import Calibration
    from pareto_monoped.pareto.pick import Selector


@click.command()
@click.argument("db", required=False, type=click.Path(path_type=Path))
@selector_options
@click.option("-o", "--output", metavar="DIR", required=True, type=click.Path(path_type=Path), help="Folder to make.")
@click.option("--case", type=click.Choice(list(PAPER_CASES)), help="A row of the paper's Table I, without DB.")
@click.option(
    "--record", type=click.Path(path_type=Path), metavar="FILE", help="The design.json of an export: make it again."
)
@click.option("--front", "whole_front", is_flag=True, help="Every design on the front, each in DIR/trial_N.")
@click.option("--every", type=click.IntRange(min=1), default=1, metavar="N", help="With --front: each N-th of them.")
@click.option("--workers", type=click.IntRange(min=1), metavar="N", help="With --front: processes.  [all cores]")
@click.option("--formats", metavar="NAMES", help="Some of step,stl,3mf,dxf,glb,mjcf,urdf,png.  [all]")
@click.option("--hip-deg", type=float, metavar="DEG", help="Hip angle of the assembly.  [start pose]")
@click.option("--knee-deg", type=float, metavar="DEG", help="Knee angle of the assembly.  [start pose]")
@click.option("--force", is_flag=True, help="Replace an earlier export in DIR.")
def export(
    db: Path | None,
    selector: "Selector | None",
    output: Path,
    case: str | None,
    record: Path | None,
    whole_front: bool,
    every: int,
    workers: int | None,
    formats: str | None,
    hip_deg: float | None,
    knee_deg: float | None,
    force: bool,
) -> None:
    """Write CAD, drawings, models, pictures and parts list of a design.

    The design is built with lengths of whole 0.1 mm and its gearboxes' real ratios, simulated again and checked;
    nothing is written if a check fails. An export's design.json holds its motor and jump model too, so that --record
    needs neither the study nor its files.
    """
    if record is not None:
        if db is not None or selector is not None or case is not None or whole_front:
            raise click.UsageError("--record takes no DB, no selector, no --case and no --front; drop one of them")
        if hip_deg is not None or knee_deg is not None:
            raise click.UsageError("--record takes no --hip-deg and no --knee-deg, it holds the pose; drop them")
        from pareto_monoped.cad.jobs import recorded

        _one(
            recorded(
                record,
                folder=output,
                formats=_names(formats),
                force=force,
                note=lambda text: click.echo(text, err=True),
            )
        )
        return
    if whole_front and (selector is not None or case is not None):
        raise click.UsageError("--front takes no selector and no --case; drop one of them")
    if case is not None:
        if db is not None or selector is not None:
            raise click.UsageError(f"--case {case} takes no DB and no selector; drop one of them")
        from pareto_monoped.actuator.motors import load_motor
        from pareto_monoped.jump.calibration import load_calibration

        motor, calibration = load_motor("VT8020"), load_calibration("reference")
        job = _job(PAPER_CASES[case].design, motor, calibration, output, formats, force, {"case": case})
        _one(_posed(job, hip_deg, knee_deg))
        return
    if db is None:
        raise click.UsageError("no DB given; give the study's database, or --case, or --record")
    from pareto_monoped.pareto.pick import pick
    from pareto_monoped.study.reader import read_study

    if not whole_front:
        wanted = required(selector)
    data = read_study(db)
    rows = data.front()
    if not whole_front:
        picked = pick(rows, wanted)
        click.echo(picked.why, err=True)
        rows = rows[rows["trial"] == picked.trial]
    jobs = [
        _job(
            Design.from_array([row[name] for name in NAMES]),
            data.motor,
            data.calibration,
            output / f"trial_{int(row['trial'])}" if whole_front else output,
            formats,
            force,
            {"study": data.study.name, "trial": int(row["trial"])},
        )
        for row in rows.iloc[::every].to_dict(orient="records")
    ]
    if whole_front:
        _many(jobs, workers or os.cpu_count() or 1)
    else:
        _one(_posed(jobs[0], hip_deg, knee_deg))


def _names(formats: str | None) -> list[str] | None:
    return None if formats is None else [name.strip() for name in formats.split(",")]


def _posed(job: "Job", hip_deg: float | None, knee_deg: float | None) -> "Job":
    return replace(
        job,
        hip_rad=None if hip_deg is None else math.radians(hip_deg),
        knee_rad=None if knee_deg is None else math.radians(knee_deg),
    )


def _job(
    design: Design,
    motor: "Motor",
    calibration: "Calibration",
    folder: Path,
    formats: str | None,
    force: bool,
    source: dict[str, Any],
) -> "Job":
    from pareto_monoped.cad.export import chosen_formats
    from pareto_monoped.cad.jobs import Job

    return Job(
        design=design,
        motor=motor,
        calibration=calibration,
        folder=folder,
        formats=chosen_formats(_names(formats)),
        force=force,
        source=source,
    )


def _one(job: "Job") -> None:
    from pareto_monoped.cad.jobs import run

    record = run(job, progress=lambda step: click.echo(f"{step} ...", err=True))
    click.echo(f"wrote {job.folder} ({len(record['files'])} files)", err=True)
    for name in ("searched", "as_built"):
        jump = record["jumps"][name]
        height, energy = jump["height_m"], jump["energy_j"]
        told = f"{height:.4f} m  {energy:.3f} J" if height is not None and energy is not None else jump["status"]
        click.echo(f"{name.replace('_', ' '):<9} {told}")


def _many(jobs: "list[Job]", workers: int) -> None:
    from rich.console import Console
    from rich.progress import MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

    from pareto_monoped.cad.jobs import run_all

    columns = (TextColumn("{task.description}"), MofNCompleteColumn(), TimeElapsedColumn())
    with Progress(*columns, console=Console(stderr=True)) as bar:
        task = bar.add_task("exporting", total=len(jobs))

        def done(job: "Job") -> None:
            bar.advance(task)
            bar.console.print(f"wrote {job.folder}")

        try:
            made = run_all(jobs, workers=workers, done=done)
        except KeyboardInterrupt:
            bar.console.print("interrupted; the same command goes on from here")
            raise
        bar.update(task, completed=len(jobs))
    click.echo(f"{made} made, {len(jobs) - made} there already")
