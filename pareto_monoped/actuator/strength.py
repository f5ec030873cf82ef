"""Face width from the strength of the sun's teeth: Lewis with Barth's velocity factor."""

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.actuator.gearset import GearSet
from pareto_monoped.actuator.motors import Motor
from pareto_monoped.actuator.settings import ActuatorSettings
from pareto_monoped.geometry.shapes import Numbers

# Lewis form factor Y of 20 degree full-depth teeth over the number of teeth: Shigley, table 14-2.
_LEWIS = np.array(
    [
        (12, 0.245), (13, 0.261), (14, 0.277), (15, 0.290), (16, 0.296), (17, 0.303), (18, 0.309), (19, 0.314),
        (20, 0.322), (21, 0.328), (22, 0.331), (24, 0.337), (26, 0.346), (28, 0.353), (30, 0.359), (34, 0.371),
        (38, 0.384), (43, 0.397), (50, 0.409), (60, 0.422), (75, 0.435), (100, 0.447), (150, 0.460), (300, 0.472),
    ]
)  # fmt: skip

LEAST_WIDTH_MODULES = 6.0
"""Face width is at least this many modules (Niemann/Winter: 6 to 10 for narrow gears), where strength asks for less."""


def lewis_form_factor(teeth: Numbers) -> NDArray[np.float64]:
    """Y, interpolated linearly; constant beyond the table's ends."""
    return np.asarray(np.interp(teeth, _LEWIS[:, 0], _LEWIS[:, 1]))


def velocity_factor(speed_m_per_s: Numbers) -> Numbers:
    """Barth's factor for milled or hobbed teeth, (6.1 + v) / 6.1 (Shigley, eq. 14-6b)."""
    return (6.1 + speed_m_per_s) / 6.1


def face_width_mm(gears: GearSet, motor: Motor, settings: ActuatorSettings) -> Numbers:
    """Least face width at which the sun's teeth carry the motor's peak torque.

    Every mesh of the sun carries an equal share of the torque. The sun's teeth are the weakest: all ratios are 4 or
    more, so no planet has fewer teeth. The speed is that of the pitch point against the carrier, which decides how hard
    teeth strike each other. It is taken at the motor's no-load speed, an upper bound.
    """
    radius_m = 0.5e-3 * gears.module_mm * gears.sun_teeth
    force_n = settings.parts.gears.service_factor * motor.peak_torque_n_m / (radius_m * gears.planets)
    speed = motor.no_load_speed_rad_per_s * (1.0 - 1.0 / gears.ratio) * radius_m
    stress_mpa = settings.materials.gear_steel.allowable_stress_mpa / settings.parts.gears.factor_of_safety
    weakest = np.minimum(gears.sun_teeth, gears.planet_teeth)
    strong = velocity_factor(speed) * force_n / (stress_mpa * gears.module_mm * lewis_form_factor(weakest))
    return np.maximum(strong, LEAST_WIDTH_MODULES * gears.module_mm)
