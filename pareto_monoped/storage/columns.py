"""The columns of a trial: name, storage, meaning and source of their values; what a run stores in one transaction."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from datetime import datetime
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.design import ALL_NAMES, KNOTS, PAPER_NAMES, VARIABLES
from pareto_monoped.measures import MEASURES, measure
from pareto_monoped.pareto.objectives import HEIGHT_AND_ENERGY

if TYPE_CHECKING:
    from pareto_monoped.definition.study import Study
    from pareto_monoped.jump.evaluate import Evaluations
    from pareto_monoped.search.scoring import Judgement


@dataclass(frozen=True, slots=True)
class Column:
    """One column of the table ``monoped_trials`` and of ``StudyData.trials``."""

    name: str  #: in both
    sql: str  #: type and constraints in the database
    #: In the data frame; a missing real number is NaN there and NULL in the database
    dtype: Literal["int64", "str", "float64"]
    meaning: str  #: what it is
    #: Its values of all trials of a generation, in order
    values: "Callable[[Generation], Sequence[Any] | NDArray[Any]]"


def _variable(index: int) -> Column:
    variable = (*VARIABLES, *KNOTS)[index]
    sql = "REAL" if variable.default is None else f"REAL NOT NULL DEFAULT {variable.default!r}"
    return Column(variable.name, sql, "float64", variable.meaning, lambda generation: generation.designs[:, index])


def _measure(name: str, meaning: str) -> Column:
    return Column(name, "REAL", "float64", meaning, lambda generation: generation.evaluations.of(name))


def _motor(name: str, meaning: str) -> Column:
    return Column(name, "TEXT", "str", meaning, lambda one: one.motors.get(name) or [None] * len(one.designs))


_STATE = "feasible, infeasible (jumps, but misses a constraint) or failed (no jump)"
_STATUS = "how the jump ended, one of jump.evaluate.STATUSES"
_VIOLATION = "how far the constraints are missed, as a sum of shares of their limits; 0 where all hold"
_WEIGHT = "weight of the first objective in a weighted search; missing for other searches"
_IDENTITY = (
    Column("trial", "INTEGER PRIMARY KEY", "int64", "number of the trial, from 0", lambda one: one.trials),
    Column(
        "generation", "INTEGER NOT NULL", "int64", "number of its generation, from 0", lambda one: one.same(one.number)
    ),
    Column("state", "TEXT NOT NULL", "str", _STATE, lambda one: one.judgement.state.tolist()),
    Column("status", "TEXT NOT NULL", "str", _STATUS, lambda one: one.evaluations.status.tolist()),
    Column(
        "reason", "TEXT NOT NULL", "str", "why it is not feasible; empty where it is", lambda one: one.judgement.reason
    ),
)
_JUDGEMENT = (
    Column("violation", "REAL NOT NULL", "float64", _VIOLATION, lambda one: one.judgement.violation),
    Column("height_weight", "REAL", "float64", _WEIGHT, lambda one: one.same(one.height_weight)),
)
_MOTOR = _motor("motor", "name of the motor of both joints; NULL in the database of a study with no choice of it")
_JOINT_MOTORS = tuple(
    _motor(f"{joint}_motor", f"name of the {joint}'s motor, where it is chosen for itself; else NULL")
    for joint in ("hip", "knee")
)
_VARIABLES = tuple(_variable(index) for index in range(len(VARIABLES)))
_MEASURES = tuple(_measure(entry.name, entry.meaning) for entry in MEASURES)

COLUMNS: tuple[Column, ...] = (*_IDENTITY, *_JUDGEMENT, *_VARIABLES, _MOTOR, *_MEASURES, *_JOINT_MOTORS)
"""All columns of a trial, in the order of the database."""


def columns_of(study: "Study") -> tuple[Column, ...]:
    """Return all columns and those of the knots, measures under uncertainty and own functions of a study."""
    asked = (*study.robust_names, *study.own_names)
    knots = (_variable(ALL_NAMES.index(one.name)) for one in study.controller.variables if one in KNOTS)
    return (*COLUMNS, *knots, *(_measure(name, measure(name).meaning) for name in asked))


def listed(names: Iterable[str]) -> str:
    """Return columns of a table for SQL, in quotes because the names of measures under uncertainty have a dot."""
    return ", ".join(f'"{name}"' for name in names)


REQUIRED: tuple[str, ...] = (*(column.name for column in _IDENTITY), *PAPER_NAMES, *HEIGHT_AND_ENERGY.names)
"""Columns that every study has, in the order of the data frame; the others follow as the database has them."""

LATER: tuple[Column, ...] = tuple(
    column for column in (*_VARIABLES, _MOTOR, *_MEASURES, *_JOINT_MOTORS) if column.name not in REQUIRED
)
"""Columns that a database of an earlier version may lack. Optional variables then have their defaults, the motor is the
study's only one, and measures are missing. The columns are added to such a database when its study goes on."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Generation:
    """A simulated generation, or the part of it that one session simulated."""

    number: int  #: of the generation
    first_trial: int  #: number of the first of these trials
    designs: NDArray[np.float64]  #: shape (n, number of variables)
    #: evaluations, judgement: of these designs
    evaluations: "Evaluations"
    judgement: "Judgement"
    height_weight: float | None  #: weight of the first objective in a weighted search; None for other searches
    #: The algorithm's state once it knows the scores of the whole generation; None while some are missing
    state: Mapping[str, Any] | None
    hypervolume: float  #: of all trials up to here
    seconds: float  #: running time up to here, over all sessions
    #: started, ended: when these designs were simulated
    started: datetime
    ended: datetime
    #: Coordinate that chooses a motor -> name of each design's; empty where the study has no such choice
    motors: Mapping[str, tuple[str, ...]] = field(default_factory=dict)

    @property
    def trials(self) -> range:
        """Numbers of the trials."""
        return range(self.first_trial, self.first_trial + len(self.designs))

    def same(self, value: Any) -> list[Any]:
        """Return a value for each trial."""
        return [value] * len(self.designs)
