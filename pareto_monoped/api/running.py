"""Run and resume studies from scripts, and let stored designs jump as robots are built."""

import warnings
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Executor
from typing import TYPE_CHECKING, Any

from numpy.typing import ArrayLike

from pareto_monoped.api.given import (
    called_after,
    executor_of,
    own_calibration,
    seed_of,
    stored_calibration_name,
    trial_of,
)
from pareto_monoped.api.jumps import AnyCalibration, StrPath
from pareto_monoped.api.studies import Picked, StoredStudy, as_path, as_place, load_study
from pareto_monoped.definition.given import as_list, as_plain, as_table, count_of
from pareto_monoped.definition.study import Study, budgeted, study_from_dict
from pareto_monoped.errors import InputError, StudyError, complaint
from pareto_monoped.jump.calibration import Calibration
from pareto_monoped.jump.calibration_defaults import rules_for
from pareto_monoped.search.own_algorithm import own_algorithm_name
from pareto_monoped.storage.place import StudyPlace
from pareto_monoped.study.own_functions import Own, OwnFunction, functions_of, listed, own_name

if TYPE_CHECKING:
    from pandas import DataFrame

    from pareto_monoped.study.run import RunSummary
    from pareto_monoped.study.session import Progress

_STUDY = "a Study, or the path of a study file"
_CALIBRATION = "a Calibration, the name of a shipped one, or the path of a TOML file"

Goal = str | OwnFunction  #: A measure by its name, or an own function.
Limits = Mapping[Any, Any] | OwnFunction | Sequence[Any]


def objective_names(objectives: Sequence[Goal]) -> tuple[list[str], dict[str, OwnFunction]]:
    """Return names of objectives, and the own functions among them; raise ``StudyError`` for anything else."""
    several = as_list(objectives)
    if isinstance(several, str | Mapping) or not isinstance(several, Sequence):
        allowed = "a list of two or three measures or functions, such as ['height_m', 'energy_j']"
        raise StudyError(complaint("objectives", objectives, allowed, "give one"))
    functions = functions_of([one for one in several if not isinstance(one, str)])
    return [one if isinstance(one, str) else own_name(one) for one in several], functions


def limits_of(constraints: Limits) -> tuple[dict[str, Any], dict[str, OwnFunction]]:
    """Return limits by their stored keys, such as "max_mass_kg", and the own functions that they limit.

    ``constraints`` is a mapping of measures, or functions, to their limits; or a function, which holds at <= 0; or a
    list of such mappings and functions. Anything else, or a limit given twice in whatever spelling, is a
    ``StudyError``.
    """
    given = as_table(constraints)
    parts = [given] if isinstance(given, Mapping) or callable(given) else given
    if isinstance(parts, str) or not isinstance(parts, Sequence):
        allowed = "limits such as {'mass_kg': {'max': 4.0}}, or a list of these and of functions that hold at <= 0"
        raise StudyError(complaint("constraints", constraints, allowed, "give one of these"))
    flat: dict[str, Any] = {}
    functions: list[object] = []
    for part in parts:
        table = part if isinstance(part, Mapping) else {part: {"max": 0.0}} if callable(part) else None
        if table is None:
            allowed = "limits such as {'mass_kg': {'max': 4.0}}, or a function that holds at <= 0"
            raise StudyError(complaint("constraint", part, allowed, "give one of these"))
        functions += [key for key in table if not isinstance(key, str)]
        for key, limits in table.items():
            name = key if isinstance(key, str) else own_name(key)
            new = as_plain(_flattened(name, limits))
            if twice := [stored for stored in new if stored in flat]:
                side, _, measured = twice[0].partition("_")
                raise StudyError(f"constraints: the {side} of {measured} is given twice; drop one")
            flat |= new
    return flat, functions_of(functions)


def _flattened(name: str, limits: Any) -> dict[str, Any]:
    if not isinstance(limits, Mapping):
        return {name: limits}
    if not limits or not set(limits) <= {"min", "max"}:
        allowed = "a table with 'min', 'max' or both, such as {'max': 4.0}"
        raise StudyError(complaint(f"constraints: limits of {name}", dict(limits), allowed, "correct it"))
    return {f"{side}_{name}": value for side, value in limits.items()}


def run(
    study: Study | StrPath,
    db: StrPath | StudyPlace | None = None,
    *,
    algorithm: Any = None,
    objectives: Sequence[Goal] | None = None,
    constraints: Limits | None = None,
    calibration: AnyCalibration | None = None,
    evaluations: int | None = None,
    seed: int | None = None,
    workers: int | None = None,
    executor: Executor | None = None,
    callback: "Callable[[Progress], Any] | None" = None,
) -> StoredStudy:
    """Run a study into a database, or continue it where it stopped; the command ``run`` makes the same trials.

    Every generation is stored before ``callback`` hears of it. After a crash or an interrupt the same call goes on.

    An own function takes a table of jumps, name of a variable or measure -> array of shape (n,), and returns one number
    for each, from that jump alone. It becomes the measure ``own_NAME``, of which less is better. The database stores
    name and values, never the function: commands read, pick and report such a study, and only Python continues it.

    Args:
        study: a study, or the path of a study file.
        db: the database, made if missing; by default a file beside the study file, with the suffix
            ``.db``. Or the address of a server as text, ``postgresql://USER@HOST/DATABASE?schema=NAME``.
        algorithm: name of a search algorithm, or its name and settings, instead of the study's. Or one's own: an object
            with ``ask()``, which returns designs of shape (n, d) or None at its end, and ``tell(scores)``, see
            ``Scores``; or a class or function of the ``Space`` and the seed that makes one.
        objectives: two or three measures or own functions, instead of the study's.
        constraints: limits of measures or own functions, such as ``{"mass_kg": {"max": 4.0}}``, an own function that
            holds at <= 0, or a list of these; besides the study's, or instead of those on the same side of the same
            measure.
        calibration: the jump model instead of the study's: a calibration, the name of a shipped one, or a TOML file.
            ``paper`` brings the gearbox rules ``paper``; else rules and strength stay the study's.
        evaluations: total number of trials, instead of the study's.
        seed: instead of the study's.
        workers: threads that simulate, all cores if None. It does not change the trials.
        executor: does the jumps in their place, such as ``concurrent.futures.ProcessPoolExecutor``; it does not change
            the trials either.
        callback: called after each generation is stored, with the progress. If it returns True, the run ends with the
            next generation, which is computed by then: it is stored and told of, too. The study can be resumed.

    Warns:
        UserWarning: no design is feasible; it says which limits are missed, and by how much.

    Raises:
        StudyError: an unusable study, function or algorithm, a database that began with other settings, or fewer
            evaluations than it has.
        MotorError: an unknown name or an unusable file.
        CalibrationError: an unknown name, an unusable file, or a calibration whose values cannot be.
        DatabaseError: the file is no study, is damaged, is in use, or cannot be written.

    Example:
        >>> import tempfile, pareto_monoped as pm
        >>> folder = tempfile.TemporaryDirectory()
        >>> study = pm.Study.define(name="small", evaluations=200)
        >>> def lean(jumps):  # holds at <= 0
        ...     return jumps["mass_kg"] - 10.0 * jumps["thigh_length_m"]
        >>> stored = pm.run(study, folder.name + "/small.db", constraints=[{"mass_kg": {"max": 5.0}}, lean])
        >>> len(stored.trials), bool((stored.front().own_lean <= 0).all())
        (200, True)
        >>> folder.cleanup()
    """
    from pareto_monoped.study.run import run as run_study

    one = study if isinstance(study, Study) else Study.from_toml(as_path(study, "study", allowed=_STUDY))
    target = _database(study, db)
    changes, functions = _goals(one, objectives, constraints)
    if isinstance(calibration, Calibration):
        calibration = own_calibration(calibration)
        changes["calibration"] = stored_calibration_name(calibration)
    elif calibration is not None:
        changes["calibration"] = str(as_path(calibration, "calibration", allowed=_CALIBRATION))
    if "calibration" in changes and rules_for(changes["calibration"]) == "paper":
        changes["rules"] = "paper"
    own = _own_algorithm(algorithm)
    if algorithm is not None:
        changes["algorithm"] = {"name": own_algorithm_name(own)} if own is not None else _settings(algorithm)
    if seed is not None:
        changes["seed"] = seed_of(seed)
    summary = run_study(
        _changed(one, changes),
        target,
        evaluations=count_of("evaluations", evaluations),
        workers=count_of("workers", workers),
        executor=executor_of(executor),
        progress=called_after(callback),
        own=Own(
            functions=functions,
            algorithm=own,
            calibration=calibration if isinstance(calibration, Calibration) else None,
        ),
    )
    _warn_of_no_front(summary)
    return load_study(summary.db)


def resume(
    db: StrPath | StudyPlace,
    *,
    evaluations: int | None = None,
    algorithm: Any = None,
    functions: OwnFunction | Sequence[OwnFunction] = (),
    workers: int | None = None,
    executor: Executor | None = None,
    callback: "Callable[[Progress], Any] | None" = None,
) -> StoredStudy:
    """Continue a study from its database alone, and from what is one's own, which no database holds.

    Own functions are checked against some of the stored trials. An own algorithm is asked again for all of them, and
    told their scores.

    Args:
        db: the database.
        evaluations: the new total; by default that of the last run.
        algorithm: the study's own algorithm, as it was at the start, if it has one; see ``run``.
        functions: the study's own objectives and constraints, if it has some.
        workers: threads that simulate, all cores if None.
        executor: does the jumps in their place, see ``run``.
        callback: see ``run``.

    Warns:
        UserWarning: no design is feasible, see ``run``.

    Raises:
        StudyError: this code or machine computes other jumps than the study began with, an own function or algorithm is
            missing or another, or the new total is less than what is stored.
        DatabaseError: the file is no study, is damaged, is in use, or cannot be written.

    Example:
        >>> import pareto_monoped as pm
        >>> stored = pm.resume("light.db", evaluations=240)
        >>> len(stored.trials)
        240
    """
    from pareto_monoped.study.run import resume as resume_study

    own = _own_algorithm(algorithm)
    if algorithm is not None and own is None:
        raise StudyError(complaint("algorithm", algorithm, "an own one, the study knows every other", "leave it out"))
    summary = resume_study(
        as_place(db, "db"),
        evaluations=count_of("evaluations", evaluations),
        workers=count_of("workers", workers),
        executor=executor_of(executor),
        progress=called_after(callback),
        own=Own(functions=functions_of(listed("functions", functions)), algorithm=own),
    )
    _warn_of_no_front(summary)
    return load_study(summary.db)


def _warn_of_no_front(summary: "RunSummary") -> None:
    """Warn the caller of ``run`` or ``resume`` of what the command line notes where no design is feasible."""
    if summary.front_size == 0:
        from pareto_monoped.analysis.remarks import remarks

        for line in remarks(summary.data):
            warnings.warn(f"{summary.db}: {line}", UserWarning, stacklevel=3)


def _database(study: Study | StrPath, db: StrPath | StudyPlace | None) -> StudyPlace:
    if db is not None:
        return as_place(db, "db")
    if isinstance(study, Study):
        raise StudyError("db: is not given; name the database file, such as 'mine.db'")
    return as_path(study).with_suffix(".db")


def _goals(
    study: Study, objectives: Sequence[Goal] | None, constraints: Limits | None
) -> tuple[dict[str, Any], dict[str, OwnFunction]]:
    """Return the keys of a study that other goals change, and the own functions among them."""
    changes: dict[str, Any] = {}
    functions: dict[str, OwnFunction] = {}
    if objectives is not None:
        names, functions = objective_names(objectives)
        corner = study.reference_point.as_dict()
        changes["objectives"] = names
        changes["reference_point"] = {name: value for name, value in corner.items() if name in names}
    if constraints is not None:
        limits, limited = limits_of(constraints)
        changes["constraints"] = study.constraints.as_dict() | limits
        functions = functions_of([*functions.values(), *limited.values()])
    return changes, functions


def _own_algorithm(algorithm: Any) -> Any:
    """Return an algorithm that is not one of the package's by its name; else None."""
    return None if algorithm is None or isinstance(algorithm, str | Mapping) else algorithm


def _settings(algorithm: str | Mapping[str, Any]) -> dict[str, Any]:
    return {"name": algorithm} if isinstance(algorithm, str) else dict(algorithm)


def _changed(study: Study, changes: Mapping[str, Any]) -> Study:
    """Return the study with other values for some keys, in their stored form."""
    values = study.as_dict() | dict(changes)
    if values == study.as_dict():
        return study
    given = "iterations" in changes["algorithm"] if "algorithm" in changes else not study.shared_iterations
    return budgeted(study_from_dict(values, source="study"), given=given, source="study")


def robust(
    study: StoredStudy | StrPath,
    trials: int | Picked | Sequence[int | Picked] | ArrayLike | None = None,
    *,
    samples: int | None = None,
    seed: int | None = None,
    uncertainty: StrPath | None = None,
    workers: int | None = None,
) -> "DataFrame":
    """Let designs of a study jump as robots are built: masses, motors, friction, gains and more within their ranges.

    All designs have the same samples. What is stored of earlier calls, also of the command ``robust``, is not simulated
    again.

    Args:
        study: the study or its database.
        trials: a trial by its number or as ``pick`` returned it, or several, such as a column ``trial``; by default the
            front.
        samples: jumps per design, a power of two of at least 256; by default 256, or the study's if it asks for more.
        seed: of the samples, by default the study's.
        uncertainty: TOML file of the ranges; by default the study's, or the shipped ones.
        workers: threads that simulate, all cores if None. It does not change the results.

    Returns:
        One row per trial, with ``trial``, ``samples``, ``failed_share`` and ``overloaded_share`` (shares of the jumps
        that fail, and that overload a part), and for every measure its ``.mean``, ``.p05`` and ``.p95``, such as
        ``height_m.p05``, in the unit of its name; NaN where a measure has no value in some jump.

    Raises:
        SelectionError: a trial that is not there or did not jump, or an empty front.
        InputError: too few samples, or no usable ranges.
        StudyError: this code or machine computes other jumps than the stored ones.
        DatabaseError: the study is missing, damaged, or in use by another process.

    Example:
        >>> import pareto_monoped as pm
        >>> knee = pm.load_study("light.db").pick("knee")
        >>> built = pm.robust("light.db", knee)
        >>> bool(built["height_m.p05"][0] < knee.row.height_m)
        True
    """
    import pandas as pd

    from pareto_monoped.analysis.robustness import robust as run_robust
    from pareto_monoped.measures import MEASURE_NAMES, STATISTICS
    from pareto_monoped.uncertainty.samples import DEFAULT_SAMPLES
    from pareto_monoped.uncertainty.settings import Sampling, load_uncertainty

    stored = study if isinstance(study, StoredStudy) else load_study(study)
    own = stored.study.uncertainty or Sampling(ranges=load_uncertainty())
    results = run_robust(
        stored.path,
        own.ranges if uncertainty is None else load_uncertainty(as_path(uncertainty)),
        trials=_numbers(trials),
        samples=count_of("samples", samples) or max(own.samples, DEFAULT_SAMPLES),
        seed=own.seed if seed is None else seed_of(seed),
        workers=count_of("workers", workers),
    )
    rows: list[dict[str, Any]] = []
    for number, result in results.items():
        row: dict[str, Any] = {"trial": number, "samples": result.samples}
        row |= {"failed_share": result.failed, "overloaded_share": result.overloaded}
        for name in MEASURE_NAMES:
            spread = result.measures.get(name)
            row |= {f"{name}.{key}": float("nan") if spread is None else getattr(spread, key) for key in STATISTICS}
        rows.append(row)
    return pd.DataFrame(rows)


def _numbers(trials: Any) -> list[int] | None:
    if trials is None:
        return None
    listed = as_list(trials)
    several = list(listed) if isinstance(listed, Sequence) and not isinstance(listed, str | bytes) else [listed]
    if not several:
        raise InputError(complaint("number of trials", 0, "at least 1", "name one, or leave it out for the front"))
    return [one.trial if isinstance(one, Picked) else trial_of(one) for one in several]
