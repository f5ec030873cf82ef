"""Everything that this package raises on purpose, as a tree of exceptions.

    ParetoMonopedError          everything this package raises on purpose; exit code 1
    |-- InputError              what the user gave cannot be used; exit code 2
    |   |-- DesignError         a design variable or a robot that cannot be built
    |   |-- MotorError          a motor name or a motor file
    |   |-- CalibrationError    a calibration name or a calibration file
    |   |-- StudyError          a study file, or a change that the stored study forbids
    |   |-- DatabaseError       a database that is missing, damaged, locked or not a study
    |   |   `-- LostTrialsError a database that lacks trials which were safe
    |   |-- SelectionError      a selection that no design on the front meets
    |   `-- OutputError         a file or folder that cannot be written or must not be overwritten
    |-- DiskError               a disk, or another limit of the system, that is full or fails
    |-- SimulationError         a simulation that should have worked failed
    `-- CheckError              an export failed its own checks (overlap, open mesh, ...)

Every message is one line that gives the quantity, its value, what is allowed, and the cure, in one of two forms::

    knee_ratio = 3: must be 4 to 8.7; choose another value
    motor file 'my.toml': no such file; check the path
"""


class ParetoMonopedError(Exception):
    """Base of all errors raised on purpose; the command line prints the message and exits with ``exit_code``."""

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


class SimulationError(ParetoMonopedError):
    """A simulation that should have succeeded did not."""


class CheckError(ParetoMonopedError):
    """An export failed its own checks; the message names the parts and the measured values."""


def complaint(quantity: str, value: object, allowed: str, cure: str) -> str:
    """The message of an error in the first of the two forms above."""
    return f"{quantity} = {value!r}: must be {allowed}; {cure}"
