"""Trials of a study that an Optuna user has added: ignored here, counted, and named."""

from pareto_monoped.study.connection import Connection


def foreign_count(connection: Connection) -> int:
    """How many of Optuna's trials are not of this package."""
    (more,) = connection.execute(
        "SELECT (SELECT count(*) FROM trials) - (SELECT count(*) FROM monoped_trials)"
    ).fetchone()
    return max(0, int(more))


def foreign_note(count: int) -> str:
    """What is said of them."""
    what, them = ("1 of Optuna's trials is", "it") if count == 1 else (f"{count} of Optuna's trials are", "them")
    return (
        f"{what} not of this package: ignored here, but Optuna's best_trials may have {them}; 'repair DB' drops {them}"
    )
