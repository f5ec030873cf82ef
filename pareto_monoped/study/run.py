"""Run a study into its database, or continue it: checks before, one session, the audit after."""

from collections.abc import Callable
from concurrent.futures import Executor
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from typing import Any, Literal

import numpy as np

from pareto_monoped.compute.chunks import cores
from pareto_monoped.definition import provenance
from pareto_monoped.definition.algorithms import WeightedSettings, share_of
from pareto_monoped.definition.study import Study
from pareto_monoped.errors import StudyError, complaint
from pareto_monoped.pareto.growth import SecondSearch, left_to_gain, second_search
from pareto_monoped.pareto.objectives import hypervolume
from pareto_monoped.search.registry import make_algorithm
from pareto_monoped.storage.base import BY_NAME, StudyLock
from pareto_monoped.storage.kept_front import foreign_note
from pareto_monoped.storage.meta import StudyMeta
from pareto_monoped.storage.place import StudyPlace, beside, storage_of
from pareto_monoped.storage.reader import StudyData, read_study
from pareto_monoped.storage.store import Store, create_database
from pareto_monoped.study.audits import audit_front
from pareto_monoped.study.own_functions import NOTHING, Own, refuse_other_functions, require_functions, with_functions
from pareto_monoped.study.session import Interrupt, Progress, Session
from pareto_monoped.study.simulator import (
    Simulator,
    continued_simulator,
    evaluation_of,
    load_simulator,
    stored_simulator,
)


def shared_anew(study: Study, evaluations: int | None) -> Study:
    """Return the study of a new database: a budget beyond the file's own is shared out, a smaller one cuts it."""
    settings = study.algorithm
    if not study.shared_iterations or not isinstance(settings, WeightedSettings):
        return study
    budget = max(evaluations or 0, study.evaluations)
    return replace(study, algorithm=replace(settings, iterations=max(1, share_of(settings, budget))))


def shared_as_stored(study: Study, stored: Study) -> Study:
    """Return the study of an existing database: a file that gives no iterations takes the stored ones."""
    settings, before = study.algorithm, stored.algorithm
    if study.shared_iterations and isinstance(settings, WeightedSettings) and isinstance(before, WeightedSettings):
        return replace(study, algorithm=replace(settings, iterations=before.iterations))
    return study


@dataclass(frozen=True, slots=True, kw_only=True)
class RunSummary:
    """The result of a run."""

    db: StudyPlace  #: the study's database
    evaluations: int  #: number of trials in all
    new_evaluations: int  #: number of trials of this session
    front_size: int  #: number of designs on the front
    ill_conditioned: int  #: number of designs that failed their audit
    hypervolume: float  #: hypervolume of the front
    hypervolume_unit: str  #: product of the objectives' units, such as "m J"
    seconds: float  #: duration of this session
    #: ``budget``, ``wall_time``, ``plateau``, ``exhausted`` (the algorithm has no more designs) or ``interrupted``
    stop_reason: str
    strength: bool  #: whether designs on the front hold; else strength was not asked for
    data: StudyData  #: the study as it is stored now


def _silent(_: Any) -> None:
    """Ignore a report."""


def run(
    study: Study,
    db: StudyPlace,
    *,
    evaluations: int | None = None,
    seed: int | None = None,
    workers: int | None = None,
    executor: Executor | None = None,
    progress: Callable[[Progress], object] | None = None,
    notify: Callable[[str], None] | None = None,
    own: Own = NOTHING,
) -> RunSummary:
    """Run a study into a database, or continue it where it stopped.

    The database is created if missing; a server's address without a schema gets one after the study's name.
    ``evaluations``, the total number of trials, and ``seed`` replace the study's. Neither ``workers``, threads that
    simulate, nor an ``executor`` in their place changes the trials. ``progress`` is called after each stored
    generation; if it returns True, the run ends with the next generation, which is computed by then, stored and told
    of. ``notify`` gets lines for the user, for example on Ctrl-C.

    Raises:
        StudyError: the study in the database has other settings; the message shows the difference. Or ``own`` is not
            what the study names. Or ``evaluations`` is less than what is stored.
        DatabaseError: the file is not a study, is damaged, is in use by another process, or cannot be written.
    """
    if seed is not None:
        study = replace(study, seed=seed)
    db = storage_of(db).place_for(study.name)
    storage = storage_of(db)
    with storage.locked() as lock:
        threads = workers or cores()
        if storage.is_vacant():
            lock.acknowledge(0)
            study = shared_anew(study, evaluations)
            require_functions(study.own_names, own.functions, _source(db))
            simulator = load_simulator(study, workers=threads, executor=executor, calibration=own.calibration)
            algorithm = make_algorithm(study, simulator.coordinates(study), own.algorithm)
            create_database(db, study, _meta(study, simulator), algorithm.state())
            data = read_study(db)
        else:
            data = _checked(db, lock)
            study = shared_as_stored(study, data.study)
            simulator = continued_simulator(
                data, study, workers=threads, executor=executor, calibration=own.calibration
            )
            _refuse_changes(data, study, simulator, db)
            # The same limits in another order would give the algorithm its columns in another order.
            study = replace(study, constraints=data.study.constraints)
        _refuse_fewer(data, evaluations, db)
        budget = evaluations or study.evaluations
        return _go_on(db, data, study, simulator, budget, progress or _silent, notify or _silent, lock, own)


def resume(
    db: StudyPlace,
    *,
    evaluations: int | None = None,
    workers: int | None = None,
    executor: Executor | None = None,
    progress: Callable[[Progress], object] | None = None,
    notify: Callable[[str], None] | None = None,
    own: Own = NOTHING,
) -> RunSummary:
    """Continue a study from its database alone; arguments and errors are as for ``run``.

    The default for ``evaluations`` is the total of the last run. ``own`` has the functions and the algorithm that the
    study names, which its database does not hold. This code and machine must compute what the study began with.
    """
    read_study(db)
    with storage_of(db).locked() as lock:
        data = _checked(db, lock)
        simulator = stored_simulator(data, workers=workers or cores(), executor=executor)
        _refuse_changes(data, data.study, simulator, db)
        _refuse_fewer(data, evaluations, db)
        budget = evaluations or data.meta.budget
        return _go_on(db, data, data.study, simulator, budget, progress or _silent, notify or _silent, lock, own)


def seed_of_second(seed: int, given: int | Literal[True]) -> int:
    """Return the seed of a second search of a study: that ``given``, or the next one if that is True."""
    found = (seed + 1) % 2**63 if given is True else given
    if found == seed:
        raise StudyError(complaint("second seed", found, "another one than the study's", "give another, or no number"))
    return found


def run_second(first: RunSummary, study: Study, seed: int, **options: Any) -> tuple[RunSummary, SecondSearch | None]:
    """Search a study that has ended again with another seed, in a database beside the first, and compare at its end.

    ``options`` are those of ``run``. The budget, and the iterations of a weighted search, are those of the first.
    """
    data, corner = first.data, first.data.reference_point
    same = replace(shared_as_stored(study, data.study), shared_iterations=False)
    second = run(same, beside(first.db, f"_seed_{seed}"), evaluations=data.meta.budget, seed=seed, **options)
    if second.stop_reason == "interrupted":
        return second, None
    left = left_to_gain(*data.history[["evaluations", "hypervolume"]].to_numpy().T)
    fronts = [one.front()[list(corner.objectives.names)].to_numpy(dtype=np.float64) for one in (data, second.data)]
    return second, second_search(fronts[0], fronts[1], corner, left)


def _checked(db: StudyPlace, lock: StudyLock) -> StudyData:
    """Return the study, if it has everything that was safe when its last run was killed."""
    data = read_study(db)
    lock.confirm(data.links)
    return data


def _meta(study: Study, simulator: Simulator) -> StudyMeta:
    versions = provenance.versions(study)
    decisive = provenance.decisive(study, simulator.contents, versions)
    return StudyMeta(
        study=study.as_dict(),
        motor=study.motor_text,
        calibration=simulator.calibration.label,
        seed=study.seed,
        contents=simulator.contents,
        files=simulator.files,
        versions=versions,
        environment=provenance.environment(),
        hash=provenance.digest(decisive),
        probe=simulator.probe(),
        created=datetime.now(UTC).isoformat(timespec="seconds"),
        budget=study.evaluations,
        finished=False,
        stop_reason=None,
    )


def _refuse_changes(data: StudyData, study: Study, simulator: Simulator, db: StudyPlace) -> None:
    before = provenance.decisive(data.study, data.meta.contents, data.meta.versions)
    now = provenance.decisive(study, simulator.contents, provenance.versions(study))
    changes = provenance.differences(before, now)
    if study.evaluations < data.study.evaluations:
        changes.append(f"study.evaluations: {data.study.evaluations} -> {study.evaluations} (only more is allowed)")
    if changes:
        raise StudyError(
            f"study database {str(db)!r}: began with other settings ({'; '.join(changes)}); undo the change, "
            f"or give another database file {BY_NAME} to start anew"
        )


def _refuse_fewer(data: StudyData, evaluations: int | None, db: StudyPlace) -> None:
    """Refuse a total that is below what is stored: trials are never taken back."""
    if evaluations is not None and evaluations < len(data.trials):
        raise StudyError(
            f"study database {str(db)!r}: evaluations: {len(data.trials)} -> {evaluations} (only more is allowed); "
            f"give at least {len(data.trials)}, or none to keep them"
        )


def _refuse_other_results(data: StudyData, simulator: Simulator, db: StudyPlace) -> None:
    before, now = data.meta.probe, simulator.probe()
    if before != now:
        raise StudyError(
            f"study database {str(db)!r}: began with other results: height and energy of the probe designs were "
            f"{before}, are {now} with this code and machine; continue where it began, or start anew with another "
            f"database file {BY_NAME}"
        )


def refuse_other_code(data: StudyData, simulator: Simulator) -> None:
    """Refuse to repeat a study's jumps with code or a machine that would compute others."""
    _refuse_changes(data, data.study, simulator, data.db)
    _refuse_other_results(data, simulator, data.db)


def _nothing_left(data: StudyData, study: Study, budget: int) -> bool:
    """Return whether the study has ended and would end again at once."""
    same = data.meta.finished and study == data.study
    return same and (len(data.trials) >= budget or data.meta.stop_reason != "budget")


def _go_on(
    db: StudyPlace,
    data: StudyData,
    study: Study,
    simulator: Simulator,
    budget: int,
    progress: Callable[[Progress], object],
    notify: Callable[[str], None],
    lock: StudyLock,
    own: Own,
) -> RunSummary:
    if _nothing_left(data, study, budget):
        if not storage_of(db).is_at_rest():
            # A kill at the very end has left a log; opening the study for writing makes it a single file again.
            with Store(db, study, lock=lock):
                pass
        asked = replace(data.meta, budget=max(budget, data.meta.budget))
        return _summary(db, data, replace(data, meta=asked), 0.0)
    require_functions(study.own_names, own.functions, _source(db))
    refuse_other_functions(data.trials, own.functions, _source(db))
    _refuse_other_results(data, simulator, db)
    coordinates = simulator.coordinates(study)
    evaluate = with_functions(evaluation_of(study, simulator.evaluator), own.functions)
    with Store(db, study, coordinates=coordinates, lock=lock) as store:
        if foreign := store.foreign_count():
            notify(f"note: {foreign_note(foreign)}")
        session = Session(data, study, evaluate, store, budget, progress, coordinates, own.algorithm)
        store.set_meta({"study": study.as_dict(), "budget": budget, "finished": False, "stop_reason": None})
        with Interrupt(notify) as interrupt:
            reason = session.go(interrupt)
        finished = reason != "interrupted"
        if finished and study.audit:
            audit_front(db, store, simulator, notify)
        store.set_meta({"finished": finished, "stop_reason": reason})
    return _summary(db, data, read_study(db), session.elapsed)


def _source(db: StudyPlace) -> str:
    return f"study database {str(db)!r}"


def _summary(db: StudyPlace, before: StudyData, after: StudyData, seconds: float) -> RunSummary:
    front, objectives = after.front(), after.study.objectives
    return RunSummary(
        db=db,
        evaluations=len(after.trials),
        new_evaluations=len(after.trials) - len(before.trials),
        front_size=len(front),
        ill_conditioned=len(after.ill_conditioned),
        hypervolume=hypervolume(front[list(objectives.names)].to_numpy(), after.reference_point),
        hypervolume_unit=objectives.volume_unit,
        seconds=seconds,
        stop_reason=after.meta.stop_reason or "",
        strength=after.study.strength,
        data=after,
    )
