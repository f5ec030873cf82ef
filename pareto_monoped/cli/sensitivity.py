"""``sensitivity``: which variable and which assumption moves a design's measures most."""

import json
from pathlib import Path
from typing import TYPE_CHECKING

import click

from pareto_monoped.cli.computing import executor_at, where, where_options
from pareto_monoped.cli.options import (
    DATABASE,
    HTML_FILE,
    force_option,
    sample_seed_option,
    uncertainty_option,
    workers_option,
)
from pareto_monoped.cli.robustness import asked
from pareto_monoped.cli.selection import required, selector_options
from pareto_monoped.cli.terminal import echo, wrapped
from pareto_monoped.study.place import StudyPlace

if TYPE_CHECKING:
    from pareto_monoped.measures import Measure
    from pareto_monoped.pareto.selectors import Selector
    from pareto_monoped.study.definition import Study
    from pareto_monoped.uncertainty.influences import FactorInfluence, Sensitivity

_DEFAULT_BLOCKS, _DEFAULT_WITHIN = 256, 2.0


@click.command()
@click.argument("db", type=DATABASE)
@selector_options
@click.option(
    "--samples",
    type=int,
    default=_DEFAULT_BLOCKS,
    metavar="N",
    help="Base samples; each takes a jump per factor, and two more.  [default: 256]",
)
@click.option(
    "--within",
    type=click.FloatRange(0.0, 50.0, min_open=True),
    default=_DEFAULT_WITHIN,
    metavar="PERCENT",
    help="How far variables move, of their ranges.  [default: 2]",
)
@sample_seed_option
@uncertainty_option
@workers_option
@where_options
@click.option("--plot", type=HTML_FILE, metavar="FILE.html", help="Write a chart that needs no network.")
@force_option
@click.option("--json", "as_json", is_flag=True, help="Print everything as JSON.")
def sensitivity(
    db: StudyPlace,
    selector: "Selector | None",
    samples: int,
    within: float,
    seed: int | None,
    uncertainty: Path | None,
    workers: int | None,
    processes: int | None,
    scheduler: str | None,
    plot: Path | None,
    force: bool,
    as_json: bool,
) -> None:
    """Say which variable and which assumption moves a design most.

    The free variables move a little around the design; then everything that is uncertain in a built robot moves
    within its range. Results are stored in DB; what is there is not simulated again.
    """
    from pareto_monoped.pareto.pick import pick as pick_design
    from pareto_monoped.pareto.selectors import Trial
    from pareto_monoped.study.front_reader import read_front
    from pareto_monoped.study.infeasible import refuse_empty
    from pareto_monoped.study.sensitivity import sensitivity as find

    place = where(processes, scheduler, workers)
    wanted, kept = required(selector), read_front(db)
    ranges, _, chosen_seed = asked(kept.study, uncertainty, None, seed)
    if isinstance(wanted, Trial):
        trial = wanted.number  # which need not be on the front
    else:
        refuse_empty(kept.rows, db)
        trial = pick_design(kept.rows, wanted, kept.study.objectives).trial
    with executor_at(place) as executor:
        found = find(
            db,
            trial,
            ranges,
            blocks=samples,
            within=0.01 * within,
            seed=chosen_seed,
            workers=workers,
            executor=executor,
        )
    if plot is not None:
        from pareto_monoped.files import write_text
        from pareto_monoped.report.sensitivity_figure import sensitivity_page

        write_text(plot, sensitivity_page(trial, found, _shown(kept.study)), force=force)
        echo(f"wrote {plot}", err=True)
    if as_json:
        both = {one.about: one.as_dict() for one in found}
        echo(json.dumps({"trial": trial, "uncertainty": ranges.name, "seed": chosen_seed, **both}, indent=2))
        return
    shown = _shown(kept.study)
    for one in found:
        _print(trial, one, shown)
    _say_which(found[1], shown)


def _shown(study: "Study") -> "list[Measure]":
    """The height, and the energy that is an objective of the study."""
    from pareto_monoped.measures import measure, nominal

    objectives = [nominal(name) for name in study.objectives.names]
    energies = ("energy_j", "electrical_energy_j")
    return [measure("height_m"), measure(next((name for name in energies if name in objectives), energies[0]))]


def _unit(entry: "Measure") -> str:
    """Changes of a height are millimetres."""
    return "mm" if entry.unit == "m" else entry.unit


def _change(entry: "Measure", one: "FactorInfluence") -> str:
    change = one.measures[entry.name].change
    return f"{1000.0 * change:+.1f}" if entry.unit == "m" else f"{change:+.2f}"


def _print(trial: int, found: "Sensitivity", shown: "list[Measure]") -> None:
    """One line per factor, by its share of the height's variance."""
    title = {"variables": "variables, moved around", "assumptions": "assumptions about the robot as built, around"}
    failed = f"; {100.0 * found.failed:.1f} % fail" if found.failed else ""
    echo(f"{title[found.about]} trial {trial} ({found.jumps} jumps{failed})")
    heads = "".join(f"{f'{entry.short} {_unit(entry)}':>10} {'share %':>8}" for entry in shown)
    echo(f"{'':<19} {'range':>22}{heads}")
    for one in found.ranked(shown[0].name):
        cells = ""
        for entry in shown:
            influence = one.measures[entry.name]
            share = f"{100.0 * influence.total:.0f}+-{100.0 * influence.error:.0f}"
            cells += f"{_change(entry, one):>10} {share:>8}"
        echo(f"{one.factor.label:<19} {one.factor.text:>22}{cells}")


def _say_which(found: "Sensitivity", shown: "list[Measure]") -> None:
    """Which tolerance of what is made matters most."""
    words = []
    for entry in shown:
        made = [one for one in found.ranked(entry.name) if one.factor.tolerance]
        if made:
            share = 100.0 * made[0].measures[entry.name].total
            words.append(f"for {entry.words} {made[0].factor.label} ({share:.0f} %)")
    if words:
        echo(wrapped(f"the manufacturing tolerance that matters most: {', '.join(words)}"))
    echo(wrapped("share: total Sobol' index, with its 95 percent interval; change from end to end of the range"))
