"""Designs, their loads, and their factors one by one."""

from functools import lru_cache

import numpy as np

from pareto_monoped.actuator.search import map_for
from pareto_monoped.design import LOWER, NAMES, UPPER, complete
from pareto_monoped.jump.calibration import load_calibration
from pareto_monoped.jump.evaluate import Evaluator
from pareto_monoped.leg.dimensions import leg_dimensions
from pareto_monoped.strength.factors import TABLE
from pareto_monoped.strength.joint import ActuatorJoint, Structure, loads_of


@lru_cache(maxsize=4)
def jumped(rules="iso6336", n=30):
    """A map, random designs of the paper's bounds, their evaluations, and their loads."""
    actuator_map = map_for("VT8020", rules=rules)
    designs = complete(np.random.default_rng(11).uniform(LOWER, UPPER, (n, len(LOWER))))
    result = Evaluator(actuator_map, load_calibration("reference"))(designs)
    return actuator_map, designs, result, loads_of(dict(zip(NAMES, designs.T, strict=True)) | result.as_columns())


def structure(actuator_map, ratio):
    return Structure(
        actuator=actuator_map.lookup(ratio), leg=leg_dimensions(actuator_map), settings=actuator_map.settings
    )


def factors_one_by_one(actuator_map, design, loads, i):
    """Factors of design ``i``: plain numbers, every capacity computed anew for the gearbox that ``lookup`` gives."""
    found = {}
    for joint in TABLE:
        side = joint.side if isinstance(joint, ActuatorJoint) else "hip"
        carried = joint.capacity(structure(actuator_map, float(design[NAMES.index(f"{side}_ratio")])))
        acting = [float(loads[name][i]) for name in joint.loads]
        with np.errstate(divide="ignore"):
            value = joint.factor(*map(np.float64, np.atleast_1d(carried)), *map(np.float64, acting))
        found[joint.name] = float(np.minimum(value, 1000.0))
    return found
