"""An export again from its ``design.json``, and whether an export exists already; contradictory records are refused."""

import json
import math
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pareto_monoped.actuator.motors import stored_motor
from pareto_monoped.cad.as_built import MADE_BY, as_built, built_of, design_record
from pareto_monoped.cad.jobs import Job
from pareto_monoped.cad.write.folder import ALWAYS, FILES, RECORD, chosen_formats
from pareto_monoped.config import read_json
from pareto_monoped.design import ALL_NAMES, DEFAULTS, NAMES, RULE_SETS, Design, RuleSet
from pareto_monoped.errors import DesignError, InputError
from pareto_monoped.jump.calibration import calibration_of


@dataclass(frozen=True, slots=True, kw_only=True)
class Difference:
    """A place where two values differ."""

    field: str  #: its keys from the outside in, with dots between them
    found: Any  #: what stands there; ``ABSENT`` where there is nothing
    expected: Any


ABSENT = "nothing"


def difference(found: Any, expected: Any, *, rel_tolerance: float, field: str = "") -> Difference | None:
    """Return the first place where two JSON values differ, None if there is none."""
    if isinstance(found, dict) and isinstance(expected, dict):
        for key in (*expected, *(key for key in found if key not in expected)):
            at = f"{field}.{key}" if field else str(key)
            a, b = found.get(key, ABSENT), expected.get(key, ABSENT)
            inner = difference(a, b, rel_tolerance=rel_tolerance, field=at)
            if inner is not None:
                return inner
        return None
    if isinstance(found, list) and isinstance(expected, list) and len(found) == len(expected):
        pairs = enumerate(zip(found, expected, strict=True))
        inside = (difference(a, b, rel_tolerance=rel_tolerance, field=f"{field}.{k}") for k, (a, b) in pairs)
        return next(filter(None, inside), None)
    if isinstance(found, float) and isinstance(expected, float):
        equal = math.isclose(found, expected, rel_tol=rel_tolerance, abs_tol=1e-12)
    else:
        equal = type(found) is type(expected) and bool(found == expected)
    return None if equal else Difference(field=field, found=found, expected=expected)


_NOT_COMPARED = ("jumps", "formats", "files")
"""Keys of a record whose values a job does not fix: formats may be more, the jumps would have to be simulated."""
_GIVEN = ("made_by", "source", "searched", "motor_data", "calibration_data")
"""Keys whose values the job gives; all others are computed, and another machine may round them differently."""
REL_TOLERANCE = 1e-9  #: Of numbers that another machine may round in another way.
_JUMP_REL_TOLERANCE = 1e-3
"""Of height and energy: rounding on another machine grows in a jump, by the audit's limit to a percent at worst."""
_RATIOS = ("hip_ratio", "knee_ratio")
"""Variables that a design is built with as its gearboxes have them, which another version may choose differently."""


def is_made(job: Job, *, any_pose: bool = False) -> bool:
    """Return whether the job's folder holds this very export, by version, design, motor, calibration, source and pose.

    Its record must be what this version would write, apart from the jumps, which are not simulated for this. It must
    have the job's formats, and every file that it lists must be there and not empty. With ``any_pose`` the assembly may
    stand in another pose than the job's.
    """
    try:
        record = read_json(job.folder / RECORD)
        if not (set(job.formats) <= set(record["formats"]) and _is_whole(job.folder, record)):
            return False
        found = {key: value for key, value in record.items() if key not in _NOT_COMPARED}
        expected = expected_record(job)
        if any_pose:
            expected["pose"] = found["pose"]
        given = all(found[key] == expected[key] for key in _GIVEN)
        return given and difference(found, expected, rel_tolerance=REL_TOLERANCE) is None
    except (OSError, ValueError, KeyError, TypeError, AttributeError, RecursionError, DesignError):
        # No record, or none of ours; or a design that cannot be built, which the export itself will explain.
        return False


def _is_whole(folder: Path, record: dict[str, Any]) -> bool:
    """Return whether all listed files are there, and the list has what the record's formats make."""
    names = [str(name) for name in record["files"]]
    needed = [*ALWAYS, *(path for name in record["formats"] for path, _ in FILES[name])]
    if "cannot_stand" in (record["jumps"][name]["status"] for name in ("as_built", "stand")):
        needed = [path for path in needed if path not in dict(FILES["mjcf"])]
    listed = all(any(name == path or (path[-1] == "/" and name.startswith(path)) for name in names) for path in needed)
    return listed and all((folder / name).is_file() and (folder / name).stat().st_size > 0 for name in names)


def expected_record(job: Job) -> dict[str, Any]:
    """Return the record that this version would write, without what is not compared."""
    maps = job.maps()
    built = built_of(job.design, maps, job.calibration, hip_rad=job.hip_rad, knee_rad=job.knee_rad)
    record = design_record(
        searched=job.design,
        built=built,
        maps=maps,
        calibration=job.calibration,
        source=job.source,
        formats=(),
        strength=job.strength,
    )
    return {key: value for key, value in record.items() if key not in _NOT_COMPARED}


def record_job(
    path: Path,
    *,
    folder: Path,
    formats: Sequence[str] | None = None,
    force: bool = False,
    note: Callable[[str], None] = lambda _: None,
) -> Job:
    """Return the job that makes an export again from its ``design.json``: the same bytes, by the same version.

    ``note`` is called with a line of text if another version made the record.

    Raises:
        InputError: the file is missing, or no record of an export, or its motor or calibration is impossible, or a
            field of it does not follow from the others.
        DesignError: its design cannot be built.
    """
    source = f"design record {str(path)!r}"
    try:
        record = _parsed(path)
        design = _design(_object(record, "searched"))
        pose = _object(record, "pose")
        angles = {name: _finite(pose, name) for name in ("hip_rad", "knee_rad")}
        (hip, knee), calibration = _motors(record), dict(_object(record, "calibration_data"))
        origin = dict(_object(record, "source"))
        wanted = _names(record, "formats")
        maker = str(record["made_by"])
        rules = _rules(record.get("rules", "paper"))
        strength = record.get("strength", False) is True
    except OSError as problem:
        raise InputError(f"{source}: cannot be read ({problem.strerror}); give the design.json of an export") from None
    except (KeyError, ValueError) as problem:
        why = f"no {problem}" if isinstance(problem, KeyError) else str(problem)
        raise InputError(f"{source}: is not the record of an export ({why}); give the design.json of one") from None
    motors = stored_motor(hip, source=source), None if knee is None else stored_motor(knee, source=source)
    job = Job(
        design=design,
        motor=motors[0],
        knee_motor=motors[1],
        calibration=calibration_of(calibration, source=source),
        rules=rules,
        folder=folder,
        formats=chosen_formats(wanted if formats is None else formats),
        force=force,
        source=origin,
        strength=strength,
        **angles,
    )
    wrong = _contradiction(record, job, same_version=maker == MADE_BY)
    if wrong is not None:
        raise InputError(
            f"{source}: {wrong.field} = {_short(wrong.found)}: must be {_short(wrong.expected)} to agree with the rest "
            "of the record; give the record as its export wrote it"
        )
    if maker != MADE_BY:
        note(f"{source} was made by {maker!r}, this is {MADE_BY}: files may differ")
    return job


def _contradiction(record: Mapping[str, Any], job: Job, *, same_version: bool) -> Difference | None:
    """Return the first field of a record that does not follow from its design, motor and calibration.

    Another version may choose other gearboxes and weigh other parts: then only what no version changes is compared.
    """
    # A list of files follows from the formats, and a folder need not have all of them any more.
    found = {key: value for key, value in record.items() if key not in ("formats", "files")}
    if same_version:
        expected = expected_record(job)
        jumps = found.pop("jumps", None)
        wrong = difference(found, expected, rel_tolerance=REL_TOLERANCE)
        if wrong is not None:
            return wrong
        from pareto_monoped.cad.export import simulated_jumps

        designs = {"searched": job.design, "as_built": _design(expected["as_built"])}
        simulated = simulated_jumps(designs, job.maps(), job.calibration)
        return difference(jumps, simulated, rel_tolerance=_JUMP_REL_TOLERANCE, field="jumps")
    built = as_built(job.design, job.maps()).as_dict()
    fixed = {
        "motor": job.maps().label,
        "calibration": job.calibration.label,
        "as_built": {name: value for name, value in built.items() if name not in _RATIOS},
    }
    found = {key: found.get(key) for key in fixed}
    if isinstance(found["as_built"], dict):
        found["as_built"] = {name: value for name, value in found["as_built"].items() if name not in _RATIOS}
    return difference(found, fixed, rel_tolerance=REL_TOLERANCE)


def _short(value: Any) -> str:
    text = json.dumps(value)
    return text if len(text) <= 60 else f"{text[:57]}..."


def _parsed(path: Path) -> Mapping[str, Any]:
    try:
        found = read_json(path)
    except json.JSONDecodeError as problem:
        raise ValueError(f"no JSON text: line {problem.lineno}, column {problem.colno}") from None
    except UnicodeDecodeError:
        raise ValueError("no text in UTF-8") from None
    except ValueError:  # too deep, too long, or a number of too many digits
        raise ValueError("nested or numbered beyond reason") from None
    if not isinstance(found, dict):
        raise ValueError("no JSON object")
    return found


def _design(searched: Mapping[str, Any]) -> Design:
    """Return the design of a record; optional variables that it does not name have their defaults."""
    names: Any = {n: _finite(DEFAULTS | dict(searched), n) for n in ALL_NAMES if n in NAMES or n in searched}
    return Design(**names)


def _rules(name: Any) -> RuleSet:
    """Return the rules of a record, which names them if they are not those of the paper."""
    for rules in RULE_SETS:
        if name == rules:
            return rules
    raise ValueError(f"rules {name!r} are none of {', '.join(RULE_SETS)}")


def _object(record: Mapping[str, Any], name: str) -> Mapping[str, Any]:
    """Return a field of a record that holds fields of its own."""
    if not isinstance(record[name], dict):
        raise ValueError(f"{name} has no fields")
    return dict(record[name])


def _motors(record: Mapping[str, Any]) -> tuple[dict[str, Any], dict[str, Any] | None]:
    """Return the values of a record's motor, or of the hip's and of the knee's where these differ."""
    found = _object(record, "motor_data")
    if set(found) != {"hip", "knee"}:
        return dict(found), None
    return dict(_object(found, "hip")), dict(_object(found, "knee"))


def _names(record: Mapping[str, Any], name: str) -> list[str]:
    """Return a field of a record that is a list of names."""
    if not isinstance(record[name], list):
        raise ValueError(f"{name} = {_short(record[name])} is no list")
    return [str(one) for one in record[name]]


def _finite(record: Mapping[str, Any], name: str) -> float:
    """Return a field of a record that is a number."""
    value = record[name]
    if not isinstance(value, int | float) or not abs(value) <= sys.float_info.max:
        raise ValueError(f"{name} = {_short(value)} is not a number")
    return float(value)
