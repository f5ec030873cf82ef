"""Read a study database by plain SELECTs: everything that report, CAD and command line need.

Stored rows become a data frame with every column there is, the names of the motors, and measures that follow exactly
from those that databases of earlier versions have.
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import islice
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from pareto_monoped.config import parsed_json
from pareto_monoped.definition.study import Study, study_from_dict
from pareto_monoped.definition.variables import MOTOR_KEYS, names_of
from pareto_monoped.design import DEFAULTS, PAPER_MOTOR
from pareto_monoped.errors import DatabaseError
from pareto_monoped.pareto.objectives import Objectives, ReferencePoint
from pareto_monoped.pareto.pick import front_within
from pareto_monoped.pareto.selectors import Condition
from pareto_monoped.storage.base import undamaged
from pareto_monoped.storage.columns import COLUMNS, LATER, REQUIRED
from pareto_monoped.storage.connection import Connection
from pareto_monoped.storage.meta import StudyMeta, meta_of_rows, motor_keys
from pareto_monoped.storage.place import StudyPlace, storage_of
from pareto_monoped.storage.seals import (
    ROWS,
    Parts,
    Seals,
    content_hash,
    damaged,
    has_seals,
    missing_findings,
    numbering_findings,
    read_seals,
    trial_digests,
)

if TYPE_CHECKING:
    from pareto_monoped.actuator.motor import Motor
    from pareto_monoped.actuator.ratiomap import ActuatorMap, JointMaps
    from pareto_monoped.jump.calibration import Calibration
    from pareto_monoped.search.space import Coordinates

_DTYPES = {column.name: column.dtype for column in COLUMNS}


_BLOCK = 4_000
"""Rows that are values of Python at once, eight times as large as in the frame: 10 MB. Our own choice."""
Block = dict[str, Any]
"""Trials that follow one another: column -> values of its type."""


def trial_frame(blocks: Iterable[Block], expected: int = 0) -> pd.DataFrame:
    """Return the trials of all blocks as a data frame; it takes least memory if as many come as are ``expected``."""
    # Columns are filled in place: memory of many small pieces stays with the process after they have been joined.
    columns: dict[str, Any] = {}
    count = 0
    for block in blocks:
        end = count + len(block["trial"])
        for name, values in block.items():
            if not isinstance(values, np.ndarray):
                columns.setdefault(name, []).append(pd.Series(values))
                continue
            if name not in columns or len(columns[name]) < end:
                larger = np.empty(max(end, expected, 2 * count), dtype=values.dtype)
                larger[:count] = columns.get(name, larger)[:count]
                columns[name] = larger
            columns[name][count:end] = values
        count = end
    for name, values in columns.items():
        texts = isinstance(values, list)
        columns[name] = pd.concat(values, ignore_index=True).array if texts else values[:count]
    return pd.DataFrame(columns, copy=False)


def trial_blocks(names: list[str], rows: Iterable[tuple[Any, ...]], db: StudyPlace) -> Iterator[Block]:
    """Yield trials block by block, at least one; refuse damaged ones."""
    left = iter(rows)
    try:
        yield _typed_columns(names, list(islice(left, _BLOCK)))
        while block := list(islice(left, _BLOCK)):
            yield _typed_columns(names, block)
    except (KeyError, TypeError, ValueError, OverflowError) as error:
        raise DatabaseError(
            f"study database {str(db)!r}: its trials are damaged ({type(error).__name__}: {error}); restore a copy"
        ) from None


def _typed_columns(names: list[str], rows: list[tuple[Any, ...]]) -> Block:
    columns: dict[str, tuple[Any, ...]] = dict.fromkeys(names, ())
    if rows:
        columns = dict(zip(names, zip(*rows, strict=True), strict=True))
    for column in LATER:
        columns.setdefault(column.name, (DEFAULTS.get(column.name),) * len(rows))
    known = [*REQUIRED, *(column.name for column in COLUMNS if column.name not in REQUIRED)]
    ordered = [*known, *(name for name in columns if name not in known)]
    # A column that only a later version knows is read as a number, as every measure is.
    return {name: _typed(columns[name], _DTYPES.get(name, "float64")) for name in ordered}


def _typed(values: tuple[Any, ...], dtype: str) -> Any:
    if dtype == "str":
        # The same text is kept once per block, not once per row.
        texts = {value: "" if value is None else str(value) for value in set(values)}
        return pd.array(list(map(texts.__getitem__, values)), dtype="str")
    if dtype == "int64":
        return np.array(values, dtype=np.int64)
    return np.array(values, dtype=np.float64)  # None becomes NaN


def with_motors(trials: pd.DataFrame, study: Study, meta: StudyMeta, db: StudyPlace) -> pd.DataFrame:
    """Return the trials with the names of each one's motors, which the database leaves out where all have the same.

    The column ``motor`` always says what motors a trial has; ``hip_motor`` and ``knee_motor`` stand only where the
    study names them. A trial with another motor raises ``DatabaseError``.
    """
    contents = [meta.contents.get(key, {}) for key in motor_keys(len(study.motors))]
    known = {
        named.lower(): str(values.get("name", named)) for values, named in zip(contents, study.motors, strict=True)
    }
    for key in MOTOR_KEYS:
        given = getattr(study, key)
        if given is None:
            trials = trials.drop(columns=key)
            continue
        names = [known[named.lower()] for named in names_of(given)]
        if len(names) == 1:
            trials = trials.assign(**{key: pd.array(names * len(trials), dtype="str")})
        unknown = trials.loc[~trials[key].isin(names), key]
        if len(unknown):
            raise DatabaseError(
                f"study database {str(db)!r}: its trials are damaged ({key.replace('_', ' ')} {unknown.iloc[0]!r} is "
                "not of the study); restore a copy"
            )
    if study.motor is None:
        from pareto_monoped.actuator.ratiomap import motor_label

        labels = map(motor_label, trials["hip_motor"], trials["knee_motor"])
        trials = trials.assign(motor=pd.array(list(labels), dtype="str"))
    return trials


def with_agility(trials: pd.DataFrame) -> pd.DataFrame:
    """Return the trials with ``agility_m_per_s`` wherever height and time of the apex are known.

    It is the same division as in ``jump.evaluate``, so a filled value equals a stored one to the last bit. The running
    hash is over what is stored: check it before.
    """
    stored = trials["agility_m_per_s"].to_numpy(dtype=np.float64)
    height, start, apex = (trials[name].to_numpy(dtype=np.float64) for name in ("height_m", "start_height_m", "apex_s"))
    missing = np.isnan(stored) & np.isfinite(height) & (apex > 0.0)
    if not missing.any():
        return trials
    filled = stored.copy()
    filled[missing] = (height[missing] - start[missing]) / apex[missing]
    return trials.assign(agility_m_per_s=filled)


_HISTORY = {"generation": np.int64, "evaluations": np.int64, "hypervolume": np.float64, "seconds": np.float64}
"""Columns of the table ``monoped_history`` and their types in the data frame."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Checkpoint:
    """The algorithm's state before generation ``generation``, when it knew the scores of ``evaluations`` trials."""

    generation: int
    evaluations: int
    state: dict[str, Any]


@dataclass(frozen=True, kw_only=True, eq=False)  # without slots: cached properties need a place to keep their values
class StudyData:
    """All of a study."""

    db: StudyPlace  #: the database it was read from
    study: Study  #: its definition
    #: what else is stored about it: versions, hash, budget, how it ended, contents of motor and calibration
    meta: StudyMeta
    trials: pd.DataFrame  #: one row per trial; ``columns.COLUMNS`` says what each column is
    #: one row per generation: generation, evaluations, hypervolume, seconds, all counted from the start
    history: pd.DataFrame
    audits: pd.DataFrame  #: one row per audited trial: trial, well_conditioned, the measures of the audit, reason
    checkpoint: Checkpoint  #: for resuming
    parts: Parts  #: digests of its trials
    sealed: bool = True  #: whether it has a running hash, against which everything above was checked
    links: int = 0  #: length of its running hash

    def __repr__(self) -> str:
        """Return one line: name, place and number of trials."""
        return f"StudyData({self.study.name!r}, {str(self.db)!r}, {len(self.trials)} trials)"

    @cached_property
    def motors(self) -> "tuple[Motor, ...]":
        """The motors that the study simulates with, as stored: the user's files may be gone or changed."""
        from pareto_monoped.actuator.motors import stored_motor

        contents = [self.meta.contents.get(key, {}) for key in motor_keys(len(self.study.motors))]
        return tuple(stored_motor(values, source=self._source, error=DatabaseError) for values in contents)

    @property
    def motor_choices(self) -> dict[str, tuple[str, ...]]:
        """Each key of the study that names several motors -> their names, in its order."""
        if not self.study.motor_choices:
            return {}
        called = {named.lower(): motor.name for named, motor in zip(self.study.motors, self.motors, strict=True)}
        return {
            key: tuple(called[named.lower()] for named in names_of(getattr(self.study, key)))
            for key in self.study.motor_choices
        }

    @cached_property
    def calibration(self) -> "Calibration":
        """The calibration that the study simulates with, as stored."""
        from pareto_monoped.jump.calibration import calibration_of

        return calibration_of(self.meta.contents.get("calibration", {}), source=self._source, error=DatabaseError)

    @cached_property
    def actuator_maps(self) -> "dict[str, ActuatorMap]":
        """Name of each motor -> its gearboxes under the study's rules."""
        from pareto_monoped.actuator.search import map_of

        return {motor.name: map_of(motor, self.study.rules) for motor in self.motors}

    @cached_property
    def kits(self) -> "tuple[JointMaps, ...]":
        """The gearboxes of each kit of motors that a design may have, in the order of ``Study.kits``."""
        from pareto_monoped.search.space import kit_maps

        return kit_maps(self.study, list(self.actuator_maps.values()))

    @property
    def case_kit(self) -> "JointMaps":
        """The gearboxes of the paper's designs: with the paper's own motor, or with the first kit of the study."""
        papers = [kit for kit in self.kits if kit.label == PAPER_MOTOR]
        return (papers or self.kits)[0]

    def kit_of_trial(self, trial: int) -> "JointMaps":
        """Return the gearboxes of a trial's motors."""
        ((kit, _),) = self.kit_rows(self.trials[self.trials["trial"] == trial])
        return kit

    def kit_rows(self, trials: pd.DataFrame) -> "Iterator[tuple[JointMaps, NDArray[np.intp]]]":
        """Yield the gearboxes of each kit of motors among these trials, and the positions of its trials."""
        numbers = self.kit_numbers(trials)
        for k in np.unique(numbers).tolist():
            yield self.kits[k], np.flatnonzero(numbers == k)

    def kit_numbers(self, trials: pd.DataFrame) -> NDArray[np.intp]:
        """Return the index in ``kits`` of each of n trials, shape (n,)."""
        if len(self.kits) == 1:
            return np.zeros(len(trials), dtype=np.intp)
        hip, knee = ("motor", "motor") if self.study.motor is not None else ("hip_motor", "knee_motor")
        known = {(kit.hip.motor.name, kit.knee.motor.name): k for k, kit in enumerate(self.kits)}
        return np.array([known[pair] for pair in zip(trials[hip], trials[knee], strict=True)], dtype=np.intp)

    @cached_property
    def coordinates(self) -> "Coordinates":
        """What the study searches."""
        from pareto_monoped.search.space import plain_coordinates, searched_coordinates

        if not self.study.gear_list and len(self.study.kits) == 1:
            return plain_coordinates(self.study)
        return searched_coordinates(self.study, self.kits)

    @cached_property
    def content_hash(self) -> str:
        """SHA-256 of what decides its trials and of all trials, see ``seals.content_hash``."""
        return content_hash(self.meta, self.parts)

    @property
    def _source(self) -> str:
        return f"study database {str(self.db)!r}"

    @property
    def wall_time_s(self) -> float:
        """Running time so far, over all sessions."""
        return float(self.history["seconds"].iloc[-1]) if len(self.history) else 0.0

    @property
    def ill_conditioned(self) -> NDArray[np.int64]:
        """Numbers of the trials that failed their audit; ``jump.audit`` says what that means."""
        good = self.audits["well_conditioned"].to_numpy(dtype=bool)
        trials: NDArray[np.int64] = self.audits["trial"].to_numpy(dtype=np.int64)[~good]
        return trials

    @property
    def reference_point(self) -> ReferencePoint:
        """Corner from which the study's hypervolume is measured."""
        return self.study.reference_point

    @property
    def sound(self) -> pd.DataFrame:
        """The feasible trials that have not failed their audit: all that may be chosen."""
        return self.trials[self._able(include_ill_conditioned=False)]

    def _able(self, include_ill_conditioned: bool) -> NDArray[np.bool_]:
        """Return which trials may be on a front, shape (n,)."""
        feasible: NDArray[np.bool_] = (self.trials["state"] == "feasible").to_numpy(dtype=bool)
        if include_ill_conditioned:
            return feasible
        failed: NDArray[np.bool_] = self.trials["trial"].isin(self.ill_conditioned).to_numpy(dtype=bool)
        return feasible & ~failed

    def front(
        self,
        include_ill_conditioned: bool = False,
        objectives: Objectives | None = None,
        conditions: Sequence[Condition] = (),
    ) -> pd.DataFrame:
        """Return the non-dominated feasible trials by the first objective, from its least value to its greatest.

        Trials dominate each other under the study's own objectives unless others are given. Those that do not meet the
        conditions do not count, and neither do ill-conditioned ones, which failed their audit: trials that they
        dominate may enter.
        """
        chosen = objectives or self.study.objectives
        found = self.trials[front_within(self.trials, conditions, chosen, self._able(include_ill_conditioned))]
        return found.sort_values(chosen.names[0], kind="stable", ignore_index=True)


@dataclass(slots=True)
class _Check:
    """Checks trials while they are read, so that a million of them need not be in memory twice."""

    seals: Seals | None  #: the running hash, if the study has one
    count: int = 0  #: how many trials have been read
    #: what is wrong with numbers, and which trials do not match their hash
    numbering: list[str] = field(default_factory=list)
    unlike: list[str] = field(default_factory=list)

    @property
    def findings(self) -> list[str]:
        """What is wrong, each line once."""
        return list(dict.fromkeys((*self.numbering, *self.unlike)))

    def passing(self, blocks: Iterable[Block]) -> Iterator[Block]:
        """Yield the blocks, each after it was checked."""
        for values in blocks:
            self.numbering = self.numbering or numbering_findings(values["trial"], self.count)
            self.count += len(values["trial"])
            if self.seals is not None:
                self.unlike += self.seals.trial_findings(values, values["trial"])
            yield values
        if self.seals is not None:
            self.numbering += missing_findings(self.count, self.seals.trials)


def _stored_blocks(connection: Connection, db: StudyPlace) -> Iterator[Block]:
    rows = connection.execute("SELECT * FROM monoped_trials ORDER BY trial")
    return trial_blocks(connection.columns("monoped_trials"), rows, db)


def read_trials(db: StudyPlace) -> Iterator[pd.DataFrame]:
    """Yield all trials as ``read_study`` returns them, block by block, each checked before it is yielded.

    There is at least one block. Its ``attrs["sealed"]`` says whether the study has a running hash.

    Raises:
        DatabaseError: as by ``read_study``, where the damage is met.
    """
    with undamaged(db), storage_of(db).reading() as connection:
        seals = read_seals(connection, db) if has_seals(connection) else None
        rows = connection.execute(ROWS["meta"]).fetchall()
        if seals is not None and (findings := seals.row_findings("meta", rows)):
            raise damaged(db, findings)
        meta = meta_of_rows(rows, db)
        study = study_from_dict(meta.study, source=f"study database {str(db)!r}")
        check = _Check(seals)
        for values in check.passing(_stored_blocks(connection, db)):
            if check.findings:
                raise damaged(db, check.findings)
            trials = with_agility(with_motors(pd.DataFrame(values, copy=False), study, meta, db))
            trials.attrs["sealed"] = seals is not None
            yield trials
        if check.findings:
            raise damaged(db, check.findings)


def read_study(db: StudyPlace) -> StudyData:
    """Read a study database, finished or still growing, and check it against its running hash.

    Raises:
        DatabaseError: missing, not a study, damaged, or of a newer version.
    """
    with undamaged(db):
        with storage_of(db).reading() as connection:
            sealed = has_seals(connection)
            tables = [table for table in ROWS if sealed or table != "front"]
            rows = {table: connection.execute(ROWS[table]).fetchall() for table in tables}
            columns = connection.columns("monoped_trials")
            seals = read_seals(connection, db) if sealed else None
            check = _Check(seals)
            trials = trial_frame(check.passing(_stored_blocks(connection, db)), 0 if seals is None else seals.trials)
        meta = meta_of_rows(rows["meta"], db)
        study = study_from_dict(meta.study, source=f"study database {str(db)!r}")
        _, generation, evaluations, state = rows["checkpoint"][0]
        checkpoint = Checkpoint(generation=int(generation), evaluations=int(evaluations), state=parsed_json(state))
        audits = [
            {"trial": int(trial), "well_conditioned": bool(good)} | parsed_json(measures)
            for trial, good, measures in rows["audits"]
        ]
        history = pd.DataFrame(rows["history"], columns=list(_HISTORY)).astype(_HISTORY)
        if not np.isfinite(history.to_numpy(dtype=np.float64)).all():
            raise ValueError("a hypervolume or time of its history is not finite")
        named = with_agility(with_motors(trials, study, meta, db))
        findings = check.findings
        if seals is not None:
            findings += [line for table in rows for line in seals.row_findings(table, rows[table])]
        if findings:
            raise damaged(db, findings)
        parts: Parts = (
            [(range(len(trials)), tuple(columns), "".join(trial_digests(columns, trials)))]
            if seals is None
            else seals.parts
        )
        return StudyData(
            db=db,
            study=study,
            meta=meta,
            trials=named,
            history=history,
            audits=pd.DataFrame(audits) if audits else pd.DataFrame({"trial": [], "well_conditioned": []}),
            checkpoint=checkpoint,
            parts=parts,
            sealed=sealed,
            links=0 if seals is None else seals.links,
        )
