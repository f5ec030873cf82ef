"""Studies in scripts: what a database holds, and designs chosen from it."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from pareto_monoped.api.jumps import StrPath
from pareto_monoped.design import NAMES, Design
from pareto_monoped.errors import InputError, SelectionError, complaint
from pareto_monoped.pareto.conditions import CONDITION_NAMES
from pareto_monoped.pareto.selectors import (
    Among,
    Chooser,
    Compromise,
    Condition,
    Knee,
    MaxEnergy,
    Nearest,
    Tradeoff,
    Trial,
    Weights,
)

if TYPE_CHECKING:
    from pandas import DataFrame, Series

    from pareto_monoped.pareto.objectives import Objectives
    from pareto_monoped.study.alternatives import Alternative
    from pareto_monoped.study.definition import Study
    from pareto_monoped.study.reader import StudyData

By = Literal["knee", "tradeoff"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Picked:
    """A design picked from a front.

    Attributes:
        trial: its number.
        design: its variables.
        row: its row of ``StoredStudy.trials``.
        why: the reason in one sentence.
    """

    trial: int
    design: Design
    row: "Series[Any]"
    why: str


@dataclass(frozen=True)  # without slots: cached properties need a place to keep their values
class StoredStudy:
    """A study in its database, finished or still growing; each property reads what was there at ``load_study``.

    Attributes:
        path: the database.
        study: its definition.
        data: everything that was read; its form may change between versions.
    """

    path: Path
    study: "Study"
    data: "StudyData"

    @cached_property
    def trials(self) -> "DataFrame":
        """All trials in order: number, generation, variables, ``state`` and ``reason``, and every stored measure.

        Columns have the names and units that databases, files and flags have.
        """
        return self.data.trials.copy()

    @property
    def finished(self) -> bool:
        """Whether the study has ended; else it can be resumed."""
        return self.data.meta.finished

    def front(self, objectives: Sequence[str] | None = None, *, include_ill_conditioned: bool = False) -> "DataFrame":
        """The non-dominated feasible trials by the first objective, from its least value to its greatest.

        Args:
            objectives: two or three measures, instead of the study's own.
            include_ill_conditioned: whether designs may be on it whose jump steps and rounding decide.

        Raises:
            StudyError: an unknown measure, one without a direction, or not two or three of them.
        """
        return self.data.front(include_ill_conditioned, self._objectives(objectives))

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
        objectives: Sequence[str] | None = None,
    ) -> Picked:
        """Pick one design from the front; the command ``pick`` with the same words chooses the same.

        Conditions combine with each other and with one way to choose. Without a way, the best design that meets the
        conditions is taken.

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
            objectives: of the front, instead of the study's own.

        Raises:
            SelectionError: nothing asked for, several ways to choose, an unknown name, or no design that fits; the
                message then names the nearest that can be had.

        Example:
            >>> import pareto_monoped as pm
            >>> pm.load_study("studies/case_c.db").pick(min_height_m=0.9).trial  # doctest: +SKIP
            3471
        """
        from pareto_monoped.pareto.pick import pick

        chosen = self._objectives(objectives) or self.study.objectives
        front = self.data.front(objectives=chosen)
        ways = _ways(by, trial, weights, compromise, nearest)
        conditions = _conditions(min_height_m, max_energy_j, at_least, at_most)
        if not ways and not conditions:
            raise SelectionError(
                "pick: nothing is asked for; give by='knee', or min_height_m, or one of the other arguments"
            )
        found = pick(front, Among(conditions=conditions, chooser=ways[0] if ways else None), chosen)
        return Picked(trial=found.trial, design=self.design(found.trial), row=self._row(found.trial), why=found.why)

    def design(self, trial: int) -> Design:
        """The design of a trial.

        Raises:
            SelectionError: no trial has this number.
        """
        return Design.from_array([self._row(trial)[name] for name in NAMES])

    def motors(self, trial: int) -> tuple[str, str]:
        """Names of the motors of a trial's hip and knee, for ``simulate`` and ``build_robot``.

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
        from pareto_monoped.study.alternatives import alternatives

        return alternatives(self.data, trial, count=count, tolerance=tolerance)

    def simulate(self, designs: Any, *, trial: int | None = None, workers: int | None = None) -> "DataFrame":
        """Let other designs jump as this study does: with its motors, calibration and gearbox rules, as stored.

        Args:
            designs: see ``pareto_monoped.simulate``.
            trial: whose motors they have, where the study has a choice of motors; else its first ones.
            workers: number of threads, all cores if None.

        Raises:
            DesignError: see ``pareto_monoped.simulate``.
            SelectionError: no trial has this number.
        """
        from pareto_monoped.api.jumps import jumps_of

        kit = self.data.kits[0]
        if trial is not None:
            self._row(trial)
            kit = self.data.kit_of_trial(trial)
        return jumps_of(designs, kit, self.data.calibration, workers)

    def _row(self, trial: int) -> "Series[Any]":
        rows = self.data.trials[self.data.trials["trial"] == trial]
        if len(rows) == 0:
            allowed = f"0 to {len(self.data.trials) - 1}"
            raise SelectionError(complaint("trial", trial, allowed, "take one that the study has"))
        return rows.iloc[0]

    def _objectives(self, names: Sequence[str] | None) -> "Objectives | None":
        from pareto_monoped.study.goals import objectives_of

        return None if names is None else objectives_of(names, source="front")


def load_study(path: StrPath) -> StoredStudy:
    """The study in a database.

    Args:
        path: the database that ``run`` made. To read a study file, use ``Study.from_toml``.

    Raises:
        DatabaseError: missing, not a study, damaged, or of a newer version.
    """
    from pareto_monoped.study.reader import read_study

    data = read_study(as_path(path))
    return StoredStudy(path=data.db, study=data.study, data=data)


def as_path(given: StrPath) -> Path:
    """A path from text or a path.

    Raises:
        InputError: it is neither.
    """
    try:
        return Path(given)
    except TypeError:
        raise InputError(complaint("path", given, "text or a path", "give one")) from None


def _ways(
    by: str | None,
    trial: int | None,
    weights: Sequence[float] | None,
    compromise: Sequence[float] | None,
    nearest: Mapping[str, float] | None,
) -> list[Chooser]:
    """The ways to choose that are asked for.

    Raises:
        SelectionError: more than one, or an unknown one.
    """
    ways: list[Chooser] = []
    if by is not None:
        if by not in ("knee", "tradeoff"):
            raise SelectionError(complaint("by", by, "'knee' or 'tradeoff'", "correct it, or use another argument"))
        ways.append(Knee() if by == "knee" else Tradeoff())
    if trial is not None:
        ways.append(Trial(number=trial))
    if weights is not None:
        ways.append(Weights(values=tuple(map(float, weights))))
    if compromise is not None:
        ways.append(Compromise(values=tuple(map(float, compromise))))
    if nearest is not None:
        ways.append(Nearest(wish=_known(nearest)))
    if len(ways) > 1:
        raise SelectionError(f"ways to choose = {len(ways)}: must be at most 1, with any conditions; drop the others")
    return ways


def _conditions(
    min_height_m: float | None,
    max_energy_j: float | None,
    at_least: Mapping[str, float] | None,
    at_most: Mapping[str, float] | None,
) -> tuple[Condition | MaxEnergy, ...]:
    found: list[Condition | MaxEnergy] = []
    if min_height_m is not None:
        found.append(Condition(name="height_m", side="min", value=float(min_height_m), asked="min_height_m"))
    if max_energy_j is not None:
        found.append(MaxEnergy(energy_j=float(max_energy_j)))
    for name, value in _known(at_least or {}).items():
        found.append(Condition(name=name, side="min", value=value))
    for name, value in _known(at_most or {}).items():
        found.append(Condition(name=name, side="max", value=value))
    return tuple(found)


def _known(values: Mapping[str, float]) -> dict[str, float]:
    """Numbers of known measures and variables.

    Raises:
        SelectionError: an unknown name.
    """
    for name in values:
        if name not in CONDITION_NAMES:
            import difflib

            near = difflib.get_close_matches(str(name), CONDITION_NAMES, n=1)
            cure = f"did you mean {near[0]!r}?" if near else f"choose from {', '.join(CONDITION_NAMES)}"
            raise SelectionError(f"name = {name!r}: must be a measure or a variable; {cure}")
    return {name: float(value) for name, value in values.items()}
