"""What goes with a calibration by its name alone; reading a stored study needs no more, and no simulator."""

import re

from pareto_monoped.design import DEFAULT_RULES, RuleSet
from pareto_monoped.errors import CalibrationError, InputError, complaint

DEFAULT = "reference"
STAND = "stand"  #: The calibration whose robot jumps on the rails of the test stand.
_PAPER = "paper"
_PAPER_COPIES = 11
"""Our own choice: Table I's medians of 11 copies are within 0.1 percent of those of 100."""
OWN_CALIBRATION = "own:"  #: How the name of a calibration begins whose values stand only in the study's database.


def rules_for(
    calibration: str, asked: RuleSet | None = None, *, key: str = "rules", error: type[InputError] = CalibrationError
) -> RuleSet:
    """Return the rules ``asked``, or the gearbox rules that go with a calibration, given by name or path.

    The calibration ``paper`` is fitted with the paper's gearboxes; any other rules raise ``error`` (its line begins
    with ``key``).
    """
    if not _is_paper(calibration):
        return DEFAULT_RULES if asked is None else asked
    if asked not in (None, "paper"):
        allowed = f"'paper' with the calibration {_PAPER!r}, which is fitted with these gearboxes"
        raise error(complaint(key, asked, allowed, "drop it, or choose another calibration"))
    return "paper"


def strength_for(calibration: str) -> bool:
    """Return whether a study asks for strength by default: not under ``paper``, whose robot has no end stops."""
    return not _is_paper(calibration)


def copies_for(calibration: str) -> int:
    """Return how many copies' median a study scores a design by: several under ``paper``, whose jumps are chaotic."""
    return _PAPER_COPIES if _is_paper(calibration) else 1


def is_stand(calibration: str) -> bool:
    """Return whether a name is that of the calibration ``stand``, with or without a version."""
    return _is(STAND, calibration)


def _is_paper(calibration: str) -> bool:
    return _is(_PAPER, calibration)


def _is(name: str, calibration: str) -> bool:
    return re.fullmatch(rf"{name}(-\d+)?", calibration) is not None
