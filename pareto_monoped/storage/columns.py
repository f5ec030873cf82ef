"""The columns of a trial: name, storage, meaning and source of their values; what a run stores in one transaction."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from datetime import datetime
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.design import DEFAULTS, PAPER_NAMES, VARIABLES
from pareto_monoped.jump.evaluate import Evaluations
from pareto_monoped.measures import MEASURES, measure
from pareto_monoped.pareto.objectives import HEIGHT_AND_ENERGY
from pareto_monoped.search.scoring import Judgement

if TYPE_CHECKING:
    from pareto_monoped.definition.study import Study


@dataclass(frozen=True, slots=True, kw_only=True)
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
    variable = VARIABLES[index]
    return Column(
        name=variable.name,
        sql="REAL" if variable.default is None else f"REAL NOT NULL DEFAULT {DEFAULTS[variable.name]!r}",
        dtype="float64",
        meaning=variable.meaning,
        values=lambda generation: generation.designs[:, index],
    )


def _measure(name: str, meaning: str) -> Column:
    return Column(
        name=name,
        sql="REAL",
        dtype="float64",
        meaning=meaning,
        values=lambda generation: generation.evaluations.of(name),
    )


_IDENTITY = (
    Column(
        name="trial",
        sql="INTEGER PRIMARY KEY",
        dtype="int64",
        meaning="number of the trial, from 0",
        values=lambda generation: range(generation.first_trial, generation.first_trial + len(generation.designs)),
    ),
    Column(
        name="generation",
        sql="INTEGER NOT NULL",
        dtype="int64",
        meaning="number of its generation, from 0",
        values=lambda generation: [generation.number] * len(generation.designs),
    ),
    Column(
        name="state",
        sql="TEXT NOT NULL",
        dtype="str",
        meaning="feasible, infeasible (jumps, but misses a constraint) or failed (no jump)",
        values=lambda generation: generation.judgement.state.tolist(),
    ),
    Column(
        name="status",
        sql="TEXT NOT NULL",
        dtype="str",
        meaning="how the jump ended, one of jump.evaluate.STATUSES",
        values=lambda generation: generation.evaluations.status.tolist(),
    ),
    Column(
        name="reason",
        sql="TEXT NOT NULL",
        dtype="str",
        meaning="why it is not feasible; empty where it is",
        values=lambda generation: generation.judgement.reason,
    ),
)
_JUDGEMENT = (
    Column(
        name="violation",
        sql="REAL NOT NULL",
        dtype="float64",
        meaning="how far the constraints are missed, as a sum of shares of their limits; 0 where all hold",
        values=lambda generation: generation.judgement.violation,
    ),
    Column(
        name="height_weight",
        sql="REAL",
        dtype="float64",
        meaning="weight of the first objective in a weighted search; missing for other searches",
        values=lambda generation: [generation.height_weight] * len(generation.designs),
    ),
)


def _motor(name: str, meaning: str) -> Column:
    return Column(
        name=name,
        sql="TEXT",
        dtype="str",
        meaning=meaning,
        values=lambda generation: generation.motors.get(name) or [None] * len(generation.designs),
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
    """Return all columns and those of the measures under uncertainty and own functions that a study asks for."""
    asked = (*study.robust_names, *study.own_names)
    return (*COLUMNS, *(_measure(name, measure(name).meaning) for name in asked))


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
    evaluations: Evaluations
    judgement: Judgement
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
