"""Run, resume and compare studies from scripts, with a bar that shows how far they are."""

import sys
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import Executor
from contextlib import contextmanager
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Literal

from pareto_monoped.api.given import (
    called_after,
    executor_of,
    own_calibration,
    seed_of,
    stored_calibration_name,
    truth_of,
)
from pareto_monoped.api.jumps import AnyCalibration, StrPath
from pareto_monoped.api.studies import StoredStudy, as_path, as_place, load_study
from pareto_monoped.definition.given import as_list, as_plain, as_table, count_of
from pareto_monoped.definition.study import Study, budgeted, open_up, study_from_dict
from pareto_monoped.definition.study import load_study as load_study_file
from pareto_monoped.errors import InputError, StudyError, complaint, require_extra
from pareto_monoped.jump.calibration import Calibration
from pareto_monoped.jump.calibration_defaults import copies_for, rules_for
from pareto_monoped.search.own_algorithm import own_algorithm_name
from pareto_monoped.storage.place import StudyPlace
from pareto_monoped.study.own_functions import Own, OwnFunction, functions_of, listed, own_name

if TYPE_CHECKING:
    from pandas import DataFrame
    from rich.console import Console

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
    second_seed: int | Literal[True] | None = None,
    opened: bool = False,
    workers: int | None = None,
    executor: Executor | None = None,
    callback: "Callable[[Progress], Any] | None" = None,
    progress: bool | None = None,
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
        second_seed: search again with this seed, or the next one if True, and compare: the result has it as ``second``.
        opened: free the optional variables, but for the start height, that a file leaves out or a ``Study`` has at
            their defaults, and give K, C and T wider bounds than the paper's.
        workers: threads that simulate, all cores if None. It does not change the trials.
        executor: does the jumps in their place, such as ``concurrent.futures.ProcessPoolExecutor``; it does not change
            the trials either.
        callback: called after each generation is stored, with the progress. If it returns True, the run ends with the
            next generation, which is computed by then: it is stored and told of, too. The study can be resumed.
        progress: whether to show a bar; by default in notebooks only.

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
        >>> study = pm.Study.define(name="small", evaluations=100)
        >>> def lean(jumps):  # holds at <= 0
        ...     return jumps["mass_kg"] - 10.0 * jumps["thigh_length_m"]
        >>> stored = pm.run(study, folder.name + "/small.db", constraints=[{"mass_kg": {"max": 5.0}}, lean])
        >>> len(stored.trials), bool((stored.front().own_lean <= 0).all())
        (100, True)
        >>> folder.cleanup()
    """
    from pareto_monoped.study.run import run as run_study
    from pareto_monoped.study.run import run_second, seed_of_second

    opened = truth_of("opened", opened)
    if isinstance(study, Study):
        one = open_up(study) if opened else study
    else:
        one = load_study_file(as_path(study, "study", allowed=_STUDY), opened=opened)
    target = _database(study, db)
    changed, own = _asked(one, algorithm, objectives, constraints, calibration, seed)
    second = found = None
    if second_seed is not None:
        given = second_seed if second_seed is True else seed_of(second_seed, "second_seed")
        second = seed_of_second(changed.seed, given)
        if not isinstance(own.algorithm, type) and hasattr(own.algorithm, "ask"):
            allowed = "a class or function that makes one, for a second seed"
            raise StudyError(complaint("algorithm", own.algorithm, allowed, "give one"))
    options = {"workers": count_of("workers", workers), "executor": executor_of(executor), "own": own}
    with _heard(callback, progress) as hear:
        summary = run_study(changed, target, evaluations=count_of("evaluations", evaluations), progress=hear, **options)
        if second is not None and summary.stop_reason != "interrupted":
            _, found = run_second(summary, changed, second, progress=hear, **options)
    _warn_of_no_front(summary)
    return replace(load_study(summary.db), second=found)


def _asked(
    study: Study,
    algorithm: Any,
    objectives: Sequence[Goal] | None,
    constraints: Limits | None,
    calibration: AnyCalibration | None,
    seed: int | None,
) -> tuple[Study, Own]:
    """Return the study with what ``run`` was asked to change, and what of it is one's own."""
    changes, functions = _goals(study, objectives, constraints)
    own_model: Calibration | None = None
    if isinstance(calibration, Calibration):
        own_model = own_calibration(calibration)
        changes["calibration"] = stored_calibration_name(own_model)
    elif calibration is not None:
        changes["calibration"] = str(as_path(calibration, "calibration", allowed=_CALIBRATION))
    if "calibration" in changes:
        changes["copies"] = copies_for(changes["calibration"])
        if rules_for(changes["calibration"]) == "paper":
            changes |= {"rules": "paper", "audit": False}
    own = _own_algorithm(algorithm)
    if algorithm is not None:
        changes["algorithm"] = {"name": own_algorithm_name(own)} if own is not None else _settings(algorithm)
    if seed is not None:
        changes["seed"] = seed_of(seed)
    return _changed(study, changes), Own(functions=functions, algorithm=own, calibration=own_model)


def resume(
    db: StrPath | StudyPlace,
    *,
    evaluations: int | None = None,
    algorithm: Any = None,
    functions: OwnFunction | Sequence[OwnFunction] = (),
    workers: int | None = None,
    executor: Executor | None = None,
    callback: "Callable[[Progress], Any] | None" = None,
    progress: bool | None = None,
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
        progress: see ``run``.

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
    with _heard(callback, progress) as hear:
        summary = resume_study(
            as_place(db, "db"),
            evaluations=count_of("evaluations", evaluations),
            workers=count_of("workers", workers),
            executor=executor_of(executor),
            progress=hear,
            own=Own(functions=functions_of(listed("functions", functions)), algorithm=own),
        )
    _warn_of_no_front(summary)
    return load_study(summary.db)


@contextmanager
def _heard(callback: Any, progress: bool | None) -> "Iterator[Callable[[Progress], Any] | None]":
    """Yield what hears of every stored generation: a bar where one is wanted, and the callback, whose answer counts."""
    call = called_after(callback)
    if not (in_notebook() if progress is None else truth_of("progress", progress)):
        yield call
        return
    with bar() as show:

        def hear(standing: "Progress") -> Any:
            show(standing)
            return None if call is None else call(standing)

        yield hear


def in_notebook() -> bool:
    """Return whether a notebook runs this process, rather than a terminal or a script."""
    shell = sys.modules["IPython"].get_ipython() if "IPython" in sys.modules else None
    return hasattr(shell, "kernel")


@contextmanager
def bar(console: "Console | None" = None) -> "Iterator[Callable[[Progress], None]]":
    """Yield what shows progress as a bar, in the notebook or on stderr."""
    if in_notebook():
        from IPython import display as notebook

        html: Any = notebook.HTML
        shown: Any = notebook.display(html(""), display_id=True)  # type: ignore[no-untyped-call]  # IPython has no types
        yield lambda now: shown.update(
            html(f"<progress value='{now.evaluations}' max='{now.budget}'></progress> {now.text()}")
        )
        return
    from rich.progress import BarColumn, TextColumn
    from rich.progress import Progress as Bar

    if console is None:
        from rich.console import Console

        console = Console(stderr=True)
    with Bar(BarColumn(bar_width=16), TextColumn("{task.description}"), console=console) as lines:
        task = lines.add_task("simulating", total=None)
        yield lambda now: lines.update(task, total=now.budget, completed=now.evaluations, description=now.text())


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


def run_campaign(
    file: StrPath,
    *,
    folder: StrPath | None = None,
    workers: int | None = None,
    scheduler: str | None = None,
    status: bool = False,
    report: StrPath | None = None,
    csv: StrPath | None = None,
    force: bool = False,
) -> "DataFrame":
    """Run a grid of studies, or continue it where it stopped; the command ``campaign`` does the same.

    Args:
        file: the campaign's TOML file, which names a study and lists of values for some of its keys.
        folder: of the databases; by default one beside the file, with its name.
        workers: threads of all studies together, all cores if None; with a scheduler, studies at a time.
        scheduler: address of a Dask scheduler, whose workers do the jumps.
        status: whether to run nothing, and only say how the studies stand.
        report: HTML file for a page that compares them.
        csv: file for a table that compares them.
        force: replace files of another kind.

    Returns:
        One row per study: name, database, state, trials, hypervolume, size of the front, and why it failed, if it did.

    Raises:
        StudyError: an unusable campaign, or databases of another one.
        InputError: an unusable path, or the extra for a scheduler is missing.
        DatabaseError: another process holds the folder.

    Example:
        >>> import pareto_monoped as pm
        >>> grid = pm.run_campaign("seeds.toml", report="seeds.html")  # doctest: +SKIP
        >>> grid[["study", "state", "hypervolume"]]  # doctest: +SKIP
    """
    import pandas as pd

    from pareto_monoped.campaign.coordinator import run_campaign as run_all
    from pareto_monoped.campaign.coordinator import standings_of
    from pareto_monoped.campaign.folder import held, places_of
    from pareto_monoped.campaign.grid import load_campaign
    from pareto_monoped.files import require_writable

    if scheduler is not None:
        if not isinstance(scheduler, str):
            raise InputError(complaint("scheduler", scheduler, "an address, such as 'tcp://host:8786'", "give one"))
        require_extra("cluster", "scheduler")
    page, table = (None if one is None else as_path(one, what) for what, one in (("report", report), ("csv", csv)))
    for output in (page, table):
        if output is not None:
            require_writable(output)
    grid = load_campaign(as_path(file, "file"))
    place = grid.folder if folder is None else as_path(folder, "folder")
    if truth_of("status", status):
        standings = standings_of(places_of(grid, place))
    else:
        with held(place):
            standings = standings_of(places_of(grid, place))
            run_all(
                standings,
                cores=count_of("workers", workers),
                scheduler=scheduler,
                changed=lambda _: None,
                notify=warnings.warn,
            )
    if page is not None or table is not None:
        from pareto_monoped.campaign.page import write_results

        failed = {one.name: one.reason for one in standings if one.state == "failed"}
        write_results(
            grid, [one.place for one in standings], failed, page=page, table=table, force=truth_of("force", force)
        )
    return pd.DataFrame([one.as_dict() for one in standings])
