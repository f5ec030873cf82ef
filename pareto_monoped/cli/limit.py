"""Command ``limit``: what the hardware of designs can do with the best torque found."""

import json
import time
from typing import TYPE_CHECKING

import click

from pareto_monoped.cli import options
from pareto_monoped.cli.selection import condition_options
from pareto_monoped.cli.terminal import echo, note, wrapped
from pareto_monoped.storage.place import StudyPlace

if TYPE_CHECKING:
    from pareto_monoped.analysis.limit import Limit, Reached
    from pareto_monoped.pareto.selectors import Condition, MaxEnergy

_DESIGNS, _JUMPS = 12, 3000  # as ``analysis.limit`` has them; a help text imports no simulator


@click.command()
@click.argument("db", type=options.DATABASE)
@click.option(
    "--trial",
    "trials",
    type=click.IntRange(min=0),
    multiple=True,
    metavar="N",
    shell_complete=options.trials,
    help="A trial, instead of the front.",
)
@condition_options
@click.option(
    "--designs",
    type=click.IntRange(min=1),
    default=_DESIGNS,
    show_default=True,
    metavar="N",
    help="At most N of the front, evenly spread.",
)
@click.option(
    "--jumps",
    type=click.IntRange(20, 1_000_000),
    default=_JUMPS,
    show_default=True,
    metavar="N",
    help="Of each of a design's four searches.",
)
@click.option(
    "--seed", type=click.IntRange(min=0), default=1, show_default=True, metavar="N", help="Of the random numbers."
)
@options.workers_option
@click.option("--json", "as_json", is_flag=True, help="Print everything as JSON, with the torques found.")
def limit(
    db: StudyPlace,
    trials: tuple[int, ...],
    conditions: "tuple[Condition | MaxEnergy, ...]",
    designs: int,
    jumps: int,
    seed: int,
    workers: int | None,
    as_json: bool,
) -> None:
    """Find what the best torque could do.

    For designs of the front: the least energy at a design's height, and the greatest height, of motor torques free over
    time within the motors' limits; with and without overloading parts. What is found is reached by a jump; less energy
    than the floor needs no controller can do.
    """
    from pareto_monoped.analysis.choices import settled_front
    from pareto_monoped.analysis.limit import chosen, limits
    from pareto_monoped.storage.reader import read_study

    if trials and conditions:
        raise click.UsageError("conditions make the front, and --trial names trials; drop one")
    data = read_study(db)
    front = settled_front(db, conditions, notify=note) if conditions else data.front()
    rows = chosen(data, front, trials, designs)
    if not trials and len(rows) < len(front):
        note(f"{len(rows)} of the front's {len(front)} designs, evenly spread; --designs N takes more")
    found: list[Limit] = []
    started = time.monotonic()
    for one in limits(data, rows, jumps=jumps, seed=seed, workers=workers):
        found.append(one)
        left = (time.monotonic() - started) / len(found) * (len(rows) - len(found))
        minutes, seconds = divmod(round(left), 60)
        echo(f"{len(found)}/{len(rows)} designs, {minutes}:{seconds:02d} left", err=True)
    if as_json:
        settings = {"jumps": jumps, "seed": seed}
        echo(json.dumps(settings | {"limits": [one.as_dict() for one in found]}, indent=2))
    else:
        _print(found)


def _print(found: "list[Limit]") -> None:
    """One row per design: its own jump, the floor, least energy, gap and greatest height, also if all parts hold."""
    echo(f"{'':6} {'as designed':>15} {'floor':>7} {'least energy, J':>26} {'greatest height, m':>19}")
    heads = f"{'height':>7} {'J':>7} {'J':>7} {'any':>7} {'gap %':>6} {'held':>6} {'gap %':>5} {'any':>9} {'held':>9}"
    echo(f"{'trial':>6} {heads}")
    for one in found:
        own = f"{one.height_m:7.3f} {one.energy_j:7.2f} {one.floor_j:7.2f}"
        gaps = f"{one.least.energy_j:7.2f} {one.controller_gap:6.1f} {_energy(one.least_held)} {_gap(one)}"
        echo(f"{one.trial:6d} {own} {gaps} {one.greatest.height_m:9.3f} {_height(one.greatest_held)}")
    echo(
        wrapped(
            f"energy: {found[0].energy}; gap: what the best torque found saves of it at the design's "
            "height; held: no part is overloaded; floor: what no controller can go below"
        )
    )


def _energy(reached: "Reached | None") -> str:
    return f"{'-':>6}" if reached is None else f"{reached.energy_j:6.2f}"


def _gap(one: "Limit") -> str:
    return f"{'-':>5}" if one.controller_gap_held is None else f"{one.controller_gap_held:5.1f}"


def _height(reached: "Reached | None") -> str:
    return f"{'-':>9}" if reached is None else f"{reached.height_m:9.3f}"
