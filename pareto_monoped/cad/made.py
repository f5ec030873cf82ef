"""Whether the export that a job asks for exists already, complete and up to date."""

from pathlib import Path
from typing import Any

from pareto_monoped.cad.as_built import built_of
from pareto_monoped.cad.compare import difference
from pareto_monoped.cad.jobs import Job
from pareto_monoped.cad.write.design_record import design_record
from pareto_monoped.cad.write.formats import ALWAYS, FILES, RECORD
from pareto_monoped.config import read_json
from pareto_monoped.errors import DesignError

_NOT_COMPARED = ("jumps", "formats", "files")
"""Keys of a record whose values a job does not fix: formats may be more, the jumps would have to be simulated."""
_GIVEN = ("made_by", "source", "searched", "motor_data", "calibration_data")
"""Keys whose values the job gives; all others are computed, and another machine may round them differently."""
REL_TOLERANCE = 1e-9
"""Of numbers that another machine may round in another way."""


def is_made(job: Job, *, any_pose: bool = False) -> bool:
    """Whether the job's folder holds this very export: same version, design, motor, calibration, source and pose.

    Its record must be what this version would write, apart from the jumps, which are not simulated for this. It must
    have the job's formats, and every file that it lists must be there and not empty.

    Args:
        job: what is asked for.
        any_pose: whether the assembly may stand in another pose than the job's.
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
    """Whether all listed files are there, and the list has what the record's formats make."""
    names = [str(name) for name in record["files"]]
    needed = [*ALWAYS, *(path for name in record["formats"] for path, _ in FILES[name])]
    if record["jumps"]["as_built"]["status"] == "cannot_stand":
        needed = [path for path in needed if path != "model/monoped.xml"]
    listed = all(
        any(name == path or (path.endswith("/") and name.startswith(path)) for name in names) for path in needed
    )
    return listed and all((folder / name).is_file() and (folder / name).stat().st_size > 0 for name in names)


def expected_record(job: Job) -> dict[str, Any]:
    """The record that this version would write, without what is not compared."""
    maps = job.maps()
    built = built_of(job.design, maps, job.calibration, hip_rad=job.hip_rad, knee_rad=job.knee_rad)
    record = design_record(
        searched=job.design,
        built=built,
        maps=maps,
        jumps={},
        calibration=job.calibration,
        source=job.source,
        formats=(),
        strength=job.strength,
    )
    return {key: value for key, value in record.items() if key not in _NOT_COMPARED}
