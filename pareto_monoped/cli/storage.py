"""Commands that look after a study database: ``verify``."""

from pathlib import Path

import click


@click.command()
@click.argument("db", type=click.Path(path_type=Path))
@click.option(
    "--simulate", type=click.IntRange(min=0), default=0, metavar="N", help="Simulate N trials again and compare."
)
@click.option("--workers", type=click.IntRange(min=1), metavar="N", help="Number of threads.  [default: all cores]")
def verify(db: Path, simulate: int, workers: int | None) -> None:
    """Check that nothing in a study has been lost or changed.

    Checks the running hash, the numbering, that values are finite and possible, and that Optuna's tables agree.
    """
    from pareto_monoped.study.run import default_workers
    from pareto_monoped.study.seals import UNSEALED
    from pareto_monoped.study.verify import require_sound
    from pareto_monoped.study.verify import verify as verify_study

    result = verify_study(db, simulate=simulate, workers=workers or default_workers())
    for line in result.findings:
        click.echo(f"found: {line}", err=True)
    if result.foreign:
        click.echo(f"note: {foreign_note(result.foreign)}", err=True)
    if not result.sealed:
        click.echo(f"note: {UNSEALED}", err=True)
    require_sound(db, result)
    again = f", {result.simulated} jumped again as stored" if result.simulated else ""
    click.echo(f"{db}: sound, {result.trials} trials{again}")


def foreign_note(numbers: tuple[int, ...]) -> str:
    """What is said of trials that are not of this package."""
    first = ", ".join(map(str, numbers[:3])) + (", ..." if len(numbers) > 3 else "")
    return (
        f"{len(numbers)} of Optuna's trials are not of this package (Optuna's numbers {first}); they are ignored here, "
        "but may be among Optuna's best_trials"
    )
