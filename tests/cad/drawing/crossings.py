"""Which texts of a paper a line or an arrow runs through: every text against every straight piece, one by one."""

import numpy as np
import shapely

_ROUNDING_MM = 0.05


def crossed(paper):
    """The texts whose boxes a line or an arrow head meets."""
    pieces = []
    for stroke in paper.strokes:
        points = np.vstack([stroke.points, stroke.points[:1]]) if stroke.closed else stroke.points
        pieces.append(shapely.linestrings(points))
    pieces += [shapely.polygons(fill.points) for fill in paper.fills]
    found = []
    for label in paper.labels:
        x0, y0, x1, y1 = label.box()
        box = shapely.box(x0 + _ROUNDING_MM, y0 + _ROUNDING_MM, x1 - _ROUNDING_MM, y1 - _ROUNDING_MM)
        if np.any(shapely.intersects(box, pieces)):
            found.append(label.text)
    return found
