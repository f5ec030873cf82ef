"""How evenly the planets share the load."""

import numpy as np

from pareto_monoped.actuator.settings import ActuatorSettings
from pareto_monoped.geometry.shapes import Numbers


def load_sharing(planets: Numbers, settings: ActuatorSettings) -> Numbers:
    """K_gamma by the number of planets, from the settings' table for the sun's support."""
    data = settings.parts.rating
    table = data.load_sharing_fixed if data.sun_support == "fixed" else data.load_sharing_floating
    factor: Numbers = np.asarray(table)[np.minimum(np.asarray(planets).astype(int) - 2, len(table) - 1)][()]
    return factor
