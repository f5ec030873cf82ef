"""The design variables, their bounds, the designs of the paper's Table I, and the names of gearbox rules.

Order and symbols of the first seven are those of the paper (section III-B): Y = [l1, l2, g_k, g_h, K, C, T]. The
others are optional: each has a default that leaves the paper's controller as it is, and a study may free them.

``VARIABLES`` has the ``Variable`` records in the order of the columns of every array of designs, and by name.
``PAPER_CASES`` has a ``PaperCase`` for each row of Table I, by its name.

Example:
    >>> from pareto_monoped import PAPER_CASES, VARIABLES
    >>> for one in VARIABLES[-2:]:
    ...     print(f"{one.name}: {one.meaning}, {one.lower:g} to {one.upper:g} {one.unit}, default {one.default:g}")
    rest_length_m: rest length of the virtual spring, 1 to 20 m, default 10
    start_height_m: height of the base above the floor at rest, 0.35 to 0.7 m, default 0.5
    >>> list(PAPER_CASES), PAPER_CASES["C"].design.thigh_length_m, PAPER_CASES["C"].height_m
    (['nominal', 'A', 'B', 'C'], 0.49, 0.8)
"""

import difflib
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import wraps
from numbers import Real
from typing import Any, Literal, Protocol, SupportsIndex, TypeVar, get_args, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pareto_monoped.errors import DesignError, InputError, complaint, unknown_name

_T = TypeVar("_T")
Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class Variable:
    """One design variable."""

    name: str  #: its name in files, flags, databases and code
    symbol: str  #: the paper's symbol
    unit: str  #: of its values and bounds
    #: lower, upper: the paper's bounds (section III-B); of an optional variable our own
    lower: float
    upper: float
    meaning: str  #: what it is, in a few words
    #: Value of an optional variable where a study does not name it; None for the paper's seven
    default: float | None = None
    label: str = field(repr=False)  #: what it is called in reports
    shown_unit: str = field(repr=False)  #: unit in reports
    decimals: int = field(repr=False)  #: decimals in reports, in the shown unit
    scale: float = field(repr=False)  #: factor from ``unit`` to the shown one
    factor: str = field(repr=False)  #: what a sensitivity calls it among what moves a design


_R = TypeVar("_R", bound="_Named")


class _Named(Protocol):
    @property
    def name(self) -> str: ...


class Records(tuple[_R, ...]):
    """Records in their order, which are also found by their names: ``VARIABLES["knee_ratio"]``."""

    __slots__ = ()

    @overload
    def __getitem__(self, key: SupportsIndex | str, /) -> _R: ...
    @overload
    def __getitem__(self, key: slice, /) -> tuple[_R, ...]: ...
    def __getitem__(self, key: SupportsIndex | str | slice, /) -> _R | tuple[_R, ...]:
        """Return the record of a name or at a place; raise ``InputError`` for a name that none has."""
        if not isinstance(key, str):
            return super().__getitem__(key)
        found = next((one for one in self if one.name == key), None)
        if found is None:
            near = difflib.get_close_matches(key, [one.name for one in self], n=1)
            raise InputError(f"name = {key!r}: is unknown; {f'did you mean {near[0]!r}?' if near else 'correct it'}")
        return found


BASE_START_HEIGHT_M = 0.5  #: Height of the base above the floor at rest (paper, section IV-B).
REST_LENGTH_M = 10.0  #: l0, rest length of the virtual spring, in a passage that the paper's final text lost.


def _variable(
    name: str,
    symbol: str,
    unit: str,
    bounds: tuple[float, float],
    meaning: str,
    label: str,
    decimals: int,
    *,
    shown: tuple[str, float] | None = None,
    factor: str = "",
    default: float | None = None,
) -> Variable:
    """Describe a variable, which is shown in its own unit unless ``shown`` gives another unit and the factor to it."""
    (lower, upper), (shown_unit, scale) = bounds, shown or (unit, 1.0)
    return Variable(
        name=name,
        symbol=symbol,
        unit=unit,
        lower=lower,
        upper=upper,
        meaning=meaning,
        default=default,
        label=label,
        shown_unit=shown_unit,
        decimals=decimals,
        scale=scale,
        factor=factor or label,
    )


_MM, _TO_ONE = ("mm", 1000.0), (": 1", 1.0)

# fmt: off
VARIABLES: Records[Variable] = Records((
    _variable("thigh_length_m", "l1", "m", (0.3, 0.5), "thigh, hip axis to knee axis", "thigh length", 1, shown=_MM,
        factor="length of the thigh"),
    _variable("shank_length_m", "l2", "m", (0.3, 0.5), "shank, knee axis to foot centre", "shank length", 1, shown=_MM,
        factor="length of the shank"),
    _variable("knee_ratio", "g_k", "1", (4.0, 8.7), "gear ratio of the knee actuator", "knee ratio", 2, shown=_TO_ONE,
        factor="gearbox of the knee"),
    _variable("hip_ratio", "g_h", "1", (4.0, 8.7), "gear ratio of the hip actuator", "hip ratio", 2, shown=_TO_ONE,
        factor="gearbox of the hip"),
    _variable("stiffness_n_per_m", "K", "N/m", (5.0, 200.0), "virtual spring", "stiffness", 1, factor="stiffness K"),
    _variable("damping_n_s_per_m", "C", "N s/m", (0.0, 10.0), "virtual damper", "damping", 2, factor="damping C"),
    _variable("torsional_stiffness_n_m_per_rad", "T", "N m/rad", (0.0, 50.0), "virtual torsional spring",
        "torsional stiffness", 2, factor="torsion T"),
    _variable("knee_release_rad", "r_k", "rad", (0.0, 1.0),
        "angle before the knee's stop over which its torque fades to zero", "knee release", 3,
        factor="release of the knee", default=0.0),
    _variable("rest_length_m", "l0", "m", (1.0, 20.0), "rest length of the virtual spring", "rest length", 2,
        default=REST_LENGTH_M),
    _variable("start_height_m", "z0", "m", (0.35, 0.7), "height of the base above the floor at rest", "start height", 0,
        shown=_MM, default=BASE_START_HEIGHT_M),
))
# fmt: on
"""The records of all design variables, the paper's seven first; each has name, unit, bounds, meaning and default."""
MOST_KNOTS = 12  #: Of a torque profile, per joint.


def _knot(joint: str, number: int) -> Variable:
    symbol, meaning = f"{joint[0]}{number}", f"knot {number} of the {joint}'s torque, as a share of its motor's peak"
    return _variable(
        f"{joint}_knot_{number}", symbol, "1", (-1.0, 1.0), meaning, f"{joint} knot {number}", 3, default=0.0
    )


KNOTS: tuple[Variable, ...] = (
    _variable("push_time_s", "t_p", "s", (0.1, 0.6), "time from the first knot to the last", "push time", 0,
        shown=("ms", 1000.0), default=0.3),
    *(_knot(joint, number) for joint in ("hip", "knee") for number in range(1, MOST_KNOTS + 1)),
)  # fmt: skip
"""The records of the variables of torque profiles (``jump.laws``), of which a study has those that its controller
names; for all others they are out of use, at their defaults."""
ALL_NAMES: tuple[str, ...] = tuple(variable.name for variable in (*VARIABLES, *KNOTS))
"""In the order of the columns of arrays of designs with torque profiles."""
NAMES: tuple[str, ...] = tuple(variable.name for variable in VARIABLES)
"""In the order of the columns of arrays of designs without."""
KNOT_NAMES: tuple[str, ...] = tuple(variable.name for variable in KNOTS)
"""Of torque profiles: the push time, the knots of the hip, then those of the knee."""
PAPER_NAMES: tuple[str, ...] = tuple(variable.name for variable in VARIABLES if variable.default is None)
"""The names of the paper's seven, which come first."""
DEFAULTS: dict[str, float] = {v.name: v.default for v in VARIABLES if v.default is not None}
"""Optional variable -> its default."""
ALL_DEFAULTS = DEFAULTS | {v.name: v.default for v in KNOTS if v.default is not None}
"""The same with the variables of torque profiles."""
LENGTHS = ("thigh_length_m", "shank_length_m")
RATIOS = ("knee_ratio", "hip_ratio")
PAPER_CONTROL = ("stiffness_n_per_m", "damping_n_s_per_m", "torsional_stiffness_n_m_per_rad")
"""K, C and T of the virtual controller."""
CONTROL = (*PAPER_CONTROL, *DEFAULTS)  #: Everything that a jump needs besides the robot.
LOWER: Floats = np.array([variable.lower for variable in VARIABLES if variable.default is None])
UPPER: Floats = np.array([variable.upper for variable in VARIABLES if variable.default is None])
"""The paper's bounds of its seven variables, shape (7,)."""
LOWER.flags.writeable = False
UPPER.flags.writeable = False

MOST = 1e9  #: Beyond this value of any variable, numbers overflow.
_SHORTEST_M = 0.05  #: Of a link or start; a shorter link has no room for the actuators' output couplings.
LEAST: Floats = np.array(
    [
        *(_SHORTEST_M if n in (*LENGTHS, "start_height_m") else 1.0 if n in RATIOS else 0.0 for n in NAMES),
        *(-MOST for _ in KNOT_NAMES),  # motors have limits of their own, and an own law means what it likes
    ]
)  #: The least value of each variable that a design can mean; a ratio of 1 is no gearbox. Shape (number of variables,).
LEAST.flags.writeable = False


def in_use(values: Mapping[str, ArrayLike]) -> tuple[Variable, ...]:
    """Return the paper's seven variables and the optional ones that differ from their defaults anywhere in a table."""
    return tuple(
        variable
        for variable in (*VARIABLES, *KNOTS)
        if variable.default is None
        or (variable.name in values and bool(np.any(np.asarray(values[variable.name]) != variable.default)))
    )


def complete(designs: ArrayLike) -> Floats:
    """Return designs with a column for each variable, of which optional ones may have been left out at their defaults.

    ``designs`` has shape (..., 7), the paper's variables, or a column for each of ``NAMES`` or ``ALL_NAMES``, in this
    order; these stay as they are.

    Raises:
        DesignError: another number of values.
    """
    values = np.asarray(designs, dtype=np.float64)
    given = values.shape[-1] if values.ndim else 0
    if given in (len(NAMES), len(ALL_NAMES)):
        return values
    if given != len(PAPER_NAMES):
        allowed = f"(..., {len(PAPER_NAMES)}) or (..., {len(NAMES)})"
        raise DesignError(
            complaint("shape of designs", values.shape, allowed, f"give {', '.join(NAMES)} in this order")
        )
    optional = np.broadcast_to(list(DEFAULTS.values()), (*values.shape[:-1], len(DEFAULTS)))
    return np.concatenate([values, optional], axis=-1)


def designs_of(table: Any) -> Floats:
    """Return designs, shape (n, number of variables), from a table with a column per variable.

    Optional variables that the table leaves out have their defaults; those of torque profiles are there if it has one.
    """
    count = len(table[PAPER_NAMES[0]])
    names = ALL_NAMES if any(name in table for name in KNOT_NAMES) else NAMES
    given = [table[name] if name in table else np.full(count, ALL_DEFAULTS[name]) for name in names]
    return np.column_stack([np.asarray(column, dtype=np.float64) for column in given])


def table_of(designs: Floats) -> dict[str, Floats]:
    """Return name -> values, shape (n,), of all of ``VARIABLES`` and of those of ``KNOTS`` that are in use."""
    columns = dict(zip(ALL_NAMES, designs.T, strict=False))
    used = {variable.name for variable in in_use(columns)}
    return {name: values for name, values in columns.items() if name in NAMES or name in used}


def complete_control(control: ArrayLike) -> Floats:
    """Return values of ``CONTROL`` and ``KNOT_NAMES``, shape (n, 31), from the first 3, 6 or all of them."""
    values = np.atleast_2d(np.asarray(control, dtype=np.float64))
    missing = [ALL_DEFAULTS[name] for name in (*CONTROL, *KNOT_NAMES)[values.shape[1] :]]
    return np.concatenate([values, np.broadcast_to(missing, (len(values), len(missing)))], axis=1)


def columns(designs: ArrayLike, names: Sequence[str]) -> Floats:
    """Return a C-ordered copy of some variables' values, such as ``CONTROL``; for ``designs`` see ``complete``."""
    return np.take(complete(designs), [ALL_NAMES.index(name) for name in names], axis=-1)


def control_of(designs: ArrayLike) -> Floats:
    """Return what a jump needs besides the robot: columns of ``CONTROL`` and of a torque profile, if there is one."""
    values = complete(designs)
    return np.concatenate([columns(values, CONTROL), values[..., len(NAMES) :]], axis=-1)


def nonsense(name: str, value: float) -> str | None:
    """Return what is wrong with a value that no design can mean; the paper's bounds play no part. None if it is one."""
    if not np.isfinite(value):
        return complaint(name, float(value), "a finite number", "give a number")
    least = LEAST[ALL_NAMES.index(name)]
    if value < least:
        return f"{name} = {value:g}: must be at least {least:g}; give a larger value"
    return f"{name} = {value:g}: must be at most {MOST:g}; give a smaller value" if value > MOST else None


def _number(name: str, given: object) -> float:
    """Return a value that a design can mean, or raise ``DesignError``."""
    if isinstance(given, bool) or not isinstance(given, Real):
        raise DesignError(complaint(name, given, "a finite number", "give a number"))
    try:
        value = float(given)
    except OverflowError:  # a whole number beyond the greatest float
        value = math.inf
    if (problem := nonsense(name, value)) is not None:
        raise DesignError(problem)
    return value


def _checked(kind: type[_T]) -> type[_T]:
    """Wrap the class so that unknown or missing names and values that nobody can mean are our own errors."""
    made = kind.__init__

    @wraps(made)
    def checked(self: _T, **values: Any) -> None:
        profile = values.pop("profile", ())
        values |= dict(zip(KNOT_NAMES, profile, strict=False))
        for name in values:
            if name not in ALL_NAMES:
                raise DesignError(unknown_name("design variable", name, NAMES))
        if missing := [name for name in PAPER_NAMES if name not in values]:
            raise DesignError(f"design: lacks {', '.join(missing)}; add them")
        numbers = {name: _number(name, value) for name, value in values.items()}
        knots = tuple(numbers.pop(name, ALL_DEFAULTS[name]) for name in KNOT_NAMES) if len(values) > len(NAMES) else ()
        made(self, **numbers, profile=knots)  # type: ignore[call-arg]  # of the class itself

    kind.__init__ = checked  # type: ignore[assignment, method-assign]  # replaced on purpose
    return kind


@_checked
@dataclass(frozen=True, slots=True, kw_only=True)
class Design:
    """One design: a value for each variable, in the order of ``NAMES``; optional ones have defaults.

    Those of a torque profile are given by their names, too, and kept together in ``profile``.

    The paper's bounds play no part, but values that nobody can mean are a ``DesignError``: links and starts of less
    than 0.05 m, gear ratios below 1, negative stiffness, damping or release, and what is no finite number.

    Example:
        >>> from pareto_monoped import PAPER_CASES
        >>> longer = PAPER_CASES["C"].design.replace({"thigh_length_m": 0.45})
        >>> longer.thigh_length_m, longer.rest_length_m
        (0.45, 10.0)
    """

    thigh_length_m: float
    shank_length_m: float
    knee_ratio: float
    hip_ratio: float
    stiffness_n_per_m: float
    damping_n_s_per_m: float
    torsional_stiffness_n_m_per_rad: float
    knee_release_rad: float = 0.0
    rest_length_m: float = REST_LENGTH_M
    start_height_m: float = BASE_START_HEIGHT_M
    profile: tuple[float, ...] = field(default=(), repr=False)  #: in the order of ``KNOT_NAMES``

    def as_array(self) -> Floats:
        """Return the values in the order of ``NAMES``, shape (10,), or with a profile of ``ALL_NAMES``, shape (35,)."""
        return np.array([*(getattr(self, name) for name in NAMES), *self.profile], dtype=np.float64)

    def as_dict(self) -> dict[str, float]:
        """Return the values by name: the paper's seven, and the optional ones that differ from their defaults."""
        values = dict(zip(ALL_NAMES, self.as_array().tolist(), strict=False))
        return {name: value for name, value in values.items() if value != ALL_DEFAULTS.get(name)}

    @classmethod
    def from_array(cls, values: ArrayLike) -> "Design":
        """Return a design from its values in the order of ``NAMES``.

        Raises:
            DesignError: a wrong number of values, or a value that no design can mean.
        """
        try:
            array = np.asarray(values, dtype=np.float64)
        except (TypeError, ValueError, OverflowError):
            raise DesignError(complaint("design", values, "a number for each variable", "correct it")) from None
        if array.ndim != 1:
            shape = f"({len(PAPER_NAMES)},) or ({len(NAMES)},)"
            raise DesignError(complaint("shape of a design", array.shape, shape, "give one design"))
        return cls(**dict(zip(ALL_NAMES, complete(array).tolist(), strict=False)))

    def replace(self, changes: Mapping[str, float] | None = None, /, **more: float) -> "Design":
        """Return a copy with some variables changed, which are named in a mapping, or one by one.

        Raises:
            DesignError: an unknown name, or a value that no design can mean.

        Example:
            >>> from pareto_monoped import PAPER_CASES
            >>> PAPER_CASES["C"].design.replace(knee_ratio=6.0).knee_ratio
            6.0
        """
        changes = {} if changes is None else changes
        if not isinstance(changes, Mapping):
            allowed = "a mapping of variables to numbers, such as {'knee_ratio': 6.0}"
            raise DesignError(complaint("changes of a design", changes, allowed, "give one"))
        changes = {**changes, **more}
        for name in changes:
            if name not in ALL_NAMES:
                raise DesignError(unknown_name("design variable", name, NAMES))
        return Design(**(dict(zip(ALL_NAMES, self.as_array().tolist(), strict=False)) | dict(changes)))


@dataclass(frozen=True, slots=True, kw_only=True)
class PaperCase:
    """One row of the paper's Table I."""

    name: str  #: of the row, as the paper has it
    design: Design  #: its variables
    #: height_m, energy_j: what the authors report for it
    height_m: float
    energy_j: float
    free: tuple[str, ...]  #: the variables that the paper's optimisation could change (section IV-B)


class _Cases(dict[str, PaperCase]):
    """The rows of the paper's Table I by name, see ``PAPER_CASES``; an unknown name is a ``DesignError``.

    Example:
        >>> from pareto_monoped import PAPER_CASES
        >>> [f"{name}: {case.height_m} m for {case.energy_j} J" for name, case in PAPER_CASES.items()][1:3]
        ['A: 0.743 m for 15.51 J', 'B: 0.771 m for 17.02 J']
    """

    def __missing__(self, name: object) -> PaperCase:
        raise DesignError(unknown_name("case", name, self))


def _case(name: str, values: tuple[float, ...], height_m: float, energy_j: float, free: tuple[str, ...]) -> PaperCase:
    return PaperCase(name=name, design=Design.from_array(values), height_m=height_m, energy_j=energy_j, free=free)


# Table I of the paper. The paper prints g_h before g_k; here the values stand in the order of NAMES.
PAPER_CASES: Mapping[str, PaperCase] = _Cases(
    {
        "nominal": _case("nominal", (0.400, 0.400, 6.0, 6.0, 50.0, 2.5, 10.0), 0.887, 31.44, ()),
        "A": _case("A", (0.400, 0.400, 7.9, 4.0, 13.7, 6.5, 46.5), 0.743, 15.51, RATIOS + PAPER_CONTROL),
        "B": _case("B", (0.499, 0.346, 6.0, 6.0, 8.9, 1.0, 6.9), 0.771, 17.02, LENGTHS + PAPER_CONTROL),
        "C": _case("C", (0.490, 0.360, 6.0, 4.0, 7.9, 2.2, 8.4), 0.800, 15.36, LENGTHS + RATIOS + PAPER_CONTROL),
    }
)
"""The rows of the paper's Table I by name: ``nominal``, ``A``, ``B`` and ``C``; each has its ``design``, and the height
and energy that the authors report."""
PAPER_MOTOR = "VT8020"  #: The motor of all rows of Table I; the default wherever a motor may be named.
RuleSet = Literal["paper", "iso6336"]
"""Rules that gearboxes are chosen by, see ``actuator.settings.ActuatorSettings``."""
RULE_SETS: tuple[RuleSet, ...] = get_args(RuleSet)
DEFAULT_RULES: RuleSet = "iso6336"  #: Where none are named. Studies stored without rules were made with ``paper``.
HEADLINE_HEIGHT_M = PAPER_CASES["C"].height_m  #: Height at which a front's least energy is quoted: that of Case C.
GRAVITY_M_PER_S2 = 9.81  #: The default of MuJoCo, also used for the paper's m g.


ConstraintName = Literal[
    "meshing", "no_interference", "teeth_min", "tip_thickness", "gearbox_diameter", "ring_root", "root_fillet",
    "sun_rim", "planet_rim", "ring_rim", "ring_interference", "contact_ratio", "within_stator", "bearing",
    "bearing_room", "face_width", "flank_strength", "root_strength", "overload_strength", "output_bearing",
    "planet_bearing",
]  # fmt: skip
"""Names of ``rules.CONSTRAINTS``, here for settings and commands that only check names."""
CONSTRAINT_NAMES: tuple[ConstraintName, ...] = get_args(ConstraintName)
