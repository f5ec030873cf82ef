"""The keys of a study file, their types and defaults; the files that it names; the study files of the package."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from importlib import resources
from importlib.resources.abc import Traversable
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import Field

from pareto_monoped.config import Positive, Strict, checked, read_toml
from pareto_monoped.definition.algorithms import (
    ALGORITHMS,
    DEFAULT_ALGORITHM,
    OWN_ALGORITHM,
    AlgorithmSettings,
    OwnSettings,
    WeightedSettings,
)
from pareto_monoped.definition.given import as_plain
from pareto_monoped.definition.goals import flattened
from pareto_monoped.definition.variables import MOTOR_KEYS, number_of
from pareto_monoped.design import ALL_NAMES, NAMES, RuleSet
from pareto_monoped.errors import StudyError, unknown_name
from pareto_monoped.pareto.objectives import HEIGHT_AND_ENERGY, ReferencePoint

START = "case_c"
"""The study that a newcomer begins with: all seven variables of the paper, its best design."""


def shipped_studies() -> dict[str, Traversable]:
    """Return the file of each study that comes with the package, by name, in alphabetical order."""
    folder = resources.files("pareto_monoped") / "data" / "studies"
    if not folder.is_dir():
        folder = Path(__file__).parents[2] / "studies"
    return {file.name.removesuffix(".toml"): file for file in _files(folder)}


def _files(folder: Traversable) -> list[Traversable]:
    found = [file for file in folder.iterdir() if file.name.endswith(".toml")] if folder.is_dir() else []
    return sorted(found, key=lambda file: file.name)


def shipped_study(name: str) -> str:
    """Return the text of a shipped study; refuse an unknown name."""
    known = shipped_studies()
    if name not in known:
        raise StudyError(unknown_name("study", name, known))
    return known[name].read_text(encoding="utf-8")


@dataclass(frozen=True, slots=True, kw_only=True)
class Stop(Strict):
    """Conditions that end a study before its budget is used up."""

    wall_time_s: Positive | None = None  #: longest running time, over all sessions
    #: plateau_evaluations, plateau_growth: end when the hypervolume has grown by less than the share ``plateau_growth``
    #: during the last ``plateau_evaluations`` evaluations
    plateau_evaluations: Annotated[int, Field(ge=1)] | None = None
    plateau_growth: Annotated[float, Field(ge=0.0, le=1.0)] = 0.001


@dataclass(frozen=True, slots=True, kw_only=True)
class StudyFile(Strict):
    """Keys of a study file; its tables but ``stop``, the motors and the objectives are checked separately."""

    name: Annotated[str, Field(min_length=1, max_length=200)]
    description: Annotated[str, Field(max_length=2000)] = ""
    case: Literal["A", "B", "C"] | None = None
    motor: Any = None
    hip_motor: Any = None
    knee_motor: Any = None
    calibration: Annotated[str, Field(min_length=1, max_length=1000)] = "reference"
    engine: Literal["mujoco", "compiled"] | None = None
    controller: Any = None
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
    copies: Annotated[int, Field(ge=1, le=100)] = 1  # of a stored study; see ``copies_for``
    uncertainty: dict[str, Any] | None = None
    algorithm: dict[str, Any] = field(default_factory=dict)


def file_values(path: Path) -> dict[str, Any]:
    """Read the keys of a study file, whose relative paths count from its folder; refuse what is no TOML."""
    if not path.exists() and (name := path.name.removesuffix(".toml")) in shipped_studies():
        raise StudyError(
            f"study file {str(path)!r}: no such file; 'pareto-monoped init {name}' copies the one that comes with the "
            "package"
        )
    return with_paths(read_toml(path, what="study file", error=StudyError), path.parent)


def plain_values(values: Mapping[str, Any], source: str) -> dict[str, Any]:
    """Return the keys of a study file from a script: paths, arrays and numbers of NumPy, but no motor itself."""
    from pareto_monoped.actuator.motor import Motor
    from pareto_monoped.jump.calibration import Calibration

    plain = {key: as_plain(value) for key, value in values.items()}
    for key in MOTOR_KEYS:
        several = plain.get(key)
        if any(isinstance(one, Motor) for one in (several if isinstance(several, list) else [several])):
            raise StudyError(f"{source}: {key}: is a Motor, must be its name or file; give the path of its TOML file")
    if isinstance(plain.get("calibration"), Calibration):
        raise StudyError(
            f"{source}: calibration: is a Calibration, must be its name or file; give it where the study starts: "
            "pareto_monoped.run(study, db, calibration=...)"
        )
    return plain


def with_paths(values: Mapping[str, Any], folder: Path) -> dict[str, Any]:
    """Return the keys of a study file with the files of motors and calibrations in ``folder`` as full paths."""

    def resolved(name: Any) -> Any:
        file = isinstance(name, str) and name.endswith(".toml")
        return str((folder / name).resolve()) if file else name

    changed = dict(values)
    for key in (*MOTOR_KEYS, "calibration"):
        if key in changed:
            given = changed[key]
            changed[key] = [resolved(name) for name in given] if isinstance(given, list) else resolved(given)
    return changed


def with_objectives(values: Mapping[str, Any], objectives: Sequence[str]) -> dict[str, Any]:
    """Return the keys of a study file with other objectives, without what its reference point says of dropped ones."""
    changed = dict(values) | {"objectives": list(objectives)}
    if isinstance(corner := values.get("reference_point"), dict):
        changed["reference_point"] = {name: value for name, value in flattened(corner).items() if name in objectives}
    return changed


def algorithm_of(file: StudyFile, corner: ReferencePoint, source: str) -> AlgorithmSettings:
    """Return the settings in the table ``algorithm``; refuse unknown ones, and a study that they cannot search."""
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
            if key not in ALL_NAMES:
                raise StudyError(f"{source}: {unknown_name('variable in algorithm.start', key, NAMES)}")
            number_of(f"{source}: algorithm.start.{key}", key, value)
        _check_weighted(file, corner, source)
    return settings


def _check_weighted(file: StudyFile, corner: ReferencePoint, source: str) -> None:
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
