"""Commands that run studies: ``run``, ``resume`` and ``status``."""

import json
import textwrap
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import asdict, fields
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import click

from pareto_monoped.cli import options
from pareto_monoped.cli.options import DATABASE, Local, executor_at, where, where_options, workers_option
from pareto_monoped.cli.terminal import echo, name, new_console, note, wrapped
from pareto_monoped.design import HEADLINE_HEIGHT_M
from pareto_monoped.errors import InputError, complaint
from pareto_monoped.storage.place import StudyPlace

if TYPE_CHECKING:
    from pareto_monoped.pareto.growth import SecondSearch
    from pareto_monoped.study.run import RunSummary
    from pareto_monoped.study.session import Progress

_evaluations = click.option(
    "--evaluations", type=click.IntRange(min=1), metavar="N", help="Total number of jumps, instead of the study's."
)
_as_json = click.option(
    "--json", "as_json", is_flag=True, help="Print JSON: a line per stored generation, and one at the end."
)
_SECONDS_BETWEEN_LINES = 5.0
_AT_HEIGHT = f"{HEADLINE_HEIGHT_M:g} m"
_REASONS = {
    "budget": "the budget is used up",
    "wall_time": "the wall time is used up",
    "plateau": "the hypervolume has stopped growing",
    "exhausted": "the algorithm has no more designs",
    "interrupted": "interrupted; continue it with 'resume'",
}


class _Seed(click.IntRange):
    """A seed; or "next", which is True."""

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """Return the number, or True; a file may have taken its place."""
        if value == "next":
            return True
        if isinstance(value, str) and value.endswith(".toml"):
            raise InputError(complaint("--second-seed", value, "a number or nothing", "put it after STUDY.toml"))
        return super().convert(value, param, ctx)


@click.command()
@click.argument("study_file", metavar="STUDY.toml", type=Local())
@_evaluations
@click.option("--seed", type=click.IntRange(0, 2**63 - 1), metavar="N", help="Random seed, instead of the study's.")
@click.option(
    "--second-seed",
    type=_Seed(0, 2**63 - 1),
    is_flag=False,
    flag_value="next",
    metavar="[N]",
    help="Search again with this seed, or the next one, and compare.",
)
@workers_option
@where_options
@click.option("--db", type=DATABASE, metavar="DB", help="Database.  [default: STUDY.db beside STUDY.toml]")
@click.option(
    "--objectives",
    metavar="A,B",
    shell_complete=options.measures,
    help="Two or three measures, instead of the study's; needs a --db of its own.",
)
@click.option("--no-strength", is_flag=True, help="Do not ask whether parts hold; needs a --db of its own.")
@click.option("--opened", is_flag=True, help="Free more variables than the study does; needs a --db of its own.")
@_as_json
def run(
    study_file: Path,
    evaluations: int | None,
    seed: int | None,
    second_seed: int | Literal[True] | None,
    workers: int | None,
    processes: int | None,
    scheduler: str | None,
    db: StudyPlace | None,
    objectives: str | None,
    no_strength: bool,
    opened: bool,
    as_json: bool,
) -> int:
    """Run a study, or continue it where it stopped.

    Every evaluated design is stored; the study can be stopped and run again at any time.
    """
    from pareto_monoped.definition.goals import names_of
    from pareto_monoped.definition.study import load_study
    from pareto_monoped.study.run import run as run_study
    from pareto_monoped.study.run import run_second, seed_of_second

    study = load_study(
        study_file,
        objectives=None if objectives is None else names_of(objectives),
        seed=seed,
        strength=False if no_strength else None,
        opened=opened,
    )
    second = None if second_seed is None else seed_of_second(study.seed, second_seed)
    target = db or study_file.with_suffix(".db")
    place = where(processes, scheduler, workers)
    with executor_at(place) as executor:
        given: dict[str, Any] = {"workers": workers, "executor": executor, "notify": _said}
        with progress_reports(as_json) as progress:
            summary = run_study(study, target, evaluations=evaluations, progress=progress, **given)
        code = _finish(summary, as_json)
        if second is None or code:
            return code
        with progress_reports(as_json) as progress:
            again, found = run_second(summary, study, second, progress=progress, **given)
    code = _finish(again, as_json)
    if found is not None:
        _print_second(found, (study.seed, second), as_json)
    return code


def _print_second(found: "SecondSearch", seeds: tuple[int, int], as_json: bool) -> None:
    """Print how far a second search agrees: a table, and what follows from it."""
    if as_json:
        echo(json.dumps({"event": "second_search", "seeds": seeds} | asdict(found) | {"text": found.text()}))
        return
    from rich import box
    from rich.table import Column, Table

    titles = (*(f"seed {seed}" for seed in seeds), "difference")
    columns = (Column(title, justify="right", min_width=10) for title in titles)
    table = Table("", *columns, box=box.SIMPLE_HEAD, pad_edge=False)
    rows = zip(found.heights_m, found.energies_j, found.differences, strict=True)
    for height, energies, difference in rows:
        cells = [f"{energy:.2f} J" for energy in energies]
        table.add_row(
            f"least energy for {height:.2f} m or more", *cells, f"{round(100.0 * difference, 1) + 0.0:+.1f} %"
        )
    table.add_row("share of the joined hypervolume alone", *(f"{100.0 * share:.1f} %" for share in found.alone), "")
    new_console(width=80).print(table)
    echo(wrapped(found.text(), indent=0))


@click.command()
@click.argument("db", type=DATABASE)
@_evaluations
@workers_option
@where_options
@_as_json
def resume(
    db: StudyPlace,
    evaluations: int | None,
    workers: int | None,
    processes: int | None,
    scheduler: str | None,
    as_json: bool,
) -> int:
    """Continue a study from its database alone."""
    from pareto_monoped.study.run import resume as resume_study

    place = where(processes, scheduler, workers)
    with executor_at(place) as executor, progress_reports(as_json) as progress:
        summary = resume_study(
            db, evaluations=evaluations, workers=workers, executor=executor, progress=progress, notify=_said
        )
    return _finish(summary, as_json)


@click.command()
@click.argument("db", type=DATABASE)
@click.option("--json", "as_json", is_flag=True, help="Print everything as JSON.")
def status(db: StudyPlace, as_json: bool) -> None:
    """Show a study's progress, hypervolume, speed and settings."""
    from pareto_monoped.definition.study import NO_STRENGTH
    from pareto_monoped.pareto.growth import AHEAD
    from pareto_monoped.storage.kept_front import foreign_note
    from pareto_monoped.storage.seals import UNSEALED
    from pareto_monoped.storage.status import status as study_status

    facts = study_status(db)
    if as_json:
        echo(json.dumps(facts, indent=2))
        return
    rate, left = facts["evaluations_per_second"], facts["left_to_gain"]
    lines = {
        "study": name(facts["name"]),
        "state": _state(facts),
        "motor, calibration": name(f"{facts['motor']}, {facts['calibration']}"),
        **({"gearbox rules": rules} if (rules := facts["settings"].get("rules")) else {}),
        "algorithm, seed": f"{facts['algorithm']}, {facts['seed']}",
        "free variables": f"{len(facts['free'])} of {len(facts['settings']['variables'])}",
        "strength": "every joint has its required factor" if facts["strength"] else NO_STRENGTH,
        "least height": f"{facts['settings']['constraints']['min_height_m']:g} m",
        **_other_limits(facts),
        "evaluations": f"{facts['evaluations']} of {facts['budget']}",
        "feasible": f"{facts['feasible']} ({facts['infeasible']} infeasible, {facts['failed']} failed)",
        "front": f"{facts['front']} designs ({facts['ill_conditioned']} ill-conditioned left out)",
        **({"foreign": foreign_note(facts["foreign"])} if facts["foreign"] else {}),
        "objectives": ", ".join(facts["objectives"]),
        "hypervolume": f"{facts['hypervolume']:.4f} {facts['hypervolume_unit']} from ({_corner(facts)})",
        **({} if left is None else {"left to gain": f"{left:.1%} with {AHEAD} times as many evaluations (estimated)"}),
        **_at_height(facts),
        "time": f"{facts['wall_time_s']:.1f} s" + (f", {rate:.0f} designs/s" if rate else ""),
        "settings hash": facts["hash"][:16],
        "content hash": facts["content_hash"][:32],
    }
    for label, value in lines.items():
        echo(f"{label:<22} {value}")
    if not facts["sealed"]:
        note(UNSEALED)


def _state(facts: dict[str, Any]) -> str:
    state: str = facts["state"]
    if state == "finished" and facts["stop_reason"]:
        state += f" ({_REASONS[facts['stop_reason']]})"
    if facts["process"]:
        state += f" (process {facts['process']})"
    return state


def _other_limits(facts: dict[str, Any]) -> dict[str, str]:
    """Return the line on the limits besides the least height; none if there are no others."""
    from pareto_monoped.strength.groups import REQUIRED_MEASURES

    limits: dict[str, float | None] = facts["settings"]["constraints"]
    told = {"min_height_m": None, **(dict.fromkeys((f"min_{measure}" for measure in REQUIRED_MEASURES), 1.0))}
    shown = [
        f"{key} {value:g}"
        for key, value in limits.items()
        if value is not None and not (key in told and told[key] in (None, value))
    ]
    wrapped = textwrap.wrap(", ".join(shown), width=57)
    return {"other limits": ("\n" + " " * 23).join(wrapped)} if shown else {}


def _corner(facts: dict[str, Any]) -> str:
    from pareto_monoped.pareto.objectives import Objectives, ReferencePoint

    values: dict[str, float] = facts["reference_point"]
    return ReferencePoint(objectives=Objectives(names=tuple(values)), values=tuple(values.values())).text()


def _at_height(facts: dict[str, Any]) -> dict[str, str]:
    """Return the line on the best design at the headline height; none for objectives without a height."""
    from pareto_monoped.measures import measure

    lines = {}
    for key, value in (facts["best_at_0_8_m"] or {}).items():
        entry = measure(key)
        word = "most" if entry.direction == "maximise" else "least"
        lines[f"{word} {entry.short} at {_AT_HEIGHT}"] = "not reached" if value is None else entry.text(value)
    return lines


def _said(text: str) -> None:
    """Print what a run has to say besides its progress."""
    echo(wrapped(text), err=True)


def _finish(summary: "RunSummary", as_json: bool) -> int:
    """Say how a run ended; returns the exit code."""
    code = 130 if summary.stop_reason == "interrupted" else 0
    from pareto_monoped.analysis.remarks import remarks
    from pareto_monoped.definition.study import NO_STRENGTH
    from pareto_monoped.pareto.growth import AHEAD, left_to_gain

    found = remarks(summary.data)
    if as_json:
        facts = {one.name: getattr(summary, one.name) for one in fields(summary) if one.name != "data"}
        echo(json.dumps({"event": "end"} | facts | {"db": str(summary.db), "remarks": found}))
        return code
    echo(
        f"{summary.db}: {summary.evaluations} evaluations ({summary.new_evaluations} new, {summary.seconds:.1f} s), "
        f"{_REASONS[summary.stop_reason]}",
        err=True,
    )
    echo(
        f"front: {summary.front_size} designs, hypervolume {summary.hypervolume:.4f} {summary.hypervolume_unit}"
        + (f", {summary.ill_conditioned} ill-conditioned left out" if summary.ill_conditioned else "")
    )
    left = left_to_gain(*summary.data.history[["evaluations", "hypervolume"]].to_numpy().T)
    if left is not None and summary.front_size:
        note(f"{AHEAD} times as many evaluations would gain about {left:.1%} of this hypervolume")
    strength = () if summary.strength else (NO_STRENGTH,)
    # Without a front, the first remark says why there is none.
    said = (*strength, *found) if summary.front_size else (*found, *strength)
    for line in said:
        note(line)
    return code


@contextmanager
def progress_reports(as_json: bool = False) -> "Iterator[Callable[[Progress], None]]":
    """Return a callback that shows progress: a bar on a terminal, else a line on stderr every few seconds.

    As JSON it is a line on stdout for every stored generation.
    """
    import sys

    if as_json:
        yield _json_report
    elif sys.stderr is not None and sys.stderr.isatty():
        from pareto_monoped.api.running import bar

        with bar(new_console(stderr=True)) as show:
            yield show
    else:
        yield _line_reports()


def _json_report(progress: "Progress") -> None:
    echo(
        json.dumps(
            {
                "event": "generation",
                "evaluations": progress.evaluations,
                "budget": progress.budget,
                "per_second": round(progress.per_second, 1),
                "seconds_left": round(progress.seconds_left, 1),
                "hypervolume": progress.hypervolume,
            }
        )
    )


def _line_reports() -> "Callable[[Progress], None]":
    import time

    last = time.monotonic()

    def show(progress: "Progress") -> None:
        nonlocal last
        if time.monotonic() - last >= _SECONDS_BETWEEN_LINES:
            last = time.monotonic()
            echo(progress.text(), err=True)

    return show
