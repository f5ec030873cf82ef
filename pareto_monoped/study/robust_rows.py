"""The stored robustness of a study: one row per trial that was simulated under uncertainty."""

from dataclasses import dataclass
from typing import Any

from pareto_monoped.config import checked
from pareto_monoped.errors import DatabaseError
from pareto_monoped.study.extra_rows import ExtraTable, read_rows
from pareto_monoped.study.place import StudyPlace
from pareto_monoped.uncertainty.statistics import Robustness

ROBUSTNESS = ExtraTable(what="robustness", key="trial INTEGER")


@dataclass(frozen=True, slots=True, kw_only=True)
class Stored:
    """The robustness of one trial, and the settings that it was simulated under."""

    settings: dict[str, Any]
    result: Robustness


def read_robustness(db: StudyPlace) -> dict[int, Stored]:
    """The stored robustness of a study by trial; empty if it has none.

    Raises:
        DatabaseError: missing, not a study, or damaged.
    """
    found = read_rows(db, ROBUSTNESS, _result)
    return {int(trial): Stored(settings=settings, result=result) for trial, (settings, result) in found.items()}


def _result(_: Any, values: Any, source: str) -> Robustness:
    return checked(Robustness, values, source=source, error=DatabaseError)
