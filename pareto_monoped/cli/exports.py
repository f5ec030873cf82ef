"""``export``: CAD and model files of one design, or of the whole front."""

import math
import signal
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from pareto_monoped.cli import options
from pareto_monoped.cli.selection import required, selector_options
from pareto_monoped.cli.terminal import echo, new_console, note, wrapped
from pareto_monoped.design import DEFAULT_RULES, PAPER_CASES, RULE_SETS, RuleSet
from pareto_monoped.storage.place import StudyPlace

if TYPE_CHECKING:
    from pareto_monoped.cad.batch import Progress
    from pareto_monoped.cad.jobs import Job
    from pareto_monoped.pareto.selectors import Selector
    from pareto_monoped.storage.reader import StudyData


@click.command()
@click.argument("db", required=False, type=options.DATABASE)
@selector_options
@click.option("-o", "--output", metavar="DIR", required=True, type=options.Local(), help="Folder for the export.")
@click.option("--case", type=click.Choice(list(PAPER_CASES)), help="A row of the paper's Table I, instead of DB.")
@options.motor_options("With --case: ")
@click.option("--rules", type=click.Choice(RULE_SETS), help=f"With --case: gearbox rules.  [default: {DEFAULT_RULES}]")
@click.option(
    "--record", type=options.Local(), metavar="FILE.json", help="Repeat the export that has this design.json."
)
@click.option("--front", "whole_front", is_flag=True, help="Export all designs of the front to DIR/trial_N.")
@click.option(
    "--every", type=click.IntRange(min=1), default=1, metavar="N", help="With --front: only every N-th design."
)
@click.option(
    "--workers", type=click.IntRange(1, 1024), metavar="N", help="With --front: processes.  [default: all cores]"
)
@options.scheduler_option
@click.option(
    "--formats",
    metavar="A,B",
    shell_complete=options.formats,
    help="From step,stl,3mf,dxf,glb,mjcf,urdf,pdf,\nassembly,png.  [default: all]",
)
@click.option("--no-drawings", is_flag=True, help="Leave out pdf, the workshop drawings.")
@click.option("--no-assembly", is_flag=True, help="Leave out assembly, the instructions with their pictures.")
@click.option("--hip-deg", type=float, metavar="DEG", help="Hip angle of the assembly.  [default: start pose]")
@click.option("--knee-deg", type=float, metavar="DEG", help="Knee angle of the assembly.  [default: start pose]")
@click.option("--force", is_flag=True, help="Replace an earlier export in DIR.")
@click.option("--no-strength", is_flag=True, help="Do not refuse a design whose joints do not hold.")
def export(
    db: StudyPlace | None,
    selector: "Selector | None",
    output: Path,
    case: str | None,
    motor: str | None,
    hip_motor: str | None,
    knee_motor: str | None,
    rules: RuleSet | None,
    record: Path | None,
    whole_front: bool,
    every: int,
    workers: int | None,
    scheduler: str | None,
    formats: str | None,
    no_drawings: bool,
    no_assembly: bool,
    hip_deg: float | None,
    knee_deg: float | None,
    force: bool,
    no_strength: bool,
) -> None:
    """Write CAD, drawings, models and parts list of a design.

    The design is built with lengths rounded to 0.1 mm and the real ratios of its gearboxes, then simulated again and
    checked. Nothing is written if a check fails. The design.json of an export also contains its motor and jump model,
    so that --record needs neither the study nor its files.
    """
    _refuse_mixed_sources(db, selector, case, record, whole_front, hip_deg, knee_deg, no_strength)
    place = options.where(None, scheduler, workers)
    if scheduler is not None and not whole_front:
        raise click.UsageError("--scheduler goes with --front only, for which it makes many exports; drop it")
    given = {"--rules": rules, "--motor": motor, "--hip-motor": hip_motor, "--knee-motor": knee_motor}
    for option, value in given.items():
        if value is not None and case is None:
            raise click.UsageError(f"{option} goes with --case only, studies and records name theirs; drop it")
    from pareto_monoped.errors import require_extra

    require_extra("cad", "CAD")
    from pareto_monoped.cad.interrupt import ending_at
    from pareto_monoped.cad.kernel import client as kernel

    with ending_at(signal.SIGINT):
        if not whole_front:
            # It loads meanwhile; the exports of a front have kernels of their own.
            kernel.start()
        from pareto_monoped.analysis.remarks import refuse_empty
        from pareto_monoped.cad.jobs import case_job, front_jobs, trial_job
        from pareto_monoped.cad.records import record_job
        from pareto_monoped.compute.chunks import cores

        names = None if formats is None else [name.strip() for name in formats.split(",")]
        dropped = {name for name, out in (("pdf", no_drawings), ("assembly", no_assembly)) if out}
        angles: dict[str, Any] = {"hip_rad": _radians(hip_deg), "knee_rad": _radians(knee_deg)}
        how: dict[str, Any] = {"folder": output, "formats": names, "force": force}
        asked = how | {"strength": False if no_strength else None}
        if record is not None:
            _one(_without(dropped, record_job(record, **how, note=_note)))
        elif case is not None:
            hip, knee = options.chosen_motors(motor, hip_motor, knee_motor)
            job = case_job(case, motor=hip, knee_motor=knee, rules=rules or DEFAULT_RULES, **asked, **angles)
            _one(_without(dropped, job))
        elif whole_front:
            data = _read(_given(db))
            refuse_empty(data.front(), data)
            jobs = front_jobs(data, every=every, **asked)
            _many([_without(dropped, job) for job in jobs], workers or cores(), place)
        else:
            from pareto_monoped.analysis.choices import choose, dear_words

            study, wanted = _given(db), required(selector)
            chosen = choose(_read(study), wanted, notify=note)
            _note(wrapped(chosen.picked.why))
            row = chosen.rows[chosen.rows["trial"] == chosen.picked.trial].iloc[0]
            if dear := dear_words(chosen.data, row):
                note(dear)
            _one(_without(dropped, trial_job(chosen.data, chosen.picked.trial, **asked, **angles)))


def _read(db: StudyPlace) -> "StudyData":
    from pareto_monoped.storage.reader import read_study
    from pareto_monoped.storage.seals import UNSEALED

    data = read_study(db)
    if not data.sealed:
        note(UNSEALED)
    return data


def _refuse_mixed_sources(
    db: StudyPlace | None,
    selector: "Selector | None",
    case: str | None,
    record: Path | None,
    whole_front: bool,
    hip_deg: float | None,
    knee_deg: float | None,
    no_strength: bool,
) -> None:
    """A usage error for options that exclude each other."""
    if record is not None:
        if db is not None or selector is not None or case is not None or whole_front:
            raise click.UsageError("--record takes no DB, no selector, no --case and no --front; drop one of them")
        if hip_deg is not None or knee_deg is not None:
            raise click.UsageError("--record takes no --hip-deg and no --knee-deg, it holds the pose; drop them")
        if no_strength:
            raise click.UsageError("--record takes no --no-strength, it says whether the design must hold; drop it")
    if whole_front and (selector is not None or case is not None):
        raise click.UsageError("--front takes no selector and no --case; drop one of them")
    if case is not None and (db is not None or selector is not None):
        raise click.UsageError(f"--case {case} takes no DB and no selector; drop one of them")


def _without(dropped: set[str], job: "Job") -> "Job":
    """Return the same job without some formats, whatever formats it names."""
    return replace(job, formats=tuple(name for name in job.formats if name not in dropped))


def _given(db: StudyPlace | None) -> StudyPlace:
    if db is None:
        raise click.UsageError("no DB given; give the study's database, or --case, or --record")
    return db


def _radians(degrees: float | None) -> float | None:
    return None if degrees is None else math.radians(degrees)


def _note(text: str) -> None:
    echo(text, err=True)


def _one(job: "Job") -> None:
    from pareto_monoped.cad.batch import run
    from pareto_monoped.definition.study import NO_STRENGTH

    record = run(job, progress=lambda step: _note(f"{step} ..."), note=note)
    _note(f"wrote {job.folder} ({len(record['files'])} files)")
    if not job.strength:
        note(NO_STRENGTH)
    for name in ("searched", "as_built"):
        jump = record["jumps"][name]
        height, energy = jump["height_m"], jump["energy_j"]
        result = f"{height:.4f} m  {energy:.3f} J" if height is not None and energy is not None else jump["status"]
        echo(f"{name.replace('_', ' '):<9} {result}")


def _many(jobs: "list[Job]", workers: int, place: options.Where) -> None:
    from rich.progress import BarColumn, MofNCompleteColumn, TextColumn, TimeElapsedColumn
    from rich.progress import Progress as Bar

    from pareto_monoped.cad.batch import run_all
    from pareto_monoped.compute.crew import EXPORT_LIMITS

    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn())
    with Bar(*columns, console=new_console(stderr=True)) as bar:
        task = bar.add_task("exporting", total=len(jobs))

        def show(progress: "Progress") -> None:
            # Each line stands for itself, as the bar is drawn on terminals only.
            bar.update(task, completed=len(jobs) - progress.total + progress.made)
            left = f", {_duration(progress.left_s)} left" if progress.made < progress.total else ""
            bar.console.print(
                f"wrote {progress.job.folder} ({progress.made} of {progress.total}{left})", soft_wrap=True
            )

        try:
            with options.executor_at(place, limits=EXPORT_LIMITS, extra="cad") as executor:
                made = run_all(jobs, workers=workers, executor=executor, progress=show)
        except KeyboardInterrupt:
            bar.console.print("interrupted; the same command continues from here")
            raise
        bar.update(task, completed=len(jobs))
    echo(f"{made} made, {len(jobs) - made} already there")


def _duration(seconds: float) -> str:
    """Return a time to wait, in words: ``50 s``, ``12 min`` or ``3 h 05 min``."""
    if seconds < 99.5:
        return f"{seconds:.0f} s"
    minutes = round(seconds / 60.0)
    return f"{minutes} min" if minutes < 100 else f"{minutes // 60} h {minutes % 60:02d} min"
