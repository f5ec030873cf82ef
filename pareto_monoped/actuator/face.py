"""The face width of a gear set under either set of rules."""

import numpy as np

from pareto_monoped.actuator.gearset import GearSet
from pareto_monoped.actuator.layout import Family
from pareto_monoped.actuator.motors import Motor
from pareto_monoped.actuator.rating.build import build_stage
from pareto_monoped.actuator.rating.width import least_width_mm
from pareto_monoped.actuator.settings import ActuatorSettings
from pareto_monoped.actuator.strength import face_width_mm as lewis_width_mm
from pareto_monoped.geometry.shapes import Numbers


def face_width_mm(gears: GearSet, motor: Motor, family: Family, settings: ActuatorSettings) -> Numbers:
    """Least face width that carries the motor's torque, of one gear set or of arrays of them.

    Under ``paper`` by ``strength``, under ``iso6336`` by ``rating``; there, if no width is enough, the best one.
    """
    if settings.rules == "paper":
        return lewis_width_mm(gears, motor, settings)
    return np.asarray(least_width_mm(build_stage(gears, motor, family, settings), settings.constraints_off))[()]
