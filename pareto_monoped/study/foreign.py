"""Trials of a study that an Optuna user has added: ignored here, counted, and named."""

FOREIGN_COUNT = "SELECT max(0, (SELECT count(*) FROM trials) - (SELECT count(*) FROM monoped_trials))"
"""How many of Optuna's trials are not of this package."""


def foreign_note(count: int) -> str:
    """What is said of them."""
    what, them = ("1 of Optuna's trials is", "it") if count == 1 else (f"{count} of Optuna's trials are", "them")
    return (
        f"{what} not of this package: ignored here, but Optuna's best_trials may have {them}; 'repair DB' drops {them}"
    )
