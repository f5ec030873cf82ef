"""What can go wrong, as a tree of exceptions.

    ParetoMonopedError          everything this package raises on purpose; exit code 1
    |-- InputError              what the user gave cannot be used; exit code 2
    |   |-- DesignError         a design variable or a robot that cannot be built
    |   |-- MotorError          a motor name or motor file
    |   |-- CalibrationError    a calibration name or file
    |   |-- StudyError          a study file, or a study that may not be changed so
    |   |-- DatabaseError       a database that is missing, damaged, locked or of another kind
    |   |-- SelectionError      no design answers the selection asked for
    |   `-- OutputError         a place that cannot be written to or must not be overwritten
    |-- SimulationError         a simulation that should have worked failed
    `-- CheckError              a finished product failed its own checks (CAD clash, open mesh, ...)

Every message is one line: the quantity, its value, what is allowed, and the cure.
"""


class ParetoMonopedError(Exception):
    """Base of all errors raised on purpose; the command line prints its one line and exits with ``exit_code``."""

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


class SelectionError(InputError):
    """No design of the front answers the selection."""


class OutputError(InputError):
    """A file or folder that cannot be written, or that would be overwritten."""


class SimulationError(ParetoMonopedError):
    """A simulation that should have succeeded did not."""


class CheckError(ParetoMonopedError):
    """A product failed its own checks; the message names the parts and the measure."""


def complaint(quantity: str, value: object, allowed: str, cure: str) -> str:
    """One line in the form every input error has: quantity, value, what is allowed, cure."""
    return f"{quantity} = {value!r}: must be {allowed}; {cure}"
