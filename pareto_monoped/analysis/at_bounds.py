"""Limits that hold a design where it is: bounds or ends of lists of gearboxes, and constraints."""

from dataclasses import dataclass

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from pareto_monoped.definition.variables import Bounds
from pareto_monoped.design import KNOTS, VARIABLES
from pareto_monoped.measures import Measure, measure
from pareto_monoped.storage.front_reader import StudyFront
from pareto_monoped.storage.reader import Checkpoint, StudyData

_AT = 0.005
"""Share of its range within which a variable is at its bound. Our own choice: 1 N/m of K's 195."""
_WORTH_TELLING = 0.1
"""Least share of the front that is told. Our own choice."""
_GAP = 0.1
"""Share of the front's extent in its first objective over which a part of it must be missing to divide it in two."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Part:
    """A part of the front along its first objective."""

    #: least, greatest: first objective of its ends, in stored units
    least: float
    greatest: float
    share: float  #: of the front's designs between the ends that are at the bound


@dataclass(frozen=True, slots=True, kw_only=True)
class AtBound:
    """A variable that is at one of its bounds on a share of the front."""

    name: str  #: of the variable
    side: str  #: ``lower`` or ``upper``
    bound: float  #: its value there
    share: float  #: of the designs on the front, at most 1
    parts: tuple[Part, ...]  #: of the front where it is there
    #: The study's bounds, if its values are those of a list of gearboxes, whose end ``bound`` then is
    given: Bounds | None = None
    motor: str = ""  #: with which it is there, where the motor decides the list; else empty

    @property
    def words(self) -> str:
        """The bound in words, such as "its lower bound of 5 N/m" or "the last gearbox, 7.6 with MN8014"."""
        if self.given is not None:
            whose = f" with {self.motor}" if self.motor else ""
            return f"the {'first' if self.side == 'lower' else 'last'} gearbox, {self.bound:.4g}{whose}"
        unit = next(one for one in (*VARIABLES, *KNOTS) if one.name == self.name).unit
        return f"its {self.side} bound of {self.bound:.4g} {unit}".removesuffix(" 1")

    @property
    def within(self) -> str:
        """The bounds that the list of gearboxes lies within, such as ", within 4 to 8.7"; else empty."""
        return "" if self.given is None else f", within {self.given.lower:g} to {self.given.upper:g}"


@dataclass(frozen=True, slots=True, kw_only=True)
class _Range:
    """Ends of the values that a variable can have in the designs of the front that ``own`` says, shape (n,)."""

    lower: float
    upper: float
    own: NDArray[np.bool_]
    listed: bool
    motor: str = ""


def at_bounds(data: StudyData, front: pd.DataFrame) -> list[AtBound]:
    """Return the free variables at a bound on at least ``_WORTH_TELLING`` of the front, the greatest share first."""
    along = front[data.study.objectives.names[0]].to_numpy(dtype=np.float64)
    found = []
    for name in data.study.free:
        given = data.study.variables[name]
        assert isinstance(given, Bounds)
        values = front[name].to_numpy(dtype=np.float64)
        for one in _ranges(data, front, name):
            # Gearboxes are told apart exactly: the last but one may be close to the last.
            near = 0.0 if one.listed else _AT * (one.upper - one.lower)
            sides = (("lower", one.lower, values <= one.lower + near), ("upper", one.upper, values >= one.upper - near))
            for side, bound, at in sides:
                there = at & one.own
                share = float(there.mean())
                if share >= _WORTH_TELLING:
                    parts, ends = _parts(along, there), given if one.listed else None
                    found.append(
                        AtBound(
                            name=name, side=side, bound=bound, share=share, parts=parts, given=ends, motor=one.motor
                        )
                    )
    return sorted(found, key=lambda one: -one.share)


def bound_lines(data: StudyData, front: pd.DataFrame) -> dict[str, str]:
    """Return each variable at a bound -> the sentence that says at which, and where; the greatest share first."""
    if len(front) == 0:
        return {}
    entry = measure(data.study.objectives.names[0])
    by_name: dict[str, list[AtBound]] = {}
    for one in at_bounds(data, front):
        by_name.setdefault(one.name, []).append(one)
    # A design is at one bound of a variable only, so shares add up.
    order = sorted(by_name, key=lambda name: -sum(one.share for one in by_name[name]))
    return {name: _line(by_name[name], entry) for name in order}


def _ranges(data: StudyData, front: pd.DataFrame, name: str) -> list[_Range]:
    """Return the ranges of a variable, one for each motor that decides its gearboxes, that leave a choice."""
    where = data.coordinates
    limits = where.motor_limits(name)
    if limits is None:
        lower, upper = where.limits(name)
        listed = name in where.space.gears
        found = [_Range(lower=lower, upper=upper, own=np.full(len(front), True), listed=listed)]
    else:
        motors = front[limits[0]].to_numpy()
        found = [
            _Range(lower=lower, upper=upper, own=np.asarray(motors == motor), listed=True, motor=motor)
            for motor, (lower, upper) in limits[1].items()
        ]
    return [one for one in found if one.lower < one.upper]


def _parts(along: NDArray[np.float64], there: NDArray[np.bool_]) -> tuple[Part, ...]:
    """Return the parts of the front, divided where no design ``there`` lies within ``_GAP`` of its extent."""
    values = np.sort(along[there])
    ends = np.flatnonzero(np.diff(values) > _GAP * float(np.ptp(along)))
    first, last = [0, *(ends + 1).tolist()], [*ends.tolist(), len(values) - 1]
    return tuple(
        Part(
            least=float(values[a]),
            greatest=float(values[b]),
            share=float(there[(along >= values[a]) & (along <= values[b])].mean()),
        )
        for a, b in zip(first, last, strict=True)
    )


def _line(found: list[AtBound], entry: Measure) -> str:
    """Return the sentence on all bounds of a variable."""
    within = found[0].within
    subject, comma = (f"{found[0].name}{within},", ",") if within else (found[0].name, "")
    clauses = [
        f"at {one.words}{comma} in {100.0 * one.share:.0f} % of the front ({_where(one, entry)})" for one in found
    ]
    return f"{subject} is {'; '.join(clauses)}"


def _where(found: AtBound, entry: Measure) -> str:
    """Return the parts of the front, such as "all of height 0.600 to 0.700 m, 86 % of 0.900 to 1.000 m"."""
    texts = []
    for part in found.parts:
        ends = [entry.text(part.least), entry.text(part.greatest)]
        if ends[0] != ends[1]:
            ends[0] = ends[0].removesuffix(f" {entry.shown_unit}")
        # Rounded up to 100 %, it would say that all are there.
        share = "all" if part.share == 1.0 else f"{min(99.0, 100.0 * part.share):.0f} %"
        texts.append(f"{share} of {' to '.join(dict.fromkeys(ends))}")
    first, *others = texts
    return ", ".join((first.replace(" of ", f" of {entry.short} ", 1), *others))


_BINDING_AT = 0.01
"""Share of a constraint's limit within which a design is at it. Our own choice: 1 percent is 40 g of a 4 kg robot."""


def binding_limits(data: StudyData, trial: int) -> list[str]:
    """Return a phrase for each limit that a trial is at: bounds first, then constraints; none if it is free.

    A search would leave such a limit if it could, so that widening it may lead to a better design.
    """
    row = data.trials[data.trials["trial"] == trial]
    return [
        *(f"{found.name} at {found.words}{found.within}" for found in at_bounds(data, row)),
        *_constraints(data, row),
    ]


def front_alone(front: StudyFront) -> StudyData:
    """Return a study of which only the front was read: without its other trials, history, audits and checkpoint."""
    found = StudyData(
        db=front.db,
        study=front.study,
        meta=front.meta,
        trials=front.rows,
        history=pd.DataFrame(),
        audits=pd.DataFrame({"trial": [], "well_conditioned": []}),
        checkpoint=Checkpoint(generation=0, evaluations=0, state={}),
        parts=(),
        sealed=front.sealed,
    )
    vars(found)["content_hash"] = front.content_hash  # that of all trials, whose digests it has not
    return found


def _constraints(data: StudyData, row: pd.DataFrame) -> list[str]:
    phrases = []
    for limit in data.study.constraints.limits:
        values = row[limit.measure].to_numpy(dtype=np.float64)
        if -_BINDING_AT <= limit.shares(values)[0] <= 0.0:
            entry = measure(limit.measure)
            unit = "" if entry.unit == "1" else f" {entry.unit}"
            least = "most" if limit.side == "max" else "least"
            phrases.append(f"{limit.measure} {values[0]:.4g}{unit}, at {least} {limit.value:g}{unit} is asked")
    return phrases
