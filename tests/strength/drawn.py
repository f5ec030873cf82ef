"""The parts of the default robot, and what their drawn sections have: areas, second moments, cuts."""

import numpy as np
import shapely

from pareto_monoped.actuator.search import map_for
from pareto_monoped.leg.base import base_parts
from pareto_monoped.leg.dimensions import leg_dimensions
from pareto_monoped.leg.hip import hip_joints
from pareto_monoped.leg.shank import shank_parts
from pareto_monoped.leg.thigh import thigh_parts
from pareto_monoped.strength.factors import TABLE
from tests.leg.polygons import polygon
from tests.strength.support import structure

MAP = map_for("VT8020")
D = leg_dimensions(MAP)
FOUND = [entry.actuator for entry in MAP.entries if entry.actuator is not None]
BOTH = {family: structure(MAP, next(a.ratio for a in FOUND if a.family == family)) for family in ("ISSPG", "ESSPG")}
S = BOTH["ESSPG"]
ROWS = {joint.name: joint for joint in TABLE}
THIGH = {part.name: part for part in thigh_parts(0.4, D)}
SHANK = {part.name: part for part in shank_parts(0.4, D)}
BASE = {part.name: part for part in base_parts(0.07, D)}
DRIVE = {part.name: part for part in hip_joints(D)}


def region(prism):
    """A prism's section with its holes."""
    return drawn(prism.outline).difference(shapely.union_all([drawn(hole) for hole in prism.holes]))


def drawn(hole):
    """A shape as a polygon."""
    if hasattr(hole, "centres_mm"):
        return shapely.union_all([shapely.Point(*at).buffer(float(hole.radius_mm), 128) for at in hole.centres_mm()])
    if hasattr(hole, "radius_mm"):
        return shapely.Point(float(hole.x_mm), float(hole.y_mm)).buffer(float(hole.radius_mm), 128)
    return polygon(hole)


def second_moment_mm4(shape, n=1500):
    """About the x axis, by slices along y."""
    low, high = shape.bounds[1], shape.bounds[3]
    ys = low + (np.arange(n) + 0.5) / n * (high - low)
    wide = [shape.intersection(shapely.LineString([(-999.0, y), (999.0, y)])).length for y in ys]
    return float(np.sum(ys**2 * wide) * (high - low) / n)


def cut_at(part, y_mm):
    """The pieces of a plate that a line across it meets, from the drawn section."""
    (prism,) = part.prisms
    line = region(prism).intersection(shapely.LineString([(-999.0, y_mm), (999.0, y_mm)]))
    pieces = getattr(line, "geoms", [line])
    return [(piece.bounds[0], piece.bounds[2]) for piece in pieces]
