"""Run, resume and make robust: studies that grow, from scripts."""

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pareto_monoped.api.jumps import StrPath
from pareto_monoped.api.studies import StoredStudy, as_path, load_study
from pareto_monoped.errors import StudyError, complaint
from pareto_monoped.study.definition import Study

if TYPE_CHECKING:
    from pareto_monoped.study.session import Progress


def run(
    study: Study | StrPath,
    db: StrPath | None = None,
    *,
    algorithm: str | Mapping[str, Any] | None = None,
    objectives: Sequence[str] | None = None,
    constraints: Mapping[str, Any] | None = None,
    evaluations: int | None = None,
    seed: int | None = None,
    workers: int | None = None,
    callback: "Callable[[Progress], Any] | None" = None,
) -> StoredStudy:
    """Run a study into a database, or continue it where it stopped; the command ``run`` makes the same trials.

    Every generation is stored before ``callback`` hears of it. After a crash or an interrupt the same call goes on.

    Args:
        study: a study, or the path of a study file.
        db: the database, made if missing; by default a file beside the study file, with the suffix ``.db``.
        algorithm: name of a search algorithm, or its name and settings, instead of the study's.
        objectives: two or three measures, instead of the study's.
        constraints: limits of measures, such as ``{"mass_kg": {"max": 4.0}}``, besides the study's or instead of those
            of the same measures.
        evaluations: total number of trials, instead of the study's.
        seed: instead of the study's.
        workers: threads that simulate, all cores if None. It does not change the trials.
        callback: called after each generation with the progress. If it returns True, the run stops there and can be
            resumed.

    Raises:
        StudyError: an unusable study, or a database that began with other settings.
        MotorError, CalibrationError: an unknown name or an unusable file.
        DatabaseError: the file is no study, is damaged, is in use, or cannot be written.

    Example:
        >>> import tempfile, pareto_monoped as pm
        >>> folder = tempfile.TemporaryDirectory()
        >>> study = pm.Study.define(name="small", evaluations=200)
        >>> stored = pm.run(study, folder.name + "/small.db", constraints={"mass_kg": {"max": 5.0}})
        >>> len(stored.trials)
        200
        >>> folder.cleanup()
    """
    from pareto_monoped.study.run import run as run_study

    one = study if isinstance(study, Study) else Study.from_toml(as_path(study))
    target = _database(study, db)
    changed = _changed(one, algorithm=algorithm, objectives=objectives, constraints=constraints)
    run_study(changed, target, evaluations=evaluations, seed=seed, workers=workers, progress=callback)
    return load_study(target)


def resume(
    db: StrPath,
    *,
    evaluations: int | None = None,
    workers: int | None = None,
    callback: "Callable[[Progress], Any] | None" = None,
) -> StoredStudy:
    """Continue a study from its database alone.

    Args:
        db: the database.
        evaluations: the new total; by default that of the last run.
        workers: threads that simulate, all cores if None.
        callback: see ``run``.

    Raises:
        StudyError: this code or machine computes other jumps than the study began with.
        DatabaseError: the file is no study, is damaged, is in use, or cannot be written.
    """
    from pareto_monoped.study.run import resume as resume_study

    resume_study(as_path(db), evaluations=evaluations, workers=workers, progress=callback)
    return load_study(db)


def _database(study: Study | StrPath, db: StrPath | None) -> Path:
    if db is not None:
        return as_path(db)
    if isinstance(study, Study):
        raise StudyError("db: is not given; name the database file, such as 'mine.db'")
    return as_path(study).with_suffix(".db")


def _changed(
    study: Study,
    *,
    algorithm: str | Mapping[str, Any] | None,
    objectives: Sequence[str] | None,
    constraints: Mapping[str, Any] | None,
) -> Study:
    """The study with other goals or another search."""
    values = study.as_dict()
    if algorithm is not None:
        values["algorithm"] = algorithm if isinstance(algorithm, str) else dict(algorithm)
    if objectives is not None:
        values["objectives"] = list(objectives)
        values["reference_point"] = {
            name: value for name, value in values["reference_point"].items() if name in objectives
        }
    if constraints is not None:
        if not isinstance(constraints, Mapping):
            allowed = "a mapping of measures to limits, such as {'mass_kg': {'max': 4.0}}"
            raise StudyError(complaint("constraints", constraints, allowed, "give one"))
        values["constraints"] = _joined(values["constraints"], constraints)
    if values == study.as_dict():
        return study
    return Study.define(**values)


def _joined(before: Mapping[str, Any], given: Mapping[str, Any]) -> dict[str, Any]:
    """Limits in their stored form, ``max_mass_kg``, with those given in either form in the place of older ones."""
    flat: dict[str, Any] = {}
    for key, limits in given.items():
        sides = limits if isinstance(limits, Mapping) else None
        flat |= {key: limits} if sides is None else {f"{side}_{key}": value for side, value in sides.items()}
    return dict(before) | flat
