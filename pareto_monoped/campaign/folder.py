"""The databases of a campaign: which study is in which file, how far each is, and what stands in the way."""

import os
from collections.abc import Iterable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Literal

from pareto_monoped.campaign.grid import Campaign, Member, canonical
from pareto_monoped.definition.provenance import decisive, differences
from pareto_monoped.definition.study import Study, study_from_dict
from pareto_monoped.errors import DatabaseError, OutputError, StudyError
from pareto_monoped.files import unwritable
from pareto_monoped.pareto.objectives import hypervolume
from pareto_monoped.storage.lock import holder, locked
from pareto_monoped.storage.meta import StudyMeta, meta_of_rows
from pareto_monoped.storage.place import storage_of
from pareto_monoped.storage.status import Summary, read_summary

State = Literal["waiting", "running", "finished", "unfinished", "failed"]
"""Of a study: ``waiting`` has not begun, ``unfinished`` can be continued, ``finished`` has a front."""

NO_FEASIBLE_DESIGN = "no feasible design"


@dataclass(frozen=True, slots=True, kw_only=True)
class Place:
    """A study and its database."""

    name: str  #: of the study in the campaign
    db: Path  #: missing before the study began
    study: Study  #: under the name that the database has
    member: Member  #: what it is in the campaign


@dataclass(frozen=True, slots=True, kw_only=True)
class Stored:
    """How far a study is according to its database."""

    state: State  #: ``failed`` if the database cannot be read, or the study ended without a feasible design
    evaluations: int  #: number of trials
    budget: int  #: how many trials there shall be
    hypervolume: float  #: of its front
    hypervolume_unit: str
    front: int = 0  #: number of designs on it
    seconds: float = 0.0  #: running time so far
    reason: str = ""  #: why it failed; else empty
    summary: Summary | None = None  #: the rest; None before the study began, and if its database cannot be read


@contextmanager
def held(folder: Path) -> Iterator[None]:
    """Make the folder of a campaign, and keep other coordinators out of it.

    Raises:
        DatabaseError: another process runs a campaign there.
        OutputError, DiskError: it cannot be written to.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise unwritable(folder, error, "give another --folder") from None
    if not os.access(folder, os.W_OK | os.X_OK):
        raise OutputError(
            f"campaign folder {str(folder)!r}: cannot be written to; give another --folder, or look only, with --status"
        )
    marker = folder / "campaign"
    with ExitStack() as stack:
        try:
            stack.enter_context(locked(marker))
        except DatabaseError:
            raise DatabaseError(
                f"campaign folder {str(folder)!r}: is being run by process {holder(marker) or 'unknown'}; wait for it, "
                "stop it, or give another --folder"
            ) from None
        except OutputError as error:
            problem = f"campaign folder {str(folder)!r}: cannot be used ({error}); give another --folder"
            raise OutputError(problem) from None
        yield


def places_of(campaign: Campaign, folder: Path) -> list[Place]:
    """Return the database of each study of a campaign, which has the study's name.

    If it does not exist, but another database in the folder that no name leads to has the same settings, that is used:
    the grid has got another axis since. Other settings in databases of these names are a ``StudyError``.
    """
    own = {member.name: folder / f"{member.name}.db" for member in campaign.members}
    others = _others(folder, own.values())
    places, refused = [], []
    for member in campaign.members:
        db = own[member.name]
        if _is_new(db):
            db = others.get(_key(member.study), db)
        stored = _meta(db)
        study = member.study if stored is None else replace(member.study, name=stored[0].name)
        if stored is not None and (changes := _changes(stored[0], study)):
            refused.append((db, changes))
        places.append(Place(name=member.name, db=db, study=study, member=member))
    if refused:
        db, changes = refused[0]
        count = f"{len(refused)} databases" if len(refused) > 1 else "a database"
        raise StudyError(
            f"campaign folder {str(folder)!r}: {count} began with other settings, such as {db.name!r} "
            f"({'; '.join(changes)}); undo the change, or give another --folder"
        )
    return places


def strangers(folder: Path, places: Sequence[Place]) -> list[Path]:
    """Return databases in the folder that are of no study of the campaign."""
    used = {place.db for place in places}
    return [db for db in sorted(folder.glob("*.db")) if db not in used]


def stored_state(place: Place) -> Stored:
    """Return how far a study is."""
    budget, unit = place.study.evaluations, place.study.objectives.volume_unit
    nothing = Stored(state="waiting", evaluations=0, budget=budget, hypervolume=0.0, hypervolume_unit=unit)
    try:
        if storage_of(place.db).is_vacant():
            return nothing
        summary = read_summary(place.db)
    except (DatabaseError, OSError) as error:
        return replace(nothing, state="failed", reason=str(error))
    done = sum(summary.counts.values())
    ended = summary.meta.finished and (done >= budget or summary.meta.stop_reason != "budget")
    empty = ended and not len(summary.front)
    state: State = "failed" if empty else "finished" if ended else "running" if holder(place.db) else "unfinished"
    return Stored(
        state=state,
        evaluations=done,
        budget=budget,
        hypervolume=hypervolume(summary.front, summary.study.reference_point),
        hypervolume_unit=unit,
        front=len(summary.front),
        seconds=summary.seconds,
        reason=NO_FEASIBLE_DESIGN if empty else "",
        summary=summary,
    )


def is_ended(place: Place, stored: Stored) -> bool:
    """Return whether a study has ended as its file says, with no motor or calibration file of the user's."""
    if stored.summary is None or stored.state not in ("finished", "failed"):
        return False
    names = (*place.study.motors, place.study.calibration)
    return stored.summary.study == place.study and not any(name.endswith(".toml") for name in names)


def _others(folder: Path, own: Iterable[Path]) -> dict[str, Path]:
    known = set(own)
    found = {}
    for db in sorted(folder.glob("*.db")):
        if db not in known and (stored := _meta(db)) is not None:
            found[_key(stored[0])] = db
    return found


def _is_new(db: Path) -> bool:
    try:
        return storage_of(db).is_vacant()
    except DatabaseError:
        return False


def _meta(db: Path) -> tuple[Study, StudyMeta] | None:
    """Return a stored study's settings; None where none can be read: running it then says why."""
    try:
        if storage_of(db).is_vacant():
            return None
        with storage_of(db).reading() as connection:
            meta = meta_of_rows(connection.execute("SELECT key, value FROM monoped_meta").fetchall(), db)
        return study_from_dict(meta.study, source=f"study database {str(db)!r}"), meta
    except (DatabaseError, StudyError, OSError):
        return None


def _settings(study: Study) -> dict[str, Any]:
    """Return what decides a study's trials, with the names of motors and calibration, without its own name."""
    # Of files the last part of their path: a folder with campaign, motors and databases can be moved.
    names = [[Path(name).name for name in kit] for kit in study.kits]
    settings = decisive(study, {}, {})["study"] | {"motors": names, "calibration": Path(study.calibration).name}
    return {key: value for key, value in settings.items() if key != "name"}


def _key(study: Study) -> str:
    return canonical(_settings(study))


def _changes(stored: Study, study: Study) -> list[str]:
    before, now = _settings(stored), _settings(study)
    changes = [] if canonical(before) == canonical(now) else differences(before, now)
    if study.evaluations < stored.evaluations:
        changes.append(f"evaluations: {stored.evaluations} -> {study.evaluations} (only more is allowed)")
    return changes
