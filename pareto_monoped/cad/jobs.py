"""What to export: jobs from a row of the paper's Table I, from the trials of a study, or from an earlier export."""

import json
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pareto_monoped.actuator.motors import Motor, load_motor, stored_motor
from pareto_monoped.cad.write.design_record import MADE_BY
from pareto_monoped.cad.write.formats import FORMATS, chosen_formats
from pareto_monoped.design import DEFAULT_RULES, DEFAULTS, NAMES, PAPER_CASES, RULE_SETS, Design, RuleSet
from pareto_monoped.errors import InputError
from pareto_monoped.jump.calibration import Calibration, calibration_of, load_calibration

if TYPE_CHECKING:
    from pareto_monoped.study.reader import StudyData

_CASE_MOTOR, _CASE_CALIBRATION = "VT8020", "reference"
"""What a row of Table I is built and simulated with: the paper's motor and our best model of its robot."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Job:
    """One design to export: everything that another process needs.

    Attributes:
        design: as searched.
        motor: the motor of both actuators.
        calibration: the jump model.
        rules: of the gearboxes.
        folder: where to.
        formats: of ``FORMATS``, in its order.
        force: replace an export of something else.
        source: where the design comes from.
        hip_rad: angle of the hip in the assembly, instead of that of the start pose.
        knee_rad: angle of the knee, likewise.
    """

    design: Design
    motor: Motor
    calibration: Calibration
    rules: RuleSet = DEFAULT_RULES
    folder: Path
    formats: tuple[str, ...] = FORMATS
    force: bool = False
    source: dict[str, Any]
    hip_rad: float | None = None
    knee_rad: float | None = None


def case_job(
    case: str,
    *,
    rules: RuleSet = DEFAULT_RULES,
    folder: Path,
    formats: Sequence[str] | None = None,
    force: bool = False,
    hip_rad: float | None = None,
    knee_rad: float | None = None,
) -> Job:
    """The job for a row of the paper's Table I, with the paper's motor and the reference calibration.

    Args:
        case: name of the row.
        rules: of the gearboxes.
        folder: where to.
        formats: some of ``FORMATS``; default all.
        force: replace an earlier export there.
        hip_rad: angle of the hip in the assembly, instead of that of the start pose.
        knee_rad: angle of the knee, likewise.

    Raises:
        InputError: an unknown format.
    """
    return Job(
        design=PAPER_CASES[case].design,
        motor=load_motor(_CASE_MOTOR),
        calibration=load_calibration(_CASE_CALIBRATION),
        rules=rules,
        folder=folder,
        formats=chosen_formats(formats),
        force=force,
        source={"case": case},
        hip_rad=hip_rad,
        knee_rad=knee_rad,
    )


def trial_job(
    data: "StudyData",
    trial: int,
    *,
    folder: Path,
    formats: Sequence[str] | None = None,
    force: bool = False,
    hip_rad: float | None = None,
    knee_rad: float | None = None,
) -> Job:
    """The job for one trial of a study, with the motor and the calibration that the study stores.

    Args:
        data: the study.
        trial: the trial's number.
        folder: where to.
        formats: some of ``FORMATS``; default all.
        force: replace an earlier export there.
        hip_rad: angle of the hip in the assembly, instead of that of the start pose.
        knee_rad: angle of the knee, likewise.

    Raises:
        InputError: an unknown format.
        DatabaseError: the study's motor or calibration is damaged.
    """
    row = data.trials.loc[data.trials["trial"] == trial].iloc[0]
    return Job(
        design=Design.from_array([row[name] for name in NAMES]),
        motor=data.motor,
        calibration=data.calibration,
        rules=data.study.rules,
        folder=folder,
        formats=chosen_formats(formats),
        force=force,
        source={"study": data.study.name, "trial": int(trial)},
        hip_rad=hip_rad,
        knee_rad=knee_rad,
    )


def front_jobs(
    data: "StudyData", *, folder: Path, every: int = 1, formats: Sequence[str] | None = None, force: bool = False
) -> list[Job]:
    """The jobs for the designs on a study's front, from the lowest jump to the highest.

    Args:
        data: the study.
        folder: holds a folder ``trial_N`` per design.
        every: take only each N-th design, beginning with the first.
        formats: some of ``FORMATS``; default all.
        force: replace earlier exports.

    Raises:
        InputError: an unknown format.
        DatabaseError: the study's motor or calibration is damaged.
    """
    trials = data.front()["trial"].astype(int).tolist()[::every]
    return [trial_job(data, trial, folder=folder / f"trial_{trial}", formats=formats, force=force) for trial in trials]


def record_job(
    path: Path,
    *,
    folder: Path,
    formats: Sequence[str] | None = None,
    force: bool = False,
    note: Callable[[str], None] = lambda _: None,
) -> Job:
    """The job that makes an export again from its ``design.json``: the same bytes, by the same version.

    Args:
        path: the record.
        folder: where to.
        formats: some of ``FORMATS``; default those of the record.
        force: replace an earlier export there.
        note: called with a line of text if another version made the record.

    Raises:
        InputError: the file is missing, or no record of an export, or its motor or calibration is impossible.
    """
    source = f"design record {str(path)!r}"
    try:
        record = json.loads(path.read_text(encoding="utf-8"))
        design = _design(record["searched"])
        angles = {name: _finite(record["pose"][name]) for name in ("hip_rad", "knee_rad")}
        motor, calibration = dict(record["motor_data"]), dict(record["calibration_data"])
        origin = dict(record["source"])
        wanted = [str(name) for name in record["formats"]]
        maker = str(record["made_by"])
        rules = _rules(record.get("rules", "paper"))
    except OSError as problem:
        raise InputError(f"{source}: cannot be read ({problem.strerror}); give the design.json of an export") from None
    except (ValueError, KeyError, TypeError, AttributeError, OverflowError, RecursionError) as problem:
        why = f"no {problem}" if isinstance(problem, KeyError) else str(problem).splitlines()[0]
        raise InputError(f"{source}: is not the record of an export ({why}); give the design.json of one") from None
    if maker != MADE_BY:
        note(f"{source} was made by {maker!r}, this is {MADE_BY}: files may differ")
    return Job(
        design=design,
        motor=stored_motor(motor, source=source),
        calibration=calibration_of(calibration, source=source),
        rules=rules,
        folder=folder,
        formats=chosen_formats(wanted if formats is None else formats),
        force=force,
        source=origin,
        **angles,
    )


def _design(searched: Mapping[str, Any]) -> Design:
    """The design of a record; optional variables that it does not name have their defaults."""
    values = DEFAULTS | dict(searched)
    return Design.from_array([_finite(values[name]) for name in NAMES])


def _rules(name: Any) -> RuleSet:
    """The rules of a record, which names them if they are not those of the paper."""
    for rules in RULE_SETS:
        if name == rules:
            return rules
    raise ValueError(f"rules {name!r} are none of {', '.join(RULE_SETS)}")


def _finite(value: Any) -> float:
    number = float(value)
    if not math.isfinite(number):
        raise ValueError(f"{number} is not a number")
    return number
