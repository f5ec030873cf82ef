"""The base's cheeks, whose holes keep apart whatever motor they are drilled for."""

from itertools import combinations

import numpy as np
import pytest
import shapely
import shapely.affinity

from pareto_monoped.actuator.motors import motor_names
from pareto_monoped.actuator.search import map_for
from pareto_monoped.design import RULE_SETS
from pareto_monoped.geometry.shapes import Circle, Pattern
from pareto_monoped.leg.base import base_parts
from pareto_monoped.leg.dimensions import leg_dimensions

LEAST_WALL_MM = 1.4


def discs(shape):
    """Every round hole of a shape as a polygon that lies within it."""
    if isinstance(shape, Circle):
        return [shapely.Point(shape.x_mm, shape.y_mm).buffer(shape.radius_mm, quad_segs=64)]
    if isinstance(shape, Pattern):
        centre = shapely.Point(shape.pitch_radius_mm, 0.0)
        return [
            shapely.affinity.rotate(
                centre, shape.phase_rad + 2.0 * np.pi * k / shape.count, origin=(0.0, 0.0), use_radians=True
            ).buffer(shape.radius_mm, quad_segs=64)
            for k in range(shape.count)
        ]
    return []


@pytest.mark.parametrize("rules", RULE_SETS)
@pytest.mark.parametrize("motor", motor_names())
def test_the_round_holes_of_the_cheeks_keep_apart(motor, rules):
    found = {part.name: part for part in base_parts(0.06, leg_dimensions(map_for(motor, rules)))}
    for name in ("base_near_cheek", "base_far_cheek"):
        for prism in found[name].prisms:
            holes = [disc for shape in prism.holes for disc in discs(shape)]
            assert len(holes) > 4
            assert min(one.distance(other) for one, other in combinations(holes, 2)) > LEAST_WALL_MM
