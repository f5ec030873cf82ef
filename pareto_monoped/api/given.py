"""Checks of what scripts give: plain values, designs in every form, motors, own functions and own calibrations.

A function that refuses its argument raises an ``InputError`` of the kind that fits; ``what`` names it in the message.
"""

import difflib
import math
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass
from functools import cache
from html import escape
from numbers import Integral, Real
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.actuator.ratiomap import JointMaps, motor_label
from pareto_monoped.definition.given import as_list, as_table, is_series
from pareto_monoped.definition.variables import MOTOR_KEYS
from pareto_monoped.design import ALL_DEFAULTS, ALL_NAMES, KNOT_NAMES, NAMES, PAPER_NAMES, Design, complete
from pareto_monoped.errors import CalibrationError, DesignError, InputError, SelectionError, StudyError, complaint
from pareto_monoped.jump.calibration import (
    Calibration,
    calibration_names,
    calibration_of,
    calibration_values,
    earlier_calibrations,
)
from pareto_monoped.jump.calibration import load_calibration as shipped_calibration
from pareto_monoped.jump.calibration_defaults import OWN_CALIBRATION
from pareto_monoped.measures import GOAL_NAMES, is_own, near_measures

if TYPE_CHECKING:
    from pandas import DataFrame

    from pareto_monoped.pareto import selectors


def executor_of(given: Any) -> Any:
    """Return something that does calls elsewhere, or None where none is given."""
    if given is None or isinstance(given, Executor):
        return given
    allowed = "a concurrent.futures.Executor, such as a ProcessPoolExecutor"
    raise InputError(complaint("executor", given, allowed, "give one, or leave it out"))


def seed_of(given: Any, what: str = "seed") -> int:
    """Return the seed of a random generator, a whole number from 0 to 2**63 - 1."""
    if isinstance(given, bool) or not isinstance(given, Integral) or not 0 <= int(given) < 2**63:
        raise InputError(complaint(what, given, "a whole number from 0 to 2**63 - 1", "correct it"))
    return int(given)


def trial_of(given: Any) -> int:
    """Return the number of a trial, a whole number of at least 0."""
    if isinstance(given, bool) or not isinstance(given, Integral) or given < 0:
        raise InputError(complaint("trial", given, "the number of a trial, from 0", "give one"))
    return int(given)


def truth_of(what: str, given: Any) -> bool:
    """Return True or False; anything else is refused, because it might count as either."""
    if not isinstance(given, bool | np.bool_):
        raise InputError(complaint(what, given, "True or False", "give one of them"))
    return bool(given)


def number_of(what: str, given: Any) -> float:
    """Return a finite number."""
    if isinstance(given, Real) and not isinstance(given, bool):
        try:
            number = float(given)
        except OverflowError:  # a whole number beyond the greatest float
            number = math.inf
        if math.isfinite(number):
            return number
    raise InputError(complaint(what, given, "a finite number", "give one"))


def numbers_of(what: str, given: Any) -> tuple[float, ...]:
    """Return finite numbers from a list, an array or a series."""
    values = as_list(given)
    if isinstance(values, str | bytes | Mapping) or not isinstance(values, Sequence):
        raise InputError(complaint(what, given, "a list of numbers", "give one"))
    return tuple(number_of(what, value) for value in values)


def table_of(what: str, given: Any) -> dict[str, float]:
    """Return finite numbers by name, from a mapping or a series."""
    values = as_table(given)
    if not isinstance(values, Mapping):
        raise InputError(complaint(what, given, "a mapping of names to numbers", "give one"))
    return {name: number_of(f"{what}[{name!r}]", value) for name, value in values.items()}


_FORMS = "a Design, a list of them, a mapping or data frame of variables, or an array of numbers"


@cache
def _known() -> tuple[str, ...]:
    """Return the names of columns that frames of designs may have: those of stored trials."""
    from pareto_monoped.storage.columns import COLUMNS

    return tuple(dict.fromkeys((*ALL_NAMES, *(column.name for column in COLUMNS), *GOAL_NAMES)))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Given:
    """Designs, and the motors that they were found with."""

    values: NDArray[np.float64]  #: of the n designs, shape (n, number of variables), in the order of ``NAMES``
    #: Names of each one's motors as ``JointMaps.label`` has them; '' where nothing is said of them
    motors: tuple[str, ...]


def given_designs(designs: Any) -> Given:
    """Return designs from any form that ``simulate`` takes; raise ``DesignError`` for anything else."""
    several = designs if isinstance(designs, list | tuple) and designs else [designs]
    for one in several:
        if isinstance(getattr(one, "design", None), Design):
            raise DesignError(f"designs: are of class {type(one).__name__}, must be Designs; {_cure_of_holder(one)}")
    if all(isinstance(one, Design) for one in several):
        return _unsaid(_of_designs(several))
    if _is_named(designs):
        return _of_columns(as_table(designs))
    if all(isinstance(one, Design) or _is_named(one) for one in several):
        parts = [given_designs(one) for one in several]
        motors = tuple(motor for part in parts for motor in part.motors)
        return Given(values=np.concatenate([part.values for part in parts]), motors=motors)
    try:
        values = np.asarray(designs, dtype=np.float64)
    except (TypeError, ValueError, OverflowError):
        raise DesignError(complaint("designs", designs, _FORMS, "give one of these")) from None
    if values.ndim == 0:
        raise DesignError(complaint("designs", designs, _FORMS, "give one of these"))
    if values.ndim > 2:
        raise DesignError(complaint("dimensions of designs", values.ndim, "1 or 2", "give one row per design"))
    return _unsaid(complete(np.atleast_2d(values)))


def renamed(designs: Any, names: Mapping[str, str]) -> Any:
    """Return designs with some of their columns called otherwise, in any form that ``simulate`` takes."""
    if isinstance(designs, list | tuple):
        return [renamed(one, names) for one in designs]
    if not names or not _is_named(designs):
        return designs
    table = as_table(designs)
    return {names.get(name, name): table[name] for name in table}


def with_motors(designs: Any, maps: JointMaps) -> NDArray[np.float64]:
    """Return designs as an array of shape (n, number of variables), in any form that ``simulate`` takes.

    A frame that names other motors than those of ``maps`` is a ``DesignError``: it would jump otherwise than it says.
    """
    given = given_designs(designs)
    for row, motor in enumerate(given.motors):
        if motor and motor.casefold() != maps.label.casefold():
            cure = "let StoredStudy.simulate take each row's own motors, name them here, or drop the columns of motors"
            raise DesignError(complaint(f"motor of design {row}", motor, f"{maps.label!r}, which is used here", cure))
    return given.values


def one_design(design: Any, maps: JointMaps) -> Design:
    """Return one design in any form that ``trace`` takes, see ``with_motors``."""
    values = with_motors(design, maps)
    if len(values) != 1:
        raise DesignError(complaint("number of designs", len(values), "1", "give one"))
    return Design.from_array(values[0])


def _unsaid(values: NDArray[np.float64]) -> Given:
    return Given(values=values, motors=("",) * len(values))


def _is_named(given: Any) -> bool:
    """Return whether something has names of variables: a mapping, a data frame, or a row of one."""
    if is_series(given):
        return any(isinstance(label, str) for label in given.index)
    return isinstance(given, Mapping) or hasattr(given, "columns")


def _cure_of_holder(given: Any) -> str:
    """What to do with an object that has a design: one that was picked from a study has the study's motors, too."""
    if hasattr(given, "trial"):
        return "use its .design and the motors of its study, or what knows them: StoredStudy.simulate, export_trial"
    return "use its .design"


def _of_designs(designs: Sequence[Design]) -> NDArray[np.float64]:
    try:
        return np.array([one.as_array() for one in designs])
    except (TypeError, ValueError, OverflowError):
        raise DesignError("designs: must have a number for each variable; correct them") from None


def _of_columns(table: "Mapping[str, Any] | DataFrame") -> Given:
    """Return designs from one column per variable, or one value; other columns may be those of stored trials."""
    for name in table:
        if name not in _known() and not is_own(name):
            raise DesignError(f"designs: {name!r} is neither a variable nor a column of stored trials; {_near(name)}")
    if missing := [name for name in PAPER_NAMES if name not in table]:
        raise DesignError(f"designs: lack {', '.join(missing)}; add them")
    names = ALL_NAMES if any(name in table for name in KNOT_NAMES) else NAMES
    given = [table[name] if name in table else ALL_DEFAULTS[name] for name in names]
    try:
        columns = np.broadcast_arrays(*(np.atleast_1d(np.asarray(v, dtype=np.float64)) for v in given))
        values = np.column_stack(columns)
        said = [_said(table, key, len(values)) for key in MOTOR_KEYS]
    except (TypeError, ValueError, OverflowError):
        raise DesignError("designs: must have numbers, as many of each variable; correct them") from None
    return Given(values=values, motors=tuple(_label(*names) for names in zip(*said, strict=True)))


def _near(name: object) -> str:
    for known in (NAMES, _known()):
        if near := difflib.get_close_matches(str(name), known, n=1):
            return f"did you mean {near[0]!r}?"
    return "correct the name, or drop it"


def _said(table: "Mapping[str, Any] | DataFrame", key: str, count: int) -> list[str]:
    """Return what a column says of each row's motor; '' where it says nothing."""
    column = np.asarray(table.get(key, ""), dtype=object)
    return [_text(value) for value in np.broadcast_to(np.atleast_1d(column), (count,)).tolist()]


def _text(motor: Any) -> str:
    """Return the name of a motor; '' for what pandas has in place of a missing one."""
    return "" if motor is None or isinstance(motor, float) or str(motor) == "<NA>" else str(motor)


def _label(motor: str, hip: str, knee: str) -> str:
    """Return the motors of one row as ``JointMaps.label`` has them."""
    return motor_label(hip or motor or "unknown", knee or motor or "unknown") if hip or knee else motor


def own_calibration(given: Calibration) -> Calibration:
    """Return a calibration that a script made, checked as one from a file.

    A class of its own is refused, too, because no study stores its behaviour.
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
    """Return the name under which a study stores a script's calibration, which no shipped one may have."""
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
    """Return a callback, or raise ``StudyError`` if it cannot be called."""
    if callback is None or callable(callback):
        return callback
    raise StudyError(complaint("callback", callback, "a function of the progress", "give one"))


def ways_of(
    by: str | None,
    trial: int | None,
    weights: Sequence[float] | None,
    compromise: Sequence[float] | None,
    nearest: Mapping[str, float] | None,
    least: str | None,
    most: str | None,
) -> "list[selectors.Chooser]":
    """Return the ways to choose that are asked for; more than one, or an unknown one, is a ``SelectionError``."""
    from pareto_monoped.pareto import selectors

    ways: list[selectors.Chooser] = []
    if by is not None:
        if not isinstance(by, str) or by not in ("knee", "tradeoff"):
            raise SelectionError(complaint("by", by, "'knee' or 'tradeoff'", "correct it, or use another argument"))
        ways.append(selectors.Knee() if by == "knee" else selectors.Tradeoff())
    if trial is not None:
        ways.append(selectors.Trial(number=trial_of(trial)))
    if weights is not None:
        ways.append(selectors.Weights(values=numbers_of("weights", weights)))
    if compromise is not None:
        ways.append(selectors.Compromise(values=numbers_of("compromise", compromise)))
    if nearest is not None:
        if not (wish := _named("nearest", nearest)):
            raise SelectionError("nearest: names no measure; give one, such as {'height_m': 1.0}")
        ways.append(selectors.Nearest(wish=wish))
    for what, name in (("least", least), ("most", most)):
        if name is not None:
            ways.append(selectors.Extreme(name=_known_name(what, name), most=what == "most"))
    if len(ways) > 1:
        raise SelectionError(f"ways to choose = {len(ways)}: must be at most 1, with any conditions; drop the others")
    return ways


def conditions_of(
    min_height_m: float | None,
    max_energy_j: float | None,
    at_least: Mapping[str, float] | None,
    at_most: Mapping[str, float] | None,
) -> "tuple[selectors.Condition | selectors.MaxEnergy, ...]":
    """Return the conditions that are asked for; an unknown name is a ``SelectionError``."""
    from pareto_monoped.pareto import selectors

    found: list[selectors.Condition | selectors.MaxEnergy] = []
    if min_height_m is not None:
        least = number_of("min_height_m", min_height_m)
        found.append(selectors.Condition(name="height_m", side="min", value=least, asked="min_height_m"))
    if max_energy_j is not None:
        found.append(selectors.MaxEnergy(energy_j=number_of("max_energy_j", max_energy_j)))
    for name, value in _named("at_least", {} if at_least is None else at_least).items():
        found.append(selectors.Condition(name=name, side="min", value=value))
    for name, value in _named("at_most", {} if at_most is None else at_most).items():
        found.append(selectors.Condition(name=name, side="max", value=value))
    return tuple(found)


def _named(what: str, values: Any) -> dict[str, float]:
    """Return numbers of measures and variables; raise ``InputError``, or ``SelectionError`` for an unknown name."""
    numbers = table_of(what, values)
    for name in numbers:
        _known_name(what, name)
    return numbers


def _known_name(what: str, name: Any) -> str:
    from pareto_monoped.pareto.selectors import CONDITION_NAMES

    if not isinstance(name, str):
        raise SelectionError(complaint(what, name, "the name of a measure or a variable", "give one"))
    if name not in CONDITION_NAMES and not is_own(name):
        cure = near_measures(name, CONDITION_NAMES)
        raise SelectionError(f"{what} = {name!r}: must be a measure or a variable; {cure}")
    return name


def html_of(title: str, facts: Mapping[str, object]) -> str:
    """Return what notebooks show of an object: its title above a table of facts."""
    rows = "".join(
        f"<tr><th style='text-align:left'>{escape(name)}</th><td style='text-align:left'>{escape(str(value))}</td></tr>"
        for name, value in facts.items()
    )
    return f"<b>{escape(title)}</b><table>{rows}</table>"
