"""What goes with a calibration by its name alone; reading a stored study needs no more, and no simulator."""

import re

from pareto_monoped.design import DEFAULT_RULES, RuleSet
from pareto_monoped.errors import CalibrationError, InputError, complaint

DEFAULT = "reference"
_PAPER = "paper"
OWN_CALIBRATION = "own:"
"""In a study, what the name of a calibration begins with that no file and no shipped name leads to: its values stand in
the study's database alone."""


def rules_for(
    calibration: str, asked: RuleSet | None = None, *, key: str = "rules", error: type[InputError] = CalibrationError
) -> RuleSet:
    """The gearbox rules that go with a calibration.

    The calibration ``paper`` is fitted to the paper's table with the paper's gearboxes, and means the rules ``paper``.

    Args:
        calibration: its name, or the path of a file.
        asked: the rules that were asked for, if any.
        key: where they were, for a message.
        error: which kind of ``InputError`` to raise.

    Raises:
        CalibrationError: (or ``error``) other rules than ``paper`` were asked for with the calibration ``paper``.
    """
    if not _is_paper(calibration):
        return DEFAULT_RULES if asked is None else asked
    if asked not in (None, "paper"):
        allowed = f"'paper' with the calibration {_PAPER!r}, which is fitted with these gearboxes"
        raise error(complaint(key, asked, allowed, "drop it, or choose another calibration"))
    return "paper"


def strength_for(calibration: str) -> bool:
    """Whether a study under a calibration asks for strength unless its file says otherwise.

    The calibration ``paper`` follows the paper's simulation, whose robot has no end stops.
    """
    return not _is_paper(calibration)


def _is_paper(calibration: str) -> bool:
    """Whether a name is that of the calibration ``paper``, with or without a version."""
    return re.fullmatch(rf"{_PAPER}(-\d+)?", calibration) is not None
