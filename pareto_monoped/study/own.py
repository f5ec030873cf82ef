"""What a caller brings along that no database holds: functions, an algorithm, a calibration."""

from dataclasses import dataclass, field
from typing import Any

from pareto_monoped.jump.calibration import Calibration
from pareto_monoped.study.own_functions import Functions


@dataclass(frozen=True, slots=True, kw_only=True)
class Own:
    """What is the user's own.

    Attributes:
        functions: objectives and constraints.
        algorithm: with ``ask`` and ``tell``, or what makes one; see ``own_algorithm``.
        calibration: of a new study, whose values its database then has; None: the one that the study names.
    """

    functions: Functions = field(default_factory=dict)
    algorithm: Any = None
    calibration: Calibration | None = None


NOTHING = Own()
"""What the command line brings along."""
