"""Triangles -> pixels with a depth buffer, compiled by numba; another thread runs on meanwhile.

Importing this module imports numba, so it is imported where a picture is drawn.
"""

import numpy as np
from numpy.typing import NDArray

from pareto_monoped.jump.compiled import compiled

Floats = NDArray[np.float64]
Indices = NDArray[np.int32]


@compiled
def nearest(triangles: Floats, winner: Indices, depth: Floats) -> None:
    """Which triangle is nearest at each pixel, and how near; of equally near ones the first.

    Args:
        triangles: corners in pixels to the right, pixels down, and towards the viewer, shape (n, 3, 3).
        winner: the triangle's index, shape (height, width); pixels that none covers are left as they are.
        depth: how near, shape (height, width); -infinity where there is nothing yet.
    """
    height, width = winner.shape
    for index in range(len(triangles)):
        t = triangles[index]
        area = (t[1, 0] - t[0, 0]) * (t[2, 1] - t[0, 1]) - (t[1, 1] - t[0, 1]) * (t[2, 0] - t[0, 0])
        if area == 0.0:
            continue
        # Depth is linear over a triangle.
        slope_x = ((t[1, 2] - t[0, 2]) * (t[2, 1] - t[0, 1]) - (t[2, 2] - t[0, 2]) * (t[1, 1] - t[0, 1])) / area
        slope_y = ((t[2, 2] - t[0, 2]) * (t[1, 0] - t[0, 0]) - (t[1, 2] - t[0, 2]) * (t[2, 0] - t[0, 0])) / area
        top, bottom = min(t[0, 1], t[1, 1], t[2, 1]), max(t[0, 1], t[1, 1], t[2, 1])
        # A pixel belongs to the triangle that covers its centre.
        for row in range(max(int(np.ceil(top - 0.5)), 0), min(int(np.ceil(bottom - 0.5)), height)):
            y = row + 0.5
            left, right = np.inf, -np.inf
            for i in range(3):
                j = (i + 1) % 3
                y0, y1 = t[i, 1], t[j, 1]
                if y0 != y1 and min(y0, y1) <= y <= max(y0, y1):
                    x = t[i, 0] + (y - y0) / (y1 - y0) * (t[j, 0] - t[i, 0])
                    left, right = min(left, x), max(right, x)
            if left > right:
                continue
            for column in range(max(int(np.ceil(left - 0.5)), 0), min(int(np.ceil(right - 0.5)), width)):
                z = t[0, 2] + slope_x * (column + 0.5 - t[0, 0]) + slope_y * (y - t[0, 1])
                if z > depth[row, column]:
                    depth[row, column] = z
                    winner[row, column] = index


@compiled
def composed(winner: Indices, depth: Floats, owner: Indices, colours: Floats, line: Floats, jump: float) -> Floats:
    """Colours from 0 to 1 of a picture of half the width and height, with lines where another body or depth begins.

    Args:
        winner: index of the triangle at each pixel, shape (2 height, 2 width); the last colour's where none is.
        depth: how near it is, the same shape.
        owner: body of each triangle, and a last number for the background.
        colours: red, green and blue of each triangle, and last of the paper.
        line: colour of the lines.
        jump: difference of depth that makes a line.
    """
    height, width = winner.shape
    picture = np.zeros((height // 2, width // 2, 3))
    for row in range(height):
        for column in range(width):
            here = winner[row, column]
            edge = False
            for step in range(2):
                there_row, there_column = row + step, column + 1 - step
                if there_row < height and there_column < width:
                    there = winner[there_row, there_column]
                    if owner[there] != owner[here] or abs(depth[there_row, there_column] - depth[row, column]) > jump:
                        edge = True
            for channel in range(3):
                colour = line[channel] if edge else colours[here, channel]
                picture[row // 2, column // 2, channel] += 0.25 * colour
    return picture
