"""Motors by name or file: the six that ship with the package, a user's own, and those that a study or export stores."""

import json
from collections.abc import Callable, Mapping
from dataclasses import asdict, fields, replace
from functools import lru_cache
from pathlib import Path
from typing import Any

from pareto_monoped.actuator.motor import (
    AIR_GAP_MM,
    BELL_THICKNESS_MM,
    PEAK_TO_CONTINUOUS,
    FramedMotor,
    FramelessMotor,
    HolePattern,
    Motor,
    mass_share,
)
from pareto_monoped.actuator.motor_checks import contradiction
from pareto_monoped.config import checked, read_shipped, read_toml
from pareto_monoped.errors import InputError, MotorError, unknown_name
from pareto_monoped.materials import MATERIALS

__all__ = [
    "AIR_GAP_MM",
    "BELL_THICKNESS_MM",
    "PEAK_TO_CONTINUOUS",
    "FramedMotor",
    "FramelessMotor",
    "HolePattern",
    "Motor",
    "load_motor",
    "motor_names",
    "motor_source",
    "motor_values",
    "require_motor_name",
    "stored_motor",
]


@lru_cache(maxsize=1)
def _shipped() -> dict[str, dict[str, Any]]:
    return read_shipped("motors.toml", what="motor file", error=MotorError)


def motor_names() -> tuple[str, ...]:
    """The motors that ship with the package; the first is the default."""
    return tuple(_shipped())


def _shipped_name(name_or_path: str) -> str | None:
    return next((name for name in _shipped() if name.lower() == name_or_path.lower()), None)


def motor_source(name_or_path: str) -> str:
    """What error messages call a motor: ``motor U8`` or ``motor file 'my.toml'``."""
    name = _shipped_name(name_or_path)
    return f"motor file {str(Path(name_or_path))!r}" if name is None else f"motor {name}"


def load_motor(name_or_path: str) -> Motor:
    """A motor by the name of a shipped one (any case), or from a user's TOML file with one motor at its top level.

    Raises:
        MotorError: unknown name, unreadable file, a field that is missing, unknown or impossible, or fields that
            contradict each other.
    """
    name, source = _shipped_name(name_or_path), motor_source(name_or_path)
    values = _user_values(name_or_path) if name is None else {"name": name} | _shipped()[name]
    motor = checked(Motor, values, source=source, error=MotorError)
    problem = contradiction(motor)
    if problem is not None:
        raise MotorError(f"{source}: {problem}")
    return motor


def require_motor_name(name_or_path: str, *, key: str = "motor") -> None:
    """Refuse what is neither the name of a shipped motor nor may be a file, which is not opened.

    Args:
        name_or_path: the name.
        key: where it was given, for the message.

    Raises:
        MotorError: an unknown name.
    """
    path = Path(name_or_path)
    if _shipped_name(name_or_path) is None and path.suffix != ".toml" and not path.is_file():
        raise MotorError(unknown_name(key, name_or_path, motor_names(), ", or a TOML file"))


def _user_values(name_or_path: str) -> dict[str, Any]:
    """The fields of the motor in a user's file."""
    require_motor_name(name_or_path)
    path = Path(name_or_path)
    values = read_toml(path, what="motor file", error=MotorError)
    known = {field.name for field in fields(Motor)}
    if len(values) == 1 and not known & set(values):
        # A file in the shipped form, with the motor's name as its one table.
        ((name, inner),) = values.items()
        if isinstance(inner, dict):
            values = {"name": name} | inner
    return {"name": path.stem} | values


def motor_values(motor: Motor) -> dict[str, Any]:
    """Every value of a motor as JSON has it; ``stored_motor`` reads it back.

    A field that motors did not always have is left out at the value that ``stored_motor`` gives it, so that studies and
    exports stored before it came keep their hash.
    """
    values: dict[str, Any] = json.loads(json.dumps(asdict(motor)))
    return {name: value for name, value in values.items() if name not in _LATER or value != _LATER[name](motor)}


def stored_motor(values: Mapping[str, Any], *, source: str, error: type[InputError] = MotorError) -> Motor:
    """A motor from what a study or an export stores; its values may contradict each other, as they did then.

    Args:
        values: as ``motor_values`` gives them, of this version or an earlier one.
        source: where they come from, the first words of a message.
        error: which kind of ``InputError`` to raise.

    Raises:
        MotorError: (or ``error``) a field is missing, unknown or impossible.
    """
    motor = checked(Motor, values, source=source, error=error)
    return replace(motor, **{name: earlier(motor) for name, earlier in _LATER.items() if name not in values})


_LATER: Mapping[str, Callable[[Motor], Any]] = {
    "winding_resistance_kind": lambda _: "line_to_line",
    # Version 0.1.0 took these densities, which leave out the stator's copper.
    "rotor_mass_share": lambda motor: mass_share(
        motor, MATERIALS.motor_rotor.density_kg_per_m3, MATERIALS.motor_stator.density_kg_per_m3
    ),
    "thermal": lambda _: None,
}
"""Fields that motors did not always have, and what they were before."""
