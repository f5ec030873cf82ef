"""Commands that read a front: ``front`` and ``pick``; also the options that select one design, shared by ``export``."""

import functools
import inspect
import json
import math
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from pareto_monoped.design import VARIABLES, Variable, in_use

if TYPE_CHECKING:
    from pandas import DataFrame

    from pareto_monoped.measures import Measure
    from pareto_monoped.pareto.objectives import Objectives
    from pareto_monoped.pareto.pick import Selector
    from pareto_monoped.study.definition import Study
    from pareto_monoped.study.reader import StudyData


def shown_columns(study: "Study", used: "Sequence[Variable]", objectives: "Objectives") -> list[str]:
    """The columns of each design in the output of ``front`` and ``pick``: objectives, variables in use, choices."""
    variables = [variable.name for variable in used]
    return ["trial", *objectives.names, *variables, *(["motor"] if len(study.motors) > 1 else [])]


def selector_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """Add the options that select one design; ``command`` receives them as the keyword ``selector``.

    More than one of them is a usage error. Without any, ``selector`` is None, which ``required`` refuses.
    """

    @click.option("--min-height", type=float, metavar="M", help="Least energy for a jump of at least M metres.")
    @click.option("--max-energy", type=float, metavar="J", help="Highest jump for at most J joules.")
    @click.option("--limit", metavar="MEASURE=X", help="Best design with a measure at X, in SI units, or better.")
    @click.option("--knee", is_flag=True, help="The design where the front bends most.")
    @click.option("--weights", metavar="WH,WE", help="Best weighted sum of the scaled objectives.")
    @click.option("--trial", type=click.IntRange(min=0), metavar="N", help="The trial with this number.")
    @functools.wraps(command)
    def wrapper(*arguments: Any, **given: Any) -> Any:
        selector = _selector(**{name: given.pop(name) for name in inspect.signature(_selector).parameters})
        return command(*arguments, selector=selector, **given)

    return wrapper


def _selector(
    min_height: float | None,
    max_energy: float | None,
    limit: str | None,
    knee: bool,
    weights: str | None,
    trial: int | None,
) -> "Selector | None":
    from pareto_monoped.pareto.pick import Knee, MaxEnergy, MinHeight, Trial, Weights, Within

    chosen: list[Selector] = []
    if min_height is not None:
        chosen.append(MinHeight(height_m=_finite("--min-height", min_height)))
    if max_energy is not None:
        chosen.append(MaxEnergy(energy_j=_finite("--max-energy", max_energy)))
    if limit is not None:
        name, value = _limit(limit)
        chosen.append(Within(measure=name, value=value))
    if knee:
        chosen.append(Knee())
    if weights is not None:
        chosen.append(Weights(values=_weights(weights)))
    if trial is not None:
        chosen.append(Trial(number=trial))
    if len(chosen) > 1:
        raise click.UsageError(
            f"{len(chosen)} selectors given: must be one of --min-height, --max-energy, --limit, --knee, --weights, "
            "--trial; drop the others"
        )
    return chosen[0] if chosen else None


def required(selector: "Selector | None") -> "Selector":
    """The selector; without one, a usage error that names the options."""
    if selector is None:
        raise click.UsageError(
            "no selector given: must be one of --min-height M, --max-energy J, --limit MEASURE=X, --knee, --weights "
            "WH,WE, --trial N; add one"
        )
    return selector


def _finite(option: str, value: float) -> float:
    if not math.isfinite(value):
        raise click.UsageError(f"{option} = {value}: must be a finite number; correct it")
    return value


def _weights(text: str) -> tuple[float, ...]:
    try:
        values = tuple(float(part) for part in text.split(","))
    except ValueError:
        values = ()
    if len(values) not in (2, 3):
        raise click.UsageError(
            f"--weights = {text!r}: must be two numbers WH,WE, or three for three objectives; give for example 1,1"
        )
    return values


def _limit(text: str) -> tuple[str, float]:
    from pareto_monoped.measures import MEASURES

    known = [entry.name for entry in MEASURES if entry.direction is not None]
    name, _, value = text.partition("=")
    if name not in known:
        raise click.UsageError(f"--limit = {text!r}: must begin with a measure and =, one of {', '.join(known)}")
    try:
        return name, _finite("--limit", float(value))
    except ValueError:
        raise click.UsageError(f"--limit = {text!r}: must end with a number; give for example {name}=1.0") from None


@click.command()
@click.argument("db", type=click.Path(path_type=Path))
@click.option("--json", "as_json", is_flag=True, help="Print the designs as JSON.")
@click.option(
    "--csv", "csv_file", type=click.Path(path_type=Path), metavar="FILE", help="Write the designs to a CSV file."
)
@click.option("--all", "include_all", is_flag=True, help="Include designs that failed their audit.")
@click.option("--objectives", metavar="A,B", help="Two or three measures to judge by, instead of the study's.")
def front(db: Path, as_json: bool, csv_file: Path | None, include_all: bool, objectives: str | None) -> None:
    """List the non-dominated designs by their first objective, from the least value to the greatest.

    Under other objectives than its own, a study's front is what its trials happen to hold: they were not searched for,
    and the audit has not seen all of them.
    """
    from pareto_monoped.study.reader import read_front, read_study

    if objectives is None and not include_all:
        kept = read_front(db)
        study, rows, used, sealed, chosen = kept.study, kept.rows, kept.used, kept.sealed, kept.study.objectives
    else:
        data = read_study(db)
        study, used, sealed = data.study, in_use(data.trials), data.sealed
        chosen = _objectives(objectives, data)
        rows = data.front(include_ill_conditioned=include_all, objectives=chosen)
        if chosen != study.objectives:
            unaudited = int((~rows["trial"].isin(data.audits["trial"])).sum())
            click.echo(f"note: designs without an audit: {unaudited} of {len(rows)}", err=True)
    say_of_study(study, sealed=sealed)
    rows = rows[shown_columns(study, used, chosen)]
    if csv_file is not None:
        from pareto_monoped.files import write_text

        write_text(csv_file, rows.to_csv(index=False, lineterminator="\n"))
        click.echo(f"wrote {csv_file} ({len(rows)} designs)", err=True)
    if as_json:
        click.echo(json.dumps(rows.to_dict(orient="records"), indent=2))
    elif csv_file is None:
        _print_table(rows, chosen)


def say_of_study(study: "Study", *, sealed: bool) -> None:
    """Say that designs may not hold, where a study did not ask for it, and that it has no running hash."""
    from pareto_monoped.study.definition import NO_STRENGTH
    from pareto_monoped.study.seals import UNSEALED

    if not sealed:
        click.echo(f"note: {UNSEALED}", err=True)
    if not study.strength:
        click.echo(f"note: {NO_STRENGTH}", err=True)


def _objectives(given: str | None, data: "StudyData") -> "Objectives":
    """The objectives that an option names, or the study's own."""
    from pareto_monoped.errors import SelectionError
    from pareto_monoped.study.goals import names_of, objectives_of

    if given is None:
        return data.study.objectives
    chosen = objectives_of(names_of(given), source="--objectives")
    for name in chosen.names:
        if len(data.trials) and data.trials[name].isna().all():
            raise SelectionError(f"--objectives: no trial of {str(data.db)!r} has a value of {name}; choose another")
    return chosen


_TABLE_WIDTH = 80


def _decimals(entry: "Measure") -> int:
    """Decimals in the stored unit: one more than reports show."""
    return entry.decimals + 1 + round(math.log10(entry.scale))


def _print_table(rows: "DataFrame", objectives: "Objectives") -> None:
    shown = [variable for variable in VARIABLES if variable.name in rows.columns]
    heads = [f"{entry.short} {entry.unit}".removesuffix(" 1") for entry in objectives.measures]
    widths = [max(len(head), 8) for head in heads]
    # The motors' names stand last, in a column as wide as the longest.
    motors = ["motor", *rows["motor"]] if "motor" in rows.columns else []
    last = 1 + max(map(len, motors)) if motors else 0
    wide = 6 + sum(widths) + len(widths) + 8 * len(shown) + last <= _TABLE_WIDTH
    # With a third objective the usual columns do not fit; three digits of each variable then must do.
    number = (lambda value: f"{value:7.3f}") if wide else (lambda value: f"{round(value, 3):5.3g}")
    symbols = " ".join(f"{variable.symbol:>{7 if wide else 5}}" for variable in shown)
    words = " ".join(f"{head:>{width}}" for head, width in zip(heads, widths, strict=True))
    click.echo(f"{'trial':>6} {words} {symbols}" + (" motor" if motors else ""))
    for _, row in rows.iterrows():
        values = " ".join(number(row[variable.name]) for variable in shown)
        goals = " ".join(
            f"{row[entry.name]:{width}.{_decimals(entry)}f}"
            for entry, width in zip(objectives.measures, widths, strict=True)
        )
        motor = f" {row['motor']}" if motors else ""
        click.echo(f"{int(row['trial']):6d} {goals} {values}{motor}")


@click.command()
@click.argument("db", type=click.Path(path_type=Path))
@selector_options
@click.option("--json", "as_json", is_flag=True, help="Print the design as JSON.")
def pick(db: Path, selector: "Selector | None", as_json: bool) -> None:
    """Pick one design from the front and say why it was chosen."""
    from pareto_monoped.pareto.pick import pick as pick_design
    from pareto_monoped.study.reader import read_front

    wanted = required(selector)
    data = read_front(db)
    rows, names = data.rows, shown_columns(data.study, data.used, data.study.objectives)
    picked = pick_design(rows, wanted, data.study.objectives)
    say_of_study(data.study, sealed=data.sealed)
    row = rows.loc[rows["trial"] == picked.trial, names].to_dict(orient="records")[0]
    if as_json:
        click.echo(json.dumps(row | {"why": picked.why}, indent=2))
        return
    click.echo(picked.why)
    for name in names[1:]:
        click.echo(f"{name:<34} {row[name]}" if name == "motor" else f"{name:<34} {row[name]:.6g}")
