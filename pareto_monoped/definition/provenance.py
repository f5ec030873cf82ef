"""What decides a study's results (settings, motor, calibration, versions), its hash, and the difference of two."""

import hashlib
import json
import platform
from collections.abc import Mapping
from importlib.metadata import version
from typing import Any

from pareto_monoped import __version__
from pareto_monoped.definition.algorithms import EvolutionSettings, OptunaSettings, SurrogateSettings, WeightedSettings
from pareto_monoped.definition.study import Study
from pareto_monoped.definition.variables import MOTOR_KEYS

NOT_RESULTS = ("audit", "description", "evaluations", "stop")
"""Keys of a study that decide when it ends or what follows, but not which trials it has."""


def versions(study: Study) -> dict[str, str]:
    """Return versions of the packages that decide the trials of ``study``; of search libraries, only the one in use."""
    names = ["mujoco", "numba", "numpy"]
    match study.algorithm:
        case EvolutionSettings() | SurrogateSettings():  # whose operators are pymoo's
            names += ["pymoo"]
        case OptunaSettings():
            names += ["optuna"]
        case WeightedSettings():
            names += ["cma"]
    return {"pareto-monoped": __version__} | {name: version(name) for name in sorted(names)}


def environment() -> dict[str, str]:
    """Return Python, system and machine, which are stored for the record and not part of the hash."""
    return {"python": platform.python_version(), "system": platform.system(), "machine": platform.machine()}


def decisive(study: Study, contents: Mapping[str, Any], package_versions: Mapping[str, str]) -> dict[str, Any]:
    """Return all that changes results, as JSON values; ``contents`` are those of ``motor`` and ``calibration``."""
    settings = {key: value for key, value in study.as_dict().items() if key not in NOT_RESULTS}
    # Not the names of motor and calibration decide, but their contents, which stand beside the settings, the engine
    # among those of the calibration.
    settings = {key: value for key, value in settings.items() if key not in (*MOTOR_KEYS, "calibration", "engine")}
    if (sampling := settings.pop("uncertainty", None)) and study.robust_names:
        # Not what the ranges are called and where they come from, but their ends.
        settings["uncertainty"] = {
            key: {end: value[end] for end in ("lower", "upper")} if isinstance(value, Mapping) else value
            for key, value in sampling.items()
            if key != "name"
        }
    if study.motor is None:
        # Which joint chooses from which of the motors.
        places = {name: place for place, name in enumerate(study.motors, 1)}
        for joint, names in zip(("hip", "knee"), zip(*study.kits, strict=True), strict=True):
            settings[f"{joint}_motor"] = [f"motor_{places[name]}" for name in dict.fromkeys(names)]
    plain: dict[str, Any] = json.loads(json.dumps({"study": settings, **contents, "versions": dict(package_versions)}))
    return plain


def digest(values: Mapping[str, Any]) -> str:
    """Return the SHA-256 of JSON values, independent of the order of keys."""
    text = json.dumps(values, sort_keys=True, separators=(",", ":"))
    return hashlib.sha256(text.encode("utf-8")).hexdigest()


def differences(before: Mapping[str, Any], now: Mapping[str, Any]) -> list[str]:
    """Return the differences between two sets of JSON values, each as ``key: old -> new``."""
    old, new = _flat(before), _flat(now)
    keys = [*old, *(key for key in new if key not in old)]
    absent = "(none)"
    return [f"{key}: {old.get(key, absent)} -> {new.get(key, absent)}" for key in keys if old.get(key) != new.get(key)]


def _flat(values: Any, prefix: str = "") -> dict[str, str]:
    if isinstance(values, Mapping) and values:
        flat: dict[str, str] = {}
        for key, value in values.items():
            flat |= _flat(value, f"{prefix}.{key}" if prefix else str(key))
        return flat
    return {prefix: json.dumps(values, sort_keys=True)}
