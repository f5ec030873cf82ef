"""Stored rows of trials as a data frame: every column there is, each of its type, with the names of the motors."""

from collections.abc import Iterable
from itertools import islice
from typing import Any

import numpy as np
import pandas as pd

from pareto_monoped.design import DEFAULTS
from pareto_monoped.errors import DatabaseError
from pareto_monoped.study.columns import COLUMNS, LATER, REQUIRED
from pareto_monoped.study.definition import Study
from pareto_monoped.study.meta import StudyMeta, motor_keys
from pareto_monoped.study.named_motors import MOTOR_KEYS, names_of
from pareto_monoped.study.place import StudyPlace

_DTYPES = {column.name: column.dtype for column in COLUMNS}


_BLOCK = 20_000
"""Rows that are values of Python at once, eight times as large as in the frame: 40 MB. Our own choice."""


def trial_frame(names: list[str], rows: Iterable[tuple[Any, ...]], db: StudyPlace) -> pd.DataFrame:
    """Trials as read from the database.

    Args:
        names: of the columns that were read.
        rows: values of these columns, one row per trial, read block by block.
        db: the database, for messages.

    Raises:
        DatabaseError: a value is not of its column's type, or a required column is missing.
    """
    left = iter(rows)
    try:
        frames = [_frame(names, list(islice(left, _BLOCK)))]
        while block := list(islice(left, _BLOCK)):
            frames.append(_frame(names, block))
    except (KeyError, TypeError, ValueError, OverflowError) as error:
        raise DatabaseError(
            f"study database {str(db)!r}: its trials are damaged ({type(error).__name__}: {error}); restore a copy"
        ) from None
    return pd.concat(frames, ignore_index=True)


def _frame(names: list[str], rows: list[tuple[Any, ...]]) -> pd.DataFrame:
    columns: dict[str, tuple[Any, ...]] = dict.fromkeys(names, ())
    if rows:
        columns = dict(zip(names, zip(*rows, strict=True), strict=True))
    for column in LATER:
        columns.setdefault(column.name, (DEFAULTS.get(column.name),) * len(rows))
    known = [*REQUIRED, *(column.name for column in COLUMNS if column.name not in REQUIRED)]
    ordered = [*known, *(name for name in columns if name not in known)]
    # A column that only a later version knows is read as a number, as every measure is.
    return pd.DataFrame({name: _typed(columns[name], _DTYPES.get(name, "float64")) for name in ordered})


def _typed(values: tuple[Any, ...], dtype: str) -> Any:
    if dtype == "str":
        return pd.array(["" if value is None else str(value) for value in values], dtype="str")
    if dtype == "int64":
        return np.array(values, dtype=np.int64)
    return np.array([np.nan if value is None else value for value in values], dtype=np.float64)


def with_motors(trials: pd.DataFrame, study: Study, meta: StudyMeta, db: StudyPlace) -> pd.DataFrame:
    """The trials with the names of each one's motors, which the database leaves out where all have the same.

    The column ``motor`` always says what motors a trial has; ``hip_motor`` and ``knee_motor`` stand only where the
    study names them.

    Raises:
        DatabaseError: a trial has a motor that the study does not name.
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
        from pareto_monoped.actuator.joint_maps import motor_label

        labels = map(motor_label, trials["hip_motor"], trials["knee_motor"])
        trials = trials.assign(motor=pd.array(list(labels), dtype="str"))
    return trials
