"""The definition of a study and its TOML file: variables, motor, calibration, constraints, algorithm, budget, seed."""

from collections.abc import Container, Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from os import PathLike, fspath
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.config import checked
from pareto_monoped.definition.algorithms import AlgorithmSettings, WeightedSettings, within_budget
from pareto_monoped.definition.goals import (
    LEAST_SAFETY,
    Constraints,
    constraints_of,
    corner_of,
    objectives_of,
    stored_objectives,
)
from pareto_monoped.definition.study_file import (
    Stop,
    StudyFile,
    algorithm_of,
    file_values,
    plain_values,
    with_objectives,
)
from pareto_monoped.definition.variables import (
    MOTOR_KEYS,
    NOT_OPENED,
    OPENED,
    Bounds,
    Named,
    all_names,
    kits_of,
    named_motors,
    names_of,
    text_of,
    variables_of,
)
from pareto_monoped.definition.variables import opened as opened_variables
from pareto_monoped.design import ALL_DEFAULTS, ALL_NAMES, KNOT_NAMES, NAMES, RuleSet
from pareto_monoped.errors import StudyError, complaint
from pareto_monoped.jump.calibration_defaults import (
    OWN_CALIBRATION,
    copies_for,
    is_stand,
    rules_for,
    strength_for,
)
from pareto_monoped.jump.laws import PAPER_LAW, Law, law_of
from pareto_monoped.measures import SHARE_MEASURES, is_own, is_robust
from pareto_monoped.pareto.objectives import Objectives, ReferencePoint
from pareto_monoped.strength.groups import GROUP_MEASURES
from pareto_monoped.uncertainty.settings import Sampling, sampling_of

NO_STRENGTH = "strength was not asked for: designs may not hold"
"""What every output says of a study without ``Study.strength``; those of earlier versions are among them."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Study:
    """A complete study. Each variable is either free within ``Bounds`` or fixed to a number.

    ``motor`` is the name or file of the motor of both joints, or a tuple of several from which each design has one. It
    is None where ``hip_motor`` and ``knee_motor`` say the same of either joint.
    ``rules`` are those of the gearboxes, see ``actuator.settings``. ``audit`` says whether the front is audited when
    the study ends; ill-conditioned designs then leave it. ``strength`` says whether a feasible design must hold: every
    measure of strength is then constrained. ``gear_list`` says whether a free gear ratio goes through the list of
    gearboxes, and a stored design has their real ratios; else it is any ratio, as up to version 0.2.0. ``engine`` makes
    the jumps in place of the calibration's. ``controller`` is the law of the motors. ``uncertainty``
    is there where the file has such a table, or an objective or a constraint is of jumps under uncertainty. ``copies``
    is the number of copies, changed by up to 1e-6, whose medians are a design's measures; 1 takes its own jump.
    ``shared_iterations`` says whether the iterations of a weighted search are each weight's share of the budget,
    because the file gives none; it is not stored.

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
    engine: Literal["mujoco", "compiled"] | None = None
    controller: Law = PAPER_LAW
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
    copies: int = 1
    uncertainty: Sampling | None = None
    algorithm: AlgorithmSettings
    shared_iterations: bool = field(default=False, compare=False)

    @classmethod
    def from_toml(cls, path: str | PathLike[str], **changes: Any) -> "Study":
        """Read the study in a TOML file, with other values for some of its keys, as for ``define``.

        Raises:
            StudyError: no readable TOML, an unknown key, a wrong type, or impossible bounds.
            MotorError: an unknown name of a motor.
            CalibrationError: an unknown name of a calibration.

        Example:
            >>> from pareto_monoped import Study
            >>> Study.from_toml("studies/case_c.toml", evaluations=400).name
            'case_c'
        """
        if not isinstance(path, str | PathLike) or not isinstance(fspath(path), str):
            raise StudyError(complaint("study file", path, "text or a path", "give one"))
        source = f"study file {str(path)!r}"
        return filled(file_values(Path(path)) | plain_values(changes, source), source=source)

    @classmethod
    def define(cls, **values: Any) -> "Study":
        """Return a study from the keys of a study file, such as ``motor="U8"``.

        ``name`` and ``evaluations`` are required; the others have the defaults of a study file. Tables are mappings, an
        algorithm may be a name, and files of motors and calibrations may be paths.

        Raises:
            StudyError: an unknown key, a wrong type, or impossible bounds.
            MotorError: an unknown name of a motor.
            CalibrationError: an unknown name of a calibration.

        Example:
            >>> from pareto_monoped import Study
            >>> study = Study.define(name="mine", evaluations=200, objectives=["height_m", "electrical_energy_j"])
            >>> study.free[0]
            'thigh_length_m'
        """
        return filled(plain_values(values, "study"), source="study")

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
    def names(self) -> tuple[str, ...]:
        """Names of the columns of its designs: ``NAMES``, or ``ALL_NAMES`` under a torque profile."""
        return ALL_NAMES if KNOT_NAMES[-1] in self.variables else NAMES

    @property
    def free(self) -> tuple[str, ...]:
        """Names of the free variables, in the order of ``names``."""
        return tuple(name for name in self.names if isinstance(self.variables[name], Bounds))

    @property
    def lower(self) -> NDArray[np.float64]:
        """Lower bound of each variable, or its fixed value; in the order of ``names``."""
        return np.array([v.lower if isinstance(v, Bounds) else v for v in self._ordered()])

    @property
    def upper(self) -> NDArray[np.float64]:
        """Upper bound of each variable, or its fixed value; in the order of ``names``."""
        return np.array([v.upper if isinstance(v, Bounds) else v for v in self._ordered()])

    def _ordered(self) -> list[Bounds | float]:
        return [self.variables[name] for name in self.names]

    def as_dict(self) -> dict[str, Any]:
        """Return the study as plain values in the form of its file; ``study_from_dict`` reads it back.

        Settings that came after version 0.1.0 are left out at their defaults, so that older studies keep their hash.
        """
        plain = asdict(self)
        del plain["shared_iterations"]
        if self.uncertainty is not None:
            plain["uncertainty"] = self.uncertainty.as_dict()
        defaults: dict[str, Any] = {"rules": "paper", "strength": False, "gear_list": False, "copies": 1}
        for key, default in (defaults | dict.fromkeys(("uncertainty", "engine", *MOTOR_KEYS))).items():
            if plain[key] == default:
                del plain[key]
        if self.controller == PAPER_LAW:
            del plain["controller"]
        else:
            plain["controller"] = self.controller.as_dict()
        plain["variables"] = {
            name: asdict(v) if isinstance(v, Bounds) else v
            for name, v in zip(self.names, self._ordered(), strict=True)
            if v != ALL_DEFAULTS.get(name)
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
    opened: bool = False,
) -> Study:
    """Read the study in a TOML file, with other values for some of its keys; raise ``StudyError`` as ``from_toml``.

    With other ``objectives``, what the file's reference point says of dropped ones is left out. ``opened`` says whether
    the variables that the file leaves out are opened, see ``open_up``.
    """
    values = file_values(path)
    given = {"evaluations": evaluations, "seed": seed, "strength": strength}
    values |= {key: value for key, value in given.items() if value is not None}
    if objectives is not None:
        values = with_objectives(values, objectives)
    source = f"study file {str(path)!r}"
    study = filled(values, source=source)
    return open_up(study, kept=values.get("variables", ()), source=source) if opened else study


def open_up(study: Study, *, kept: Container[str] = (), source: str = "study") -> Study:
    """Return the study with more variables free, under a name that says so.

    Optional variables at their defaults become free, and K, C and T within the paper's bounds get wider ones; those
    named in ``kept`` stay, and the start height (``variables.NOT_OPENED``).

    Raises:
        StudyError: nothing is left to open.
    """
    without_stops = not strength_for(study.calibration)
    variables = opened_variables(study.variables, study.controller, kept, without_stops=without_stops)
    if variables == study.variables:
        raise StudyError(
            f"{source}: variables left to open = none: must be at least one of {', '.join(OPENED)} that acts; leave it "
            "out, or do not open the study"
        )
    return replace(study, variables=variables, name=f"{study.name[:170]} with more variables free")  # of 200 letters


def is_opened(study: Study, base: Study) -> bool:
    """Say whether a study has the variables of another, of which some are opened."""
    own, given = study.variables, base.variables
    wide = opened_variables(given, base.controller, ())
    return own != given and all(own[name] in (given.get(name), wide.get(name)) for name in own)


def opened_words(study: Study, base: Study) -> str:
    """Return which variables of another study are opened in a study, with their bounds."""
    wide = {name: value for name, value in study.variables.items() if value != base.variables.get(name)}
    ranges = (f"{name} {one.lower:g} to {one.upper:g}" for name, one in wide.items() if isinstance(one, Bounds))
    start = study.variables[NOT_OPENED]
    return f"{', '.join(ranges)}; {NOT_OPENED} stays {'free' if isinstance(start, Bounds) else f'{start:g}'}"


def filled(values: dict[str, Any], *, source: str) -> Study:
    """Return the study of a file's keys, with the defaults of a file for those left out; see ``Study.define``."""
    calibration = str(values.get("calibration"))
    copies = copies_for(calibration)
    defaults: dict[str, Any] = {"rules": rules_for(calibration), "strength": strength_for(calibration)}
    # An audit would find each jump of a chaotic calibration changed by the smallest change.
    defaults |= {"gear_list": True} if copies == 1 else {"gear_list": True, "copies": copies, "audit": False}
    values = defaults | values
    if isinstance(name := values.get("algorithm"), str):
        values["algorithm"] = {"name": name}
    study = study_from_dict(values, source=source)
    _require_names(study, source)
    given = "iterations" in values.get("algorithm", {})
    return budgeted(study, given=given, source=source)


def budgeted(study: Study, *, given: bool, source: str) -> Study:
    """Return a study whose search ends within the budget, see ``within_budget``."""
    settings = within_budget(study.algorithm, study.evaluations, given=given, source=source)
    return replace(study, algorithm=settings, shared_iterations=not given and isinstance(settings, WeightedSettings))


def _require_names(study: Study, source: str) -> None:
    """Refuse names of motors and of a calibration that no run could find."""
    from pareto_monoped.actuator.motors import require_motor_name
    from pareto_monoped.jump.calibration import require_calibration_name

    for key in MOTOR_KEYS:
        for name in names_of(getattr(study, key)):
            require_motor_name(name, key=f"{source}: {key}")
    if not study.calibration.startswith(OWN_CALIBRATION):
        require_calibration_name(study.calibration, key=f"{source}: calibration")


_AS_IN_FILE = (
    *("name", "description", "case", "calibration", "evaluations", "seed", "stop", "audit", "strength", "gear_list"),
    *("engine", "copies"),
)


def study_from_dict(values: Mapping[str, Any], *, source: str) -> Study:
    """Return a study from plain values, the keys of a study file; raise ``StudyError`` for impossible ones."""
    file = checked(StudyFile, values, source=source, error=StudyError)
    rules = rules_for(file.calibration, file.rules, key=f"{source}: rules", error=StudyError)
    objectives = objectives_of(file.objectives, source=source)
    corner = corner_of(file.reference_point, objectives, source=source)
    robust = any(map(is_robust, objectives.names))
    if file.copies > 1 and (
        file.uncertainty is not None or any(map(is_robust, (*objectives.names, *file.constraints)))
    ):
        raise StudyError(f"{source}: copies = {file.copies}: must be 1 under uncertainty, which has samples; give 1")
    constraints = constraints_of(file.constraints, strength=file.strength, robust=robust, source=source)
    table = {} if file.uncertainty is None and any(map(is_robust, constraints.measures)) else file.uncertainty
    plain: dict[str, Any] = {name: getattr(file, name) for name in _AS_IN_FILE}
    law = PAPER_LAW if file.controller is None else law_of(file.controller, source=source, error=StudyError)
    plain |= named_motors(file.motor, file.hip_motor, file.knee_motor, source)
    return Study(
        **plain,
        rules=rules,
        controller=law,
        variables=variables_of(file.variables, file.case, source, law),
        objectives=objectives,
        constraints=constraints,
        reference_point=corner,
        uncertainty=None if table is None else sampling_of(table, source=source, stand=is_stand(file.calibration)),
        algorithm=algorithm_of(file, corner, source),
        shared_iterations=False,
    )
