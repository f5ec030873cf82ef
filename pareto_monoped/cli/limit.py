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
    from pareto_monoped.pareto.selectors import Condition, MaxEnergy
    from pareto_monoped.storage.extra_rows import Limit, Perturbed, Reached

_DESIGNS, _JUMPS = 12, 3000  # as ``analysis.limit`` has them; a help text imports no simulator


@click.command()
@click.argument("db", type=options.DATABASE)
@options.trials_option
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
    than the floor needs no controller can do. A second table tells what robots as built make of it, and of a law that
    keeps to the leg's length and speed. The results are stored in DB, for 'pick' and 'report' as well; what is
    there is not searched again.
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
    started = time.monotonic()

    def progress(done: int, total: int) -> None:
        minutes, seconds = divmod(round((time.monotonic() - started) / done * (total - done)), 60)
        echo(f"{done}/{total} designs, {minutes}:{seconds:02d} left", err=True)

    found = limits(db, rows, jumps=jumps, seed=seed, workers=workers, progress=progress)
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
    if any(one.perturbed for one in found):
        _print_as_built(found)


def _print_as_built(found: "list[Limit]") -> None:
    """One row per design: heights of built robots by the virtual leg, the torque found, and the law ``tracking``."""
    echo(f"\n{'':6} {'virtual leg':>21} {'least over time':>21} {'tracking':>28}")
    each = f"{'5-95 %, m':>11} {'high':>4} {'hold':>4}"
    echo(f"{'trial':>6} {each} {each} {'J':>6} {each}")
    for one in found:
        tracking = one.tracking
        energy = f"{'-':>6}" if tracking is None else f"{tracking.energy_j:6.2f}"
        last = _as_built(None if tracking is None else tracking.perturbed)
        first = _as_built(one.over_time.perturbed)
        echo(f"{one.trial:6d} {_as_built(one.perturbed)} {first} {energy} {last}")
    echo(
        wrapped(
            "as built, with other motors, delay and masses: heights of nine robots of ten; high: percent of robots "
            "within 5 percent of the design's height; hold: percent that overload no part; tracking: torques over "
            "the leg's length and speed"
        )
    )


def _as_built(found: "Perturbed | None") -> str:
    if found is None:
        return f"{'-':>21}"
    return f"{found.p05_m:.3f}-{found.p95_m:.3f} {100.0 * found.reaches:4.0f} {100.0 * found.holds:4.0f}"


def _energy(reached: "Reached | None") -> str:
    return f"{'-':>6}" if reached is None else f"{reached.energy_j:6.2f}"


def _gap(one: "Limit") -> str:
    return f"{'-':>5}" if one.controller_gap_held is None else f"{one.controller_gap_held:5.1f}"


def _height(reached: "Reached | None") -> str:
    return f"{'-':>9}" if reached is None else f"{reached.height_m:9.3f}"
