"""Outlines as shapely polygons, drawn piece by piece."""

import numpy as np
import shapely

from pareto_monoped.geometry.shapes import Arc


def polygon(path, steps=400):
    points = []
    for piece in path.pieces:
        if isinstance(piece, Arc):
            # Without the last point, which is the next piece's first.
            angle = np.linspace(piece.start_rad, piece.end_rad, steps)[:-1]
            ring = np.stack([np.cos(angle), np.sin(angle)], axis=1)
            points += list(np.array([piece.x_mm, piece.y_mm]) + piece.radius_mm * ring)
        else:
            points += [(piece.x0_mm, piece.y0_mm)]
    return shapely.Polygon(points)
