"""Commands that read a front: ``front`` and ``pick``; also the options that select one design, shared by ``export``."""

import functools
import json
import math
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from pareto_monoped.design import VARIABLES, in_use

if TYPE_CHECKING:
    from pandas import DataFrame

    from pareto_monoped.pareto.pick import Selector


def shown_columns(trials: "DataFrame") -> list[str]:
    """The columns of each design in the output of ``front`` and ``pick``."""
    return ["trial", "height_m", "energy_j", *(variable.name for variable in in_use(trials))]


def selector_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """Add the options that select one design; ``command`` receives them as the keyword ``selector``.

    More than one of them is a usage error. Without any, ``selector`` is None, which ``required`` refuses.
    """

    @click.option("--min-height", type=float, metavar="M", help="Least energy for a jump of at least M metres.")
    @click.option("--max-energy", type=float, metavar="J", help="Highest jump for at most J joules.")
    @click.option("--knee", is_flag=True, help="The design where the front bends most.")
    @click.option("--weights", metavar="WH,WE", help="Best weighted sum of scaled height and energy.")
    @click.option("--trial", type=click.IntRange(min=0), metavar="N", help="The trial with this number.")
    @functools.wraps(command)
    def wrapper(
        *arguments: Any,
        min_height: float | None,
        max_energy: float | None,
        knee: bool,
        weights: str | None,
        trial: int | None,
        **others: Any,
    ) -> Any:
        return command(*arguments, selector=_selector(min_height, max_energy, knee, weights, trial), **others)

    return wrapper


def _selector(
    min_height: float | None, max_energy: float | None, knee: bool, weights: str | None, trial: int | None
) -> "Selector | None":
    from pareto_monoped.pareto.pick import Knee, MaxEnergy, MinHeight, Trial, Weights

    chosen: list[Selector] = []
    if min_height is not None:
        chosen.append(MinHeight(height_m=_finite("--min-height", min_height)))
    if max_energy is not None:
        chosen.append(MaxEnergy(energy_j=_finite("--max-energy", max_energy)))
    if knee:
        chosen.append(Knee())
    if weights is not None:
        height, energy = _pair(weights)
        chosen.append(Weights(height=height, energy=energy))
    if trial is not None:
        chosen.append(Trial(number=trial))
    if len(chosen) > 1:
        raise click.UsageError(
            f"{len(chosen)} selectors given: must be one of --min-height, --max-energy, --knee, --weights, --trial; "
            "drop the others"
        )
    return chosen[0] if chosen else None


def required(selector: "Selector | None") -> "Selector":
    """The selector; without one, a usage error that names the options."""
    if selector is None:
        raise click.UsageError(
            "no selector given: must be one of --min-height M, --max-energy J, --knee, --weights WH,WE, --trial N; "
            "add one"
        )
    return selector


def _finite(option: str, value: float) -> float:
    if not math.isfinite(value):
        raise click.UsageError(f"{option} = {value}: must be a finite number; correct it")
    return value


def _pair(text: str) -> tuple[float, float]:
    try:
        height, energy = (float(part) for part in text.split(","))
    except ValueError:
        raise click.UsageError(f"--weights = {text!r}: must be two numbers WH,WE; give for example 1,1") from None
    return height, energy


@click.command()
@click.argument("db", type=click.Path(path_type=Path))
@click.option("--json", "as_json", is_flag=True, help="Print the designs as JSON.")
@click.option(
    "--csv", "csv_file", type=click.Path(path_type=Path), metavar="FILE", help="Write the designs to a CSV file."
)
@click.option("--all", "include_all", is_flag=True, help="Include designs that failed their audit.")
def front(db: Path, as_json: bool, csv_file: Path | None, include_all: bool) -> None:
    """List the non-dominated designs, from the lowest jump to the highest."""
    from pareto_monoped.study.reader import read_study

    data = read_study(db)
    rows = data.front(include_ill_conditioned=include_all)[shown_columns(data.trials)]
    if csv_file is not None:
        from pareto_monoped.files import write_text

        write_text(csv_file, rows.to_csv(index=False, lineterminator="\n"))
        click.echo(f"wrote {csv_file} ({len(rows)} designs)", err=True)
    if as_json:
        click.echo(json.dumps(rows.to_dict(orient="records"), indent=2))
    elif csv_file is None:
        _print_table(rows)


def _print_table(rows: "DataFrame") -> None:
    shown = [variable for variable in VARIABLES if variable.name in rows.columns]
    symbols = " ".join(f"{variable.symbol:>7}" for variable in shown)
    click.echo(f"{'trial':>6} {'height m':>8} {'energy J':>8} {symbols}")
    for _, row in rows.iterrows():
        values = " ".join(f"{row[name]:7.3f}" for name in (variable.name for variable in shown))
        click.echo(f"{int(row['trial']):6d} {row['height_m']:8.4f} {row['energy_j']:8.3f} {values}")


@click.command()
@click.argument("db", type=click.Path(path_type=Path))
@selector_options
@click.option("--json", "as_json", is_flag=True, help="Print the design as JSON.")
def pick(db: Path, selector: "Selector | None", as_json: bool) -> None:
    """Pick one design from the front and say why it was chosen."""
    from pareto_monoped.pareto.pick import pick as pick_design
    from pareto_monoped.study.reader import read_study

    wanted = required(selector)
    data = read_study(db)
    rows, names = data.front(), shown_columns(data.trials)
    picked = pick_design(rows, wanted)
    row = rows.loc[rows["trial"] == picked.trial, names].to_dict(orient="records")[0]
    if as_json:
        click.echo(json.dumps(row | {"why": picked.why}, indent=2))
        return
    click.echo(picked.why)
    for name in names[1:]:
        click.echo(f"{name:<34} {row[name]:.6g}")
