"""Objectives and constraints of the user's own: plain functions of a table of jumps, evaluated with every generation.

A database stores a function's name and its values, never the function: who continues a study brings it again, as well
as an algorithm or calibration of the user's own.
"""

import difflib
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, cast

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike, NDArray

from pareto_monoped.design import ALL_NAMES, complete, designs_of
from pareto_monoped.errors import StudyError, complaint
from pareto_monoped.jump.calibration import Calibration
from pareto_monoped.jump.evaluate import Evaluations
from pareto_monoped.measures import MEASURE_NAMES, OWN, is_own
from pareto_monoped.search.algorithm import Floats

OwnFunction = Callable[[Mapping[str, NDArray[Any]]], Any]
"""A function of a table of jumps, to values of shape (n,)."""
Functions = Mapping[str, OwnFunction]
"""Name of an own measure, such as "own_landing_speed" -> its function."""

_CHECKED = 8
"""Stored trials that are computed anew before a study goes on; our own choice."""
_SAME = 1e-9
"""Relative difference up to which a value is the stored one: NumPy may round an array of another length otherwise."""

_SAME_NEAR_ZERO = 1e-12
"""Difference up to which a value near zero is the same; our own choice, above what rounding leaves of a difference."""


class Jumps(dict[str, NDArray[Any]]):
    """Name of each variable and measure -> values of n jumps, shape (n,), NaN where the jump failed."""

    def __missing__(self, name: str) -> NDArray[Any]:
        """Refuse an unknown name."""
        near = difflib.get_close_matches(str(name), self, n=1)
        cure = f"did you mean {near[0]!r}?" if near else f"choose from {', '.join(self)}"
        raise StudyError(f"jumps: {name!r} is neither a variable nor a measure; {cure}")


@dataclass(frozen=True, slots=True, kw_only=True)
class OwnEvaluations(Evaluations):
    """Results of n designs, and what own functions make of them."""

    jumps: Evaluations  #: the results
    #: Values of the functions by the names of their measures, each of shape (n,); NaN where the jump failed
    own: Mapping[str, Floats]

    def of(self, name: str) -> Floats:
        """Return the measure of that name, shape (n,)."""
        return self.own[name] if name in self.own else self.jumps.of(name)

    def as_columns(self) -> dict[str, NDArray[np.generic]]:
        """Return column name -> values of shape (n,), ``status`` and ``reason`` first, own functions last."""
        return self.jumps.as_columns() | dict(self.own)


def with_functions(evaluate: Callable[..., Evaluations], functions: Functions) -> Callable[..., Evaluations]:
    """Return what evaluates a study's trials and its own functions; the first generation shows if these mix jumps."""
    if not functions:
        return evaluate
    unchecked = dict(functions)

    def evaluated(designs: ArrayLike, *motors: ArrayLike) -> Evaluations:
        jumps = evaluate(designs, *motors)
        columns = jumps.as_columns()
        table = Jumps({name: columns[name] for name in MEASURE_NAMES})
        table |= dict(zip(ALL_NAMES, np.atleast_2d(complete(designs)).T, strict=False))
        failed = ~jumps.ok
        own = {name: np.where(failed, np.nan, called(function, table, failed)) for name, function in functions.items()}
        for name in [*unchecked] if np.count_nonzero(~failed) > 1 else []:
            _refuse_mixing(unchecked.pop(name), table, own[name])
        given = {name: getattr(jumps, name) for name in Evaluations.__dataclass_fields__}
        return OwnEvaluations(**given, jumps=jumps, own=own)

    return evaluated


def called(function: OwnFunction, table: Jumps, failed: NDArray[np.bool_]) -> Floats:
    """Return the values of an own function, shape (n,); refuse all but numbers, finite where the jump did not fail."""
    n, source = len(failed), f"own function {name_of(function)!r}"
    try:
        # A copy of the table: what a function changes must not reach the database.
        given = np.asarray(function(Jumps({name: column.copy() for name, column in table.items()})))
        if given.dtype.kind not in "biufO":  # complex numbers would lose their imaginary part, texts be read
            raise StudyError(f"returns {given.dtype}; it must return {n} numbers that are real")
        values = given.astype(np.float64)
    except StudyError as error:
        raise StudyError(f"{source}: {error}") from error
    except Exception as error:
        words = re.sub(r"\s+", " ", f"{type(error).__name__}: {error}")
        raise StudyError(f"{source}: {words}; {_cure(error, table, n)}") from error
    if _has_truth(given):
        raise StudyError(f"{source} = bool: must return numbers; a constraint holds where its value is <= 0")
    if values.shape != (n,):
        raise StudyError(complaint(f"shape of {source}", values.shape, f"({n},)", "return one value per jump"))
    if not np.isfinite(values[~failed]).all():
        raise StudyError(f"{source}: must be finite where the jump did not fail; correct it")
    return values


def _refuse_mixing(function: OwnFunction, table: Jumps, values: Floats) -> None:
    """Refuse a function that takes a jump's value from other jumps, too; ask it of the first and the last one."""
    jumped = np.flatnonzero(np.isfinite(values))
    for k in (jumped[0], jumped[-1]):
        alone = Jumps({name: column[k : k + 1] for name, column in table.items()})
        (value,) = called(function, alone, np.zeros(1, dtype=bool))
        if not np.isclose(value, values[k], rtol=_SAME, atol=_SAME_NEAR_ZERO):
            raise StudyError(
                f"own function {name_of(function)!r}: gives {values[k]:.9g} for a jump among {len(values)} and "
                f"{value:.9g} for the same jump alone; compute each value from its own jump"
            )


def _has_truth(given: NDArray[Any]) -> bool:
    """Return whether an answer has True or False in it, which as 1 or 0 would mean the opposite in a constraint."""
    return given.dtype == np.bool_ or (given.dtype == object and any(isinstance(one, bool) for one in given.flat))


def _cure(error: Exception, table: Jumps, n: int) -> str:
    """Return what to do about an error of an own function."""
    if isinstance(error, AttributeError) and isinstance(error.obj, Jumps):
        near = difflib.get_close_matches(str(error.name), table, n=1)
        return f'take measures by name: jumps["{near[0] if near else MEASURE_NAMES[0]}"]'
    if "truth value of a" in str(error):
        return "use numpy.where instead of if, and & and | instead of and and or"
    return f"it must return {n} numbers"


def name_of(function: object) -> str:
    """Return what a function is called."""
    return str(getattr(function, "__name__", type(function).__name__))


def own_name(function: object) -> str:
    """Return the name of the measure that a function is; refuse one that cannot be stored, such as a lambda's."""
    if not callable(function) or isinstance(function, type):
        allowed = "the name of a measure or a function of the jumps"
        raise StudyError(complaint("objective or constraint", function, allowed, "give one of these"))
    name = f"{OWN}{getattr(function, '__name__', '')}"
    if not is_own(name):
        shown = getattr(function, "__name__", type(function).__name__)
        raise StudyError(
            f"own function {shown!r}: its name is stored with the study, and must have letters, digits and '_' only; "
            "define it with def"
        )
    return name


def listed(what: str, given: Any) -> Sequence[Any]:
    """Return functions as a list; one alone is a list of one."""
    if callable(given):
        return [given]
    if isinstance(given, str | Mapping) or not isinstance(given, Sequence):
        raise StudyError(complaint(what, given, "a function of the jumps, or a list of these", "give one"))
    return given


def functions_of(given: Sequence[object]) -> dict[str, OwnFunction]:
    """Return functions by the names of their measures, each of which may be used once."""
    found: dict[str, OwnFunction] = {}
    for function in given:
        name = own_name(function)
        others = {known.lower(): known for known in found}  # SQLite does not tell A from a in the names of columns
        # Compared by value: a method is another object each time that it is asked for.
        if found.get(others.get(name.lower(), ""), function) != function:
            raise StudyError(f"own function {name_of(function)!r}: is the name of two functions; rename one")
        found[name] = cast(OwnFunction, function)  # whether it can be called has been asked for its name
    return found


def require_functions(names: Sequence[str], functions: Functions, source: str) -> None:
    """Refuse to go on without the functions that a study names, or with others; say how to give them."""
    if lacking := [name.removeprefix(OWN) for name in names if name not in functions]:
        raise StudyError(
            f"{source}: needs {', '.join(lacking)}, which only your program has; go on from Python: "
            f"pareto_monoped.resume(db, functions=[{_listed(names)}])"
        )
    if unknown := [name.removeprefix(OWN) for name in functions if name not in names]:
        raise StudyError(f"{source}: knows no own function {unknown[0]!r}; it has {_listed(names)}")


def refuse_other_functions(trials: pd.DataFrame, functions: Functions, source: str) -> None:
    """Refuse functions that give other values than those stored, in some trials from the first to the last."""
    jumped = trials[trials["status"] == "ok"]
    rows = jumped.iloc[np.unique(np.linspace(0, len(jumped) - 1, min(_CHECKED, len(jumped))).astype(int))]
    table = Jumps({name: rows[name].to_numpy(dtype=np.float64) for name in MEASURE_NAMES})
    table |= dict(zip(ALL_NAMES, designs_of(rows).T, strict=False))
    for name, function in functions.items() if len(rows) else ():
        now = called(function, table, np.zeros(len(rows), dtype=bool))
        stored = rows[name].to_numpy(dtype=np.float64)
        for k in np.flatnonzero(~np.isclose(now, stored, rtol=_SAME, atol=0.0))[:1]:
            raise StudyError(
                f"{source}: own function {name_of(function)!r} gives {now[k]:.9g} for trial "
                f"{int(rows['trial'].iloc[k])}, where {stored[k]:.9g} is stored; give the function that it began with"
            )


def _listed(names: Sequence[str]) -> str:
    return ", ".join(name.removeprefix(OWN) for name in names) or "none"


@dataclass(frozen=True, slots=True, kw_only=True)
class Own:
    """What is the user's own."""

    functions: Functions = field(default_factory=dict)  #: objectives and constraints
    algorithm: Any = None  #: with ``ask`` and ``tell``, or what makes one; see ``own_algorithm``
    #: Of a new study, whose values its database then has; None: the one that the study names
    calibration: Calibration | None = None


NOTHING = Own()
"""What the command line brings along."""
