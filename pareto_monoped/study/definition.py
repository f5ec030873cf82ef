"""The definition of a study and its TOML file: variables, motor, calibration, constraints, algorithm, budget, seed."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from os import PathLike, fspath
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import ConfigDict, Field

from pareto_monoped.config import checked, read_toml
from pareto_monoped.design import DEFAULTS, LENGTHS, NAMES, PAPER_CASES, VARIABLES, RuleSet
from pareto_monoped.errors import StudyError, complaint, unknown_name
from pareto_monoped.jump.calibration_defaults import rules_for, strength_for
from pareto_monoped.measures import SHARE_MEASURES, is_own, is_robust
from pareto_monoped.pareto.indicators import ReferencePoint
from pareto_monoped.pareto.objectives import HEIGHT_AND_ENERGY, Objectives
from pareto_monoped.strength.groups import GROUP_MEASURES
from pareto_monoped.study.algorithm_settings import (
    ALGORITHMS,
    DEFAULT_ALGORITHM,
    OWN_ALGORITHM,
    AlgorithmSettings,
    OwnSettings,
    WeightedSettings,
)
from pareto_monoped.study.goals import (
    LEAST_SAFETY,
    Constraints,
    constraints_of,
    corner_of,
    flattened,
    objectives_of,
    stored_objectives,
)
from pareto_monoped.study.named_motors import MOTOR_KEYS, Named, all_names, kits_of, named_motors, text_of
from pareto_monoped.study.weighted_budget import within_budget
from pareto_monoped.uncertainty.settings import Sampling, sampling_of

NO_STRENGTH = "strength was not asked for: designs may not hold"
"""What every output says of a study without ``Study.strength``; those of earlier versions are among them."""

Positive = Annotated[float, Field(gt=0.0, allow_inf_nan=False)]


@dataclass(frozen=True, slots=True, kw_only=True)
class Bounds:
    """Range of a free variable."""

    lower: float
    upper: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Stop:
    """Conditions that end a study before its budget is used up.

    Attributes:
        wall_time_s: longest running time, over all sessions.
        plateau_evaluations, plateau_growth: end when the hypervolume has grown by less than the share
            ``plateau_growth`` during the last ``plateau_evaluations`` evaluations.
    """

    __pydantic_config__ = ConfigDict(extra="forbid")

    wall_time_s: Positive | None = None
    plateau_evaluations: Annotated[int, Field(ge=1)] | None = None
    plateau_growth: Annotated[float, Field(ge=0.0, le=1.0)] = 0.001


@dataclass(frozen=True, slots=True, kw_only=True)
class _File:
    """Keys of a study file; its tables but ``stop``, the motors and the objectives are checked separately."""

    __pydantic_config__ = ConfigDict(extra="forbid")

    name: Annotated[str, Field(min_length=1, max_length=200)]
    description: Annotated[str, Field(max_length=2000)] = ""
    case: Literal["A", "B", "C"] | None = None
    motor: Any = None
    hip_motor: Any = None
    knee_motor: Any = None
    calibration: Annotated[str, Field(min_length=1, max_length=1000)] = "reference"
    rules: RuleSet = "paper"  # of a stored study; a file without it takes the default of ``rules_for``
    evaluations: Annotated[int, Field(ge=1, le=100_000_000)]
    seed: Annotated[int, Field(ge=0, lt=2**63)] = 1
    variables: dict[str, Any] = field(default_factory=dict)
    objectives: Any = None
    constraints: dict[str, Any] = field(default_factory=dict)
    reference_point: dict[str, Any] = field(default_factory=dict)
    stop: Stop = field(default_factory=Stop)
    audit: bool = True
    strength: bool = False  # of a stored study; a file without it takes the default of ``strength_for``
    gear_list: bool = False  # of a stored study; a file without it searches the list
    uncertainty: dict[str, Any] | None = None
    algorithm: dict[str, Any] = field(default_factory=dict)


@dataclass(frozen=True, slots=True, kw_only=True)
class Study:
    """A complete study. Each variable is either free within ``Bounds`` or fixed to a number.

    ``motor`` is the name or file of the motor of both joints, or a tuple of several from which each design has one. It
    is None where ``hip_motor`` and ``knee_motor`` say the same of either joint.
    ``rules`` are those of the gearboxes, see ``actuator.settings``. ``audit`` says whether the front is audited when
    the study ends; ill-conditioned designs then leave it. ``strength`` says whether a feasible design must hold: every
    measure of strength is then constrained. ``gear_list`` says whether a free gear ratio goes through the list of
    gearboxes, and a stored design has their real ratios; else it is any ratio, as up to version 0.2.0. ``uncertainty``
    is there where the file has such a table, or an objective or a constraint is of jumps under uncertainty.

    Example:
        >>> from pareto_monoped import Study
        >>> study = Study.define(name="mine", motor="U8", evaluations=400, constraints={"mass_kg": {"max": 4.0}})
        >>> study.objectives.names, study.constraints.value("max_mass_kg")
        (('height_m', 'energy_j'), 4.0)
    """

    name: str
    description: str
    case: str | None
    motor: Named
    hip_motor: Named = None
    knee_motor: Named = None
    calibration: str
    rules: RuleSet = "paper"
    evaluations: int
    seed: int
    variables: Mapping[str, Bounds | float]
    objectives: Objectives
    constraints: Constraints
    reference_point: ReferencePoint
    stop: Stop
    audit: bool
    strength: bool = False
    gear_list: bool = False
    uncertainty: Sampling | None = None
    algorithm: AlgorithmSettings

    @classmethod
    def from_toml(cls, path: str | PathLike[str], **changes: Any) -> "Study":
        """The study in a TOML file, with other values for some of its keys.

        Args:
            path: the file.
            changes: as for ``define``.

        Raises:
            StudyError: no readable TOML, an unknown key, a wrong type, or impossible bounds.

        Example:
            >>> from pareto_monoped import Study
            >>> Study.from_toml("studies/case_c.toml", evaluations=400).name
            'case_c'
        """
        if not isinstance(path, str | PathLike) or not isinstance(fspath(path), str):
            raise StudyError(complaint("study file", path, "text or a path", "give one"))
        return filled(file_values(Path(path)) | changes, source=f"study file {str(path)!r}")

    @classmethod
    def define(cls, **values: Any) -> "Study":
        """A study from the keys of a study file, such as ``motor="U8"`` or ``constraints={"mass_kg": {"max": 4.0}}``.

        Args:
            values: the keys. ``name`` and ``evaluations`` are required; the others have the defaults of a study file.
                Tables are mappings, and an algorithm may be a name.

        Raises:
            StudyError: an unknown key, a wrong type, or impossible bounds.

        Example:
            >>> from pareto_monoped import Study
            >>> study = Study.define(name="mine", evaluations=200, objectives=["height_m", "electrical_energy_j"])
            >>> study.free[0]
            'thigh_length_m'
        """
        return filled(dict(values), source="study")

    @property
    def motors(self) -> tuple[str, ...]:
        """Names or files of all motors, those of the hip first."""
        return all_names(self.motor, self.hip_motor, self.knee_motor)

    @property
    def kits(self) -> tuple[tuple[str, str], ...]:
        """The motors of hip and knee, named as in ``motors``, that a design may have."""
        return kits_of(self.motor, self.hip_motor, self.knee_motor)

    @property
    def motor_text(self) -> str:
        """All motors in one line."""
        return text_of(self.motor, self.hip_motor, self.knee_motor)

    @property
    def motor_choices(self) -> tuple[str, ...]:
        """The keys of the file that name several motors, of ``motor``, ``hip_motor`` and ``knee_motor``."""
        return tuple(key for key in MOTOR_KEYS if isinstance(getattr(self, key), tuple))

    @property
    def robust_names(self) -> tuple[str, ...]:
        """The measures under uncertainty that each trial has, which are those asked for and the shares of jumps."""
        asked = [name for name in (*self.objectives.names, *self.constraints.measures) if is_robust(name)]
        shares = [entry.name for entry in SHARE_MEASURES] if asked else []
        return tuple(dict.fromkeys((*shares, *asked)))

    @property
    def own_names(self) -> tuple[str, ...]:
        """The measures that are functions of the user's own, such as "own_landing_speed", each once."""
        asked = (*self.objectives.names, *self.constraints.measures)
        return tuple(dict.fromkeys(name for name in asked if is_own(name)))

    @property
    def least_safeties(self) -> dict[str, float]:
        """Each measure of strength -> what it must be for a jump not to overload a part."""
        return {name: self.constraints.value(f"min_{name}") or LEAST_SAFETY for name in GROUP_MEASURES.values()}

    @property
    def free(self) -> tuple[str, ...]:
        """Names of the free variables, in the order of ``NAMES``."""
        return tuple(name for name in NAMES if isinstance(self.variables[name], Bounds))

    @property
    def lower(self) -> NDArray[np.float64]:
        """Lower bound of each variable, or its fixed value; in the order of ``NAMES``."""
        return np.array([v.lower if isinstance(v, Bounds) else v for v in self._ordered()])

    @property
    def upper(self) -> NDArray[np.float64]:
        """Upper bound of each variable, or its fixed value; in the order of ``NAMES``."""
        return np.array([v.upper if isinstance(v, Bounds) else v for v in self._ordered()])

    def _ordered(self) -> list[Bounds | float]:
        return [self.variables[name] for name in NAMES]

    def as_dict(self) -> dict[str, Any]:
        """The study as plain values in the form of its file; ``study_from_dict`` reads it back.

        Left out are keys of motors that say nothing, optional variables at their defaults, limits that are off and came
        later, the rules ``paper``, strength that is not asked for, a list of gearboxes that is not searched, and
        uncertainty where nothing is said of it. The paper's objectives stand as 0.1.0 stored them. So studies stored
        before there were others keep their hash.
        """
        plain = asdict(self)
        if self.rules == "paper":
            del plain["rules"]
        if not self.strength:
            del plain["strength"]
        if not self.gear_list:
            del plain["gear_list"]
        if self.uncertainty is None:
            del plain["uncertainty"]
        else:
            plain["uncertainty"] = self.uncertainty.as_dict()
        for key in MOTOR_KEYS:
            if plain[key] is None:
                del plain[key]
        plain["variables"] = {
            name: asdict(v) if isinstance(v, Bounds) else v
            for name, v in zip(NAMES, self._ordered(), strict=True)
            if v != DEFAULTS.get(name)
        }
        plain["objectives"] = stored_objectives(self.objectives)
        plain["constraints"] = self.constraints.as_dict()
        plain["reference_point"] = self.reference_point.as_dict()
        return plain


def load_study(
    path: Path,
    *,
    evaluations: int | None = None,
    seed: int | None = None,
    objectives: Sequence[str] | None = None,
    strength: bool | None = None,
) -> Study:
    """The study in a TOML file.

    Args:
        path: the file.
        evaluations: budget to use instead of the one in the file.
        seed: seed to use instead of the one in the file.
        objectives: measures to use instead of those in the file; what its reference point says of others is left out.
        strength: whether designs must hold, instead of what the file says.

    Raises:
        StudyError: an unknown key, a wrong type, impossible bounds, a budget that ends before the last weight of a
            weighted search, or no readable TOML.
    """
    values = file_values(path)
    if evaluations is not None:
        values["evaluations"] = evaluations
    if seed is not None:
        values["seed"] = seed
    if strength is not None:
        values["strength"] = strength
    if objectives is not None:
        values = with_objectives(values, objectives)
    return filled(values, source=f"study file {str(path)!r}")


def with_objectives(values: Mapping[str, Any], objectives: Sequence[str]) -> dict[str, Any]:
    """The keys of a study file with other objectives; what its reference point says of others is left out."""
    changed = dict(values) | {"objectives": list(objectives)}
    if isinstance(corner := values.get("reference_point"), dict):
        changed["reference_point"] = {name: value for name, value in flattened(corner).items() if name in objectives}
    return changed


def file_values(path: Path) -> dict[str, Any]:
    """The keys of a study file. Paths in it are relative to it, so that a folder with both can be moved.

    Raises:
        StudyError: no readable TOML.
    """
    return with_paths(read_toml(path, what="study file", error=StudyError), path.parent)


def with_paths(values: Mapping[str, Any], folder: Path) -> dict[str, Any]:
    """Keys of a study file with the files of motors and calibrations, named relative to ``folder``, as full paths."""

    def resolved(name: Any) -> Any:
        file = isinstance(name, str) and name.endswith(".toml")
        return str((folder / name).resolve()) if file else name

    changed = dict(values)
    for key in (*MOTOR_KEYS, "calibration"):
        if key in changed:
            given = changed[key]
            changed[key] = [resolved(name) for name in given] if isinstance(given, list) else resolved(given)
    return changed


def filled(values: dict[str, Any], *, source: str) -> Study:
    """The study of a file's keys, with the defaults of a file where they say nothing.

    Raises:
        StudyError: an unknown key, a wrong type, or impossible bounds.
    """
    calibration = str(values.get("calibration"))
    defaults = {"rules": rules_for(calibration), "strength": strength_for(calibration), "gear_list": True}
    values = defaults | values
    if isinstance(name := values.get("algorithm"), str):
        values["algorithm"] = {"name": name}
    study = study_from_dict(values, source=source)
    given = "iterations" in values.get("algorithm", {})
    return replace(study, algorithm=within_budget(study.algorithm, study.evaluations, given=given, source=source))


def study_from_dict(values: Mapping[str, Any], *, source: str) -> Study:
    """A study from plain values.

    Args:
        values: the keys of a study file.
        source: where they come from, for messages.

    Raises:
        StudyError: an unknown key, a wrong type, or impossible bounds.
    """
    file = checked(_File, values, source=source, error=StudyError)
    rules = rules_for(file.calibration, file.rules, key=f"{source}: rules", error=StudyError)
    objectives = objectives_of(file.objectives, source=source)
    corner = corner_of(file.reference_point, objectives, source=source)
    robust = any(map(is_robust, objectives.names))
    constraints = constraints_of(file.constraints, strength=file.strength, robust=robust, source=source)
    table = {} if file.uncertainty is None and any(map(is_robust, constraints.measures)) else file.uncertainty
    return Study(
        name=file.name,
        description=file.description,
        case=file.case,
        **named_motors(file.motor, file.hip_motor, file.knee_motor, source),
        calibration=file.calibration,
        rules=rules,
        evaluations=file.evaluations,
        seed=file.seed,
        variables=_variables(file, source),
        objectives=objectives,
        constraints=constraints,
        reference_point=corner,
        stop=file.stop,
        audit=file.audit,
        strength=file.strength,
        gear_list=file.gear_list,
        uncertainty=None if table is None else sampling_of(table, source=source),
        algorithm=_algorithm(file, corner, source),
    )


def _algorithm(file: _File, corner: ReferencePoint, source: str) -> AlgorithmSettings:
    table = file.algorithm
    if not table:
        return DEFAULT_ALGORITHM
    name = table.get("name")
    kind: type[AlgorithmSettings] | None = ALGORITHMS.get(name) if isinstance(name, str) else None
    if isinstance(name, str) and name.startswith(OWN_ALGORITHM):
        kind = OwnSettings
    if kind is None:
        raise StudyError(f"{source}: {unknown_name('algorithm.name', name, ALGORITHMS)}")
    settings: AlgorithmSettings = checked(kind, table, source=f"{source}, table [algorithm]", error=StudyError)
    if isinstance(settings, WeightedSettings):
        for key, value in settings.start.items():
            if key not in NAMES:
                raise StudyError(f"{source}: {unknown_name('variable in algorithm.start', key, NAMES)}")
            _number(f"{source}: algorithm.start.{key}", key, value)
        _check_weighted(file, corner, source)
    return settings


def _check_weighted(file: _File, corner: ReferencePoint, source: str) -> None:
    """Refuse what the weighted search cannot do: a choice of motor, three objectives, or a scale of zero."""
    for key in MOTOR_KEYS:
        if isinstance(named := getattr(file, key), list | tuple):
            raise StudyError(
                f"{source}: {key} = {list(named)}: weighted_cmaes searches with one motor, because a normal "
                "distribution has no place for a choice; name one, or choose another algorithm"
            )
    if len(corner.values) != 2:
        raise StudyError(
            f"{source}: objectives: weighted_cmaes weighs two, {len(corner.values)} are named; drop one, or choose "
            "another algorithm"
        )
    for name, value in corner.as_dict().items():
        if value == 0.0 and corner.objectives != HEIGHT_AND_ENERGY:
            raise StudyError(
                f"{source}: reference_point.{name} = 0: weighted_cmaes divides {name} by it; give a number above 0"
            )


def _variables(file: _File, source: str) -> dict[str, Bounds | float]:
    for name in file.variables:
        if name not in NAMES:
            raise StudyError(f"{source}: {unknown_name('variable', name, NAMES)}")
    chosen: dict[str, Bounds | float] = {}
    for variable in VARIABLES:
        given = file.variables.get(variable.name)
        if given is not None:
            chosen[variable.name] = _variable(variable.name, given, source)
        elif variable.default is not None:
            chosen[variable.name] = variable.default
        elif file.case is None or variable.name in PAPER_CASES[file.case].free:
            chosen[variable.name] = Bounds(lower=variable.lower, upper=variable.upper)
        else:
            chosen[variable.name] = getattr(PAPER_CASES[file.case].design, variable.name)
    if not any(isinstance(value, Bounds) for value in chosen.values()):
        raise StudyError(f"{source}: variables: all are fixed, at least one must be free; give one bounds")
    longest = sum(v.upper if isinstance(v, Bounds) else v for v in (chosen[name] for name in LENGTHS))
    start = chosen["start_height_m"]
    lowest = start.lower if isinstance(start, Bounds) else start
    if longest <= lowest:
        raise StudyError(
            f"{source}: thigh_length_m + shank_length_m = {longest:g} at most: must exceed the start height of "
            f"{lowest:g} m; allow longer links"
        )
    return chosen


def _variable(name: str, given: Any, source: str) -> Bounds | float:
    key = f"{source}: variables.{name}"
    if isinstance(given, Mapping):
        if set(given) != {"lower", "upper"}:
            raise StudyError(f"{key} has the keys {sorted(map(str, given))}; must be lower and upper; correct them")
        bounds = Bounds(
            lower=_number(f"{key}.lower", name, given["lower"]), upper=_number(f"{key}.upper", name, given["upper"])
        )
        if bounds.lower >= bounds.upper:
            raise StudyError(
                f"{key}: lower = {bounds.lower:g}, upper = {bounds.upper:g}: lower must be below upper; "
                "correct them, or fix the variable to a number"
            )
        return bounds
    if not isinstance(given, int | float):
        low, high = _limits(name)
        allowed = f"a number from {low:g} to {high:g}, or a range such as {_range_example(name)}"
        raise StudyError(complaint(key, given, allowed, "correct it"))
    return _number(key, name, given)


def _range_example(name: str) -> str:
    bounds = next(variable for variable in VARIABLES if variable.name == name)
    return f'{{"lower": {bounds.lower:g}, "upper": {bounds.upper:g}}}'


_LIMITS = {"m": (0.05, 2.0), "1": (1.0, 100.0), "rad": (0.0, 3.0)}
"""Unit -> allowed range. Values beyond it are typing errors; controller gains may be any number from 0."""
_REST_LENGTHS_M = (0.5, 100.0)  # longer than any leg; a longer spring acts by its product with K alone


def _limits(name: str) -> tuple[float, float]:
    """Least and greatest value of a variable."""
    unit = next(variable.unit for variable in VARIABLES if variable.name == name)
    return _REST_LENGTHS_M if name == "rest_length_m" else _LIMITS.get(unit, (0.0, 1e6))


def _number(key: str, name: str, given: Any) -> float:
    low, high = _limits(name)
    allowed = f"a number from {low:g} to {high:g}"
    if isinstance(given, bool) or not isinstance(given, int | float) or not low <= given <= high:
        raise StudyError(complaint(key, given, allowed, "correct it"))
    return float(given)
