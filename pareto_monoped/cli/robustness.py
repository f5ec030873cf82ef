"""``robust``: designs of a study under uncertainty."""

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import click

from pareto_monoped.cli import completing
from pareto_monoped.cli.computing import executor_at, where, where_options
from pareto_monoped.cli.options import DATABASE, sample_seed_option, uncertainty_option, workers_option
from pareto_monoped.cli.terminal import echo
from pareto_monoped.study.place import StudyPlace

if TYPE_CHECKING:
    from pareto_monoped.measures import Measure
    from pareto_monoped.pareto.objectives import Objectives
    from pareto_monoped.study.definition import Study
    from pareto_monoped.uncertainty.ranges import Uncertainty
    from pareto_monoped.uncertainty.statistics import Robustness


@click.command()
@click.argument("db", type=DATABASE)
@click.option(
    "--trial",
    "trials",
    type=click.IntRange(min=0),
    multiple=True,
    metavar="N",
    shell_complete=completing.trials,
    help="A trial, instead of the front.",
)
@click.option(
    "--every", type=click.IntRange(min=1), default=1, metavar="N", help="Only every N-th design of the front."
)
@click.option(
    "--alternatives", "count", type=click.IntRange(0, 50), default=0, metavar="N", help="Also N alternatives to each."
)
@click.option(
    "--samples", type=int, metavar="N", help="Per design.  [default: 256, or the study's if it asks for more]"
)
@sample_seed_option
@uncertainty_option
@workers_option
@where_options
@click.option("--json", "as_json", is_flag=True, help="Print everything as JSON.")
def robust(
    db: StudyPlace,
    trials: tuple[int, ...],
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
    from pareto_monoped.study.front_reader import read_front
    from pareto_monoped.study.robustness import robust as run_robust

    if trials and every > 1:
        raise click.UsageError("--every goes with the front, not with --trial; drop one")
    place = where(processes, scheduler, workers)
    kept = read_front(db)
    ranges, samples, seed = asked(kept.study, uncertainty, samples, seed)
    chosen = list(trials) or kept.rows["trial"].tolist()[::every]
    if count and chosen:
        from pareto_monoped.study.alternatives import alternatives
        from pareto_monoped.study.reader import read_study

        data = read_study(db)
        chosen += [other.trial for trial in chosen for other in alternatives(data, trial, count=count)]
    with executor_at(place) as executor:
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


def asked(study: "Study", file: Path | None, samples: int | None, seed: int | None) -> "tuple[Uncertainty, int, int]":
    """Ranges, number of samples and seed that options ask for; without them the study's own, or the shipped ones."""
    from pareto_monoped.uncertainty.ranges import load_uncertainty
    from pareto_monoped.uncertainty.samples import DEFAULT_SAMPLES
    from pareto_monoped.uncertainty.settings import Sampling

    own = study.uncertainty or Sampling(ranges=load_uncertainty())
    return (
        own.ranges if file is None else load_uncertainty(file),
        max(own.samples, DEFAULT_SAMPLES) if samples is None else samples,
        own.seed if seed is None else seed,
    )


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
