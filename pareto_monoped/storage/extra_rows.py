"""Tables that only some studies have: robustness and limit per trial, sensitivity per trial and kind of factors.

Their rows have their place in the running hash.
"""

import sys
from collections.abc import Callable
from dataclasses import asdict, dataclass
from typing import Any, Generic, TypeVar, get_args

from pareto_monoped.config import Strict, checked, parsed_json
from pareto_monoped.errors import DatabaseError
from pareto_monoped.storage.connection import Connection
from pareto_monoped.storage.place import StudyPlace, storage_of
from pareto_monoped.storage.seals import damaged, has_seals, read_seals
from pareto_monoped.uncertainty.sensitivity import About, Sensitivity
from pareto_monoped.uncertainty.statistics import Robustness

T = TypeVar("T")
Row = tuple[int | str, str, str]
"""A key, the settings under which something was simulated, and the result, both as JSON."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ExtraTable:
    """A table of keys, settings and results."""

    what: str  #: its name in the running hash and in messages
    key: str  #: SQL of the column that is the key

    @property
    def create(self) -> str:
        """Statement that makes the table where it is missing."""
        columns = f"{self.key} PRIMARY KEY, settings TEXT NOT NULL, result TEXT NOT NULL"
        return f"CREATE TABLE IF NOT EXISTS monoped_{self.what} ({columns})"

    def rows(self, connection: Connection) -> list[Row]:
        """Return all rows by their keys; none if the study has no such table."""
        there = ("table", f"monoped_{self.what}") in connection.objects()
        key = self.key.split()[0]
        select = f"SELECT {key}, settings, result FROM monoped_{self.what} ORDER BY {key}"
        return connection.execute(select).fetchall() if there else []


@dataclass(frozen=True, kw_only=True)  # without slots: aliases of generic classes with slots cannot be called
class StoredResult(Generic[T]):
    """A result, and the settings that it was simulated under."""

    settings: dict[str, Any]
    result: T


@dataclass(frozen=True, slots=True, kw_only=True)
class Perturbed(Strict):
    """A jump with what robots have and models do not; height 0 where there is no jump."""

    late_m: float  #: change of its height with 2 ms of delay
    #: weak_m, strong_m: the same with 5 percent less and more torque of both motors
    weak_m: float
    strong_m: float
    #: p05_m, p95_m: percentiles of the height of robots as built
    p05_m: float
    p95_m: float
    reaches: float  #: share of them that reach 95 percent of the height that was asked for
    holds: float  #: share of them that overload no part and press no bumper beyond its travel


@dataclass(frozen=True, slots=True, kw_only=True)
class Reached(Strict):
    """One jump with the hardware of a design: a certificate."""

    height_m: float
    energy_j: float  #: the energy that the search is for
    design: dict[str, float]  #: with the knots of ``controller``
    controller: dict[str, Any]  #: as a table of a study file; the virtual leg where nothing better was found
    #: half_step_height_m, half_step_energy: changes with the step halved; the energy's as a share
    half_step_height_m: float
    half_step_energy: float
    perturbed: Perturbed | None = None  #: of ``Limit.over_time`` and ``Limit.tracking`` alone


@dataclass(frozen=True, slots=True, kw_only=True)
class Limit(Strict):
    """What the hardware of one design reaches."""

    trial: int | None
    energy: str  #: which energy, one of ``measures.ENERGIES``
    height_m: float  #: of the design's own jump
    energy_j: float
    floor_j: float  #: below which no controller can be at this height
    #: Share of the design's energy in percent that the best torque found saves at its height; at least 0
    controller_gap: float
    #: The same without overloading a part; below 0 only where the design's own jump overloads one
    controller_gap_held: float | None
    least: Reached  #: least energy of a jump at least as high, by any law
    greatest: Reached  #: greatest height
    #: The same among jumps that overload no part; None where none was found
    least_held: Reached | None
    greatest_held: Reached | None
    over_time: Reached  #: least energy of torques over time, of jumps that hold if there are any
    #: Least energy at the height of the law ``tracking`` that reaches 95 percent of it late and with other motors; None
    #: where none was found
    tracking: Reached | None
    perturbed: Perturbed | None  #: the design's own jump; None where a calibration has no room for delays
    jumps: int  #: that were made

    def text(self) -> str:
        """Return the gap in words."""
        held = self.controller_gap_held
        also = "with a part overloaded" if held is None else f"{held:.1f} % without overloading a part"
        text = f"controller gap: the best torque found takes {self.controller_gap:.1f} % less for its height, {also}"
        if self.tracking is None or self.tracking.perturbed is None:
            return text
        gap, kept = 100.0 * (1.0 - self.tracking.energy_j / self.energy_j), 100.0 * self.tracking.perturbed.reaches
        return f"{text}; tracking takes {gap:.1f} % less, and {kept:.0f} % of robots as built keep its height"

    def as_dict(self) -> dict[str, Any]:
        """Return JSON values."""
        return asdict(self)


Stored = StoredResult[Robustness]
StoredSensitivity = StoredResult[Sensitivity]
StoredLimit = StoredResult[Limit]


def read_rows(db: StudyPlace, table: ExtraTable, make: Callable[[Any, Any, str], T]) -> dict[Any, StoredResult[T]]:
    """Read settings and results by key, and check them against the running hash.

    ``make`` turns a key, the result's JSON values and a source for messages into a result.
    """
    with storage_of(db).reading() as connection:
        rows = table.rows(connection)
        seals = read_seals(connection, db, since=sys.maxsize) if has_seals(connection) else None
        findings = [] if seals is None else seals.row_findings(table.what, rows)
    if findings:
        raise damaged(db, findings)
    source = f"study database {str(db)!r}, its {table.what}"
    try:
        return {
            key: StoredResult(settings=dict(parsed_json(text)), result=make(key, parsed_json(result), source))
            for key, text, result in rows
        }
    except (TypeError, ValueError, RecursionError) as error:
        raise DatabaseError(
            f"study database {str(db)!r}: its {table.what} is damaged ({type(error).__name__}: {error}); restore a copy"
        ) from None


ROBUSTNESS = ExtraTable(what="robustness", key="trial INTEGER")


def read_robustness(db: StudyPlace) -> dict[int, Stored]:
    """Read the stored robustness of a study by trial; empty if it has none."""

    def result(_: Any, values: Any, source: str) -> Robustness:
        return checked(Robustness, values, source=source, error=DatabaseError)

    return {int(trial): stored for trial, stored in read_rows(db, ROBUSTNESS, result).items()}


LIMITS = ExtraTable(what="limits", key="trial INTEGER")


def read_limits(db: StudyPlace) -> dict[int, StoredLimit]:
    """Read the stored limits of a study's designs by trial; empty if it has none."""

    def result(_: Any, values: Any, source: str) -> Limit:
        return checked(Limit, values, source=source, error=DatabaseError)

    return {int(trial): stored for trial, stored in read_rows(db, LIMITS, result).items()}


SENSITIVITY = ExtraTable(what="sensitivity", key="trial_and_factors TEXT")


def key_of(trial: int, about: About) -> str:
    """Return the key of a row, such as "17 assumptions"."""
    return f"{trial} {about}"


def read_sensitivity(db: StudyPlace) -> dict[tuple[int, About], StoredSensitivity]:
    """Read the stored sensitivities of a study by trial and kind of factors; empty if it has none."""
    found = read_rows(db, SENSITIVITY, _sensitivity)
    return {(int(key.split()[0]), stored.result.about): stored for key, stored in found.items()}


def _sensitivity(key: Any, values: Any, source: str) -> Sensitivity:
    trial, _, about = str(key).partition(" ")
    result = checked(Sensitivity, values, source=source, error=DatabaseError)
    if not trial.isdecimal() or about != result.about or about not in get_args(About):
        raise ValueError(f"a row is called {key!r}")
    return result
