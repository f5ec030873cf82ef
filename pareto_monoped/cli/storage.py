"""Commands that look after a study database: ``verify`` and ``repair``."""

import click

from pareto_monoped.cli.computing import Where, executor_at, where, where_options
from pareto_monoped.cli.options import DATABASE
from pareto_monoped.cli.terminal import echo, note
from pareto_monoped.study.place import StudyPlace


@click.command()
@click.argument("db", type=DATABASE)
@click.option(
    "--simulate", type=click.IntRange(min=0), default=0, metavar="N", help="Simulate N trials again and compare."
)
@click.option("--workers", type=click.IntRange(1, 1024), metavar="N", help="Number of threads.  [default: all cores]")
@where_options
def verify(db: StudyPlace, simulate: int, workers: int | None, processes: int | None, scheduler: str | None) -> None:
    """Check that nothing in a study has been lost or changed.

    Checks the running hash, the numbering, that values are finite and possible, and that Optuna's tables agree.
    """
    from pareto_monoped.study.foreign import foreign_note
    from pareto_monoped.study.run import default_workers
    from pareto_monoped.study.seals import UNSEALED
    from pareto_monoped.study.verify import require_sound
    from pareto_monoped.study.verify import verify as verify_study

    place = where(processes, scheduler, workers)
    if place != Where() and not simulate:
        raise click.UsageError("--processes and --scheduler go with --simulate only, which is what they do; drop them")
    with executor_at(place) as executor:
        result = verify_study(db, simulate=simulate, workers=workers or default_workers(), executor=executor)
    for line in result.findings:
        echo(f"found: {line}", err=True)
    if result.foreign:
        note(foreign_note(len(result.foreign)))
    if not result.sealed:
        note(UNSEALED)
    require_sound(db, result)
    again = f", {result.simulated} jumped again as stored" if result.simulated else ""
    echo(f"{db}: sound, {result.trials} trials{again}")


@click.command()
@click.argument("db", type=DATABASE)
def repair(db: StudyPlace) -> None:
    """Drop trials that an Optuna user has added to a study.

    They are ignored by all other commands, but Optuna and its dashboard count them among the study's.
    """
    from pareto_monoped.study.repair import repair as repair_study

    dropped = repair_study(db)
    numbers = f", which Optuna numbered {', '.join(map(str, dropped))}" if dropped else ""
    echo(f"{db}: dropped {len(dropped)} trials{numbers}")
