"""The base's cheeks, whose holes keep apart whatever motor they are drilled for."""

import dataclasses
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
@pytest.mark.parametrize(
    "motor",
    [pytest.param(name, marks=() if name in ("VT8020", "MN8014") else pytest.mark.long) for name in motor_names()],
)
def test_the_round_holes_of_the_cheeks_keep_apart(motor, rules):
    found = {part.name: part for part in base_parts(0.06, leg_dimensions(map_for(motor, rules)))}
    for name in ("base_near_cheek", "base_far_cheek"):
        for prism in found[name].prisms:
            holes = [disc for shape in prism.holes for disc in discs(shape)]
            assert len(holes) > 4
            assert min(one.distance(other) for one, other in combinations(holes, 2)) > LEAST_WALL_MM


@pytest.mark.parametrize("far_plate_mm", [8.0, 10.0, 12.0])
def test_the_shank_of_a_rod_s_screw_ends_where_the_rod_begins(leg, far_plate_mm):
    """It goes through its own cheek, the upper ones through the driver's plate too, and then into the thread."""
    parts = base_parts(0.09, dataclasses.replace(leg, far_cheek_mm=far_plate_mm))
    spans = {part.name: [(float(p.z0_mm), float(p.z1_mm)) for p in part.prisms] for part in parts}
    (rod,) = spans["base_rod"]
    for side, face, joint in (("near", rod[0], "hip"), ("far", rod[1], "knee")):
        cheek = [z for span in spans[f"base_{side}_cheek"] for z in span]
        plate = spans[f"{joint}_driver_plate"][0]
        outer = {"lower": cheek, "upper": [*cheek, *plate]}
        for row, through in outer.items():
            _, shank, thread = spans[f"base_{row}_rod_screw_{side}"]
            assert shank == pytest.approx((min(through), max(through)))
            assert face in shank
            assert 5.0 <= thread[1] - thread[0] <= 10.0
            assert min(rod) <= min(thread) < max(thread) <= max(rod)
