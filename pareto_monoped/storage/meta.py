"""What a study database says of its study besides the trials: one checked record, one row of JSON per field."""

import json
from collections.abc import Iterable
from dataclasses import dataclass, fields
from typing import Any

from pydantic import StrictBool, StrictFloat, StrictInt

from pareto_monoped.config import checked, parsed_json
from pareto_monoped.errors import DatabaseError
from pareto_monoped.storage.place import StudyPlace

Number = StrictFloat | None
"""A number as JSON keeps it: None stands for NaN, which JSON lacks."""
# Strict types, because a stored "3" in place of 3 is damage.


def motor_keys(count: int) -> tuple[str, ...]:
    """Return the motors' keys in ``StudyMeta.contents`` and ``files``: ``motor``, or ``motor_1``, ``motor_2``, ..."""
    return ("motor",) if count == 1 else tuple(f"motor_{number}" for number in range(1, count + 1))


@dataclass(frozen=True, slots=True, kw_only=True)
class StudyMeta:
    """The table ``monoped_meta`` without its format number: key and value of each row are name and value of a field."""

    study: dict[str, Any]  #: the settings, as ``Study.as_dict`` gives them
    motor: str  #: ``Study.motor_text``: names of the motors, or paths of their files, as the study gives them
    calibration: str  #: name and version
    seed: StrictInt  #: of the search
    #: Every value of the motors (``motor_keys``) and of the ``calibration``; the study simulates with these
    contents: dict[str, dict[str, Any]]
    #: Texts of the user's own motor and ``calibration`` files, for the record; None for shipped ones
    files: dict[str, str | None]
    versions: dict[str, str]  #: of the packages that decide the results
    environment: dict[str, str]  #: Python, system and machine, for the record
    hash: str  #: SHA-256 of everything that decides the results
    probe: list[list[Number]]  #: height and energy of a few fixed designs: a fingerprint of code and machine
    created: str  #: date and time, ISO 8601 in UTC
    budget: StrictInt  #: how many trials it was last run for
    finished: StrictBool  #: whether the last run came to its end
    stop_reason: str | None  #: why it ended; None while it runs or after it was killed

    def as_rows(self) -> list[tuple[str, str]]:
        """Return key and JSON text of each field, as stored."""
        return [(field.name, strict_json(getattr(self, field.name))) for field in fields(self)]


def meta_of_rows(rows: Iterable[tuple[Any, Any]], db: StudyPlace) -> StudyMeta:
    """Return the record from its stored rows; raise ``DatabaseError`` for a missing value or one of the wrong type."""
    try:
        values = {str(key): parsed_json(value) for key, value in rows}
        return checked(StudyMeta, values, source="monoped_meta", error=DatabaseError)
    except (TypeError, ValueError, DatabaseError) as error:
        raise DatabaseError(f"study database {str(db)!r}: is damaged ({error}); restore a copy") from None


def strict_json(value: Any) -> str:
    """Return JSON that any reader takes; raise ``ValueError`` for NaN or infinity."""
    return json.dumps(value, allow_nan=False)
