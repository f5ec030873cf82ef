"""Everything that this package raises on purpose.

The exceptions are a tree, and each docstring says what the exception means::

    ParetoMonopedError                  exit code 1
    |-- InputError                      exit code 2
    |   |-- DesignError, MotorError, CalibrationError, StudyError, SelectionError, OutputError
    |   `-- DatabaseError
    |       `-- LostTrialsError
    `-- DiskError, ServerError, SimulationError, WorkerError, CheckError

Every message is one line that gives the quantity, its value, what is allowed, and the cure, in one of two forms::

    knee_ratio = 3: must be 4 to 8.7; choose another value
    motor file 'my.toml': no such file; check the path
"""

import difflib
import re
from collections.abc import Iterable
from importlib.util import find_spec


class ParetoMonopedError(Exception):
    """Base of all errors raised on purpose; the command line prints the message and exits with ``exit_code``.

    Example:
        >>> import pareto_monoped as pm
        >>> try:
        ...     pm.load_motor("VT8021")
        ... except pm.ParetoMonopedError as error:
        ...     print(str(error)[:40])
        motor = 'VT8021': must be one of VT8020,
    """

    exit_code = 1


class InputError(ParetoMonopedError):
    """Something the user gave cannot be used."""

    exit_code = 2


class DesignError(InputError):
    """A design variable out of range, or a robot that cannot be built from the design."""


class MotorError(InputError):
    """An unknown motor, or a motor file with a missing or impossible field."""


class CalibrationError(InputError):
    """An unknown calibration, or a calibration file with a missing or impossible field."""


class StudyError(InputError):
    """A study file with unknown keys, wrong types or impossible bounds, or a forbidden change of a study."""


class DatabaseError(InputError):
    """A study database that is missing, damaged, in use, newer than this package, or no study at all."""


class LostTrialsError(DatabaseError):
    """A study that lacks trials which a killed run had stored: its log was deleted, or an old copy is back."""


class SelectionError(InputError):
    """No design on the front meets the selection."""


class OutputError(InputError):
    """A file or folder that cannot be written, or that would be overwritten."""


class DiskError(ParetoMonopedError):
    """A disk, or another limit of the system, that is full or fails; nothing the user gave is wrong."""


class ServerError(ParetoMonopedError):
    """A database server that does not answer, or ended the connection; nothing the user gave is wrong."""


class SimulationError(ParetoMonopedError):
    """A simulation that should have succeeded did not."""


class WorkerError(ParetoMonopedError):
    """Nobody is left to do the work: no scheduler, no worker, or none that computes the same numbers."""


class CheckError(ParetoMonopedError):
    """An export failed its own checks; the message names the parts and the measured values."""


_SHOWN = 400  #: Most characters that a message shows of a value: more than any path has. Our own choice.
_ADDRESS = re.compile(r" at 0x[0-9a-fA-F]+")  #: Where an object is in memory, as Python's own ``repr`` ends.


def complaint(quantity: str, value: object, allowed: str, cure: str) -> str:
    """Return the message of an error in the first of the two forms above."""
    return f"{quantity} = {shown(value)}: must be {allowed}; {cure}"


def shown(value: object) -> str:
    """Return a value as messages show it: without memory addresses, a table or a large object by its kind alone."""
    text = _ADDRESS.sub("", repr(value))
    large = len(text) > _SHOWN and not isinstance(value, str | list | tuple | dict)
    if large or "\n" in text:
        return type(value).__name__
    return text if len(text) <= _SHOWN else f"{text[:_SHOWN]}..."


def unknown_name(quantity: str, value: object, known: Iterable[str], other: str = "") -> str:
    """Return the complaint about a name that is not known; its cure is the most similar known one if there is one.

    ``quantity`` is what has the name; ``other`` is what may be given besides a name, such as ", or a TOML file".
    """
    names = {name.casefold(): name for name in known}
    near = difflib.get_close_matches(str(value).casefold(), names, n=1)
    cure = f"did you mean {names[near[0]]!r}?" if near else "correct the name"
    return complaint(quantity, value, f"one of {', '.join(names.values())}{other}", cure)


EXTRAS = {
    "cad": {"OCP": "cadquery-ocp-novtk", "manifold3d": "manifold3d", "shapely": "shapely"},
    "cluster": {"distributed": "distributed"},
    "dashboard": {"optuna_dashboard": "optuna-dashboard"},
    "parquet": {"pyarrow": "pyarrow"},
    "postgres": {"psycopg": "psycopg[binary]"},
    "video": {"imageio_ffmpeg": "imageio-ffmpeg"},
}  #: Extra -> its modules, each with the package that has it; extras that are only run as programs are left out.


def require_extra(extra: str, what: str, *, instead: str = "") -> None:
    """Refuse to begin ``what``, such as an option, without the packages of an extra; ``instead`` does without them.

    Raises:
        InputError: one of its packages is missing.
    """
    missing = [package for module, package in EXTRAS[extra].items() if find_spec(module) is None]
    if missing:
        verb = "is" if len(missing) == 1 else "are"
        way = f", or {instead}" if instead else ""
        raise InputError(
            f"{what}: needs {' and '.join(missing)}, which {verb} not installed; install the extra: "
            f"pip install 'pareto-monoped[{extra}]'{way}"
        )
