"""The duty of a joint as turns per hour, and the life of a bearing under it."""

from collections.abc import Sequence
from functools import reduce

import numpy as np

from pareto_monoped.actuator.rating_data import DutyData
from pareto_monoped.actuator.service.data import ServiceData
from pareto_monoped.geometry.shapes import Numbers


def output_turns_per_hour(duty: DutyData, service: ServiceData) -> float:
    """Angle through which the output turns in an hour, in whole turns."""
    return 60.0 * service.jumps_per_minute * sum(duty.output_angles_rad) / (2.0 * np.pi)


def life_turns(loads_n: Sequence[Numbers], rating_n: Numbers, exponent: float, duty: DutyData) -> Numbers:
    """L10 in turns of the bearing (ISO 281), summed over the duty's levels (Palmgren and Miner).

    Args:
        loads_n: equivalent load at each level of the duty.
        rating_n: C.
        exponent: 3 for balls, 10 / 3 for rollers.
        duty: whose angles weigh the levels.
    """
    whole = sum(duty.output_angles_rad)
    levels = zip(loads_n, duty.output_angles_rad, strict=True)
    used = [angle / whole * (load / rating_n) ** exponent for load, angle in levels]
    return 1e6 / reduce(np.add, used)
