"""Command ``pareto``, the main job, made of the other commands, and ``init``: a study file to start from."""

import contextlib
import io
import textwrap
import threading
import tomllib
import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from math import isnan
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from pareto_monoped.cli import options
from pareto_monoped.cli.options import DATABASE_FILE, Local
from pareto_monoped.cli.terminal import echo, new_console, note, wrapped
from pareto_monoped.compute.chunks import cores
from pareto_monoped.compute.processes import Processes, say

if TYPE_CHECKING:
    from pareto_monoped.analysis.choices import Choice
    from pareto_monoped.definition.study import Study
    from pareto_monoped.report.schema import Payload
    from pareto_monoped.storage.reader import StudyData

_OPENED_SHARE = 2
"""How many times as many jumps the study has as the opened one. Our own choice: half of the shipped study's
4,000 show what opening saves, 13 to 31 percent. More would show more: three seeds with 8,000 jumps found designs that
take 4 to 15 percent less than theirs with 2,000 somewhere on the front."""


@click.command()
@click.argument("study_file", metavar="[STUDY.toml]", required=False, type=Local())
@click.option("-o", "--output", metavar="DIR", type=Local(), help="Folder for the results.  [default: reports/STUDY]")
@click.option("--db", metavar="DB", type=DATABASE_FILE, help="Database.  [default: beside STUDY.toml]")
@click.option("--evaluations", type=click.IntRange(min=1), metavar="N", help="Number of jumps, instead of the study's.")
@click.option("--workers", type=click.IntRange(1, 1024), metavar="N", help="Number of threads.  [default: all cores]")
@click.option("--seed", type=click.IntRange(0, 2**63 - 1), metavar="N", help="Random seed, instead of the study's.")
@click.option("--no-strength", is_flag=True, help="Do not ask whether parts hold.")
def pareto(
    study_file: Path | None,
    output: Path | None,
    db: Path | None,
    evaluations: int | None,
    workers: int | None,
    seed: int | None,
    no_strength: bool,
) -> None:
    """Do the main job: gearboxes, fronts, CAD, report.

    The design that gets CAD is the knee of the first front, or the compromise of three objectives, of the designs that
    take less than 1.5 times the least battery energy stored for their height.

    The first front is that of the study. The second has the other energy in place of the study's: that at the battery
    for mechanical energy. The third, of fewer jumps, is the first with more variables free ('run --opened'). The
    studies run side by side, each with all threads, unless there is one. A study of other objectives has one front
    only, and one that leaves nothing to open has two. Without a STUDY.toml it is studies/case_c.toml, which is written
    if it is missing.

    It can be repeated safely: a finished study is not run again, and CAD and report are made again only if they are
    out of date.
    """
    from pareto_monoped.errors import require_extra

    # Before the search: minutes later would be too late to say so.
    require_extra("cad", "CAD")
    from pareto_monoped.analysis.choices import default_pick, settled
    from pareto_monoped.analysis.remarks import refuse_empty
    from pareto_monoped.cad.jobs import trial_job
    from pareto_monoped.cad.records import is_made
    from pareto_monoped.definition.study import NO_STRENGTH, load_study
    from pareto_monoped.storage.reader import read_study

    study_file = study_file or _first_study()
    study = load_study(study_file)
    folder = output or Path("reports") / study_file.stem
    db = db or study_file.with_suffix(".db")
    folder.mkdir(parents=True, exist_ok=True)
    table, report, cad = folder / "actuators.csv", folder / "report.html", folder / "cad"
    tables = {motor: table if motor == study.motor else _named(table, motor) for motor in study.motors}
    options = [f"--workers={workers}"] if workers else []
    options += [] if seed is None else [f"--seed={seed}"]
    options += ["--no-strength"] if no_strength else []
    runs = _searches(study_file, study, db, evaluations, options)
    dbs = list(runs)
    steps = _Steps(total=len(tables) + len(runs) + 2)

    for motor, path in tables.items():
        steps.do("actuators", "--motor", motor, "--csv", path)
    several_cores = (workers or cores()) > 1
    # No study needs another. Where there is a report, all are most likely finished.
    _search(list(runs.values()), steps, side_by_side=not report.exists() and several_cores)
    studies = [read_study(path) for path in dbs]
    refuse_empty(studies[0].front(), studies[0])

    def begins_with(data: "StudyData") -> int:
        return default_pick(data, [data, *studies[1:]]).trial

    # The pick may be behind the front, where no design was audited.
    first = settled(studies[0], lambda data: [begins_with(data)], notify=note)
    studies[0], chosen = first, begins_with(first)
    design = cad / f"trial_{chosen}"
    job = trial_job(studies[0], chosen, folder=design)
    exported = is_made(job)
    again = ["--force"] if (design / "design.json").exists() and not exported else []
    with contextlib.ExitStack() as stack:
        finish = None
        if not exported and several_cores:
            # The page's content but for this export takes as long as the export.
            content = stack.enter_context(_Ahead(_content, dbs))
            finish = partial(_finish_page, content, cad, studies, report)
        steps.do("export", db, "--trial", chosen, "-o", design, *again, made=lambda: exported)
        sources = (*dbs, design / "design.json")
        steps.do("report", *dbs, "-o", report, "--exports", cad, made=lambda: _newer(report, *sources), by=finish)

    echo("\nMade")
    several = len(studies) > 1
    made = [f"jumps {_by(data, studies)}; opens in Optuna" for data in studies]
    fronts = zip(dbs, made if several else ["every jump; resumable, opens in Optuna"], strict=True)
    for path, what in (
        *((path, f"the lightest actuator of every ratio{_of(motor, study.motors)}") for motor, path in tables.items()),
        *fronts,
        (design, "CAD and models of one design"),
        (report, "the fronts: open it in a browser" if several else "the front: open it in a browser"),
    ):
        echo(f"  {path!s:<32} {what}")
    _print_headline(studies[0], chosen)
    _print_choices(studies)
    _print_saved(studies)
    word = "motor" if len(study.motors) == 1 else "motors"
    echo(f"Simulated with {word} {study.motor_text}, calibration {study.calibration}.")
    if not studies[0].study.strength:
        echo(f"Note: {NO_STRENGTH}.")
    counts = ", ".join(f"{len(data.front())} {_by(data, studies)}" for data in studies)
    echo(wrapped(f"Designs on the front: {counts}.", indent=0))


def _first_study() -> Path:
    """Return the study of the main job where none is named; outside a checkout, one to begin with is written."""
    from pareto_monoped.definition.study_file import START

    path = Path("studies") / f"{START}.toml"
    if not path.exists():
        path.parent.mkdir(exist_ok=True)
        write_study(START, path)
    return path


def _named(table: Path, motor: str) -> Path:
    """Return the table of one of several motors, such as actuators_U8.csv for actuators.csv."""
    return table.with_name(f"{table.stem}_{Path(motor).stem if motor.endswith('.toml') else motor}{table.suffix}")


def _of(motor: str, motors: Sequence[str]) -> str:
    return f", {Path(motor).stem}" if len(motors) > 1 else ""


@dataclass(slots=True)
class _Steps:
    """The steps of the job, counted as they are done."""

    total: int
    done: int = 0

    def do(
        self,
        *command: object,
        made: Callable[[], bool] = lambda: False,
        by: Callable[[], int | None] | None = None,
    ) -> None:
        """Run one of our own commands as a user would. Show the command, but not what it prints to stdout.

        One that was begun ahead comes to its end ``by`` another call, which returns the exit code.
        """
        self.done += 1
        words = [str(word) for word in command]
        up_to_date = made()
        ending = "  (up to date)" if up_to_date else ""
        echo(f"[{self.done}/{self.total}] pareto-monoped {' '.join(words)}{ending}", err=True)
        if not up_to_date:
            code = by() if by else _code_of(words)
            if code:
                raise click.exceptions.Exit(code)


def _code_of(words: Sequence[str]) -> int | None:
    """Run a command without what it prints to stdout, and return its exit code, which may be None for 0."""
    from pareto_monoped.cli import cli

    with contextlib.redirect_stdout(io.StringIO()):
        code: int | None = cli.main(args=list(words), prog_name="pareto-monoped", standalone_mode=False)
    return code


class _Ahead:
    """A context in which a call is made in a process of its own; its messages wait until its result is asked for.

    The process ends with the context. Of a study that is cut short so, everything is stored but one generation.
    """

    def __init__(self, function: Callable[..., Any], *arguments: object) -> None:
        self._lock, self._waiting, self._heard = threading.Lock(), True, ""
        self._process = Processes(hear=self._hear)
        self._future = self._process.submit(_elsewhere, function, *arguments)

    def __enter__(self) -> "_Ahead":
        return self

    def __exit__(self, *problem: Any) -> None:
        self._process.__exit__(*problem)

    def result(self) -> Any:
        """Show what the call has said and what it says from now on; return its result or raise its error."""
        with self._lock:
            self._waiting = False
            echo(self._heard, err=True, nl=False)
        return self._future.result()

    def _hear(self, text: str) -> None:
        with self._lock:
            if self._waiting:
                self._heard += text
            else:
                echo(text, err=True, nl=False)


class _Told(io.StringIO):
    """A stream to the process that began this one."""

    def write(self, text: str) -> int:
        count = super().write(text)  # which refuses bytes
        say(text)
        return count


def _elsewhere(function: Callable[..., Any], *arguments: object) -> Any:
    warnings.simplefilter("ignore")  # they are for developers
    with contextlib.redirect_stderr(_Told()):
        return function(*arguments)


def _content(dbs: Sequence[Path]) -> "Payload":
    """Return the content of the job's page without exported designs."""
    from pareto_monoped.report.page import payload_of

    return payload_of(dbs, note=note)


def _finish_page(content: _Ahead, cad: Path, studies: "Sequence[StudyData]", report: Path) -> None:
    from pareto_monoped.cli.stored import write_page
    from pareto_monoped.report.page import with_exports

    write_page(with_exports(content.result(), cad, studies, note), report)


def _searches(
    study_file: Path, study: "Study", db: Path, evaluations: int | None, options: Sequence[object]
) -> dict[Path, tuple[object, ...]]:
    """Return what to run for each database: the study, by the other energy, with more variables free."""
    from pareto_monoped.analysis.choices import counterpart
    from pareto_monoped.definition.algorithms import WeightedSettings
    from pareto_monoped.definition.study import load_study
    from pareto_monoped.errors import StudyError

    def search(place: Path, *more: object, budget: int | None = evaluations) -> tuple[object, ...]:
        limit = () if budget is None else (f"--evaluations={budget}",)
        return ("run", study_file, *more, "--db", place, *limit, *options)

    found = {db: search(db)}
    other = counterpart(study.objectives)
    if other is None:
        note("one front only: others need height_m and energy_j, or height_m and electrical_energy_j, as objectives")
        return found
    word = "battery" if "electrical_energy_j" in other.names else "mechanical"
    second, third = (db.with_name(f"{db.stem}_{word}{db.suffix}") for word in (word, "opened"))
    found[second] = search(second, "--objectives", ",".join(other.names))
    try:
        load_study(study_file, opened=True)
    except StudyError as error:
        note(f"no third front: {error}")
        return found
    budget = evaluations or study.evaluations
    if not isinstance(study.algorithm, WeightedSettings):  # whose last weights come last
        budget = max(1, budget // _OPENED_SHARE)
    found[third] = search(third, "--opened", budget=budget)
    return found


def _search(runs: Sequence[tuple[object, ...]], steps: _Steps, *, side_by_side: bool) -> None:
    """Run the studies, all of them at the same time if they are to be ``side_by_side``."""
    with contextlib.ExitStack() as stack:
        others = [[str(word) for word in run] for run in runs[1:]]
        ahead = [stack.enter_context(_Ahead(_code_of, run)).result if side_by_side else None for run in others]
        for run, begun in zip(runs, (None, *ahead), strict=True):
            steps.do(*run, by=begun)


def _by(data: "StudyData", studies: "Sequence[StudyData]") -> str:
    """Return what tells a study of the job from the others: what it minimises, or that more variables are free."""
    from pareto_monoped.analysis.choices import WORDS
    from pareto_monoped.definition.study import is_opened

    if is_opened(data.study, studies[0].study):
        return "with more free"
    names = data.study.objectives.names
    return f"by {next((word for name, word in WORDS.items() if name in names), ', '.join(names))}"


def _newer(target: Path, *sources: Path) -> bool:
    return target.exists() and all(target.stat().st_mtime >= source.stat().st_mtime for source in sources)


def _print_headline(data: "StudyData", chosen_trial: int) -> None:
    from rich import box
    from rich.table import Table

    from pareto_monoped.analysis.choices import headline

    table = Table(box=box.SIMPLE_HEAD, title_justify="left", pad_edge=False)
    table.add_column("design")
    for title in ("height\n/ m", "energy\n/ J", "stands\n/ m", "rise\n/ m"):
        table.add_column(title, justify="right")
    for row in headline(data, chosen_trial):
        jump = (row.height_m, row.energy_j, row.height_m - row.above_standing_m, row.rise_m)
        table.add_row(row.label, *("-" if isnan(v) else f"{v:.{d}f}" for v, d in zip(jump, (3, 2, 3, 3), strict=True)))
    new_console(width=80).print(table)
    echo("stands: its base on a straight leg; rise: of its centre of mass from lift-off\n")


def _print_choices(studies: "list[StudyData]") -> None:
    """The closing table: what choosing by mechanical energy costs at the battery, height by height."""
    from pareto_monoped.analysis.choices import choices, two_fronts

    pair = two_fronts(studies)
    if pair is None:
        return
    side = f"{'mech. J':>8} {'batt. J':>8} {'hip':>6} {'knee':>6}"
    echo(f" {'least':6}{'chosen by mechanical energy':>31}  {'chosen by battery energy':>31} {'costs at':>8}")
    echo(f" {'height':6}{side}  {side} {'battery':>8}")
    echo(f" {'─' * 78}")
    rows = choices(*pair)
    for row in rows:
        cost = "-" if row.cost is None else f"{100.0 * row.cost:+.1f} %"
        echo(f" {row.height_m:.1f} m {_cells(row.mechanical)}  {_cells(row.battery)} {cost:>8}")
    if len(studies[0].study.kits) > 1:
        echo("\nMotors")
        for row in rows:
            chosen = "  ".join(f"{'not reached' if c is None else c.motor:>31}" for c in (row.mechanical, row.battery))
            echo(f" {row.height_m:.1f} m {chosen}")
    echo("\nhip, knee: gear ratios; costs: what choosing by mechanical energy adds there.")


def _print_saved(studies: "Sequence[StudyData]") -> None:
    """Print what more free variables save of the study's energy, and what the designs of either front take besides."""
    from pareto_monoped.analysis.choices import WORDS, saved
    from pareto_monoped.definition.study import is_opened, opened_words

    first, last = studies[0], studies[-1]
    if not is_opened(last.study, first.study):
        return
    own = first.study.objectives.other_than("height_m").name
    other = next(name for name in WORDS if name != own)
    echo(f"\n {'least':6}{f'least {WORDS[own]} / J':>33}{f'their {WORDS[other]} / J':>31}")
    echo(f" {'height':6}{'studied':>11} {'more free':>11} {'saved':>9} {'studied':>18} {'more free':>11}")
    echo(f" {'─' * 70}")
    for height, before, after in saved(first, last):
        least, besides = (
            [f"{'not reached' if one is None else format(getattr(one, name), '.2f'):>11}" for one in (before, after)]
            for name in (own, other)
        )
        share = "-"
        if before is not None and after is not None:
            share = f"{100.0 * (1.0 - getattr(after, own) / getattr(before, own)):.1f} %"
        echo(f" {height:.1f} m {' '.join(least)} {share:>9} {' '.join(besides):>30}")
    text = f"more free: {opened_words(last.study, first.study)}; {len(last.trials)} jumps."
    echo("\n" + wrapped(text, indent=0))


def _cells(choice: "Choice | None") -> str:
    if choice is None:
        return f"{'not reached':>31}"
    return f"{choice.energy_j:8.2f} {choice.electrical_energy_j:8.2f} {choice.hip_ratio:6.2f} {choice.knee_ratio:6.2f}"


@click.command()
@click.argument("name", metavar="[STUDY]", required=False, shell_complete=options.studies)
@click.option("-o", "--output", type=Local(), metavar="FILE.toml", help="The copy.  [default: STUDY.toml]")
@click.option("--list", "listed", is_flag=True, help="List the studies that there are.")
@click.option("--force", is_flag=True, help="Replace an existing study file.")
def init(name: str | None, output: Path | None, listed: bool, force: bool) -> None:
    """Copy a study file that comes with the program, to start from.

    Without a name it is case_c, the paper's best design with all seven variables free; wide shows every key.
    """
    from pareto_monoped.definition.study_file import START, shipped_studies, shipped_study

    if listed:
        for study in shipped_studies():
            line = f"{study:<16} {tomllib.loads(shipped_study(study)).get('description', '')}"
            echo(textwrap.fill(line, width=80, subsequent_indent=" " * 17))
        return
    chosen = name or START
    write_study(chosen, output or Path(f"{chosen}.toml"), force=force)


def write_study(name: str, path: Path, *, force: bool = False) -> None:
    """Write a shipped study to a file, and say what to do with it.

    A file that exists is refused: it may have changes of the user's.
    """
    from pareto_monoped.definition.study_file import shipped_study
    from pareto_monoped.errors import OutputError
    from pareto_monoped.files import write_text

    text = shipped_study(name)
    if path.exists() and not force:
        raise OutputError(f"study file {str(path)!r}: exists; give another -o, or --force to replace it")
    write_text(path, text, force=force)
    echo(f"wrote {path}; run it with: pareto-monoped run {path}", err=True)
