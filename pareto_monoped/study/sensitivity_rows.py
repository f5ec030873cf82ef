"""The stored sensitivities of a study: one row per trial and per kind of factors."""

from dataclasses import dataclass
from typing import Any, get_args

from pareto_monoped.config import checked
from pareto_monoped.errors import DatabaseError
from pareto_monoped.study.extra_rows import ExtraTable, read_rows
from pareto_monoped.study.place import StudyPlace
from pareto_monoped.uncertainty.influences import About, Sensitivity

SENSITIVITY = ExtraTable(what="sensitivity", key="trial_and_factors TEXT")


@dataclass(frozen=True, slots=True, kw_only=True)
class StoredSensitivity:
    """A sensitivity, and the settings that it was simulated under."""

    settings: dict[str, Any]
    result: Sensitivity


def key_of(trial: int, about: About) -> str:
    """The key of a row, such as "17 assumptions"."""
    return f"{trial} {about}"


def read_sensitivity(db: StudyPlace) -> dict[tuple[int, About], StoredSensitivity]:
    """The stored sensitivities of a study by trial and kind of factors; empty if it has none.

    Raises:
        DatabaseError: missing, not a study, or damaged.
    """
    found: dict[tuple[int, About], StoredSensitivity] = {}
    for key, (settings, result) in read_rows(db, SENSITIVITY, _result).items():
        found[int(key.split()[0]), result.about] = StoredSensitivity(settings=settings, result=result)
    return found


def _result(key: Any, values: Any, source: str) -> Sensitivity:
    trial, _, about = str(key).partition(" ")
    result = checked(Sensitivity, values, source=source, error=DatabaseError)
    if not trial.isdecimal() or about != result.about or about not in get_args(About):
        raise ValueError(f"a row is called {key!r}")
    return result
