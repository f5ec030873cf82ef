"""Where a study's numbers come from: versions, settings and the command that runs it again."""

from collections.abc import Mapping
from typing import Any

from pareto_monoped.study.reader import StudyData

_ABOVE = ("name", "description", "seed", "motor", "hip_motor", "knee_motor", "calibration")
"""Settings that stand in the first rows of the table or elsewhere on the page."""


def provenance(data: StudyData) -> list[list[str]]:
    """Rows of name and value: the study, the versions and machine it ran on, and every setting."""
    meta, study = data.meta, data.study
    rows = [
        ("study", study.name),
        ("database", data.db),
        ("created", meta.created),
        ("state", "finished" if meta.finished else "unfinished"),
        ("ended because of", meta.stop_reason or "nothing yet"),
        ("seed", study.seed),
        ("motor", study.motor_text),
        ("calibration", meta.calibration),
        ("settings hash (SHA-256)", meta.hash),
        *((f"version of {name}", version) for name, version in meta.versions.items()),
        *((name, value) for name, value in meta.environment.items()),
        *((key, value) for key, value in _flat(study.as_dict()) if key not in _ABOVE),
    ]
    return [[str(key), str(value)] for key, value in rows]


def _flat(values: Mapping[str, Any], prefix: str = "") -> list[tuple[str, str]]:
    """Nested settings as rows of ``table.key`` and value."""
    rows: list[tuple[str, str]] = []
    for key, value in values.items():
        if isinstance(value, Mapping):
            rows += _flat(value, f"{prefix}{key}.")
        elif value is not None:
            rows.append((f"{prefix}{key}", f"{value:g}" if isinstance(value, float) else str(value)))
    return rows


def command(data: StudyData) -> str:
    """The command that runs the study again from its study file."""
    return f"pareto-monoped run STUDY.toml --seed {data.study.seed} --evaluations {data.meta.budget}"
