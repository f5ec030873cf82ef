"""Studies in scripts: what a database holds, and designs chosen from it."""

import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from pareto_monoped.api.given import conditions_of, html_of, number_of, trial_of, truth_of, ways_of
from pareto_monoped.api.jumps import StrPath
from pareto_monoped.definition.given import as_list, count_of
from pareto_monoped.design import ALL_NAMES, VARIABLES, Design
from pareto_monoped.errors import DesignError, InputError, SelectionError, StudyError, complaint
from pareto_monoped.measures import measure
from pareto_monoped.pareto import selectors
from pareto_monoped.storage.address import is_address
from pareto_monoped.storage.place import StudyPlace, place_of

if TYPE_CHECKING:
    from pandas import DataFrame, Series

    from pareto_monoped.analysis.alternatives import Alternative
    from pareto_monoped.definition.study import Study
    from pareto_monoped.pareto.growth import SecondSearch
    from pareto_monoped.pareto.objectives import Objectives
    from pareto_monoped.storage.reader import StudyData

By = Literal["knee", "tradeoff"]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Picked:
    """A design picked from a front.

    Example:
        >>> import pareto_monoped as pm
        >>> picked = pm.load_study("light.db").pick(min_height_m=0.7)
        >>> bool(picked.row.height_m >= 0.7), picked.design.start_height_m
        (True, 0.5)
    """

    trial: int  #: its number
    design: Design  #: its variables
    row: "Series[Any]"  #: its row of ``StoredStudy.trials``
    why: str  #: the reason in one sentence
    #: where it takes half as much again from the battery as the least that is stored for its height, a sentence on that
    dear: str = ""

    def __repr__(self) -> str:
        """Return one line: the trial and the reason."""
        return f"Picked(trial={self.trial}, why={self.why!r})"

    def _repr_html_(self) -> str:
        """Return the reason, with the measures of the objectives' kind and the variables, for notebooks."""
        entries = [measure(name) for name in ("height_m", "energy_j", "electrical_energy_j", "mass_kg")]
        facts: dict[str, object] = {
            one.words: one.text(float(self.row[one.name])) for one in entries if one.name in self.row
        }
        for one in VARIABLES:
            value = f"{getattr(self.design, one.name) * one.scale:.{one.decimals}f} {one.shown_unit}"
            facts[one.label] = value.removesuffix(" 1")
        return html_of(f"trial {self.trial}: {self.why}", facts)


@dataclass(frozen=True, eq=False)  # without slots: cached properties need a place to keep their values
class StoredStudy:
    """A study in its database, finished or still growing; each property reads what was there at ``load_study``.

    Example:
        >>> import pareto_monoped as pm
        >>> stored = pm.load_study("light.db")
        >>> stored.finished, len(stored.trials), len(stored.front()) <= len(stored.trials)
        (True, 200, True)
    """

    path: StudyPlace  #: the database; as text the name of a file, or the address of a server without its password
    study: "Study"  #: its definition
    data: "StudyData"  #: everything that was read; its form may change between versions
    second: "SecondSearch | None" = None  #: how far a second search agrees, where ``run`` was asked for one

    def __repr__(self) -> str:
        """Return one line: name, place, trials and objectives."""
        trials, state = len(self.data.trials), "finished" if self.finished else "not finished"
        names = ", ".join(self.study.objectives.names)
        return f"StoredStudy({self.study.name!r}, {str(self.path)!r}, {trials} trials, {state}, objectives {names})"

    def _repr_html_(self) -> str:
        """Return place, trials and front, for notebooks."""
        front, goals = self.front(), self.study.objectives
        facts: dict[str, object] = {
            "database": self.path,
            "trials": f"{len(self.data.trials)}, {'finished' if self.finished else 'not finished'}",
            "front": f"{len(front)} designs",
            "hypervolume": f"{self.hypervolume:.4f} {goals.volume_unit}",
        }
        for entry in goals.measures if len(front) else ():
            least, most = (entry.text(float(end)) for end in (front[entry.name].min(), front[entry.name].max()))
            facts[f"front, {entry.words}"] = f"{least} to {most}"
        return html_of(f"study {self.study.name}", facts)

    @cached_property
    def trials(self) -> "DataFrame":
        """All trials in order, with number, generation, variables, ``state``, ``reason`` and every stored measure.

        Columns have the names and units that databases, files and flags have.
        """
        return self.data.trials.copy()

    @property
    def finished(self) -> bool:
        """Whether the study has ended; else it can be resumed."""
        return self.data.meta.finished

    @property
    def hypervolume(self) -> float:
        """The hypervolume of the front from the study's reference point, in the product of the objectives' units."""
        from pareto_monoped.pareto.objectives import hypervolume

        names = list(self.study.objectives.names)
        return hypervolume(self.data.front()[names].to_numpy(dtype=np.float64), self.study.reference_point)

    def front(
        self,
        objectives: Sequence[str] | None = None,
        *,
        min_height_m: float | None = None,
        max_energy_j: float | None = None,
        at_least: Mapping[str, float] | None = None,
        at_most: Mapping[str, float] | None = None,
        include_ill_conditioned: bool = False,
    ) -> "DataFrame":
        """Return the non-dominated feasible trials by the first objective, from its least value to its greatest.

        With conditions it is the front of the trials that meet them, which is empty if none does. The audit has not
        seen all of these, nor all of a front under other objectives.

        Args:
            objectives: two or three measures, instead of the study's own.
            min_height_m: condition: a jump of at least this height.
            max_energy_j: condition: at most this energy.
            at_least: conditions: name of a measure or variable -> least value, in its stored unit.
            at_most: conditions: name of a measure or variable -> greatest value.
            include_ill_conditioned: whether designs may be on it whose jump steps and rounding decide.

        Raises:
            StudyError: an unknown measure, one without a direction, or not two or three of them.
            SelectionError: an unknown name in a condition.
        """
        from pareto_monoped.pareto.pick import condition_on

        if not isinstance(include_ill_conditioned, bool):
            name = "include_ill_conditioned"
            raise StudyError(complaint(name, include_ill_conditioned, "True or False", "give one"))
        chosen = self._objectives(objectives) or self.study.objectives
        given = conditions_of(min_height_m, max_energy_j, at_least, at_most)
        return self.data.front(include_ill_conditioned, chosen, [condition_on(one, chosen) for one in given])

    def pick(
        self,
        by: By | None = None,
        *,
        trial: int | None = None,
        min_height_m: float | None = None,
        max_energy_j: float | None = None,
        at_least: Mapping[str, float] | None = None,
        at_most: Mapping[str, float] | None = None,
        weights: Sequence[float] | None = None,
        compromise: Sequence[float] | None = None,
        nearest: Mapping[str, float] | None = None,
        least: str | None = None,
        most: str | None = None,
        objectives: Sequence[str] | None = None,
        robust: bool = False,
    ) -> Picked:
        """Pick one design; the command ``pick`` with the same words chooses the same.

        Conditions make the front: that of the designs that meet them. One way to choose takes a design from it, and
        without a way the best one is taken. A design that the audit at the end of the study has not seen gets its
        audit first, which the database keeps; if it fails, the next best design is taken.

        Args:
            by: the ``knee``, or the design of the best ``tradeoff``.
            trial: the trial with this number.
            min_height_m: condition: a jump of at least this height.
            max_energy_j: condition: at most this energy.
            at_least: conditions: name of a measure or variable -> least value, in its stored unit.
            at_most: conditions: name of a measure or variable -> greatest value.
            weights: the best weighted sum of the scaled objectives, a weight for each.
            compromise: the nearest to the best of every objective, a weight for each.
            nearest: the nearest to a wished-for point, measure -> value.
            least: the least of this measure or variable, whether or not it is an objective.
            most: the most of this measure or variable.
            objectives: of the front, instead of the study's own.
            robust: choose by what 19 of 20 built robots keep, among the trials that ``robust`` has simulated again; the
                row then has for each measure the worse of its 5th and 95th percentiles.

        Raises:
            SelectionError: nothing asked for, several ways to choose, an unknown name, or no design that fits; the
                message then names the nearest that can be had.

        Example:
            >>> import pareto_monoped as pm
            >>> pm.load_study("light.db").pick(min_height_m=0.7, at_most={"mass_kg": 6.0}).design.start_height_m
            0.5
        """
        from pareto_monoped.analysis.choices import choose, dear_words

        chosen = self._objectives(objectives) or self.study.objectives
        ways = ways_of(by, trial, weights, compromise, nearest, least, most)
        conditions = conditions_of(min_height_m, max_energy_j, at_least, at_most)
        if not ways and not conditions:
            raise SelectionError(
                "pick: nothing is asked for; give by='knee', or min_height_m, or one of the other arguments"
            )
        wanted = selectors.Among(conditions=conditions, chooser=ways[0] if ways else None)
        data = self._by_robustness() if truth_of("robust", robust) else self.data
        found = choose(data, wanted, chosen, notify=warnings.warn).picked
        row = data.trials[data.trials["trial"] == found.trial].iloc[0]
        dear = dear_words(self.data, row)
        return Picked(trial=found.trial, design=self.design(found.trial), row=row, why=found.why, dear=dear)

    def design(self, trial: int) -> Design:
        """Return the design of a trial.

        Raises:
            SelectionError: no trial has this number.
        """
        row = self._row(trial)
        return Design(**{name: row[name] for name in ALL_NAMES if name in row})

    def motors(self, trial: int) -> tuple[str, str]:
        """Return names of the motors of a trial's hip and knee, for ``simulate`` and ``build_robot``.

        Raises:
            SelectionError: no trial has this number.
        """
        self._row(trial)
        kit = self.data.kit_of_trial(trial)
        return kit.hip.motor.name, kit.knee.motor.name

    def alternatives(self, trial: int, *, count: int = 5, tolerance: float = 0.02) -> "tuple[Alternative, ...]":
        """Designs that cost about as much as a trial, and differ from it and from each other as much as possible.

        Args:
            trial: the number of a trial of the front.
            count: how many at most.
            tolerance: share by which they may be worse in an objective.

        Raises:
            SelectionError: no such trial.
        """
        from pareto_monoped.analysis.alternatives import alternatives

        self._row(trial)
        most, share = count_of("count", count) or 5, number_of("tolerance", tolerance)
        return alternatives(self.data, trial, count=most, tolerance=share)

    def simulate(self, designs: Any, *, trial: int | None = None, workers: int | None = None) -> "DataFrame":
        """Let other designs jump as this study does: with its motors, calibration and gearbox rules, as stored.

        Args:
            designs: see ``pareto_monoped.simulate``; or what ``pick`` returned, or a list of that. Rows of a frame that
                names motors, such as the front, have these.
            trial: whose motors the designs have that name none, where the study has a choice of motors; by default its
                first ones.
            workers: number of threads, all cores if None.

        Returns:
            One row per design, in the order given, see ``pareto_monoped.simulate``.

        Raises:
            DesignError: see ``pareto_monoped.simulate``; or motors that the study does not have.
            SelectionError: no trial has this number.

        Example:
            >>> import pareto_monoped as pm
            >>> stored = pm.load_study("light.db")
            >>> bool((stored.simulate(stored.front()).height_m == stored.front().height_m).all())
            True
        """
        from pareto_monoped.api.given import given_designs
        from pareto_monoped.api.jumps import jumps_of

        given = given_designs(_rows(designs))
        kits = self.data.kits
        unsaid = kits[0]
        if trial is not None:
            self._row(trial)
            unsaid = self.data.kit_of_trial(trial)
        known = {kit.label.casefold(): k for k, kit in enumerate(kits)} | {"": kits.index(unsaid)}
        for row, motor in enumerate(given.motors):
            if motor.casefold() not in known:
                labels = " or ".join(repr(kit.label) for kit in kits)
                cure = "take rows of this study, or drop the columns of motors"
                raise DesignError(complaint(f"motor of design {row}", motor, f"{labels}, as the study has", cure))
        motors = np.array([known[motor.casefold()] for motor in given.motors], dtype=np.intp)
        return jumps_of(given.values, kits, self.data.calibration, workers, motors)

    def _by_robustness(self) -> "StudyData":
        from pareto_monoped.analysis.robustness import as_built
        from pareto_monoped.storage.extra_rows import read_robustness

        return as_built(self.data, read_robustness(self.path), notify=warnings.warn)[0]

    def _row(self, trial: int) -> "Series[Any]":
        rows = self.data.trials[self.data.trials["trial"] == trial_of(trial)]
        if len(rows) == 0:
            allowed = f"0 to {len(self.data.trials) - 1}"
            raise SelectionError(complaint("trial", trial, allowed, "take one that the study has"))
        return rows.iloc[0]

    def _objectives(self, names: Sequence[str] | None) -> "Objectives | None":
        from pareto_monoped.definition.goals import objectives_of

        if names is None:
            return None
        chosen = objectives_of(as_list(names), source="front")
        if lacking := [name for name in chosen.names if name not in self.data.trials]:
            raise StudyError(f"front: objective {lacking[0]!r} is not stored with this study; choose another")
        return chosen


def _rows(designs: Any) -> Any:
    """Return designs, with the rows of the trials, which name their motors, in place of what ``pick`` returned."""
    if isinstance(designs, list | tuple):
        return [_rows(one) if isinstance(one, Picked) else one for one in designs]
    return designs.row if isinstance(designs, Picked) else designs


def load_study(path: StrPath | StudyPlace) -> StoredStudy:
    """Return the study in a database.

    Args:
        path: the database that ``run`` made: a file, or a server's address as text. To read a study file, use
            ``Study.from_toml``.

    Raises:
        DatabaseError: missing, not a study, damaged, or of a newer version.

    Example:
        >>> import pareto_monoped as pm
        >>> pm.load_study("light.db").study.name
        'light'
    """
    from pareto_monoped.storage.reader import read_study

    data = read_study(as_place(path))
    return StoredStudy(path=data.db, study=data.study, data=data)


def as_place(given: StrPath | StudyPlace, what: str = "path", *, allowed: str = "text or a path") -> StudyPlace:
    """Return where a study stands, from text that is a server's address, else from text or a path."""
    if isinstance(given, StudyPlace) and not isinstance(given, Path):
        return given
    return place_of(given) if isinstance(given, str) and is_address(given) else as_path(given, what, allowed=allowed)


def as_path(given: StrPath, what: str = "path", *, allowed: str = "text or a path") -> Path:
    """Return a path from text or a path; else raise ``InputError``, in which ``what`` is ``allowed``."""
    try:
        path = Path(given)
    except TypeError:
        raise InputError(complaint(what, given, allowed, "give one")) from None
    if "\0" in str(path):
        raise InputError(complaint(what, str(path), "without a zero byte", "check it"))
    try:
        str(path).encode()
    except UnicodeEncodeError:  # reports and records name it
        raise InputError(complaint(what, str(path), "UTF-8", "rename the file")) from None
    return path
