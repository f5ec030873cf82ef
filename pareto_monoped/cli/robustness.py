"""Commands on uncertainty: ``robust`` for designs of a study, and ``sensitivity`` for what moves a design most."""

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import click

from pareto_monoped.cli import options
from pareto_monoped.cli.selection import condition_options, required, selector_options
from pareto_monoped.cli.terminal import echo, note, wrapped
from pareto_monoped.storage.place import StudyPlace

if TYPE_CHECKING:
    from pareto_monoped.definition.study import Study
    from pareto_monoped.measures import Measure
    from pareto_monoped.pareto.objectives import Objectives
    from pareto_monoped.pareto.selectors import Condition, MaxEnergy, Selector
    from pareto_monoped.uncertainty.sensitivity import FactorInfluence, Sensitivity
    from pareto_monoped.uncertainty.statistics import Robustness


@click.command()
@click.argument("db", type=options.DATABASE)
@options.trials_option
@condition_options
@click.option(
    "--every", type=click.IntRange(min=1), default=1, metavar="N", help="Only every N-th design of the front."
)
@click.option(
    "--alternatives", "count", type=click.IntRange(0, 50), default=0, metavar="N", help="Also N alternatives to each."
)
@click.option(
    "--samples", type=int, metavar="N", help="Per design.  [default: 256, or the study's if it asks for more]"
)
@options.sample_seed_option
@options.uncertainty_option
@options.workers_option
@options.where_options
@click.option("--json", "as_json", is_flag=True, help="Print everything as JSON.")
def robust(
    db: StudyPlace,
    trials: tuple[int, ...],
    conditions: "tuple[Condition | MaxEnergy, ...]",
    every: int,
    count: int,
    samples: int | None,
    seed: int | None,
    uncertainty: Path | None,
    workers: int | None,
    processes: int | None,
    scheduler: str | None,
    as_json: bool,
) -> None:
    """Simulate designs again as robots are built.

    What is uncertain in a built robot is drawn within its range.

    Masses, motors, friction, springs, lengths, gains, delay and battery vary together; all designs get the same
    samples. The results are stored in DB; what is there is not simulated again.
    """
    from pareto_monoped.analysis.choices import settled_front
    from pareto_monoped.analysis.robustness import robust as run_robust
    from pareto_monoped.analysis.robustness import sampling
    from pareto_monoped.storage.front_reader import read_front
    from pareto_monoped.uncertainty.settings import load_uncertainty

    if trials and every > 1:
        raise click.UsageError("--every goes with the front, not with --trial; drop one")
    if trials and conditions:
        raise click.UsageError("conditions make the front, and --trial names trials; drop one")
    place = options.where(processes, scheduler, workers)
    kept = read_front(db)
    ranges, samples, seed = sampling(kept.study, load_uncertainty(uncertainty) if uncertainty else None, samples, seed)
    front = settled_front(db, conditions, notify=note) if conditions else kept.rows
    chosen = list(trials) or front["trial"].tolist()[::every]
    if count and chosen:
        from pareto_monoped.analysis.alternatives import alternatives
        from pareto_monoped.storage.reader import read_study

        data = read_study(db)
        chosen += [other.trial for trial in chosen for other in alternatives(data, trial, count=count)]
    with options.executor_at(place) as executor:
        results = run_robust(
            db,
            ranges,
            trials=chosen or None,
            samples=samples,
            seed=seed,
            workers=workers,
            executor=executor,
            progress=lambda done, total: echo(f"{done}/{total} designs", err=True),
        )
    if as_json:
        shown = {str(trial): result.as_dict() for trial, result in results.items()}
        echo(json.dumps({"uncertainty": ranges.name, "samples": samples, "seed": seed, "trials": shown}, indent=2))
    else:
        _print(results, kept.study.objectives)


def _print(results: "Mapping[int, Robustness]", objectives: "Objectives") -> None:
    """One row per design: mean and percentiles of two objectives, shares of jumps that fail or overload a part."""
    from pareto_monoped.measures import measure, nominal

    shown = [measure(name) for name in dict.fromkeys(nominal(entry.name) for entry in objectives.measures)][:2]
    heads = "  ".join(f"{f'{entry.short} {entry.shown_unit}'.removesuffix(' 1'):>24}" for entry in shown)
    echo(f"{'':6} {heads}  {'':7} {'over':>7}")
    ends = "  ".join(f"{'mean':>8}{'5 %':>8}{'95 %':>8}" for _ in shown)
    echo(f"{'trial':>6} {ends}  {'fail %':>7} {'load %':>7}")
    for trial, result in results.items():
        cells = "  ".join(_cells(result, entry) for entry in shown)
        echo(f"{trial:6d} {cells}  {100.0 * result.failed:7.1f} {100.0 * result.overloaded:7.1f}")


def _cells(result: "Robustness", entry: "Measure") -> str:
    spread = result.measures.get(entry.name)
    values: Sequence[float | None] = (spread.mean, spread.p05, spread.p95) if spread else (None,) * 3
    texts = ["-" if value is None else f"{value * entry.scale:.{entry.decimals}f}" for value in values]
    return "".join(f"{text:>8}" for text in texts)


_DEFAULT_BLOCKS, _DEFAULT_WITHIN = 256, 2.0


@click.command()
@click.argument("db", type=options.DATABASE)
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
@options.sample_seed_option
@options.uncertainty_option
@options.workers_option
@options.where_options
@click.option("--plot", type=options.HTML_FILE, metavar="FILE.html", help="Write a chart that needs no network.")
@options.force_option
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
    from pareto_monoped.analysis.choices import choose_of
    from pareto_monoped.analysis.robustness import sampling
    from pareto_monoped.analysis.sensitivity import sensitivity as find
    from pareto_monoped.pareto.selectors import Trial
    from pareto_monoped.storage.front_reader import read_front
    from pareto_monoped.uncertainty.settings import load_uncertainty

    place = options.where(processes, scheduler, workers)
    wanted, kept = required(selector), read_front(db)
    ranges, _, chosen_seed = sampling(kept.study, load_uncertainty(uncertainty) if uncertainty else None, None, seed)
    if isinstance(wanted, Trial):
        trial = wanted.number  # which need not be on the front
    else:
        trial = choose_of(kept, wanted, notify=note).picked.trial
    with options.executor_at(place) as executor:
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
        from pareto_monoped.report.figures import sensitivity_page

        write_text(plot, sensitivity_page(trial, found, _shown(kept.study)), force=force)
        echo(f"wrote {plot}", err=True)
    if as_json:
        both = {one.about: one.as_dict() for one in found}
        echo(json.dumps({"trial": trial, "uncertainty": ranges.name, "seed": chosen_seed, **both}, indent=2))
        return
    shown = _shown(kept.study)
    for one in found:
        _sensitivity_print(trial, one, shown)
    _say_which(found[1], shown)


def _shown(study: "Study") -> "list[Measure]":
    """Return the height, and the energy that is an objective of the study."""
    from pareto_monoped.measures import ENERGIES, measure, nominal

    objectives = [nominal(name) for name in study.objectives.names]
    return [measure("height_m"), measure(next((name for name in ENERGIES if name in objectives), ENERGIES[0]))]


def _unit(entry: "Measure") -> str:
    """Changes of a height are millimetres."""
    return "mm" if entry.unit == "m" else entry.unit


def _change(entry: "Measure", one: "FactorInfluence") -> str:
    change = one.measures[entry.name].change
    return f"{1000.0 * change:+.1f}" if entry.unit == "m" else f"{change:+.2f}"


def _sensitivity_print(trial: int, found: "Sensitivity", shown: "list[Measure]") -> None:
    """One line per factor, by its share of the height's variance."""
    title = {"variables": "variables, moved around", "assumptions": "assumptions about the robot as built, around"}
    failed = f"; {100.0 * found.failed:.1f} % fail" if found.failed else ""
    echo(f"{title[found.about]} trial {trial} ({found.jumps} jumps{failed})")
    heads = "".join(f"{f'{entry.short} {_unit(entry)}':>10} {'share %':>8}" for entry in shown)
    echo(f"{'':<19} {'range':>22}{heads}")
    for one in found.ranked(shown[0].name):
        cells = ""
        for entry in shown:
            share = one.measures[entry.name].share_text
            cells += f"{_change(entry, one):>10} {share:>8}"
        echo(f"{one.factor.label:<19} {one.factor.text:>22}{cells}")


def _say_which(found: "Sensitivity", shown: "list[Measure]") -> None:
    """Which tolerance of what is made matters most."""
    words = []
    for entry in shown:
        made = [one for one in found.ranked(entry.name) if one.factor.tolerance]
        if not made:
            continue
        first, *others = (one.measures[entry.name] for one in made)
        if others and first.total - first.error < others[0].total + others[0].error:
            both = f"{made[0].factor.label} or {made[1].factor.label}"
            words.append(f"for {entry.words} {both}, which {found.blocks} samples do not tell apart")
        else:
            words.append(f"for {entry.words} {made[0].factor.label} ({first.share_text} %)")
    if words:
        echo(wrapped(f"the manufacturing tolerance that matters most: {'; '.join(words)}"))
    echo(
        wrapped(
            "share: total Sobol' index, with its 95 percent interval, or only that interval where it is wide; change "
            "from end to end of the range"
        )
    )
