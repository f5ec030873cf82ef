"""What a script brings along: its own functions among the goals of a study, and its own calibration."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from pareto_monoped.errors import CalibrationError, StudyError, complaint
from pareto_monoped.jump.calibration import (
    Calibration,
    calibration_names,
    calibration_of,
    calibration_values,
    earlier_calibrations,
)
from pareto_monoped.jump.calibration import load_calibration as shipped_calibration
from pareto_monoped.jump.calibration_defaults import OWN_CALIBRATION
from pareto_monoped.study.own_functions import OwnFunction, functions_of, own_name
from pareto_monoped.study.plain import as_list, as_plain, as_table

Goal = str | OwnFunction
"""A measure by its name, or an own function."""
Limits = Mapping[Any, Any] | OwnFunction | Sequence[Any]


def objective_names(objectives: Sequence[Goal]) -> tuple[list[str], dict[str, OwnFunction]]:
    """Names of objectives, and the own functions among them.

    Raises:
        StudyError: no list, or something in it that is neither a name nor a function.
    """
    several = as_list(objectives)
    if isinstance(several, str | Mapping) or not isinstance(several, Sequence):
        allowed = "a list of two or three measures or functions, such as ['height_m', 'energy_j']"
        raise StudyError(complaint("objectives", objectives, allowed, "give one"))
    functions = functions_of([one for one in several if not isinstance(one, str)])
    return [one if isinstance(one, str) else own_name(one) for one in several], functions


def limits_of(constraints: Limits) -> tuple[dict[str, Any], dict[str, OwnFunction]]:
    """Limits by their stored keys, such as "max_mass_kg", and the own functions that they are of.

    Args:
        constraints: a mapping of measures, or functions, to their limits; or a function, which holds at <= 0; or a list
            of such mappings and functions.

    Raises:
        StudyError: something else, or a limit that is given twice, in whatever spelling.
    """
    given = as_table(constraints)
    parts = [given] if isinstance(given, Mapping) or callable(given) else given
    if isinstance(parts, str) or not isinstance(parts, Sequence):
        allowed = "limits such as {'mass_kg': {'max': 4.0}}, or a list of these and of functions that hold at <= 0"
        raise StudyError(complaint("constraints", constraints, allowed, "give one of these"))
    flat: dict[str, Any] = {}
    functions: list[object] = []
    for part in parts:
        table = part if isinstance(part, Mapping) else {part: {"max": 0.0}} if callable(part) else None
        if table is None:
            allowed = "limits such as {'mass_kg': {'max': 4.0}}, or a function that holds at <= 0"
            raise StudyError(complaint("constraint", part, allowed, "give one of these"))
        functions += [key for key in table if not isinstance(key, str)]
        for key, limits in table.items():
            name = key if isinstance(key, str) else own_name(key)
            new = as_plain(_flattened(name, limits))
            if twice := [stored for stored in new if stored in flat]:
                side, _, measured = twice[0].partition("_")
                raise StudyError(f"constraints: the {side} of {measured} is given twice; drop one")
            flat |= new
    return flat, functions_of(functions)


def _flattened(name: str, limits: Any) -> dict[str, Any]:
    """The limits of one measure in their stored form."""
    if not isinstance(limits, Mapping):
        return {name: limits}
    if not limits or not set(limits) <= {"min", "max"}:
        allowed = "a table with 'min', 'max' or both, such as {'max': 4.0}"
        raise StudyError(complaint(f"constraints: limits of {name}", dict(limits), allowed, "correct it"))
    return {f"{side}_{name}": value for side, value in limits.items()}


def own_calibration(given: Calibration) -> Calibration:
    """A calibration that a script made, checked as one from a file.

    Raises:
        CalibrationError: a value that no calibration can have, or a class of its own, whose behaviour no study stores.
    """
    if type(given) is not Calibration:
        kind = type(given).__name__
        raise CalibrationError(
            f"calibration: is a {kind}, must be a Calibration itself, because only its values are stored; change the "
            "values of one: dataclasses.replace(load_calibration('reference'), ...)"
        )
    try:
        values = calibration_values(given)
    except (AttributeError, TypeError, ValueError) as error:
        raise CalibrationError(f"calibration {given.name!r}: {error}; correct its values") from None
    checked = calibration_of(values, source=f"calibration {given.name!r}")
    if checked != given:
        raise CalibrationError(f"calibration {given.name!r}: has values of a class of its own; take plain ones")
    return checked


def stored_calibration_name(calibration: Calibration) -> str:
    """The name under which a study stores a calibration that a script gives.

    Raises:
        CalibrationError: it has the name of a shipped one and other values.
    """
    if calibration.name not in calibration_names():
        return f"{OWN_CALIBRATION}{calibration.name}"
    if calibration.label in earlier_calibrations() and calibration == shipped_calibration(calibration.label):
        return calibration.label
    if calibration != shipped_calibration(calibration.name):
        raise CalibrationError(
            f"calibration.name = {calibration.name!r}: is a shipped calibration with other values; give yours another "
            "name: dataclasses.replace(calibration, name='mine')"
        )
    return calibration.name


def called_after(callback: object) -> Callable[..., Any] | None:
    """A callback, if it is one.

    Raises:
        StudyError: it cannot be called.
    """
    if callback is None or callable(callback):
        return callback
    raise StudyError(complaint("callback", callback, "a function of the progress", "give one"))
