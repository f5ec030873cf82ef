"""Teeth cut as in a workshop, in shapely: a rack polygon swept through a blank, a ring along the drawn curve.

Shares no formula with the package: the rack is ISO 53's drawing, the sweep is done position by position, and the ring's
flank is where a string unwinds to.
"""

import numpy as np
import shapely
from shapely import affinity

ANGLE = np.radians(20.0)


def rack_tooth(module, feed_mm, points=25):
    """A tooth of the rack, which points down to the gear's axis; its datum line is ``feed_mm`` above y = 0."""
    rho, depth = 0.38 * module, 1.25 * module
    # The corner that the rounding replaces, and the rounding's centre by its distances from bottom and flank.
    centre_y = rho - depth
    flank_x = 0.25 * np.pi * module + centre_y * np.tan(ANGLE)  # of the flank at the centre's height
    centre_x = flank_x - rho / np.cos(ANGLE)
    turn = np.linspace(-0.5 * np.pi, -ANGLE, points)
    right = [(centre_x + rho * np.cos(t), centre_y + rho * np.sin(t)) for t in turn]
    right.append((0.25 * np.pi * module + 2.0 * module * np.tan(ANGLE), 2.0 * module))
    outline = np.array([*right, *((-x, y) for x, y in reversed(right))])
    return outline + np.array([0.0, feed_mm])


def cut_gear(teeth, module, shift, thinning_mm, tip_mm, *, spaces=1, positions=701, points=25):
    """Metal around ``spaces`` spaces of a gear, whose middle one is around the y axis, cut position by position.

    Teeth are thinned as usual, by feeding the rack deeper: by half the thinning over the tangent of its angle.
    """
    feed = shift * module - 0.5 * thinning_mm / np.tan(ANGLE)
    radius, tooth = 0.5 * teeth * module, rack_tooth(module, feed, points)
    reach = min(0.9, 18.0 / teeth)
    cuts = []
    for turned in np.linspace(-reach, reach, positions):
        x, y = tooth[:, 0] + radius * turned, tooth[:, 1] + radius
        cos, sin = np.cos(turned), np.sin(turned)
        cuts.append(shapely.Polygon(np.stack([cos * x - sin * y, sin * x + cos * y], axis=1)))
    space, pitch = shapely.union_all(cuts), 2.0 * np.pi / teeth
    spread = np.linspace(-0.5 * spaces * pitch, 0.5 * spaces * pitch, 800 * spaces)
    blank = shapely.Polygon([(0.0, 0.0), *zip(tip_mm * np.sin(spread), tip_mm * np.cos(spread), strict=True)])
    turns = pitch * (np.arange(spaces) - spaces // 2)
    return blank.difference(shapely.union_all([affinity.rotate(space, -t, (0, 0), use_radians=True) for t in turns]))


def string_flank(base_mm, low_mm, high_mm, points=400):
    """Radii and angles of an involute that starts at angle 0 on its base circle."""
    unwound = np.linspace(np.sqrt(max(low_mm**2 - base_mm**2, 0.0)), np.sqrt(high_mm**2 - base_mm**2), points) / base_mm
    x = base_mm * (np.cos(unwound) + unwound * np.sin(unwound))
    y = base_mm * (np.sin(unwound) - unwound * np.cos(unwound))
    return np.hypot(x, y), np.arctan2(y, x)


def tip_corner(teeth, module, tip_mm, thickness_mm, *, internal):
    """Angle of a tooth's tip corner from the middle of the tooth, which is so thick on the reference circle."""
    pitch, base = 0.5 * teeth * module, 0.5 * teeth * module * np.cos(ANGLE)
    at_pitch, at_tip = (string_flank(base, base, radius)[1][-1] for radius in (pitch, tip_mm))
    lean = at_tip - at_pitch
    return 0.5 * thickness_mm / pitch + (lean if internal else -lean)


def cut_ring(teeth, module, shift, widening_mm, tip_mm, points=400):
    """Metal around one space of a ring, which is around the y axis: its root is where a wire of 0.38 modules turns."""
    pitch, base = 0.5 * teeth * module, 0.5 * teeth * module * np.cos(ANGLE)
    root = pitch + (1.25 + shift) * module
    width = 0.5 * np.pi * module + 2.0 * shift * module * np.tan(ANGLE) + widening_mm
    radii, lean = string_flank(base, tip_mm, root + module, points)
    beside = 0.5 * width / pitch + string_flank(base, base, pitch)[1][-1] - lean
    radii, beside = radii[beside > 0.0], beside[beside > 0.0]
    side = np.stack([radii * np.sin(beside), radii * np.cos(beside)], axis=1)
    space = shapely.Polygon([*side, *(side[::-1] * [-1.0, 1.0])])
    space = space.union(shapely.box(-0.2 * module, 0.5 * tip_mm, 0.2 * module, tip_mm + 0.1 * module))
    space = space.intersection(shapely.Point(0.0, 0.0).buffer(root, quad_segs=4000))
    rounded = space.buffer(-0.38 * module, quad_segs=200).buffer(0.38 * module, quad_segs=200)
    whole = space.difference(shapely.Point(0.0, 0.0).buffer(root - 0.9 * module, quad_segs=2000))
    hole = rounded.union(space.difference(whole))
    spread = np.linspace(-np.pi / teeth, np.pi / teeth, 400)
    outer = [(0.0, 0.5 * tip_mm), *((root + module) * np.stack([np.sin(spread), np.cos(spread)], axis=1))]
    sector = shapely.Polygon(outer).difference(shapely.Point(0.0, 0.0).buffer(tip_mm, quad_segs=4000))
    metal = sector.difference(hole)
    return max(shapely.get_parts(metal), key=shapely.area)  # without slivers of rounding


def deepest(metal, *, teeth, distance_mm, corner, taken_rad, kind):
    """How deep a tip's corner comes into metal around the y axis that stands still while its gear rolls along.

    ``teeth`` are those of the metal and of the rolling gear; ``kind`` says which of them is a ring.
    """
    ratio = teeth[0] / teeth[1]
    worst = 0.0
    for turned in np.linspace(-1.5, 1.5, 1501) * 2.0 * np.pi / teeth[0]:
        centre = distance_mm * np.array([np.sin(turned), np.cos(turned)])
        if kind == "outside":
            angle = np.pi + turned * (1.0 + ratio) - corner[1] - taken_rad
        else:
            angle = turned * (1.0 - ratio) + corner[1] + taken_rad
            centre = -centre if kind == "ring in planet" else centre
        point = shapely.Point(centre + corner[0] * np.array([np.sin(angle), np.cos(angle)]))
        if metal.contains(point):
            worst = max(worst, metal.exterior.distance(point))
    return worst
